//! A linear-Gaussian model, whose exact answer is a Kalman filter's, for the tests of the particle
//! filter.
use stickslip_filter::{
    Block, BlockMut, ConstantVelocity, Draw, Model, ParticleFilter, Purpose, Settings, Streams,
    WeightedSums,
};

/// Columns.
pub const POSITION: usize = 0;
pub const VELOCITY: usize = 1;

pub const AXIS: ConstantVelocity = ConstantVelocity {
    process_noise: 0.5,
    measurement_std: 0.3,
    initial_velocity_std: 1.0,
};

/// One axis of nearly constant velocity as particles; the state of [`ConstantVelocity`].
pub struct Axis {
    pub noise: ConstantVelocity,
    /// The first measurement.
    pub start: f64,
    /// A particle farther than this from a measurement has likelihood zero.
    pub gate: f64,
    /// At least 2; what is in others is not used.
    pub columns: usize,
}

impl Axis {
    pub const OPEN: Axis = Axis {
        noise: AXIS,
        start: 0.0,
        gate: f64::INFINITY,
        columns: 2,
    };
    pub const GATED: Axis = Axis {
        gate: 3.0,
        ..Axis::OPEN
    };
}

/// Weighted sums over particles, of position and velocity.
#[derive(Debug, Default)]
pub struct Sums {
    /// Σ w.
    pub weight: f64,
    /// Σ w x.
    pub first: [f64; 2],
    /// Σ w x².
    pub second: [f64; 2],
}

impl Sums {
    /// The variance of a column.
    pub fn variance(&self, column: usize) -> f64 {
        self.second[column] - self.first[column] * self.first[column]
    }
}

impl WeightedSums for Sums {
    fn clear(&mut self) {
        *self = Sums::default();
    }

    fn add(&mut self, other: &Self, scale: f64) {
        self.weight += scale * other.weight;
        for column in [POSITION, VELOCITY] {
            self.first[column] += scale * other.first[column];
            self.second[column] += scale * other.second[column];
        }
    }
}

/// Random numbers of one block.
pub type Noise = [Vec<f64>; 2];

impl Model for Axis {
    /// The step's length [s].
    type Input = f64;
    type Observation = f64;
    type Scratch = Noise;
    type Sums = Sums;

    fn columns(&self) -> usize {
        self.columns
    }

    fn scratch(&self) -> Noise {
        [
            vec![0.0; stickslip_filter::BLOCK],
            vec![0.0; stickslip_filter::BLOCK],
        ]
    }

    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        for (lane, particle) in block.particles() {
            let [a, b] = draw.normals(particle, 0);
            block.column_mut(POSITION)[lane] = self.start + self.noise.measurement_std * a;
            block.column_mut(VELOCITY)[lane] = self.noise.initial_velocity_std * b;
        }
    }

    fn propagate(&self, h: &f64, draw: Draw, block: &mut BlockMut<'_>, [a, b]: &mut Noise) {
        // Cholesky factor of q [h^3/3 h^2/2; h^2/2 h]
        let scale = self.noise.process_noise.sqrt();
        let (xx, xv) = (scale * (h * h * h / 3.0).sqrt(), scale * (0.75 * h).sqrt());
        let vv = scale * (0.25 * h).sqrt();
        let n = block.len();
        draw.normal_columns(block.first_particle(), 0, &mut a[..n], &mut b[..n]);
        let [x, v] = block.columns_mut([POSITION, VELOCITY]);
        for i in 0..n {
            x[i] += h * v[i] + xx * a[i];
            v[i] += xv * a[i] + vv * b[i];
        }
    }

    fn log_likelihood(&self, measured: &f64, block: &Block<'_>, out: &mut [f64]) {
        let std = self.noise.measurement_std;
        let constant = -libm::log(std * std::f64::consts::TAU.sqrt());
        for (l, x) in out.iter_mut().zip(block.column(POSITION)) {
            let z = (measured - x) / std;
            *l = if (measured - x).abs() > self.gate {
                f64::NEG_INFINITY
            } else {
                constant - 0.5 * z * z
            };
        }
    }

    fn sum(&self, _: &f64, block: &Block<'_>, weights: &[f64], sums: &mut Sums) {
        let sum = |column: usize, power: i32| {
            let weighted = weights.iter().zip(block.column(column));
            weighted.map(|(w, x)| w * x.powi(power)).sum()
        };
        *sums = Sums {
            weight: weights.iter().sum(),
            first: [sum(POSITION, 1), sum(VELOCITY, 1)],
            second: [sum(POSITION, 2), sum(VELOCITY, 2)],
        };
    }

    fn reinitialise(&self, measured: &f64, draw: Draw, block: &mut BlockMut<'_>) {
        for (lane, particle) in block.particles() {
            block.column_mut(POSITION)[lane] =
                measured + self.noise.measurement_std * draw.normal(particle, 0);
        }
    }
}

/// The weighted mean of a column.
pub fn mean<M: Model>(filter: &ParticleFilter<M>, column: usize) -> f64 {
    filter.expectation(column, |x| x)
}

/// The weighted standard deviation of a column.
pub fn std<M: Model>(filter: &ParticleFilter<M>, column: usize) -> f64 {
    let mean = mean(filter, column);
    filter
        .expectation(column, |x| (x - mean) * (x - mean))
        .sqrt()
}

pub fn settings(particles: usize, seed: u64) -> Settings {
    Settings {
        particles,
        seed,
        ..Settings::default()
    }
}

/// (times, measurements) of one axis that follows the model: steps uneven, every fifth row and a
/// run of rows missing.
pub fn series(rows: usize, seed: u64) -> (Vec<f64>, Vec<Option<f64>>) {
    let streams = Streams::new(seed).of(Purpose::Measure);
    let (mut time, mut x, mut v) = (0.0, 0.0, 0.4);
    let mut out = (vec![0.0], vec![Some(0.0)]);
    for row in 1..rows {
        let draw = streams.at(row as u64);
        let h = 0.2 + 0.2 * draw.uniform(0, 0);
        let [a, b, r] = draw.normals(0, 0);
        let q = AXIS.process_noise;
        x += h * v + (q * h * h * h / 3.0).sqrt() * a;
        v += (0.75 * q * h).sqrt() * a + (0.25 * q * h).sqrt() * b;
        time += h;
        let missing = row % 5 == 3 || (10..14).contains(&row);
        out.0.push(time);
        out.1
            .push((!missing).then_some(x + AXIS.measurement_std * r));
    }
    out
}
