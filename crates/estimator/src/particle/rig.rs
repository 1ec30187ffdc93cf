//! Unknowns of the rig (robust model): where pusher and fixels stand, how large the object is, how
//! late the camera (docs/method.md (36), (43)).

use stickslip_dynamics::{Lanes, Mask, Particles};
use stickslip_filter::{Block, BlockMut};

use crate::particle::chunk::{Column, LANES, flag, is_set, load_chunk, store_chunk};
use crate::particle::columns::Columns;
use crate::particle::noise_clock::sharing;
use crate::particle::propagation::{Propagation, Transition, load_columns};
use crate::particle::step_plan::StepPlan;
use crate::uncertainty::Uncertainty;

/// Share of their spread by which offsets wander from one draw of the noise to the next on a rig of
/// nominal roughness: copies of a particle must differ.
const OFFSET_STEP: f64 = 0.1;

/// Share of its spread by which the logarithm of a rig's roughness wanders at rest.
const ROUGHNESS_STEP: f64 = 0.05;

/// Share of its spread by which creep wanders.
const CREEP_STEP: f64 = 0.1;

/// Standard deviation of the logarithm of the contacts' creep over its nominal value.
const CREEP_SPREAD: f64 = 1.2;

/// Clamp on that logarithm, in standard deviations; ensemble updates are unbounded.
const MOST_CREEP: f64 = 3.0;

/// Standard deviations up to which a prior explains the logarithm of a factor. That of the random
/// force is clamped there, since ensemble updates are unbounded.
pub(crate) const MOST_SPREADS: f64 = 3.0;

/// Share of its mean by which the camera's latency wanders.
const LATENCY_STEP: f64 = 0.02;

