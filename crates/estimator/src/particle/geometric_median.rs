//! The pose that is nearest to the particles, in the mean: [`GeometricMedian`], docs/method.md (51).

use stickslip_dynamics::{Lanes, Level, Pose, on_widest};
use stickslip_filter::ParticleFilter;

use crate::angle::nearest_zero;
use crate::particle::chunk::{Column, LANES, load_chunk, load_pose, total};
use crate::particle::columns::Columns;
use crate::particle::group::{Point, squared};
use crate::particle::model::ContactModel;

/// Distance below which a particle pulls less (m): one on the median itself would hold it.
const SOFTENED: f64 = 1e-5;

/// Step that ends the iteration (m).
const LEAST_STEP: f64 = 1e-7;

/// Steps at most; sets that part in halves take most.
const MOST_STEPS: usize = 64;

/// Finds the pose of the least mean distance to a particle set; memory is kept from row to row.
#[derive(Clone, Debug)]
pub(crate) struct GeometricMedian {
    /// The object's radius of gyration ρ (m).
    rho: f64,
    particles: Vec<Weighed>,
}

/// Particles side by side: weights, and poses as points about the mean (m).
#[derive(Clone, Copy, Debug)]
struct Weighed {
    weight: Column,
    at: [Column; 3],
}

impl GeometricMedian {
    /// For an object of radius of gyration `rho` (m).
    pub fn new(rho: f64) -> Self {
        Self {
            rho,
            particles: Vec::new(),
        }
    }

    /// The way from `mean`, a pose near the particles, to that of the least mean distance to them.
    pub fn way_from(&mut self, filter: &ParticleFilter<ContactModel<'_>>, mean: Pose) -> Pose {
        on_widest(
            Level::new(),
            #[inline(always)]
            || {
                self.read(filter, mean);
                let [x, y, turn] = nearest_point(&self.particles);
                Pose::new(x, y, turn / self.rho)
            },
        )
    }

    #[inline(always)]
    fn read(&mut self, filter: &ParticleFilter<ContactModel<'_>>, mean: Pose) {
        self.particles.clear();
        let weights = filter.weights().weights();
        for block in filter.particles().blocks() {
            let weights = &weights[block.range()];
            for chunk in 0..block.len().div_ceil(LANES) {
                let pose = load_pose(&block, Columns::POSE, chunk);
                let turn = nearest_zero(pose.theta - mean.theta);
                self.particles.push(Weighed {
                    weight: load_chunk(weights, chunk, 0.0),
                    at: [pose.x - mean.x, pose.y - mean.y, turn * self.rho],
                });
            }
        }
    }
}

/// The point of the least mean distance to the particles, from the origin (Weiszfeld 1937).
#[inline(always)]
fn nearest_point(particles: &[Weighed]) -> Point {
    let mut point = [0.0; 3];
    for _ in 0..MOST_STEPS {
        // each particle pulls with its weight, however far it is
        let mut pull = [Column::ZERO; 3];
        let mut stiffness = Column::ZERO;
        for Weighed { weight, at } in particles {
            let mut way = *at;
            let mut square = Lanes::splat(SOFTENED * SOFTENED);
            for (way, from) in way.iter_mut().zip(point) {
                *way = *way - from;
                square = square.add_mul(*way, *way);
            }
            let share = *weight * square.inverse_sqrt();
            for (pull, way) in pull.iter_mut().zip(way) {
                *pull = pull.add_mul(share, way);
            }
            stiffness += share;
        }
        let stiffness = total(stiffness);
        let step = pull.map(
            #[inline(always)]
            |pull| total(pull) / stiffness,
        );
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
        let lanes = particles.chunks(LANES).map(|some| {
            let lane = |number: &dyn Fn(&(f64, Point)) -> f64| {
                Lanes(std::array::from_fn(|i| some.get(i).map_or(0.0, number)))
            };
            Weighed {
                weight: lane(&|(weight, _)| *weight),
                at: [0, 1, 2].map(|axis| lane(&|(_, at)| at[axis])),
            }
        });
        nearest_point(&lanes.collect::<Vec<_>>())
    }

    fn assert_near(found: Point, expected: Point) {
        let off = squared([0, 1, 2].map(|k| found[k] - expected[k])).sqrt();
        assert!(off < 1e-5, "{found:?}, not {expected:?}");
    }

    /// Of four corners of a convex quadrilateral it is where the diagonals cross (Fagnano).
    #[test]
    fn of_four_corners_it_is_where_the_diagonals_cross() {
        let (crossing, tilt) = ([0.004, -0.002, 0.003], [0.6, 0.0, 0.8]);
        let along = |way: f64| [0, 1, 2].map(|k| crossing[k] + way * tilt[k]);
        let across = |way: f64| [crossing[0], crossing[1] + way, crossing[2]];
        let corners = [along(0.01), along(-0.002), across(0.005), across(-0.03)];
        assert_near(median(&corners.map(|corner| (0.25, corner))), crossing);
    }

    /// Where one place has more than half of the weight, it is that place, however far the others are.
    #[test]
    fn it_stays_with_the_greater_part() {
        let here = [0.001, 0.002, -0.001];
        for far in [0.01, 0.1] {
            let parted = [(0.4, here), (0.3, here), (0.3, [far, 0.0, far])];
            assert_near(median(&parted), here);
        }
    }

    /// On a line it is the median, which a far particle does not move.
    #[test]
    fn on_a_line_it_is_the_median() {
        let places = [
            -0.02, -0.001, 0.0, 0.002, 0.003, 0.005, 0.008, 0.9, 0.004, 0.001, -0.003,
        ];
        let particles = places.map(|x| (1.0 / 11.0, [0.0, x, 0.0]));
        assert_near(median(&particles), [0.0, 0.002, 0.0]);
    }
}
