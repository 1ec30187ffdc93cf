//! Ways by which the drive yielded, finger by finger.

use stickslip_filter::BlockMut;

use crate::filter_model::FilterModel;
use crate::particle::set::chunk::Column;
use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{
    Propagation, Transition, load_columns, store_columns,
};

impl Propagation {
    /// Loads how far each finger of one chunk stands behind its pose.
    #[inline(always)]
    pub(crate) fn load_lags(&mut self, columns: &Columns, block: &BlockMut<'_>, chunk: usize) {
        let lags = self.particles[chunk].pusher_lag.iter_mut();
        for (finger, lag) in lags.enumerate().take(columns.fingers()) {
            load_columns(block, columns.lag(finger), chunk, lag.each_mut());
        }
    }

    /// Puts each finger where it stands: behind its place in the plan by what it has yielded so
    /// far. From its place in the plan it would be deep in a body that stopped it.
    pub(crate) fn stand_back(&mut self, transition: &Transition<'_>, chunks: usize) {
        let Transition { columns, .. } = transition;
        let fingers = chunks * columns.fingers();
        self.yielded.resize(fingers, [Column::ZERO; 2]);
        if columns.model() == FilterModel::Paper {
            self.pusher_offsets.clear();
            self.pusher_offsets.resize(fingers, [Column::ZERO; 2]);
            self.fixel_offsets.clear();
            self.fixel_offsets
                .resize(chunks * columns.fixels(), [Column::ZERO; 2]);
        }
        for (offset, way) in self.pusher_offsets.iter_mut().zip(&self.yielded) {
            *offset = [offset[0] - way[0], offset[1] - way[1]];
        }
    }

    /// Adds what the fingers yielded in this step of a plan.
    pub(crate) fn note_yields(&mut self, transition: &Transition<'_>, chunks: usize) {
        let fingers = transition.columns.fingers();
        let ways = self.yielded.chunks_mut(fingers);
        for (particles, ways) in self.particles[..chunks].iter_mut().zip(ways) {
            for (lag, way) in particles.pusher_lag.iter_mut().zip(ways) {
                let [x, y] = std::mem::take(lag);
                *way = [way[0] + x, way[1] + y];
            }
        }
    }

    /// Stores it.
    #[inline(always)]
    pub(crate) fn store_lags(&self, columns: &Columns, block: &mut BlockMut<'_>, chunk: usize) {
        let lags = self.particles[chunk].pusher_lag.iter();
        for (finger, lag) in lags.enumerate().take(columns.fingers()) {
            store_columns(block, columns.lag(finger), chunk, lag.each_ref());
        }
    }
}
