//! Inputs of a run other than its log: the [`Setup`] (scene, sensors, filter settings), as
//! `scene.toml` has it.

use stickslip_dynamics::{Feet, Friction, Part, Scene, Start};

use crate::tuning::PUSHER_SIGMAS;
use crate::uncertainty::Uncertainty;

/// Noise of the camera and of the pusher's tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Standard deviation of one object position (m).
    pub position_std: f64,
    /// Standard deviation of one object orientation (rad).
    pub orientation_std: f64,
    /// Time by which object poses lag the pusher's (s).
    pub latency: f64,
    /// Standard deviation of one pusher position (m); 0: the log's poses are used as they are.
    pub pusher_position_std: f64,
    /// Standard deviation of one pusher orientation (rad); 0: used as they are.
    pub pusher_orientation_std: f64,
}

/// Error rates and threshold of the binary tactile sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tactile {
    /// Probability that an untouched sensor reads 1.
    pub false_positive: f64,
    /// Probability that a touched sensor reads 0.
    pub false_negative: f64,
    /// Force at which the sensor switches (N) (docs/model.md (38)).
    pub touch_force: f64,
}

impl Default for Tactile {
    fn default() -> Self {
        Self {
            false_positive: 0.01,
            false_negative: 0.05,
            touch_force: 0.05,
        }
    }
}

/// Sensor of the force of the pusher, or of the whole hand, on the object: `[wrench]` of a scene
/// file (docs/model.md (49)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSensor {
    /// Standard deviation of one force, per axis (N).
    pub force_std: f64,
    /// Standard deviation of a constant error, per axis (N).
    pub bias_std: f64,
    /// Standard deviation of the logarithm of a factor on the table's friction: the sensor's scale,
    /// and friction that differs from place to place.
    pub scale_std: f64,
}

/// Closed interval of physically possible values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// `[filter]` of a scene file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Standard deviation of w_app per step of 1/30 s, as a share of μ_s m g h per linear axis,
    /// times the radius of gyration for rotation (docs/method.md (19)).
    pub force_std: f64,
    /// Standard deviation of w_β per step of 1/30 s, multiplicative (docs/method.md (20)).
    pub parameter_std: f64,
    /// Effective sample size / N below which the set is resampled (docs/method.md (18)).
    pub resample_below: f64,
    /// Factor that widens the camera's standard deviations (docs/method.md (23)).
    pub likelihood_scale: f64,
    /// Physical limits of the friction parameters, of d_tri in m, to which proposed values are
    /// clamped (docs/method.md (20)).
    pub limits: Friction<Limits>,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            force_std: 0.15,
            parameter_std: 0.05,
            resample_below: 0.5,
            likelihood_scale: 1.5,
            limits: Friction {
                mu_s: Limits {
                    min: 0.05,
                    max: 1.0,
                },
                mu_p: Limits {
                    min: 0.02,
                    max: 1.0,
                },
                mu_f: Limits {
                    min: 0.02,
                    max: 1.0,
                },
                d_tri: Limits {
                    min: 0.003,
                    max: 0.04,
                },
            },
        }
    }
}

impl FilterSettings {
    /// Returns the defaults for an object whose friction is near `nominal`. The limits reach at
    /// least from half to twice the nominal value; for d_tri the factor is 1.6, for objects larger
    /// than most.
    pub fn around(nominal: &Friction) -> Self {
        let mut settings = Self::default();
        let nominal = nominal.fields().into_iter();
        let limits = settings.limits.fields_mut().into_iter();
        for ((limits, nominal), most) in limits.zip(nominal).zip([2.0, 2.0, 2.0, 1.6]) {
            if *nominal > 0.0 {
                limits.min = limits.min.min(nominal / most);
                limits.max = limits.max.max(nominal * most);
            }
        }
        settings
    }
}

/// A scene with its sensors and filter settings.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Bodies and nominal friction.
    pub scene: Scene,
    /// True if the pusher's stall force is [`ASSUMED_STALL`](crate::ASSUMED_STALL), because the
    /// scene gives none.
    pub stall_force_assumed: bool,
    /// The camera; needed by the particle and Kalman methods only.
    pub camera: Option<Camera>,
    /// The tactile sensors' model (defaults where the scene file has no `[tactile]`).
    pub tactile: Tactile,
    /// Sensor of the pusher's force; `None`: forces are not used.
    pub wrench: Option<ForceSensor>,
    /// Filter settings.
    pub filter: FilterSettings,
    /// Uncertainty of the numbers above.
    pub uncertainty: Uncertainty,
    /// Start of the experiment; only simulations read it.
    pub start: Option<Start>,
}

impl Setup {
    /// Standard deviation (rad) of the pusher's angle about its logged one, on a rig of nominal
    /// roughness. It is 0 if turning the pusher changes nothing.
    pub(crate) fn pusher_turn(&self) -> f64 {
        let parts = self.scene.pusher.fingers[0].parts();
        let round = matches!(parts, [Part::Disc { centre, .. }] if *centre == [0.0, 0.0]);
        let camera = self.camera.as_ref().filter(|_| !round);
        camera.map_or(0.0, |camera| camera.pusher_orientation_std)
    }

    /// Returns true if the particles differ in where their feet stand.
    pub(crate) fn support_is_uncertain(&self) -> bool {
        let unsure = &self.uncertainty;
        let scaled = !self.has_tripod() && unsure.friction.d_tri > 0.0;
        scaled
            || [
                unsure.centre_of_friction,
                unsure.tripod_angle,
                unsure.foot_stretch,
            ]
            .iter()
            .any(|std| *std > 0.0)
    }

    /// Largest distance (m) of a pusher that yielded behind its logged pose: three standard
    /// deviations of that pose (docs/method.md (13)). A pusher farther behind contradicts
    /// the log: it is dragged to that distance.
    pub fn most_pusher_lag(&self) -> f64 {
        PUSHER_SIGMAS * self.camera.map_or(0.0, |camera| camera.pusher_position_std)
    }

    /// Returns r_v, the default weight of an angle in the scores: the object's radius of gyration
    /// (m).
    pub fn virtual_radius(&self) -> f64 {
        self.scene.object.gyration_radius()
    }

    /// Draws friction from its prior, by four standard normal numbers (docs/model.md (33)).
    pub fn drawn_friction(&self, normals: [f64; 4]) -> Friction {
        let (stds, limits) = (
            self.uncertainty.friction.fields(),
            self.filter.limits.fields(),
        );
        let mut friction = self.scene.nominal;
        for (k, value) in friction.fields_mut().into_iter().enumerate() {
            let drawn = *value * libm::exp(stds[k] * normals[k]);
            *value = drawn.clamp(limits[k].min, limits[k].max);
        }
        friction
    }

    /// Returns true if the tripod radius is a parameter. It is false if the feet are known.
    pub fn has_tripod(&self) -> bool {
        matches!(self.scene.feet, Feet::Tripod { .. })
    }
}
