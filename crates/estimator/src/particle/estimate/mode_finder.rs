//! Modes of a particle set: [`ModeFinder`], docs/model.md (43).

use stickslip_dynamics::Pose;
use stickslip_filter::ParticleFilter;

use crate::angle::wrapped;
use crate::belief_mode::BeliefMode;
use crate::particle::estimate::group::{Moments, Point, dot, minus, squared};
use crate::particle::model::ContactModel;
use crate::particle::set::columns::Columns;
use crate::tuning::{LEAST_DISTANCE, LEAST_WEIGHT};

/// Largest number of groups.
const MOST_MODES: u8 = 8;

/// Number of bins along an axis in which a cut is sought.
const BINS: usize = 64;

/// Finds the modes of a belief; memory is kept from row to row.
#[derive(Clone, Debug)]
pub(crate) struct ModeFinder {
    /// The object's radius of gyration ρ (m).
    rho: f64,
    /// Modes nearer than this are one (m).
    least: f64,
    points: Vec<Point>,
    mode_of: Vec<u8>,
}

impl ModeFinder {
    /// A finder for an object of radius of gyration `rho` (m), whose modes are at least `least` (m)
    /// apart.
    pub fn new(rho: f64, least: f64) -> Self {
        Self {
            rho,
            least,
            points: Vec::new(),
            mode_of: Vec::new(),
        }
    }

    /// Writes the modes of the particles, the heaviest first, one at least. `centre` and `std` are
    /// pose and spread of the row.
    pub fn find(
        &mut self,
        filter: &ParticleFilter<ContactModel<'_>>,
        (centre, std): (Pose, Pose),
        modes: &mut Vec<BeliefMode>,
    ) {
        modes.clear();
        let turn = self.rho * std.theta;
        let size = (std.x * std.x + std.y * std.y + turn * turn).sqrt();
        if size < self.least * (LEAST_WEIGHT * (1.0 - LEAST_WEIGHT)).sqrt() {
            // two modes of the least weight at the least distance would be wider
            let pose = self.nearest(filter, centre);
            modes.push(BeliefMode {
                weight: 1.0,
                pose,
                std,
            });
            return;
        }
        let weights = filter.weights().weights();
        self.read(filter, centre);
        let count = self.divide(weights);
        modes.extend((0..count).map(|mode| self.describe(filter, weights, mode)));
        modes.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    }

    /// Returns the pose of the particle nearest to `centre`.
    fn nearest(&self, filter: &ParticleFilter<ContactModel<'_>>, centre: Pose) -> Pose {
        let weights = filter.weights().weights();
        let (_, particle) = filter.particles().reduce(
            |block| {
                let weighed = block.range().enumerate();
                let weighed = weighed.filter(|(_, particle)| weights[*particle] > 0.0);
                let distances = weighed.map(|(i, particle)| {
                    let [x, y, theta] = [0, 1, 2].map(|k| block.column(Columns::POSE + k)[i]);
                    let point = self.point(Pose::new(x, y, theta), centre);
                    (squared(point), particle)
                });
                distances.fold((f64::INFINITY, 0), nearer)
            },
            nearer,
        );
        pose_of(filter, particle)
    }

    fn point(&self, pose: Pose, about: Pose) -> Point {
        let turn = wrapped(pose.theta - about.theta);
        [pose.x - about.x, pose.y - about.y, self.rho * turn]
    }

    /// Takes all particles as one group.
    fn read(&mut self, filter: &ParticleFilter<ContactModel<'_>>, centre: Pose) {
        self.points.clear();
        for block in filter.particles().blocks() {
            let [x, y, theta] = [0, 1, 2].map(|k| block.column(Columns::POSE + k));
            for i in 0..block.len() {
                let point = self.point(Pose::new(x[i], y[i], theta[i]), centre);
                self.points.push(point);
            }
        }
        self.mode_of.clear();
        self.mode_of.resize(self.points.len(), 0);
    }

    /// Cuts groups in two until none falls apart; returns their number.
    fn divide(&mut self, weights: &[f64]) -> u8 {
        let (mut count, mut mode) = (1, 0);
        while mode < count {
            let cut = (count < MOST_MODES).then(|| self.cut(weights, mode));
            let Some(cut) = cut.flatten() else {
                mode += 1;
                continue;
            };
            let points = self.points.iter().zip(&mut self.mode_of);
            for (point, mode_of) in points.filter(|(_, of)| **of == mode) {
                if cut.is_beyond(*point) {
                    *mode_of = count;
                }
            }
            count += 1;
        }
        count
    }

