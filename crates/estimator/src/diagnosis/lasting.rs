//! Errors of the camera that last over several rows: [`Lasting`].
//!
//! The object waits while the pusher is still on its way, so its poses then show the camera's
//! errors. White noise differs as much from row to row as between rows that are far apart. An error
//! that lasts hardly differs from row to row, and by more and more over longer times.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, median};
use super::pose_noise::{OF_MEDIAN, PoseNoise};

/// Fewest poses of a waiting object from which errors are judged.
const FEWEST: usize = 24;

/// Ratio of the differences of poses far apart to those of neighbouring rows above which errors
/// last.
const WANDERS: f64 = 1.8;

/// Wander above which it is a motion, in nominal standard deviations.
const MOTION: f64 = 3.0;

/// Errors that last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lasting {
    /// Standard deviations of one pose, including what lasts.
    pub wander: PoseNoise,
    /// Number of rows over which an error lasts. So many poses say as much as one with an error of
    /// its own.
    pub rows: f64,
}

impl Lasting {
    /// Returns the errors of `evidence`'s camera, if they last.
    pub fn of(evidence: &Evidence<'_>) -> Option<Self> {
        let noise = evidence.noise?;
        let camera = evidence.setup.camera.as_ref()?;
        let waiting = waiting(evidence);
        if waiting.len() < FEWEST {
            return None;
        }
        let (x, y) = (wander(&waiting, |p| p.x), wander(&waiting, |p| p.y));
        let wander = PoseNoise {
            position: median(x.into_iter().chain(y)),
            angle: median(wander(&waiting, |p| p.theta)),
        };
        // poses that are rounded may not scatter from row to row at all
        let lasts = noise.position > 0.0
            && wander.position > WANDERS * noise.position
            && wander.position < MOTION * camera.position_std
            && wander.angle < MOTION * camera.orientation_std;
        let share = noise.position / wander.position;
        let wander = PoseNoise {
            // a greater ratio of the angles than of the positions would be chance
            angle: wander.angle.min(noise.angle / share),
            ..wander
        };
        lasts.then(|| Self {
            wander: wander.max(noise),
            rows: rows(share),
        })
    }
}

/// Poses up to the first row at which the pusher may touch the object, or is not known.
fn waiting(evidence: &Evidence<'_>) -> Vec<Pose> {
    let apart = |row: &usize| {
        let gap = evidence.pusher_gap(*row, evidence.latency());
        gap.is_some_and(|gap| gap > evidence.tolerance())
    };
    let rows = evidence.seen.iter().copied().take_while(apart);
    rows.filter_map(|row| evidence.log.object[row]).collect()
}

/// Differences of poses a quarter of `waiting` apart, each as an error of one pose.
fn wander(waiting: &[Pose], pick: fn(&Pose) -> f64) -> Vec<f64> {
    let later = &waiting[waiting.len() / 4..];
    let pairs = waiting.iter().zip(later);
    pairs
        .map(|(a, b)| OF_MEDIAN * (pick(b) - pick(a)).abs() / 2.0_f64.sqrt())
        .collect()
}

/// Number of rows over which an error lasts that scatters from row to row by `share` of its wander.
///
/// Such errors are forgotten by a factor ρ from row to row. Their second differences have the
/// variance 2 (1 − ρ) (3 − ρ), those of white noise 6. A mean of n such poses is as good as one of
/// n (1 − ρ) / (1 + ρ) poses of white noise.
fn rows(share: f64) -> f64 {
    let kept = 2.0 - (1.0 + 3.0 * share * share).sqrt();
    (1.0 + kept) / (1.0 - kept)
}
