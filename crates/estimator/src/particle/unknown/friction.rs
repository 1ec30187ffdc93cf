//! Friction of the robust model: its draw before a step, and which parameters took part.

use stickslip_dynamics::{Friction, Lanes, Mask};
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{Column, FlagsMut, LANES, flag, load_chunk};
use crate::particle::set::columns::Columns;
use crate::particle::transition::noise_clock::NOISE_STEP;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::StepPlan;
use crate::setup::Limits;
use crate::tuning::JITTER;

impl Propagation {
    /// Draws the object's friction. A parameter that never took part is resampled from its prior.
    /// One that took part takes a random step that keeps the prior.
    #[inline(always)]
    pub(crate) fn draw_friction(
        &mut self,
        Transition { setup, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
    ) {
        let h = plan.duration();
        let step = match plan.driven {
            true => (JITTER * (h / NOISE_STEP).sqrt()).min(1.0),
            false => 0.0,
        };
        let priors = setup.uncertainty.friction.fields();
        let (nominal, limits) = (setup.scene.nominal.fields(), setup.filter.limits.fields());
        for chunk in 0..block.len().div_ceil(LANES) {
            let friction = &mut self.particles[chunk].friction;
            for (k, value) in friction.fields_mut().into_iter().enumerate() {
                let (prior, nominal) = (*priors[k], *nominal[k]);
                if prior <= 0.0 || nominal <= 0.0 {
                    continue;
                }
                let identified = flag(&block.as_block(), Columns::identified(k), chunk);
                let fresh = load_chunk(&self.normals[k], chunk, 0.0) * prior;
                let before = (*value * (1.0 / nominal)).ln();
                let wandered = before * (1.0 - step * step).sqrt() + fresh * step;
                let drawn = identified.select(wandered, fresh).exp() * nominal;
                let drawn = within(drawn, limits[k]);
                // without a random step, a parameter that took part keeps its bits
                let stays = identified & Mask::splat(step == 0.0);
                *value = stays.select(*value, drawn);
            }
            self.proposed[chunk] = *friction;
        }
    }
}

/// Clamps a parameter to its limits.
#[inline(always)]
fn within(value: Column, limits: &Limits) -> Column {
    value
        .max(Lanes::splat(limits.min))
        .min(Lanes::splat(limits.max))
}

/// Notes in a chunk's flags which parameters took part. Adds to `phi` those that never did: they
/// are resampled from the prior.
#[inline(always)]
pub(crate) fn note_identified(
    phi: &mut Friction<Mask<LANES>>,
    block: &mut BlockMut<'_>,
    chunk: usize,
) {
    let mut flags = FlagsMut::new(block, chunk);
    for (k, took_part) in phi.fields_mut().into_iter().enumerate() {
        let identified = flags.get(Columns::identified(k));
        flags.set(Columns::identified(k), identified | *took_part);
        *took_part = *took_part | !identified;
    }
    flags.write();
}
