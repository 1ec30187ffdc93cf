//! Likelihood of the pusher's force in the robust model (docs/model.md (49)).

use stickslip_dynamics::Lanes;
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{Column, LANES, add_chunk, squared};
use crate::particle::transition::propagation::{
    Propagation, Transition, load_columns, store_columns,
};
use crate::particle::transition::step_plan::StepPlan;
use crate::particle::unknown::table::Name;
use crate::setup::ForceSensor;
use crate::tuning::{FORCE_MODEL, FORCE_WRONG};

/// A particle's belief about the sensor's bias: normal, alike along both axes.
///
/// Given the particle's motion the bias is Gaussian, so no particle draws one (Rao-Blackwellised;
/// Doucet et al. 2000).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceBias {
    /// Mean, x and y (N).
    mean: [Column; 2],
    /// Variance per axis (N²).
    variance: Column,
}

impl ForceBias {
    /// Number of numbers, each a column.
    pub const LEN: usize = 3;

    /// The belief before the first force.
    pub fn prior(sensor: &ForceSensor) -> Self {
        Self {
            mean: [Lanes::ZERO; 2],
            variance: Lanes::splat(sensor.bias_std * sensor.bias_std),
        }
    }

    /// Its numbers.
    pub fn numbers(&self) -> [&Column; Self::LEN] {
        let [x, y] = &self.mean;
        [x, y, &self.variance]
    }

    fn numbers_mut(&mut self) -> [&mut Column; Self::LEN] {
        let [x, y] = &mut self.mean;
        [x, y, &mut self.variance]
    }

    /// The measured force without the expected bias.
    #[inline(always)]
    fn corrected(&self, measured: [f64; 2]) -> [Column; 2] {
        [0, 1].map(|axis| Lanes::splat(measured[axis]) - self.mean[axis])
    }

    /// Learns from an error of the corrected force whose variance, bias included, is `variance`. It
    /// counts as much as it is `right` (probability).
    #[inline(always)]
    fn learn(&mut self, error: [Column; 2], variance: Column, right: Column) {
        let gain = right * self.variance / variance;
        for (mean, error) in self.mean.iter_mut().zip(error) {
            *mean += gain * error;
        }
        self.variance = self.variance - gain * self.variance;
    }
}

impl Propagation {
    /// Adds up, over the substeps of a step, what the table takes up.
    #[inline(always)]
    pub(crate) fn add_support(&mut self, plan: &StepPlan, chunks: usize) {
        if plan.force.is_none() {
            return;
        }
        for chunk in 0..chunks {
            let impulse = self.work.support_impulses(chunk);
            for (sum, impulse) in self.support[chunk].iter_mut().zip(impulse) {
                *sum += impulse;
            }
        }
    }

    /// Weighs the size of the pusher's force while it moves the object over the open table: that of
    /// the table's friction. Its direction is not used: the random force turns it. While the pusher
    /// stands, its force is not unique.
    #[inline(always)]
    pub(crate) fn read_force(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let (Some(sensor), Some(measured), true) = (setup.wrench, plan.force, plan.driven) else {
            return;
        };
        let scene = &setup.scene;
        let sliding = scene.nominal.mu_s * scene.object.mass * scene.gravity;
        let noise = sensor.force_std * sensor.force_std;
        let size = libm::hypot(measured[0], measured[1]);
        // a share of the measured size: a share of the particle's would favour small forces
        let of_model = FORCE_MODEL * FORCE_MODEL * size * size;
        let other = other_density(size, noise, sliding);
        let rate = 1.0 / plan.duration();
        for chunk in 0..block.len().div_ceil(LANES) {
            let mut bias = ForceBias::prior(&sensor);
            load_columns(block, columns.force_bias(), chunk, bias.numbers_mut());

            // the table's friction, where the pusher alone moves the object
            let involved = &self.involved[chunk];
            let friction = squared(self.support[chunk]).sqrt() * rate;
            let mut scale = Lanes::ZERO;
            let column = columns.unknown(Name::ForceScale, 0);
            load_columns(block, column, chunk, [&mut scale]);
            let friction = friction * (scale * sensor.scale_std).exp();
            let force = involved.pusher.zero_unless(friction);

            // how far the measured force is from it
            let corrected = bias.corrected(measured);
            let length = squared(corrected)
                .sqrt()
                .max(Lanes::splat(f64::MIN_POSITIVE));
            let share = Lanes::splat(1.0) - force / length;
            let error = corrected.map(|force| force * share);
            let variance = bias.variance + Lanes::splat(noise + of_model);
            let right = (squared(error) / variance * -0.5).exp() * noise / variance;

            // an object that presses on a fixel, too, explains any force
            let right = involved.fixel.select(Lanes::splat(other), right);
            let likelihood = right * (1.0 - FORCE_WRONG) + Lanes::splat(FORCE_WRONG * other);
            let right = right * (1.0 - FORCE_WRONG) / likelihood;
            bias.learn(error, variance, involved.fixel.select(Lanes::ZERO, right));
            store_columns(block, columns.force_bias(), chunk, bias.numbers());
            let column = block.column_mut(columns.step_log_likelihood());
            add_chunk(column, chunk, likelihood.ln());
        }
    }
}

/// Density of a force that the model does not tell, over that of a perfect one: a Cauchy
/// distribution in the plane, as wide as the sliding force.
fn other_density(size: f64, noise: f64, sliding: f64) -> f64 {
    let square = sliding * sliding + noise;
    let relative = 1.0 + size * size / square;
    noise / square / (relative * relative.sqrt())
}
