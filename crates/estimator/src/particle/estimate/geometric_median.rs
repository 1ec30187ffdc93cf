//! Geometric median of the particles' poses: [`way_to_median`], docs/model.md (42).

use stickslip_dynamics::{Lanes, Level, Pose, on_widest};
use stickslip_filter::{Block, ParticleFilter};

use crate::angle::nearest_zero;
use crate::particle::estimate::group::{Point, squared};
use crate::particle::model::ContactModel;
use crate::particle::set::chunk::{Column, LANES, load_chunk, load_pose, total};
use crate::particle::set::columns::Columns;

/// Distance below which a particle pulls less (m): one on the median itself would hold it.
const SOFTENED: f64 = 1e-5;

/// Step length that ends the iteration (m).
const LEAST_STEP: f64 = 1e-7;

/// Largest number of steps; sets that part in halves take most.
const MOST_STEPS: usize = 64;

/// Returns the way from `mean`, a pose near the particles, to the pose of the least mean distance
/// to them.
pub(crate) fn way_to_median(filter: &ParticleFilter<ContactModel<'_>>, mean: Pose) -> Pose {
    let rho = filter.model().gyration_radius();
    let weights = filter.weights().weights();
    let [x, y, turn] = nearest_point(|point| {
        let at = Pose::new(
            mean.x + point[0],
            mean.y + point[1],
            mean.theta + point[2] / rho,
        );
        filter.particles().reduce(
            |block| Pull::of(block, &weights[block.range()], &at, rho),
            Pull::plus,
        )
    });
    Pose::new(x, y, turn / rho)
}

/// Pull of particles at a point: each with its weight, however far it is.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    /// Σ w d/|d|, d the way to the particle.
    force: Point,
    /// Σ w/|d| (1/m).
    stiffness: f64,
}

impl Pull {
    /// The pull of a block, at a pose of an object of radius of gyration `rho`.
    fn of(block: &Block<'_>, weights: &[f64], at: &Pose, rho: f64) -> Self {
        let (mut force, mut stiffness) = ([Column::ZERO; 3], Column::ZERO);
        on_widest(
            Level::new(),
            #[inline(always)]
            || {
                for chunk in 0..block.len().div_ceil(LANES) {
                    let pose = load_pose(block, Columns::POSE, chunk);
                    let turn = nearest_zero(pose.theta - at.theta) * rho;
                    let way = [pose.x - at.x, pose.y - at.y, turn];
                    let mut square = Lanes::splat(SOFTENED * SOFTENED);
                    for d in way {
                        square = square.add_mul(d, d);
                    }
                    let share = load_chunk(weights, chunk, 0.0) * square.inverse_sqrt();
                    for (force, d) in force.iter_mut().zip(way) {
                        *force = force.add_mul(share, d);
                    }
                    stiffness += share;
                }
            },
        );
        Self {
            force: force.map(total),
            stiffness: total(stiffness),
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            force: [0, 1, 2].map(|k| self.force[k] + other.force[k]),
            stiffness: self.stiffness + other.stiffness,
        }
    }
}

/// Returns the point of the least mean distance, relative to the origin, given the pull of the
/// particles at a point (Weiszfeld 1937).
fn nearest_point(pull_at: impl Fn(Point) -> Pull) -> Point {
    let mut point = [0.0; 3];
    for _ in 0..MOST_STEPS {
        let Pull { force, stiffness } = pull_at(point);
        let step = force.map(|force| force / stiffness);
        for (point, step) in point.iter_mut().zip(step) {
            *point += step;
        }
        if squared(step) < LEAST_STEP * LEAST_STEP {
            break;
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    fn median(particles: &[(f64, Point)]) -> Point {
        nearest_point(|point| {
            let pulls = particles.iter().map(|(weight, at)| {
                let way = [0, 1, 2].map(|k| at[k] - point[k]);
                let share = weight / squared(way).sqrt().hypot(SOFTENED);
                Pull {
                    force: way.map(|d| share * d),
                    stiffness: share,
                }
            });
            pulls.fold(Pull::default(), Pull::plus)
        })
    }

    fn assert_near(found: Point, expected: Point) {
        let off = squared([0, 1, 2].map(|k| found[k] - expected[k])).sqrt();
        assert!(off < 1e-5, "{found:?}, not {expected:?}");
    }

    /// The geometric median of the corners of a convex quadrilateral is where the diagonals cross
    /// (Fagnano).
    #[test]
    fn of_four_corners_it_is_where_the_diagonals_cross() {
        let (crossing, tilt) = ([0.004, -0.002, 0.003], [0.6, 0.0, 0.8]);
        let along = |way: f64| [0, 1, 2].map(|k| crossing[k] + way * tilt[k]);
        let across = |way: f64| [crossing[0], crossing[1] + way, crossing[2]];
        let corners = [along(0.01), along(-0.002), across(0.005), across(-0.03)];
        assert_near(median(&corners.map(|corner| (0.25, corner))), crossing);
    }

    /// A place with more than half of the weight is the geometric median, however far the others
    /// are.
    #[test]
    fn it_stays_with_the_greater_part() {
        let here = [0.001, 0.002, -0.001];
        for far in [0.01, 0.1] {
            let parted = [(0.4, here), (0.3, here), (0.3, [far, 0.0, far])];
            assert_near(median(&parted), here);
        }
    }

    /// The geometric median on a line is the median, which a far particle does not move.
    #[test]
    fn on_a_line_it_is_the_median() {
        let places = [
            -0.02, -0.001, 0.0, 0.002, 0.003, 0.005, 0.008, 0.9, 0.004, 0.001, -0.003,
        ];
        let particles = places.map(|x| (1.0 / 11.0, [0.0, x, 0.0]));
        assert_near(median(&particles), [0.0, 0.002, 0.0]);
    }
}
