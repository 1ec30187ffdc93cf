//! Layout of the particle set: [`Columns`].

use crate::filter_model::FilterModel;
use crate::particle::sensor::force_likelihood::ForceBias;
use crate::particle::sensor::touch_channel::BELIEF_LEN;
use crate::particle::unknown::table::{Name, UNKNOWNS};

/// Columns of a warm start.
const WARM: usize = stickslip_dynamics::WarmStart::LEN;

/// Flags in a column: the bits of a mantissa, so that a column of flags is never NaN.
const BITS: usize = 52;

/// Flags that do not belong to a fixel or to another finger than the first.
const SINGLE: usize = 11;

/// Flags of each fixel and of each other finger.
const FLAGS_PER_OTHER: usize = 4;

/// Columns of the robust model that are no unknowns of [`UNKNOWNS`]: the log-likelihood and the
/// camera's noise.
const OTHERS: usize = 4;

/// Columns of the offset of a fixel or of another finger.
const OFFSET_LEN: usize = 2;

/// A condition of every particle: one bit of a column that holds only such bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Flag {
    /// The column.
    pub column: usize,
    /// Number of the bit, below 52.
    pub bit: u32,
}

/// Slip of a particle's object on a body that it touches: to the right where neither flag is set.
/// The flags mean nothing where it does not touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlipFlags {
    /// True if it sticks.
    pub stick: Flag,
    /// True if it slides to the left.
    pub left: Flag,
}

/// Layout of a particle: pose, twist, friction, the first finger's lag, warm start, flags, the
/// other fingers' lags, the other unknowns of the robust model, past poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    model: FilterModel,
    fixels: usize,
    fingers: usize,
    history: usize,
    force: bool,
}

impl Columns {
    /// x, y, θ.
    pub const POSE: usize = 0;
    /// vx, vy, ω.
    pub const TWIST: usize = 3;
    /// μ_s, μ_p, μ_f, d_tri.
    pub const FRICTION: usize = 6;
    /// Vector from where the first finger stands to its pose: x, y (m).
    const PUSHER_LAG: usize = 10;
    /// First column of the warm start.
    pub const WARM_START: usize = 12;
    /// First column of the flags.
    const FLAGS: usize = Self::WARM_START + WARM;
    /// True if the pusher, or the first finger of a hand, touches.
    pub const CONTACT_PUSHER: Flag = Self::flag(0);
    /// True if the last step of a particle had no certified solution.
    pub const UNSOLVED: Flag = Self::flag(1);
    /// True if that step had neither a solution nor a proof that there is none.
    pub const FAILED: Flag = Self::flag(2);

    /// True if it ever was so near that contacts with it were sought (robust model).
    pub const PUSHER_WAS_NEAR: Flag = Self::flag(7);

    /// Slip of the object on it.
    pub const SLIP_PUSHER: SlipFlags = SlipFlags {
        stick: Self::flag(8),
        left: Self::flag(9),
    };

    /// True if the bodies that touch hold the object.
    pub const HELD: Flag = Self::flag(10);

    /// The layout for `fixels` fixels and `history` past poses.
    pub fn new(model: FilterModel, fixels: usize, history: usize) -> Self {
        Self {
            model,
            fixels,
            fingers: 1,
            history,
            force: false,
        }
    }

    /// The layout for a pusher of so many fingers, at least 1.
    pub fn with_fingers(self, fingers: usize) -> Self {
        Self { fingers, ..self }
    }

    /// The layout with `history` past poses.
    pub fn with_history(self, history: usize) -> Self {
        Self { history, ..self }
    }

