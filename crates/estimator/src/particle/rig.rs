//! Unknowns of the rig (robust model): where pusher and fixels stand, and how late the camera is
//! (docs/model.md (36)).

use stickslip_dynamics::{Lanes, Mask};
use stickslip_filter::BlockMut;

use crate::particle::chunk::{Column, LANES, flag, load_chunk, store_chunk};
use crate::particle::columns::Columns;
use crate::particle::propagation::{Propagation, Transition, load_columns};
use crate::particle::step_plan::StepPlan;
use crate::uncertainty::{JITTER, Uncertainty};

impl Propagation {
    /// Draws the offset of fixel j. It is resampled from the prior until the object comes near.
    #[inline(always)]
    pub(super) fn draw_fixel_offset(
        &self,
        Transition { columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        j: usize,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), columns.fixel_was_near(j), chunk);
            for axis in 0..2 {
                let column = columns.fixel_offset(j) + axis;
                self.wander(plan, near, axis, block.column_mut(column), chunk);
            }
        }
    }

    /// Draws the offset of the pusher, the roughness of the rig and the latency of the camera. They
    /// are resampled from the prior until the pusher comes near.
    #[inline(always)]
    pub(super) fn draw_offsets(
        &self,
        Transition { columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let unknowns = [
            columns.pusher_offset(),
            columns.pusher_offset() + 1,
            columns.roughness(),
            columns.latency(),
        ];
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            for (number, column) in unknowns.into_iter().enumerate() {
                self.wander(plan, near, number, block.column_mut(column), chunk);
            }
        }
    }

    /// Draws the turn of the pusher. It is resampled from the prior until the pusher comes near.
    pub(super) fn draw_pusher_turn(
        &self,
        Transition { columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let near = flag(&block.as_block(), Columns::PUSHER_WAS_NEAR, chunk);
            let turn = block.column_mut(columns.pusher_turn());
            self.wander(plan, near, 0, turn, chunk);
        }
    }

    /// Draws a chunk of an unknown, by the column `number` of normal numbers. It is resampled from
    /// its prior, the standard normal distribution, until what reveals it has been `near`. Then it
    /// takes a random step that keeps the prior, where unknowns wander.
    #[inline(always)]
    pub(super) fn wander(
        &self,
        plan: &StepPlan,
        near: Mask<LANES>,
        number: usize,
        unknown: &mut [f64],
        chunk: usize,
    ) {
        let before = load_chunk(unknown, chunk, 0.0);
        let fresh = load_chunk(&self.normals[number], chunk, 0.0);
        let known = match plan.unknowns_wander() {
            true => before * (1.0 - JITTER * JITTER).sqrt() + fresh * JITTER,
            false => before,
        };
        store_chunk(unknown, chunk, &near.select(known, fresh));
    }

    /// Returns the factor of each particle's random force while the camera is off: a rig that is
    /// measured well is also smooth. While the camera is on, the factor is 1: what the force does
    /// not allow for would pass for friction. At rest with the camera off it is 0: nothing would
    /// tell the particles apart, and their spread would only grow.
    #[inline(always)]
    pub(super) fn force_factor(
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
        chunk: usize,
    ) -> Column {
        if !plan.unknowns_wander() {
            return Lanes::ZERO;
        }
        if !plan.is_dark() {
            return Lanes::splat(1.0);
        }
        let roughness = load_chunk(block.column(columns.roughness()), chunk, 0.0);
        setup.uncertainty.well_measured_at(roughness)
    }

    /// Loads the offsets of each particle's pusher and fixels from their poses, for all substeps.
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
            let scale = measured(unsure, roughness) * unsure.fixel_position;
            let fixels = 0..columns.fixels();
            let fixels = fixels.map(|j| offset(columns.fixel_offset(j), chunk, scale));
            self.fixel_offsets.extend(fixels);
        }
    }
}

/// Returns the factor of fixels' offsets on a rig so rough.
#[inline(always)]
fn measured(unsure: &Uncertainty, roughness: Column) -> Column {
    (roughness * unsure.roughness).exp() * unsure.well_measured_at(roughness)
}

/// Returns the factor of the pusher's offset on a rig so rough.
#[inline(always)]
fn registered(unsure: &Uncertainty, roughness: Column) -> Column {
    (roughness * unsure.roughness).exp() * unsure.well_registered_at(roughness)
}
