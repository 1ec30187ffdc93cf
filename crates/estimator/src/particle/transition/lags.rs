//! Ways by which the drive yielded, finger by finger.

use stickslip_filter::BlockMut;

use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{Propagation, load_columns, store_columns};

impl Propagation {
    /// Loads how far each finger of one chunk stands behind its pose.
    #[inline(always)]
    pub(crate) fn load_lags(&mut self, columns: &Columns, block: &BlockMut<'_>, chunk: usize) {
        let lags = self.particles[chunk].pusher_lag.iter_mut();
        for (finger, lag) in lags.enumerate().take(columns.fingers()) {
            load_columns(block, columns.lag(finger), chunk, lag.each_mut());
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
