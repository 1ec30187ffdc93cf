//! Noise of the camera, estimated from what a particle has seen of it (robust model):
//! [`CameraNoise`].

use stickslip_dynamics::Lanes;
use stickslip_filter::{Block, BlockMut, Draw};

use crate::particle::set::chunk::{Column, load_chunk, store_chunk};
use crate::particle::set::columns::Columns;
use crate::tuning::{MEMORY, MOST_SPREADS};

/// Prior of the camera's noise. Its variance, in units of the nominal one, is ν₀ over a χ² number
/// of ν₀ degrees of freedom (docs/model.md (41)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoisePrior {
    /// ν₀.
    freedom: f64,
    /// Largest variance that this prior explains.
    most: f64,
}

impl NoisePrior {
    /// The prior with this standard deviation of the logarithm of the noise; `None` if the nominal
    /// noise is exact.
    pub fn new(camera_noise: f64) -> Option<Self> {
        let freedom = 1.0 + 0.5 / (camera_noise * camera_noise);
        let most = libm::exp(2.0 * MOST_SPREADS * camera_noise);
        freedom.is_finite().then_some(Self { freedom, most })
    }

    /// Draws the variance of one sensor's noise from this prior, in units of the nominal one, by
    /// the random numbers of `draw` (Marsaglia and Tsang 2000).
    pub fn drawn(&self, draw: Draw, sensor: u32) -> f64 {
        let shape = 0.5 * self.freedom;
        let d = shape - 1.0 / 3.0;
        let c = 1.0 / (9.0 * d).sqrt();
        for attempt in 0.. {
            let (normal, uniform) = (draw.normal(sensor, attempt), draw.uniform(sensor, attempt));
            let cubed = (1.0 + c * normal).powi(3);
            let bound = 0.5 * normal * normal + d * (1.0 - cubed + libm::log(cubed.max(0.0)));
            if cubed > 0.0 && libm::log(uniform) < bound {
                return shape / (d * cubed);
            }
        }
        unreachable!("19 attempts out of 20 are accepted")
    }

    /// Returns the variances of position and angle, in units of the nominal ones, after so many
    /// poses with these sums of squared residuals.
    pub fn variances(&self, poses: f64, position: f64, angle: f64) -> [f64; 2] {
        let [of_position, of_angle] = self.freedoms(poses);
        [
            (self.freedom + position) / of_position,
            (self.freedom + angle) / of_angle,
        ]
    }

    /// Returns the variances of the camera's errors, of position along any axis and of angle, that
    /// do not average out after so many poses with these sums of squared residuals.
    ///
    /// Poses that scatter by more than the prior explains have no independent errors: two cameras
    /// whose frames differ, say, alternate. What is beyond the prior then stays in every mean of
    /// them. It may all lie along one axis.
    pub fn unsettled(&self, [poses, position, angle]: [f64; 3]) -> [f64; 2] {
        let [of_position, of_angle] = self.variances(poses, position, angle);
        [
            2.0 * (of_position - self.most).max(0.0),
            (of_angle - self.most).max(0.0),
        ]
    }

    /// Returns the degrees of freedom of these variances after so many poses.
    pub fn freedoms(&self, poses: f64) -> [f64; 2] {
        [self.freedom + 2.0 * poses, self.freedom + poses]
    }
}

/// Residuals of the poses that one chunk's particles have seen, in units of the nominal standard
/// deviations: their number and the sums of their squares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraNoise {
    poses: Column,
    position: Column,
    angle: Column,
}

impl CameraNoise {
    /// Loads the noise of one chunk.
    #[inline(always)]
    pub fn load(columns: Columns, block: &Block<'_>, chunk: usize) -> Self {
        let first = columns.camera_noise();
        Self {
            poses: load_chunk(block.column(first), chunk, 0.0),
            position: load_chunk(block.column(first + 1), chunk, 0.0),
            angle: load_chunk(block.column(first + 2), chunk, 0.0),
        }
    }

    /// Writes the noise back.
    #[inline(always)]
    pub fn store(&self, columns: Columns, block: &mut BlockMut<'_>, chunk: usize) {
        let first = columns.camera_noise();
        for (k, column) in [&self.poses, &self.position, &self.angle]
            .into_iter()
            .enumerate()
        {
            store_chunk(block.column_mut(first + k), chunk, column);
        }
    }

    /// Returns ln of the likelihood of residuals whose squares are `position` (of the two
    /// coordinates together) and `angle`, relative to that of a perfect pose under the nominal
    /// noise. Student's t distributions marginalise the noise.
    #[inline(always)]
    pub fn log_likelihood(&self, prior: NoisePrior, position: Column, angle: Column) -> Column {
        let one = Lanes::splat(1.0);
        let freedom = Lanes::splat(prior.freedom);
        let (of_position, of_angle) = (freedom + self.poses * 2.0, freedom + self.poses);
        let most = Lanes::splat(prior.most);
        let spread = (freedom + self.position).min(of_position * most);
        let turn = (freedom + self.angle).min(of_angle * most);
        // Γ((ν + 1)/2) / Γ(ν/2) by Stirling's series, within 2e-4 from ν = 1 on
        let inverse = one / of_angle;
        let gamma = one - inverse * 0.25 + inverse * inverse * (1.0 / 32.0);
        let height = of_position / spread * (of_angle / turn).sqrt() * gamma;
        height.ln()
            - (of_position * 0.5 + one) * (one + position / spread).ln()
            - (of_angle + one) * 0.5 * (one + angle / turn).ln()
    }

