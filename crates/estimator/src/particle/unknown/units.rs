//! Where pusher, fixels and feet of each particle are (robust model): the units of its unknowns,
//! docs/model.md (35) and (36).

use stickslip_dynamics::{Lanes, Offsets, StepInput, Support};
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{Column, LANES, load_chunk};
use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{Propagation, Transition, load_columns};
use crate::particle::transition::step_plan::StepPlan;
use crate::particle::unknown::table::Name;

impl Propagation {
    /// Returns the factor of each particle's random force. While the camera is off it is b^½: a rig
    /// that is measured well is also smooth.
    #[inline(always)]
    pub(crate) fn force_factor(
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
        chunk: usize,
    ) -> Column {
        if !plan.is_dark() {
            return Lanes::splat(1.0);
        }
        let roughness = roughness(columns, block, chunk);
        setup.uncertainty.well_measured_at(roughness).sqrt()
    }

    /// Loads the offsets of each particle's fingers and fixels from their poses, for all substeps.
    #[inline(always)]
    pub(crate) fn load_offsets(
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
            let roughness = roughness(columns, block, chunk);
            let scale = (roughness * unsure.roughness).exp();
            let of_pusher = scale * unsure.pusher_offset;
            let first = offset(columns.unknown(Name::PusherOffset, 0), chunk, of_pusher);
            self.pusher_offsets.push(first);
            let others = columns.fixels()..columns.others();
            let others =
                others.map(|j| offset(columns.unknown(Name::OtherOffset, j), chunk, of_pusher));
            self.pusher_offsets.extend(others);
            if pusher_turn > 0.0 {
                let mut turn = Lanes::ZERO;
                load_columns(
                    block,
                    columns.unknown(Name::PusherTurn, 0),
                    chunk,
                    [&mut turn],
                );
                self.pusher_turn.push(turn * (scale * pusher_turn));
            }
            let of_fixels = scale * unsure.well_measured_at(roughness) * unsure.fixel_position;
            let fixels = 0..columns.fixels();
            let fixels =
                fixels.map(|j| offset(columns.unknown(Name::OtherOffset, j), chunk, of_fixels));
            self.fixel_offsets.extend(fixels);
        }
    }

    /// Makes one substep of the first `chunks` chunks.
    pub(crate) fn step_with_offsets(
        &mut self,
        transition: &Transition<'_>,
        input: &StepInput,
        chunks: usize,
    ) {
        let offsets = Offsets {
            pusher: &self.pusher_offsets,
            pusher_turn: &self.pusher_turn,
            fixels: &self.fixel_offsets,
            supports: &self.supports,
        };
        let particles = &mut self.particles[..chunks];
        let dynamics = &transition.dynamics;
        dynamics.step_block_offset(input, offsets, particles, &mut self.work);
    }

    /// Loads the image of the scene's feet, for all substeps: (35).
    #[inline(always)]
    pub(crate) fn load_support(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        block: &BlockMut<'_>,
    ) {
        self.supports.clear();
        if !setup.support_is_uncertain() {
            return;
        }
        let unsure = &setup.uncertainty;
        let centre = unsure.centre_of_friction * setup.scene.object.gyration_radius();
        for chunk in 0..block.len().div_ceil(LANES) {
            let mut numbers = [Lanes::ZERO; 5];
            let first = columns.unknown(Name::Feet, 0);
            load_columns(block, first, chunk, numbers.each_mut());
            let [x, y, turn, along, across] = numbers;
            let stretch = [along, across].map(|x| x * unsure.foot_stretch);
            let mut support = Support::new(
                [x * centre, y * centre],
                turn * unsure.tripod_angle,
                stretch,
            );
            if !setup.has_tripod() {
                let d_tri = load_chunk(block.column(Columns::FRICTION + D_TRI), chunk, 0.0);
                support = support.scaled(d_tri * (1.0 / setup.scene.nominal.d_tri));
            }
            self.supports.push(support);
        }
    }
}

/// Index of d_tri. Known feet, which have no radius, scale with it.
const D_TRI: usize = 3;

/// Returns the numbers of ln of the rig's scale of one chunk.
#[inline(always)]
pub(crate) fn roughness(columns: &Columns, block: &BlockMut<'_>, chunk: usize) -> Column {
    load_chunk(
        block.column(columns.unknown(Name::Roughness, 0)),
        chunk,
        0.0,
    )
}
