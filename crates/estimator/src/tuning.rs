//! Every tuned number of the filter, besides the defaults of
//! [`Uncertainty`](crate::Uncertainty) and of [`FilterSettings`](crate::FilterSettings).
//! docs/model.md, "What is tuned", says what the main ones trade. A constant that follows from an
//! equation, or that only ends an iteration, stands with its code.

// Unknowns of the robust model

/// Share of its spread by which every unknown wanders within 1/30 s: copies of a particle must
/// differ.
pub(crate) const JITTER: f64 = 0.1;

/// Steepness of the transition between the two halves of rigs, per unit of ln of roughness.
pub(crate) const BETWEEN_HALVES: f64 = 10.0;

/// Standard deviation of the logarithm of the camera's unknown latency.
pub(crate) const LATENCY_SPREAD: f64 = 1.2;

/// Multiple of its median that this latency may reach: it is longer on one rig in eighty.
pub(crate) const LATEST: f64 = 15.0;

/// Time within which the estimate follows an object that is moved by hand (s).
pub(crate) const FOLLOWED: f64 = 1.0;

// Sensors of the robust model

/// Least share of a camera pose that moves particles; the rest weighs them (docs/model.md (45)).
pub(crate) const LEAST_MOVED: f64 = 0.9;

/// Likelihood of a wrong pose, relative to that of a perfect one.
pub(crate) const WRONG: f64 = 3e-7;

/// Number of unexplained camera poses in a row after which the next one is accepted.
pub(crate) const ACCEPTED_AFTER: u32 = 4;

/// ln of the mean likelihood of a camera pose below which no particle explains it.
pub(crate) const UNEXPLAINED: f64 = -10.0;

/// Standard deviations up to which the prior explains the logarithm of the camera's noise.
pub(crate) const MOST_SPREADS: f64 = 3.0;

/// Memory in poses: the newest one makes up one part in so many, since the noise may change slowly.
pub(crate) const MEMORY: f64 = 300.0;

/// Probability that a pusher which stops was commanded to stop just there, over that of a stop by a
/// jam.
pub(crate) const COMMANDED: f64 = 0.03;

/// Rate at which a stuck sensor gets free, and `threshold` changes (1/s).
pub(crate) const RECOVERY: f64 = 0.5;

/// Relative error of the table's friction, as a pusher's force shows it.
pub(crate) const FORCE_MODEL: f64 = 0.15;

/// Probability that a force is not the table's friction.
pub(crate) const FORCE_WRONG: f64 = 0.01;

// A pusher out of sight

/// Gap of the object and an unseen pusher up to which the pusher counts as having reached the
/// object (m).
pub(crate) const REACHED: f64 = 1e-3;

/// Time for which a pusher that is seen again counts as just back (s): bodies that have come to
/// overlap meanwhile part.
pub(crate) const JUST_BACK: f64 = 0.2;

/// Least speed of an unseen pusher (m/s).
pub(crate) const UNSEEN_SPEED: f64 = 0.01;

/// Time for which an object that an unseen pusher carries goes on as it does, or rests (s).
pub(crate) const UNSEEN_LASTS: f64 = 0.15;

/// Time for which it does so if the object is not seen, either (s).
pub(crate) const UNSEEN_LASTS_IN_THE_DARK: f64 = 1.0;

/// Probability that a pusher which would have reached the object has not, having stopped or been
/// lifted.
pub(crate) const MISSES: f64 = 0.25;

/// Spread of the velocity at which a pusher that has reached the object carries it on, about its
/// own, and of the turn, as a share of the pusher's last speed.
pub(crate) const AROUND: f64 = 0.5;

// Both models

/// Gap up to which bodies touch (m).
pub(crate) const TOUCHING: f64 = 1e-4;

/// Slip velocity (m/s) above which a contact slides.
pub(crate) const SLIDING: f64 = 1e-4;

/// Best log-likelihood below which no particle explains the observation. The particles are then
/// reinitialised around it (docs/method.md (27)).
pub(crate) const COLLAPSED: f64 = -6.0;

/// Largest lag of a pusher behind its logged position, in standard deviations of that position.
pub(crate) const PUSHER_SIGMAS: f64 = 3.0;

/// Stall force of an unspecified drive, as a multiple of the force μ_s m g that slides the object
/// alone at its nominal friction (docs/method.md, "Jamming").
pub const ASSUMED_STALL: f64 = 20.0;

/// Least weight of a mode, as a share of the belief.
pub(crate) const LEAST_WEIGHT: f64 = 0.02;

/// Least distance of two modes, in root mean square standard deviations of the two (Ashman, Bird &
/// Zepf 1994: D). A normal distribution cut in two has 2.6, a uniform one 3.5.
pub(crate) const LEAST_DISTANCE: f64 = 4.0;

// Track of the pusher, and the camera's clock

/// Number of intervals from which a typical one is known.
pub(crate) const TELLING_INTERVALS: usize = 5;

/// Number of typical intervals without a pose after which the camera is off.
pub(crate) const DARK_AFTER: f64 = 2.5;

/// Length above which a step is split (s).
pub(crate) const LONGEST_STEP: f64 = 0.055;

/// Length that the parts of a split step do not exceed (s).
pub(crate) const SPLIT_TO: f64 = 0.05;

/// Length of the shortest step from row to row (s). A step moves overlapping bodies apart within
/// its time: in a shorter one, a small overlap would throw them apart.
pub const SHORTEST_STEP: f64 = 5e-4;

/// Longest gap in frequent pusher poses that the tracker bridges (s). In a longer one the pusher is
/// off the plane.
pub(crate) const LONGEST_BRIDGE: f64 = 0.2;

/// Number of typical intervals between infrequent pusher poses that the tracker bridges.
pub(crate) const BRIDGED_INTERVALS: f64 = 2.5;

/// Standard deviation of a velocity about 0 at the first measurement (m/s, rad/s).
pub(crate) const INITIAL_VELOCITY_STD: f64 = 0.1;

/// Standard deviations of its own that a tracked speed must exceed to tell the pusher's direction.
pub(crate) const TELLING_SPEED: f64 = 3.0;

/// Speed below which a pusher stands, however exactly its poses are known (m/s): the recoil of a
/// stalled drive tells no direction.
pub(crate) const STANDSTILL: f64 = 1e-5;

/// Gain in ln of a series' likelihood from which on a larger noise replaces the nominal one.
pub(crate) const LARGER_NOISE_GAIN: f64 = 12.0;

/// Models of the pusher's motion: times T (s) in which the noise of the motion reaches that of one
/// measurement, q = std²/T³.
pub(crate) const LIVELINESS: [f64; 3] = [10.0, 0.5, 0.05];

/// Mean time for which one of these models applies (s).
pub(crate) const MEAN_SOJOURN_TIME: f64 = 30.0;

/// Acceleration that no pusher has (m/s²).
pub(crate) const MOST_ACCELERATION: f64 = 20.0;

/// Distance of a pusher's parts from its centre (m).
pub(crate) const PART_RADIUS: f64 = 0.05;

/// Jump that does little harm (m).
pub(crate) const LEAST_JUMP: f64 = 2e-3;

/// Standard deviations by which no pose errs.
pub(crate) const JUMP_SIGMAS: f64 = 20.0;
