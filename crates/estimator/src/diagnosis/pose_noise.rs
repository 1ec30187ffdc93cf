//! Noise of single poses, estimated from a log alone: [`PoseNoise`].

use stickslip_dynamics::Pose;

use super::evidence::median;

/// Factor from a median of deviations from zero to a standard deviation.
pub(super) const OF_MEDIAN: f64 = 1.4826;

/// Fewest bends from which noise is estimated.
const FEWEST: usize = 10;

/// Least share of the time between its neighbours by which a pose is apart from either. Motion next
/// to a gap is not steady.
const APART: f64 = 0.2;

/// Standard deviations of one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PoseNoise {
    /// Standard deviation of x and of y (m).
    pub position: f64,
    /// Standard deviation of θ (rad).
    pub angle: f64,
}

impl PoseNoise {
    /// Estimates the noise of poses at `time` (s) from how far each lies off the line through its
    /// neighbours. A steady motion does not change that, and a median ignores jumps and stops.
    ///
    /// Rows without a pose are passed over: other sensors may bring many of them.
    pub fn of(time: &[f64], poses: &[Option<Pose>]) -> Option<Self> {
        let seen: Vec<(f64, Pose)> = time
            .iter()
            .zip(poses)
            .filter_map(|(time, pose)| Some((*time, (*pose)?)))
            .collect();
        let triples = || {
            let triples = seen.array_windows();
            let triples = triples.filter(|[(_, a), (_, b), (_, c)]| a != b && b != c);
            triples
                .filter(|[(t0, _), (t1, _), (t2, _)]| (t1 - t0).min(t2 - t1) >= APART * (t2 - t0))
        };
        let std = |pick: fn(&Pose) -> f64| {
            let bends: Vec<f64> = triples()
                .map(|[(t0, a), (t1, b), (t2, c)]| {
                    // where the steps are uneven, the middle pose is not halfway
                    let share = (t1 - t0) / (t2 - t0);
                    let bend = pick(b) - (1.0 - share) * pick(a) - share * pick(c);
                    let variance = 1.0 + (1.0 - share) * (1.0 - share) + share * share;
                    bend.abs() / variance.sqrt()
                })
                .collect();
            (bends.len() >= FEWEST).then(|| OF_MEDIAN * median(bends))
        };
        Some(Self {
            position: std(|p| p.x)?.max(std(|p| p.y)?),
            angle: std(|p| p.theta)?,
        })
    }

    /// Returns the greater one of each.
    pub fn max(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            angle: self.angle.max(other.angle),
        }
    }
}
