//! Likelihood of the tactile readings given a particle: [`TactileLikelihood`].

use stickslip_dynamics::{Lanes, Mask};
use stickslip_filter::Block;

use crate::particle::chunk::{Column, LANES, flag};
use crate::particle::columns::Columns;
use crate::setup::Tactile;

/// Probability of binary readings given a particle's contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TactileLikelihood {
    /// log-probability of reading 0 and 1 where the particle does not touch.
    free: [f64; 2],
    /// log-probability of reading 0 and 1 where it touches.
    touching: [f64; 2],
    columns: Columns,
}

impl TactileLikelihood {
    pub fn new(sensors: &Tactile, columns: Columns) -> Self {
        let (missed, false_alarm) = (sensors.false_negative, sensors.false_positive);
        Self {
            free: [1.0 - false_alarm, false_alarm].map(libm::log),
            touching: [missed, 1.0 - missed].map(libm::log),
            columns,
        }
    }

    /// Returns the log-probability of the readings given one chunk's contacts.
    ///
    /// The impulses of a driven particle show which fixels it touches. Those of an idle particle do
    /// not: the support's friction holds it, so it stays where it is whether the pusher behind it
    /// presses or not. Both are certified solutions of its step. The warm start and the tracking
    /// noise decide which of them the solver returns. So the one that explains the readings better
    /// counts.
    #[inline(always)]
    pub fn log_likelihood(
        &self,
        readings: &[Option<bool>],
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let driven = self.given(
            readings,
            #[inline(always)]
            |j| flag(block, self.columns.contact_fixel(j), chunk),
        );
        let idle = flag(block, Columns::IDLE, chunk);
        if !idle.any() {
            return driven;
        }
        let pressed = self.given(
            readings,
            #[inline(always)]
            |j| flag(block, self.columns.driven_contact_fixel(j), chunk),
        );
        let untouched = self.given(
            readings,
            #[inline(always)]
            |_| Mask::splat(false),
        );
        idle.select(pressed.max(untouched), driven)
    }

    /// Returns the log-probability of the readings if `touches(j)` are the particles that touch
    /// fixel j.
    #[inline(always)]
    fn given(&self, readings: &[Option<bool>], touches: impl Fn(usize) -> Mask<LANES>) -> Column {
        let mut sum = Column::ZERO;
        for (j, reading) in readings.iter().enumerate() {
            if let Some(reading) = reading {
                let reading = usize::from(*reading);
                let (free, touching) = (self.free[reading], self.touching[reading]);
                sum += touches(j).select(Lanes::splat(touching), Lanes::splat(free));
            }
        }
        sum
    }
}
