//! Test whether the pusher moves evenly: [`Steadiness`].

use stickslip_dynamics::StepInput;

/// Time for which the pusher's velocity has been the same, as far as that matters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steadiness {
    /// Time for which it has to be the same (s).
    window: f64,
    /// The approximate velocity (m/s), and the time (s) since when it has been so.
    since: Option<([f64; 2], f64)>,
}

/// Share of its speed by which a steady velocity may differ from what it was.
const EVEN: f64 = 0.15;

impl Steadiness {
    /// A test over `window` seconds.
    pub fn new(window: f64) -> Self {
        Self {
            window,
            since: None,
        }
    }

    /// Returns the pusher's velocity at `time` (s) if it has been about that for the whole window.
    pub fn velocity(&mut self, time: f64, substeps: &[StepInput]) -> Option<[f64; 2]> {
        let Some(motion) = substeps.last().and_then(|step| step.pusher) else {
            self.since = None;
            return None;
        };
        let twist = motion.twist;
        let now = [twist.vx, twist.vy];
        let even = |before: [f64; 2]| {
            let [dx, dy] = [now[0] - before[0], now[1] - before[1]];
            libm::hypot(dx, dy) <= EVEN * libm::hypot(before[0], before[1])
        };
        let moves = now != [0.0; 2];
        match self.since {
            Some((before, since)) if moves && even(before) => {
                (time - since >= self.window).then_some(now)
            }
            _ => {
                self.since = Some((now, time));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::{Pose, PusherMotion, Twist};

    use super::*;

    fn step(vx: f64, vy: f64) -> [StepInput; 1] {
        let twist = Twist { vx, vy, omega: 0.0 };
        [StepInput {
            h: 0.1,
            pusher: Some(PusherMotion {
                pose: Pose::default(),
                twist,
                direction: [1.0, 0.0],
            }),
        }]
    }

    #[test]
    fn a_velocity_is_steady_after_the_window_and_until_it_turns_or_stops() {
        let mut steadiness = Steadiness::new(0.3);
        let mut at = |time: f64, vx, vy| steadiness.velocity(time, &step(vx, vy));
        assert_eq!(at(0.0, 0.02, 0.0), None);
        assert_eq!(at(0.2, 0.021, 0.001), None);
        assert_eq!(at(0.4, 0.02, 0.0), Some([0.02, 0.0]));
        // as fast, another way
        assert_eq!(at(0.5, 0.0, 0.02), None);
        assert_eq!(at(0.9, 0.0, 0.02), Some([0.0, 0.02]));
        assert_eq!(at(1.0, 0.0, 0.0), None);
    }

    #[test]
    fn a_pusher_at_rest_or_off_the_plane_is_not_steady() {
        let mut steadiness = Steadiness::new(0.3);
        for time in [0.0, 0.5, 1.0] {
            assert_eq!(steadiness.velocity(time, &step(0.0, 0.0)), None);
        }
        assert_eq!(steadiness.velocity(1.5, &[]), None);

        // lifted, and put down again at the same velocity
        let lifted = [StepInput {
            pusher: None,
            ..step(0.0, 0.0)[0]
        }];
        let mut at = |time: f64, step: &[StepInput]| steadiness.velocity(time, step);
        assert_eq!(at(2.0, &step(0.02, 0.0)), None);
        assert!(at(2.4, &step(0.02, 0.0)).is_some());
        assert_eq!(at(3.0, &lifted), None);
        assert_eq!(at(8.0, &step(0.02, 0.0)), None);
        assert!(at(8.4, &step(0.02, 0.0)).is_some());
    }
}