    /// Returns the cut of a group in two along its longest axis (Otsu 1979), if it falls apart.
    fn cut(&self, weights: &[f64], mode: u8) -> Option<Cut> {
        let moments = Moments::of(self.members(weights, mode));
        let axis = moments.longest_axis()?;
        let along = |point: Point| dot(axis, minus(point, moments.mean));

        // weights by place along the axis
        let places = self.members(weights, mode).map(|(_, point)| along(point));
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
            (low.min(t), high.max(t))
        });
        let width = (high - low) / BINS as f64;
        let mut bins = [Part::default(); BINS];
        for (weight, point) in self.members(weights, mode) {
            let t = along(point);
            bins[(((t - low) / width) as usize).min(BINS - 1)].add(weight, t);
        }

        // the cut whose parts lie farthest apart, with their weights
        let whole = bins
            .iter()
            .fold(Part::default(), |sum, bin| sum.plus(bin, 1.0));
        let mut before = Part::default();
        let mut best: Option<(f64, usize, Part, Part)> = None;
        for (k, bin) in bins.iter().enumerate().take(BINS - 1) {
            before = before.plus(bin, 1.0);
            let after = whole.plus(&before, -1.0);
            let apart = after.mean() - before.mean();
            let between = before.weight * after.weight * apart * apart;
            if between > best.map_or(0.0, |(most, ..)| most) {
                best = Some((between, k + 1, before, after));
            }
        }
        let (_, bin, before, after) = best?;
        let distance = after.mean() - before.mean();
        let spread = f64::sqrt(0.5 * (before.variance() + after.variance()));
        let apart = before.weight.min(after.weight) >= LEAST_WEIGHT
            && distance >= self.least
            && distance >= LEAST_DISTANCE * spread;
        apart.then_some(Cut {
            axis,
            through: moments.mean,
            low,
            width,
            bin,
        })
    }

    /// Returns weights and points of a group; particles without weight belong to none.
    fn members<'a>(
        &'a self,
        weights: &'a [f64],
        mode: u8,
    ) -> impl Iterator<Item = (f64, Point)> + Clone + 'a {
        let all = self.points.iter().zip(weights).zip(&self.mode_of);
        all.filter(move |((_, weight), of)| **of == mode && **weight > 0.0)
            .map(|((point, weight), _)| (*weight, *point))
    }

    fn describe(
        &self,
        filter: &ParticleFilter<ContactModel<'_>>,
        weights: &[f64],
        mode: u8,
    ) -> BeliefMode {
        let moments = Moments::of(self.members(weights, mode));
        let of = |particle: &usize| self.mode_of[*particle] == mode && weights[*particle] > 0.0;
        let distances = (0..self.points.len()).filter(of).map(|particle| {
            let from_mean = minus(self.points[particle], moments.mean);
            (squared(from_mean), particle)
        });
        let (_, particle) = distances.fold((f64::INFINITY, 0), nearer);
        let [x, y, turn] = [0, 1, 2].map(|k| moments.covariance[k][k].max(0.0).sqrt());
        BeliefMode {
            weight: moments.weight / weights.iter().sum::<f64>(),
            pose: pose_of(filter, particle),
            std: Pose::new(x, y, turn / self.rho),
        }
    }
}

/// A plane between two groups, by the bins along an axis.
struct Cut {
    axis: Point,
    through: Point,
    low: f64,
    width: f64,
    /// First bin beyond it.
    bin: usize,
}

impl Cut {
    fn is_beyond(&self, point: Point) -> bool {
        let t = dot(self.axis, minus(point, self.through));
        ((t - self.low) / self.width) as usize >= self.bin
    }
}

/// Sums over a part of a group along an axis.
#[derive(Clone, Copy, Default)]
struct Part {
    weight: f64,
    first: f64,
    second: f64,
}

impl Part {
    fn add(&mut self, weight: f64, t: f64) {
        *self = self.plus(
            &Self {
                weight,
                first: weight * t,
                second: weight * t * t,
            },
            1.0,
        );
    }

    fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            weight: self.weight + times * other.weight,
            first: self.first + times * other.first,
            second: self.second + times * other.second,
        }
    }

    fn mean(&self) -> f64 {
        self.first / self.weight
    }

    fn variance(&self) -> f64 {
        let mean = self.mean();
        (self.second / self.weight - mean * mean).max(0.0)
    }
}

fn pose_of(filter: &ParticleFilter<ContactModel<'_>>, particle: usize) -> Pose {
    let [x, y, theta] = [0, 1, 2].map(|k| filter.particles().value(particle, Columns::POSE + k));
    Pose::new(x, y, theta)
}

fn nearer(a: (f64, usize), b: (f64, usize)) -> (f64, usize) {
    if b.0 < a.0 { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_filter::{Purpose, Streams};

    /// Returns the sizes of the groups found in clouds of normal numbers about these x (m), so many
    /// particles each, of standard deviation 1 mm.
    fn groups_of(clouds: &[(usize, f64)], least: f64) -> Vec<usize> {
        let draw = Streams::new(7).of(Purpose::Initialise).at(0);
        let mut finder = ModeFinder::new(0.02, least);
        for (count, x) in clouds {
            for _ in 0..*count {
                let particle = finder.points.len() as u32;
                let [a, b, c] = draw.normals::<3>(particle, 0).map(|normal| 1e-3 * normal);
                finder.points.push([x + a, b, c]);
            }
        }
        let particles = finder.points.len();
        finder.mode_of.resize(particles, 0);
        let weights = vec![1.0 / particles as f64; particles];
        let count = finder.divide(&weights);
        let of = |mode| finder.mode_of.iter().filter(|of| **of == mode).count();
        (0..count).map(of).collect()
    }

    #[test]
    fn clouds_that_lie_apart_are_modes_and_one_cloud_is_one() {
        assert_eq!(groups_of(&[(1000, 0.0)], 3e-4), [1000]);
        assert_eq!(groups_of(&[(700, 0.0), (300, 0.01)], 3e-4), [700, 300]);
        let mut three = groups_of(&[(300, 0.0), (300, 0.01), (400, 0.03)], 3e-4);
        three.sort_unstable();
        assert_eq!(three, [300, 300, 400]);

        // too near each other for their spread, nearer than the least distance, too light
        assert_eq!(groups_of(&[(500, 0.0), (500, 0.003)], 3e-4), [1000]);
        assert_eq!(groups_of(&[(500, 0.0), (500, 0.01)], 0.02), [1000]);
        assert_eq!(groups_of(&[(990, 0.0), (10, 0.02)], 3e-4), [1000]);
    }

    #[test]
    fn an_even_spread_is_one_mode() {
        let mut finder = ModeFinder::new(0.02, 3e-4);
        finder.points = (0..1000).map(|i| [1e-5 * f64::from(i), 0.0, 0.0]).collect();
        finder.mode_of = vec![0; 1000];
        assert_eq!(finder.divide(&vec![1e-3; 1000]), 1);
    }
}
