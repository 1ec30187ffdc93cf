//! Additions of the robust model to a step (docs/model.md): every particle has its
//! own friction, offsets, feet and latency, and its own view of the tactile sensors.

use stickslip_dynamics::{Body, Friction, Lanes, Mask, Offsets, StepInput, Twist, on_widest};
use stickslip_filter::{BlockMut, Draw};

use crate::particle::chunk::{Column, FlagsMut, LANES, flag, load_chunk, store_chunk};
use crate::particle::columns::Columns;
use crate::particle::noise_clock::NOISE_STEP;
use crate::particle::propagation::{Propagation, Transition, load_columns, store_columns};
use crate::particle::pusher_likelihood::squared;
use crate::particle::step_plan::StepPlan;
use crate::particle::touch_channel::{TouchChannel, felt};
use crate::setup::Limits;
use crate::uncertainty::JITTER;

/// Numbers of the draws of unknowns: they follow those of all substeps.
pub(super) const UNSEEN_PAIR: u32 = 1 << 20;
const REST_PAIR: u32 = UNSEEN_PAIR + 2;

/// Time within which the estimate follows an object that is moved by hand (s).
const FOLLOWED: f64 = 1.0;

impl Propagation {
    /// Draws the unknowns for one step.
    pub(super) fn draw_unknowns(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
    ) {
        on_widest(
            self.level,
            #[inline(always)]
            || self.note_untouched(transition, block),
        );
        self.carried.fill(Twist::default());
        if let Some(pusher) = plan.unseen_pusher {
            self.normals_of(draw, UNSEEN_PAIR, block);
            self.carry(transition, plan, (pusher, draw), block);
        }
        if !plan.is_dark() && self.untouched.iter().any(|lanes| lanes.any()) {
            self.normals_of(draw, REST_PAIR, block);
            on_widest(
                self.level,
                #[inline(always)]
                || self.nudge(transition, plan, block),
            );
        }
        self.normals_of(draw, 0, block);
        on_widest(
            self.level,
            #[inline(always)]
            || self.draw_friction(transition, plan, block),
        );
        // drawn in every row of a fast pusher, its offset would be the largest of many when it
        // comes near
        if plan.noise_age == 0 {
            self.step_unknowns(transition, plan, draw, block);
        }
        on_widest(
            self.level,
            #[inline(always)]
            || {
                self.load_offsets(transition, block);
                self.load_support(transition, block);
            },
        );
        for (before, particles) in self.lag_before.iter_mut().zip(&self.particles) {
            *before = squared(particles.pusher_lag);
        }
    }

    /// Fills the columns of normals, on the widest instructions.
    fn normals_of(&mut self, draw: Draw, pair: u32, block: &BlockMut<'_>) {
        on_widest(
            self.level,
            #[inline(always)]
            || self.draw_normals(draw, pair, block),
        );
    }

    /// Notes the particles that nothing has come near yet: their objects rest where they were first
    /// seen.
    #[inline(always)]
    fn note_untouched(
        &mut self,
        Transition { columns, .. }: &Transition<'_>,
        block: &BlockMut<'_>,
    ) {
        let block = &block.as_block();
        for chunk in 0..block.len().div_ceil(LANES) {
            let Twist { vx, vy, omega } = self.particles[chunk].twist;
            let speed = vx.abs() + vy.abs() + omega.abs();
            let mut touched = flag(block, Columns::PUSHER_WAS_NEAR, chunk) | speed.gt(Lanes::ZERO);
            for j in 0..columns.fixels() {
                touched = touched | flag(block, columns.fixel_was_near(j), chunk);
            }
            self.untouched[chunk] = !touched;
        }
    }

    /// Moves objects that nothing has come near yet by a random step. The estimate then follows one
    /// that is moved by hand within [`FOLLOWED`]: the gain of a Kalman filter is the ratio of such
    /// a step to the camera's noise.
    #[inline(always)]
    fn nudge(&mut self, transition: &Transition<'_>, plan: &StepPlan, block: &BlockMut<'_>) {
        let share = NOISE_STEP / FOLLOWED * (plan.duration() / NOISE_STEP).sqrt();
        let Some(camera) = transition.setup.camera else {
            return;
        };
        let steps = [
            camera.position_std,
            camera.position_std,
            camera.orientation_std,
        ];
        for chunk in 0..block.len().div_ceil(LANES) {
            let untouched = self.untouched[chunk];
            let pose = self.particles[chunk].pose.fields_mut();
            for (k, (number, step)) in pose.into_iter().zip(steps).enumerate() {
                let normal = load_chunk(&self.normals[k], chunk, 0.0);
                *number += untouched.zero_unless(normal * (share * step));
            }
        }
    }