    /// Returns the estimated standard deviations of position and angle, in units of the nominal
    /// ones.
    #[inline(always)]
    pub fn estimated(&self, prior: NoisePrior) -> [Column; 2] {
        let freedom = Lanes::splat(prior.freedom);
        let position = (freedom + self.position) / (freedom + self.poses * 2.0);
        let angle = (freedom + self.angle) / (freedom + self.poses);
        [position.sqrt(), angle.sqrt()]
    }

    /// Learns from a pose that is right with probability `right`.
    #[inline(always)]
    pub fn learn(&mut self, right: Column, position: Column, angle: Column) {
        let kept = 1.0 - 1.0 / MEMORY;
        self.poses = self.poses * kept + right;
        self.position = self.position * kept + right * position;
        self.angle = self.angle * kept + right * angle;
    }
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    fn after(residuals: &[[f64; 2]]) -> CameraNoise {
        let mut noise = CameraNoise {
            poses: Lanes::ZERO,
            position: Lanes::ZERO,
            angle: Lanes::ZERO,
        };
        for [position, angle] in residuals {
            let one = Lanes::splat(1.0);
            noise.learn(one, Lanes::splat(*position), Lanes::splat(*angle));
        }
        noise
    }

    fn likelihood(noise: &CameraNoise, prior: NoisePrior, [position, angle]: [f64; 2]) -> f64 {
        let [position, angle] = [position, angle].map(Lanes::splat);
        libm::exp(noise.log_likelihood(prior, position, angle).0[0])
    }

    /// Mean of the normal density over the posterior of the variance, by a sum over its logarithm.
    /// `seen` is the number of poses seen, each of `dimensions` numbers, and `squares` their sum of
    /// squares.
    fn integrated(freedom: f64, dimensions: f64, seen: f64, squares: f64, residual: f64) -> f64 {
        let (mut above, mut below) = (0.0, 0.0);
        for step in -4000..4000 {
            let log = f64::from(step) * 2e-3;
            let variance = libm::exp(log);
            // scaled inverse χ² in the logarithm of the variance, times normal densities
            let exponent =
                -0.5 * (freedom + dimensions * seen) * log - 0.5 * (freedom + squares) / variance;
            let density = libm::exp(exponent);
            below += density;
            above += density * libm::exp(-0.5 * (dimensions * log + residual / variance));
        }
        above / below
    }

    #[test]
    fn students_t_is_the_normal_density_averaged_over_the_noise() {
        let prior = NoisePrior::new(0.3).expect("unknown");
        let freedom = 1.0 + 0.5 / 0.09;
        for seen in [&[][..], &[[3.0, 0.1], [9.0, 4.0], [1.0, 2.0]]] {
            let noise = after(seen);
            let [poses, position, angle] =
                [noise.poses, noise.position, noise.angle].map(|column| column.0[0]);
            for residual in [[0.0, 0.0], [1.0, 2.0], [30.0, 0.5], [2.0, 40.0]] {
                let expected = integrated(freedom, 2.0, poses, position, residual[0])
                    * integrated(freedom, 1.0, poses, angle, residual[1]);
                let found = likelihood(&noise, prior, residual);
                assert!(
                    (found / expected - 1.0).abs() < 5e-4,
                    "{found}, {expected} of {residual:?}"
                );
            }
        }
    }

    #[test]
    fn noise_that_is_stated_twice_too_small_is_found() {
        let prior = NoisePrior::new(0.3).expect("unknown");
        let noise = after(&[[8.0, 4.0]; 200]);
        // as likely as under twice the noise, from where the normal density has nothing
        let residual = [18.0, 9.0];
        let doubled = libm::exp(-0.5 * 27.0 / 4.0) / 8.0;
        let found = likelihood(&noise, prior, residual);
        assert!((found / doubled - 1.0).abs() < 0.1, "{found}, {doubled}");
    }

    #[test]
    fn noise_drawn_has_the_prior_s_distribution() {
        // ν₀ over the variance is χ²: its mean is ν₀, its variance 2 ν₀
        for std in [0.3, 0.6] {
            let prior = NoisePrior::new(std).expect("unknown");
            let freedom = 1.0 + 0.5 / (std * std);
            let count = 100_000;
            let drawn = (0..count).map(|k| freedom / prior.drawn(Streams::new(k).at(0), 3));
            let drawn: Vec<f64> = drawn.collect();
            let mean = drawn.iter().sum::<f64>() / count as f64;
            let square = |x: &f64| (x - freedom) * (x - freedom);
            let variance = drawn.iter().map(square).sum::<f64>() / count as f64;
            assert!((mean / freedom - 1.0).abs() < 0.01, "{mean}, {freedom}");
            assert!(
                (variance / (2.0 * freedom) - 1.0).abs() < 0.03,
                "{variance}"
            );
        }
    }

    #[test]
    fn noise_that_is_known_is_not_learned() {
        assert_eq!(NoisePrior::new(0.0), None);
        assert!(NoisePrior::new(1e-3).is_some());
    }
}
