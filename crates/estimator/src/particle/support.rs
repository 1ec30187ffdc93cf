//! Unknowns of how the object stands (robust model; docs/model.md (35)): where its centre of
//! friction lies, and in which directions its three feet.

use stickslip_dynamics::Pose;
use stickslip_filter::BlockMut;

use crate::particle::chunk::{LANES, flag};
use crate::particle::columns::Columns;
use crate::particle::propagation::{Propagation, Transition, load_columns};
use crate::particle::step_plan::StepPlan;

/// Index of μ_s, the parameter that takes part where the object moves: so do the feet.
const MOVED: usize = 0;

impl Propagation {
    /// Draws where the feet stand in the object's frame. It is resampled from the prior until the
    /// object moves.
    #[inline(always)]
    pub(super) fn draw_support(
        &self,
        Transition { columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let moved = flag(&block.as_block(), Columns::felt(MOVED), chunk);
            for number in 0..3 {
                let column = columns.support() + number;
                self.wander(plan, moved, number, block.column_mut(column), chunk);
            }
        }
    }

    /// Loads the displacement and the turn of the feet relative to the scene's, for all substeps.
    #[inline(always)]
    pub(super) fn load_support(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        block: &BlockMut<'_>,
    ) {
        self.foot_offsets.clear();
        if !setup.support_is_uncertain() {
            return;
        }
        let centre = setup.uncertainty.centre_of_friction * setup.scene.object.gyration_radius();
        let angle = setup.uncertainty.tripod_angle;
        for chunk in 0..block.len().div_ceil(LANES) {
            let mut offset = Pose::default();
            load_columns(block, columns.support(), chunk, offset.fields_mut());
            let Pose { x, y, theta } = offset;
            self.foot_offsets.push(Pose {
                x: x * centre,
                y: y * centre,
                theta: theta * angle,
            });
        }
    }
}
