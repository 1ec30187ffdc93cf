//! Likelihood of the tactile readings given a particle: [`TactileLikelihood`].

use stickslip_dynamics::Lanes;
use stickslip_filter::Block;

use crate::particle::set::chunk::{Column, flag};
use crate::particle::set::columns::Columns;
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
    #[inline(always)]
    pub fn log_likelihood(
        &self,
        readings: &[Option<bool>],
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let mut sum = Column::ZERO;
        for (j, reading) in readings.iter().enumerate() {
            if let Some(reading) = reading {
                let reading = usize::from(*reading);
                let (free, touching) = (self.free[reading], self.touching[reading]);
                let touches = flag(block, self.columns.contact_of_sensor(j), chunk);
                sum += touches.select(Lanes::splat(touching), Lanes::splat(free));
            }
        }
        sum
    }
}
