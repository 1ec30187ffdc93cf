//! The pusher's track from the rows so far, as live: [`CausalTrack`].
//!
//! An interacting multiple model filter runs on each axis, with models from lively to nearly
//! unaccelerated: the level of the process noise cannot be fitted before the series is known.
//!
//! The last pose is held while the pusher is not seen. After 0.2 s, or 2.5 typical intervals if
//! these are longer, the pusher counts as lifted. Its track starts again where it comes back.

use stickslip_dynamics::Pose;
use stickslip_filter::{AxisEstimate, ConstantVelocity, ImmState, InteractingMultipleModel};

use crate::error::RunError;
use crate::pose_clock::PoseClock;
use crate::pusher::jumps::JumpGate;
use crate::pusher::tracked_pose::{TrackedPose, bridged};
use crate::setup::Camera;
use crate::tuning::{INITIAL_VELOCITY_STD, LIVELINESS, MEAN_SOJOURN_TIME};

/// Tracks the pusher row by row.
#[derive(Clone, Debug)]
pub(crate) struct CausalTrack {
    /// Filters of x, y and θ; `None` where poses are exact.
    filters: [Option<AxisFilter>; 3],
    /// The pusher on the plane; `None` while it is lifted.
    seen: Option<Seen>,
    /// Clock of the pusher's poses; `None` before the first one.
    clock: Option<PoseClock>,
    gate: JumpGate,
}

/// The filter of one axis.
type AxisFilter = InteractingMultipleModel<{ LIVELINESS.len() }>;

/// The pusher since it was last put on the plane.
#[derive(Clone, Debug)]
struct Seen {
    /// Time of the latest row (s).
    time: f64,
    /// Time of the latest row with a pose (s).
    measured: f64,
    axes: [Axis; 3],
}

/// One axis at the latest row.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// State of the filter; `None` where poses are exact.
    state: Option<ImmState<{ LIVELINESS.len() }>>,
    estimate: AxisEstimate,
}

impl CausalTrack {
    /// A track that waits for its first pose; without a `camera` poses count as exact.
    ///
    /// # Errors
    /// [`RunError::Track`] where a standard deviation is out of range.
    pub fn new(camera: Option<&Camera>) -> Result<Self, RunError> {
        let (position_std, orientation_std) = camera.map_or((0.0, 0.0), |camera| {
            (camera.pusher_position_std, camera.pusher_orientation_std)
        });
        let [x, theta] = [axis_filter(position_std)?, axis_filter(orientation_std)?];
        Ok(Self {
            filters: [x, x, theta],
            seen: None,
            clock: None,
            gate: JumpGate::new(camera),
        })
    }

    /// Takes the pose measured at `time` (s), which rises; returns the tracked one, `None` while
    /// the pusher is off the plane.
    pub fn push(&mut self, time: f64, pose: Option<Pose>) -> Option<TrackedPose> {
        let pose = self.gate.pass(time, pose);
        let filters = &self.filters;
        let interval = self.clock.as_ref().and_then(PoseClock::interval);
        let since = self.seen.take();
        let since = since.filter(|seen| bridged(seen.measured, time, interval));
        match &mut self.clock {
            Some(clock) => {
                let _ = clock.is_dark(time, pose.is_some());
            }
            None => self.clock = pose.map(|_| PoseClock::new(time)),
        }
        let held = match &since {
            Some(seen) if pose.is_some() && seen.measured < seen.time => time - seen.measured,
            _ => 0.0,
        };
        self.seen = match (since, pose) {
            (Some(seen), pose) => Some(seen.step(filters, time, pose)),
            (None, Some(pose)) => Some(Seen::start(filters, time, pose)),
            (None, None) => None,
        };
        self.seen.as_ref().map(|seen| TrackedPose {
            held,
            ..TrackedPose::of(seen.axes.map(|axis| axis.estimate))
        })
    }

    /// Number of poses that counted as missing, since the pusher could not have come there.
    pub fn left_out(&self) -> u32 {
        self.gate.left_out()
    }
}

/// The filter of an axis that is measured with standard deviation `std`; `None` where that is 0.
fn axis_filter(std: f64) -> Result<Option<AxisFilter>, RunError> {
    if std == 0.0 {
        return Ok(None);
    }
    let filter = InteractingMultipleModel {
        modes: LIVELINESS.map(|t| ConstantVelocity {
            process_noise: std * std / (t * t * t),
            measurement_std: std,
            initial_velocity_std: INITIAL_VELOCITY_STD,
        }),
        mean_sojourn_time: MEAN_SOJOURN_TIME,
    };
    filter.check()?;
    Ok(Some(filter))
}

impl Seen {
    fn start(filters: &[Option<AxisFilter>; 3], time: f64, pose: Pose) -> Self {
        let [x, y, theta] = filters;
        Self {
            time,
            measured: time,
            axes: [
                Axis::start(x, pose.x),
                Axis::start(y, pose.y),
                Axis::start(theta, pose.theta),
            ],
        }
    }

    fn step(self, filters: &[Option<AxisFilter>; 3], time: f64, pose: Option<Pose>) -> Self {
        let h = time - self.time;
        let ([fx, fy, ft], [x, y, theta]) = (filters, self.axes);
        Self {
            time,
            measured: if pose.is_some() { time } else { self.measured },
            axes: [
                x.step(fx, h, pose.map(|pose| pose.x)),
                y.step(fy, h, pose.map(|pose| pose.y)),
                theta.step(ft, h, pose.map(|pose| pose.theta)),
            ],
        }
    }
}

impl Axis {
    fn start(filter: &Option<AxisFilter>, position: f64) -> Self {
        let state = filter.as_ref().map(|filter| filter.start(position));
        let exact = AxisEstimate {
            position,
            velocity: 0.0,
            position_variance: 0.0,
            velocity_variance: 0.0,
            covariance: 0.0,
        };
        Self {
            state,
            estimate: state.map_or(exact, |state| state.estimate()),
        }
    }

    /// The axis `h` seconds later; without a measurement its estimate stands still.
    fn step(self, filter: &Option<AxisFilter>, h: f64, measured: Option<f64>) -> Self {
        let before = self.estimate;
        let state = filter
            .as_ref()
            .zip(self.state)
            .map(|(filter, state)| filter.step(&state, h, measured).0);
        let estimate = match (state, measured) {
            (Some(state), Some(_)) => state.estimate(),
            (None, Some(position)) => AxisEstimate {
                position,
                velocity: (position - before.position) / h,
                ..before
            },
            (_, None) => AxisEstimate {
                velocity: 0.0,
                ..before
            },
        };
        Self { state, estimate }
    }
}