impl Propagation {
    /// Draws the offset of fixel j. It is resampled from the prior until the object comes near.
    #[inline(always)]
    pub(super) fn draw_fixel_offset(
        &self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        j: usize,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let seen = &block.as_block();
            let near = flag(seen, columns.fixel_was_near(j), chunk);
            let roughness = load_chunk(block.column(columns.roughness()), chunk, 0.0);
            let step = offset_step(measured(&setup.uncertainty, roughness));
            for axis in 0..2 {
                let column = columns.fixel_offset(j) + axis;
                self.wander(plan, (near, step), axis, block.column_mut(column), chunk);
            }
        }
    }

    /// Draws the offset of the pusher, the size of the object and the roughness of the rig. They
    /// are resampled from the prior until the pusher comes near.
    ///
    /// After that the roughness stays while the object moves. Otherwise particles would be favoured
    /// because their offsets wander less. If the camera sees the object rest, the roughness takes
    /// random steps.
    #[inline(always)]
    pub(super) fn draw_offsets(
        &self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let unsure = &setup.uncertainty;
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            let before = load_chunk(block.column(columns.roughness()), chunk, 0.0);
            let fresh = load_chunk(&self.normals[3], chunk, 0.0) * unsure.roughness;
            let known = match plan.shows_rest() {
                true => wandered(before, Lanes::splat(ROUGHNESS_STEP), fresh),
                false => before,
            };
            let roughness = near.select(known, fresh);
            store_chunk(block.column_mut(columns.roughness()), chunk, &roughness);
            let of_pusher = offset_step(registered(unsure, roughness));
            let of_outline = offset_step(measured(unsure, roughness));
            for (number, column, step) in [
                (0, columns.pusher_offset(), of_pusher),
                (1, columns.pusher_offset() + 1, of_pusher),
                (2, columns.growth(), of_outline),
            ] {
                self.wander(plan, (near, step), number, block.column_mut(column), chunk);
            }
        }
    }

    /// Draws the turn of the pusher. It is resampled from the prior until the pusher comes near.
    pub(super) fn draw_pusher_turn(
        &self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            let roughness = load_chunk(block.column(columns.roughness()), chunk, 0.0);
            let step = offset_step(registered(&setup.uncertainty, roughness));
            let turn = block.column_mut(columns.pusher_turn());
            self.wander(plan, (near, step), 0, turn, chunk);
        }
    }

    /// Draws a chunk of an unknown, by the column `number` of normal numbers. It is resampled from
    /// its prior, the standard normal distribution, until what reveals it has been `near`. Then it
    /// takes a random `step` that keeps the prior, where unknowns wander.
    #[inline(always)]
    pub(super) fn wander(
        &self,
        plan: &StepPlan,
        (near, step): (Mask<LANES>, Column),
        number: usize,
        unknown: &mut [f64],
        chunk: usize,
    ) {
        let before = load_chunk(unknown, chunk, 0.0);
        let fresh = load_chunk(&self.normals[number], chunk, 0.0);
        let known = match plan.unknowns_wander() {
            true => wandered(before, step, fresh),
            false => before,
        };
        store_chunk(unknown, chunk, &near.select(known, fresh));
    }

    /// Draws the smoothness of the push, by the normal number that the latency does not use. It is
    /// resampled from the prior until the pusher comes near.
    #[inline(always)]
    pub(super) fn draw_force_factor(
        &self,
        Transition { setup, columns, .. }: &Transition<'_>,
        block: &mut BlockMut<'_>,
    ) {
        let spread = setup.uncertainty.force_spread;
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            let force = block.column_mut(columns.force());
            let fresh = load_chunk(&self.normals[3], chunk, 0.0) * spread;
            let factor = near.select(load_chunk(force, chunk, 0.0), fresh);
            store_chunk(force, chunk, &factor);
        }
    }

    /// Returns the factor of each particle's random force: that of its push and, while the camera
    /// is off, that of its rig. 0 at rest with the camera off.
    ///
    /// While the camera is on, the rig does not count: what the force does not allow for would pass
    /// for friction. Nor does it count in a re-simulated step, since the rig may not be what it
    /// seemed.
    #[inline(always)]
    pub(super) fn force_factor(
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
        chunk: usize,
    ) -> Column {
        let unsure = &setup.uncertainty;
        if !plan.unknowns_wander() {
            return Lanes::splat(0.0);
        }
        let mut factor = Lanes::splat(1.0);
        if unsure.force_spread > 0.0 {
            let most = Lanes::splat(MOST_SPREADS * unsure.force_spread);
            let logarithm = load_chunk(block.column(columns.force()), chunk, 0.0);
            factor = logarithm.max(-most).min(most).exp();
        }
        if plan.is_dark() && !plan.second_try {
            let roughness = load_chunk(block.column(columns.roughness()), chunk, 0.0);
            factor = factor * unsure.well_measured_at(roughness);
        }
        factor
    }

    /// Draws the creep of contacts with the pusher and with fixels. It is resampled from the prior
    /// until these come near.
    #[inline(always)]
    pub(super) fn draw_creep(
        &self,
        Transition { columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let step = Lanes::splat(CREEP_STEP);
        for chunk in 0..block.len().div_ceil(LANES) {
            let seen = &block.as_block();
            let pusher = flag(seen, Columns::PUSHER_WAS_NEAR, chunk);
            let mut fixel = Mask::splat(false);
            for j in 0..columns.fixels() {
                fixel = fixel | flag(seen, columns.fixel_was_near(j), chunk);
            }
            for (k, near) in [pusher, fixel].into_iter().enumerate() {
                let column = columns.creep() + k;
                self.wander(plan, (near, step), k, block.column_mut(column), chunk);
            }
        }
    }

    /// Draws the latency of the camera. It is resampled from the prior until the pusher comes near.
    /// Then it takes a random walk that keeps the prior (Metropolis).
    #[inline(always)]
    pub(super) fn draw_latency(
        &self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let mean = setup.uncertainty.latency;
        for chunk in 0..block.len().div_ceil(LANES) {
            let a = load_chunk(&self.normals[0], chunk, 0.0);
            let b = load_chunk(&self.normals[1], chunk, 0.0);
            let step = load_chunk(&self.normals[2], chunk, 0.0);
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            let column = block.column_mut(columns.latency());
            let before = load_chunk(column, chunk, 0.0);
            // half the sum of squares of two normal numbers is exponential
            let fresh = (a * a + b * b) * (0.5 * mean);
            let moved = (before + step * (LATENCY_STEP * mean)).abs();
            let accepted = (moved - before).lt(fresh) & Mask::splat(plan.unknowns_wander());
            let known = accepted.select(moved, before);
            store_chunk(column, chunk, &near.select(known, fresh));
        }
    }

    /// Exchanges latency for pusher offset under a steady push. A pusher that is ahead by v τ is
    /// one that is early by τ, and so is an object that touches nothing else. Seen later by τ, it
    /// shows the camera the same poses. Metropolis' rule decides by the priors alone.
    pub(super) fn exchange_latency(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        velocity: [f64; 2],
        block: &mut BlockMut<'_>,
    ) {
        let unsure = &setup.uncertainty;
        let speed = libm::hypot(velocity[0], velocity[1]);
        if !(unsure.pusher_offset > 0.0 && unsure.latency > 0.0) {
            return;
        }
        for (i, _) in block.particles() {
            if !is_pushed_alone(columns, &block.as_block(), i) {
                continue;
            }
            let [step, a, b, _] = self.normals.each_ref().map(|column| column[i]);
            let roughness = Lanes([block.column(columns.roughness())[i]]);
            let later = measured(unsure, roughness).0[0];
            let scale = unsure.pusher_offset * registered(unsure, roughness).0[0];
            let early = step * scale / speed;
            let offset = [0, 1].map(|axis| block.column(columns.pusher_offset() + axis)[i]);
            let moved = [0, 1].map(|axis| offset[axis] + velocity[axis] * early / scale);
            let latency = block.column(columns.latency())[i] + early / later;
            let squares = |[x, y]: [f64; 2]| x * x + y * y;
            let loss = 0.5 * (squares(moved) - squares(offset)) + early / later / unsure.latency;
            // half the sum of squares of two normal numbers is exponential, as −ln of a uniform one
            let accepted = latency >= 0.0
                && latency * later < unsure.most_latency()
                && loss < 0.5 * (a * a + b * b);
            if accepted {
                block.column_mut(columns.latency())[i] = latency;
                for axis in 0..2 {
                    block.column_mut(columns.pusher_offset() + axis)[i] = moved[axis];
                }
                self.advance_trajectory(columns, plan, early, block, i);
            }
        }
    }

    /// Moves particle `i` to where it is `early` seconds later, its past included. Past velocities
    /// are means over the time for which noise lasts. Between rows a millisecond apart they would
    /// be mostly noise, which every move would multiply.
    fn advance_trajectory(
        &mut self,
        columns: &Columns,
        plan: &StepPlan,
        early: f64,
        block: &mut BlockMut<'_>,
        i: usize,
    ) {
        let Particles { pose, twist, .. } = &mut self.particles[i / LANES];
        let now = pose.map(|column| column.0[i % LANES]);
        let twist = twist.map(|column| column.0[i % LANES]);
        let at = |block: &BlockMut<'_>, slot: usize, k: usize| {
            block.column(columns.past_pose(slot) + k)[i]
        };
        let past = &plan.seen.past;
        for (row, &(before, slot)) in past.iter().enumerate() {
            let rows = past.get(row + 1).map(|(next, _)| sharing(next - before));
            let later = rows.and_then(|rows| past.get(row + rows as usize));
            for (k, velocity) in twist.fields().into_iter().enumerate() {
                let rate = later.map_or(*velocity, |&(after, next)| {
                    (at(block, next, k) - at(block, slot, k)) / (after - before)
                });
                block.column_mut(columns.past_pose(slot) + k)[i] += rate * early;
            }
        }
        let moved = now.advance(twist, early);
        for (to, from) in pose.fields_mut().into_iter().zip(moved.fields()) {
            to.0[i % LANES] = *from;
        }
    }

    /// Loads the offsets of each particle's pusher and fixels from their poses, and the creep of
    /// contacts, for all substeps.
    #[inline(always)]
    pub(super) fn load_offsets(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        block: &BlockMut<'_>,
    ) {
        let unsure = &setup.uncertainty;
        let offset = |column: usize, chunk: usize, scale: Column| {
            let mut offset = [Lanes::ZERO; 2];
            load_columns(block, column, chunk, offset.each_mut());
            [offset[0] * scale, offset[1] * scale]
        };
        let pusher_turn = setup.pusher_turn();
        self.pusher_offsets.clear();
        self.pusher_turn.clear();
        self.fixel_offsets.clear();
        self.growth.clear();
        self.creep.clear();
        for chunk in 0..block.len().div_ceil(LANES) {
            let mut roughness = Lanes::ZERO;
            load_columns(block, columns.roughness(), chunk, [&mut roughness]);
            let registered = registered(unsure, roughness);
            let scale = registered * unsure.pusher_offset;
            let pusher = offset(columns.pusher_offset(), chunk, scale);
            self.pusher_offsets.push(pusher);
            if pusher_turn > 0.0 {
                let mut turn = Lanes::ZERO;
                load_columns(block, columns.pusher_turn(), chunk, [&mut turn]);
                self.pusher_turn.push(turn * (registered * pusher_turn));
            }
            let measured = measured(unsure, roughness);
            let scale = measured * unsure.fixel_position;
            let fixels = 0..columns.fixels();
            let fixels = fixels.map(|j| offset(columns.fixel_offset(j), chunk, scale));
            self.fixel_offsets.extend(fixels);
            let mut growth = Lanes::ZERO;
            load_columns(block, columns.growth(), chunk, [&mut growth]);
            self.growth.push(growth * (measured * unsure.outline));
            if unsure.creep > 0.0 {
                let most = Lanes::splat(MOST_CREEP);
                let mut creep = [Lanes::ZERO; 2];
                load_columns(block, columns.creep(), chunk, creep.each_mut());
                let share = |spreads: Column| {
                    let spreads = spreads.max(-most).min(most);
                    (spreads * CREEP_SPREAD).exp() * unsure.creep
                };
                self.creep.push(creep.map(share));
            }
        }
    }
}