    /// The layout with columns for the errors of a force sensor, or without.
    pub fn with_force(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// Configuration of the filter.
    pub fn model(&self) -> FilterModel {
        self.model
    }

    /// Number of fixels.
    pub fn fixels(&self) -> usize {
        self.fixels
    }

    /// Number of the pusher's fingers.
    pub fn fingers(&self) -> usize {
        self.fingers
    }

    /// Number of bodies besides the object and the first finger: the fixels, then the other
    /// fingers.
    pub fn others(&self) -> usize {
        self.fixels + self.fingers - 1
    }

    /// Number of bodies that may have a tactile sensor: the fixels, then the fingers of a hand of
    /// several.
    pub fn sensors(&self) -> usize {
        match self.fingers {
            1 => self.fixels,
            fingers => self.fixels + fingers,
        }
    }

    const fn flag(number: usize) -> Flag {
        Flag {
            column: Self::FLAGS + number / BITS,
            bit: (number % BITS) as u32,
        }
    }

    /// True if friction parameter `k` (in the order of its columns) ever took part (robust model).
    pub fn identified(k: usize) -> Flag {
        Self::flag(3 + k)
    }

    /// c_j: true if fixel or other finger j touches.
    pub fn contact_other(&self, other: usize) -> Flag {
        Self::flag(SINGLE + other)
    }

    /// True if the body of sensor k touches.
    pub fn contact_of_sensor(&self, sensor: usize) -> Flag {
        match sensor.checked_sub(self.fixels) {
            None => self.contact_other(sensor),
            Some(0) => Self::CONTACT_PUSHER,
            Some(finger) => self.contact_other(self.fixels + finger - 1),
        }
    }

    /// Slip of the object on fixel or other finger j.
    pub fn slip_other(&self, other: usize) -> SlipFlags {
        let first = SINGLE + 2 * self.others() + 2 * other;
        SlipFlags {
            stick: Self::flag(first),
            left: Self::flag(first + 1),
        }
    }

    /// True if fixel or other finger j ever was so near that contacts with it were sought (robust
    /// model).
    pub fn other_was_near(&self, other: usize) -> Flag {
        Self::flag(SINGLE + self.others() + other)
    }

    /// Vector from where a finger stands to its pose: first of two columns, x and y (m).
    pub fn lag(&self, finger: usize) -> usize {
        match finger {
            0 => Self::PUSHER_LAG,
            _ => self.after_flags() + 2 * (finger - 1),
        }
    }

    /// First column after the flags.
    fn after_flags(&self) -> usize {
        Self::FLAGS + (SINGLE + FLAGS_PER_OTHER * self.others()).div_ceil(BITS)
    }

    /// First column after the other fingers' lags.
    fn unknowns(&self) -> usize {
        self.after_flags() + 2 * (self.fingers - 1)
    }

    /// log-likelihood of the pusher's place and the tactile readings of the latest row, without the
    /// camera (robust model).
    pub fn step_log_likelihood(&self) -> usize {
        self.unknowns()
    }

    /// Three columns of [`CameraNoise`](crate::particle::sensor::camera_noise::CameraNoise) (robust model).
    pub fn camera_noise(&self) -> usize {
        self.unknowns() + 1
    }

    /// First column of the [`ForceBias`], where there is a force sensor (robust model).
    pub fn force_bias(&self) -> usize {
        self.unknowns() + OTHERS
    }

    /// Belief about a sensor, the numbers of a
    /// [`SensorBelief`](super::touch_channel::SensorBelief) (robust model).
    pub fn sensor(&self, sensor: usize) -> usize {
        let force = if self.force { ForceBias::LEN } else { 0 };
        self.force_bias() + force + BELIEF_LEN * sensor
    }

    /// Returns true if the layout has an unknown: only a force sensor needs its scale.
    pub(crate) fn has(&self, name: Name) -> bool {
        self.force || name != Name::ForceScale
    }

    /// First column of an unknown; of one that every fixel and other finger has, that of
    /// `other` (robust model).
    pub(crate) fn unknown(&self, name: Name, other: usize) -> usize {
        let before = UNKNOWNS.iter().take_while(|unknown| unknown.name != name);
        let before = before.filter(|unknown| self.has(unknown.name));
        let before: usize = before.map(|unknown| unknown.numbers).sum();
        self.sensor(self.sensors()) + before + OFFSET_LEN * other
    }

    /// x of the past pose in ring slot `slot`; y and θ follow.
    pub fn past_pose(&self, slot: usize) -> usize {
        let first = match self.model {
            // behind the last offset
            FilterModel::Robust => self.unknown(Name::OtherOffset, self.others()),
            FilterModel::Paper => self.unknowns(),
        };
        first + 3 * slot
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        self.past_pose(self.history)
    }

    /// Number of past poses kept.
    pub fn history(&self) -> usize {
        self.history
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::unknown::table;
    use std::collections::HashSet;

    const FIXELS: usize = 50;

    /// Flags of all kinds.
    fn flags(columns: &Columns) -> Vec<Flag> {
        let of_slip = |SlipFlags { stick, left }: SlipFlags| [stick, left];
        let single = [
            Columns::CONTACT_PUSHER,
            Columns::UNSOLVED,
            Columns::FAILED,
            Columns::PUSHER_WAS_NEAR,
            Columns::HELD,
        ];
        let of_others = (0..columns.others()).flat_map(|j| {
            let flags = [columns.contact_other(j), columns.other_was_near(j)];
            flags.into_iter().chain(of_slip(columns.slip_other(j)))
        });
        let identified = (0..4).map(Columns::identified);
        let single = single.into_iter().chain(of_slip(Columns::SLIP_PUSHER));
        single.chain(identified).chain(of_others).collect()
    }

    /// First column and length of all that holds numbers.
    fn numbers(columns: &Columns) -> Vec<(usize, usize)> {
        let mut numbers = vec![
            (Columns::POSE, 3),
            (Columns::TWIST, 3),
            (Columns::FRICTION, 4),
            (Columns::PUSHER_LAG, 2),
            (Columns::WARM_START, WARM),
            (columns.step_log_likelihood(), 1),
            (columns.camera_noise(), 3),
        ];
        numbers.extend((1..columns.fingers()).map(|i| (columns.lag(i), 2)));
        numbers.extend((0..columns.sensors()).map(|j| (columns.sensor(j), BELIEF_LEN)));
        numbers.extend(table::numbers(*columns).map(|number| (number.column, 1)));
        numbers.extend((0..columns.history()).map(|slot| (columns.past_pose(slot), 3)));
        numbers
    }

    #[test]
    fn everything_has_a_place_of_its_own_and_every_column_is_used() {
        for fingers in [1, 3] {
            let columns = Columns::new(FilterModel::Robust, FIXELS, 3).with_fingers(fingers);
            let flags = flags(&columns);
            let places: HashSet<Flag> = flags.iter().copied().collect();
            assert_eq!(flags.len(), SINGLE + FLAGS_PER_OTHER * columns.others());
            assert_eq!(places.len(), flags.len());
            assert!(flags.iter().all(|flag| flag.bit < 52));

            let of_flags: HashSet<usize> = flags.iter().map(|flag| flag.column).collect();
            let numbers = numbers(&columns).into_iter();
            let of_numbers = numbers.flat_map(|(first, length)| first..first + length);
            let mut used: Vec<usize> = of_numbers.chain(of_flags).collect();
            used.sort_unstable();
            assert_eq!(used, (0..columns.count()).collect::<Vec<_>>());
        }
    }
}
