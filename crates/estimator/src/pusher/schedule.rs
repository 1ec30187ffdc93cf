//! Steps of a log: [`Schedule`], the substeps that lead from each row to the next.

use stickslip_dynamics::{FingerMotion, PusherMotion, StepInput};

use crate::pusher::track::PusherTrack;
use crate::pusher::tracked_pose::keep_directions;
use crate::tuning::{LONGEST_STEP, SHORTEST_STEP, SPLIT_TO};

/// The substeps of every step of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    steps: Vec<Vec<StepInput>>,
    driven: Vec<bool>,
}

impl Schedule {
    /// Steps from row to row of `time`, driven by `track`; `substeps` forces a number of parts. A
    /// row that comes less than half a millisecond after the last step has none: the next step
    /// begins where the last one ended.
    pub fn new(time: &[f64], track: &PusherTrack, substeps: Option<u32>) -> Self {
        let mut directions = track.first_directions(time);
        let mut from = 0;
        let steps = (1..time.len()).map(|to| {
            let h = time[to] - time[from];
            if h < SHORTEST_STEP {
                return Vec::new();
            }
            let h = track.step_length(to, h);
            let motion = track.motion(from..to, h, &directions);
            keep_directions(motion.as_ref(), &mut directions);
            from = to;
            split(h, motion, substeps).collect()
        });
        Self {
            steps: steps.collect(),
            driven: (1..time.len())
                .map(|row| track.moves_after(row - 1))
                .collect(),
        }
    }

    /// The substeps from `row` to the next.
    pub fn step(&self, row: usize) -> &[StepInput] {
        &self.steps[row]
    }

    /// Returns true if the pusher moves on the way from `row` to the next. The remaining motion of
    /// a standing pusher is tracking noise.
    pub fn driven(&self, row: usize) -> bool {
        self.driven[row]
    }
}

fn parts_of(h: f64) -> u32 {
    if h > LONGEST_STEP {
        (h / SPLIT_TO).ceil() as u32
    } else {
        1
    }
}

/// Splits a step of `h` seconds into `parts` of equal length, or into as many as the length asks
/// for.
pub(crate) fn split(
    h: f64,
    motion: Option<PusherMotion>,
    parts: Option<u32>,
) -> impl Iterator<Item = StepInput> {
    let parts = parts.unwrap_or_else(|| parts_of(h));
    let h = h / f64::from(parts);
    let at = move |part: u32| {
        let advanced = |m: FingerMotion| FingerMotion {
            pose: m.pose.advance(m.twist, h * f64::from(part)),
            ..m
        };
        motion.map(|pusher| pusher.map(advanced))
    };
    (0..parts).map(move |part| StepInput {
        h,
        pusher: at(part),
    })
}