/// Returns true if the pusher, and nothing else, pushes particle `i`.
fn is_pushed_alone(columns: &Columns, block: &Block<'_>, i: usize) -> bool {
    let fixel = (0..columns.fixels()).any(|j| is_set(block, columns.fixel_was_near(j), i));
    !fixel && is_set(block, Columns::CONTACT_PUSHER, i) && !is_set(block, Columns::IDLE, i)
}

/// Returns the factor of fixels' offsets, outline and latency on a rig so rough.
#[inline(always)]
fn measured<const W: usize>(unsure: &Uncertainty, roughness: Lanes<W>) -> Lanes<W> {
    roughness.exp() * unsure.well_measured_at(roughness)
}

/// Returns the factor of the pusher's offset on a rig so rough.
#[inline(always)]
fn registered<const W: usize>(unsure: &Uncertainty, roughness: Lanes<W>) -> Lanes<W> {
    roughness.exp() * unsure.well_registered_at(roughness)
}

/// Returns the share of their spread by which offsets wander at a time if they are `scale` times
/// their nominal size. The step has the same length (m), however large they are.
#[inline(always)]
fn offset_step(scale: Column) -> Column {
    (Lanes::splat(OFFSET_STEP) / scale).min(Lanes::splat(1.0))
}

/// Makes one step of a random walk that keeps a normal distribution: `fresh` is drawn from that
/// distribution, `step` is its share.
#[inline(always)]
fn wandered(before: Column, step: Column, fresh: Column) -> Column {
    (Lanes::splat(1.0) - step * step).sqrt() * before + step * fresh
}