    /// Draws the object's friction. A parameter that never took part is resampled from its prior.
    /// One that took part takes a random step that keeps the prior.
    #[inline(always)]
    fn draw_friction(
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
                let felt = flag(&block.as_block(), Columns::felt(k), chunk);
                let fresh = load_chunk(&self.normals[k], chunk, 0.0) * prior;
                let before = (*value * (1.0 / nominal)).ln();
                let wandered = before * (1.0 - step * step).sqrt() + fresh * step;
                let drawn = felt.select(wandered, fresh).exp() * nominal;
                let drawn = within(drawn, limits[k]);
                // without a random step, a parameter that took part keeps its bits
                let stays = felt & Mask::splat(step == 0.0);
                *value = stays.select(*value, drawn);
            }
            self.proposed[chunk] = *friction;
        }
    }

    /// Makes one substep of the first `chunks` chunks.
    pub(super) fn step_with_offsets(
        &mut self,
        transition: &Transition<'_>,
        input: &StepInput,
        chunks: usize,
    ) {
        let offsets = Offsets {
            pusher: &self.pusher_offsets,
            pusher_turn: &self.pusher_turn,
            fixels: &self.fixel_offsets,
            foot_offsets: &self.foot_offsets,
        };
        let particles = &mut self.particles[..chunks];
        let dynamics = &transition.dynamics;
        dynamics.step_block_offset(input, offsets, particles, &mut self.work);
    }

    /// Weighs what is known without the camera at the end of the step: the readings of the sensors
    /// and the pusher's place.
    pub(super) fn feel(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        block
            .column_mut(transition.columns.felt_log_likelihood())
            .fill(0.0);
        on_widest(
            self.level,
            #[inline(always)]
            || self.read_touch(transition, plan, block),
        );
        self.read_pusher(transition, plan, block);
    }

    /// Weighs the tactile readings.
    #[inline(always)]
    fn read_touch(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let Transition { setup, columns, .. } = transition;
        let channel = TouchChannel::new(&setup.tactile);
        let freed = channel.freed(plan.duration());
        let last_h = plan.substeps.last().map_or(0.0, |step| step.h);
        let threshold = Lanes::splat(setup.tactile.touch_force * last_h);
        let touch_gap = Lanes::splat(setup.uncertainty.touch_gap);
        for j in 0..columns.fixels() {
            // a row without readings of a sensor is silent on it
            let reading = plan.tactile.get(j).copied().flatten();
            let most = reading.map_or(0.0, |reading| libm::log(channel.most_likely(reading)));
            for chunk in 0..block.len().div_ceil(LANES) {
                let mut belief = channel.start();
                load_columns(block, columns.sensor(j), chunk, belief.fields_mut());
                belief = channel.later(belief, freed);
                let Some(reading) = reading else {
                    store_columns(block, columns.sensor(j), chunk, belief.fields());
                    continue;
                };
                let impulse = self.work.normal_impulses(chunk, Body::Fixel(j)) / threshold;
                let gap = self.work.gaps(chunk, Body::Fixel(j)) / touch_gap;
                let (after, log_likelihood) = channel.read(belief, felt(impulse, gap), reading);
                let log_likelihood = log_likelihood - Lanes::splat(most);
                store_columns(block, columns.sensor(j), chunk, after.fields());
                let column = columns.felt_log_likelihood();
                let so_far = load_chunk(block.column(column), chunk, 0.0);
                store_chunk(block.column_mut(column), chunk, &(so_far + log_likelihood));
            }
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
pub(super) fn note_felt(phi: &mut Friction<Mask<LANES>>, block: &mut BlockMut<'_>, chunk: usize) {
    let mut flags = FlagsMut::new(block, chunk);
    for (k, took_part) in phi.fields_mut().into_iter().enumerate() {
        let felt = flags.get(Columns::felt(k));
        flags.set(Columns::felt(k), felt | *took_part);
        *took_part = *took_part | !felt;
    }
    flags.write();
}
