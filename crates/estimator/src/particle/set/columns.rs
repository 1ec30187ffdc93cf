//! Layout of the particle set: [`Columns`].

use crate::filter_model::FilterModel;
use crate::particle::sensor::force_likelihood::ForceBias;
use crate::particle::sensor::touch_channel::BELIEF_LEN;
use crate::particle::unknown::table::{Name, UNKNOWNS};

/// Columns of a warm start.
const WARM: usize = stickslip_dynamics::WarmStart::LEN;

/// Flags in a column: the bits of a mantissa, so that a column of flags is never NaN.
const BITS: usize = 52;

/// Flags that do not belong to a fixel.
const SINGLE: usize = 10;

/// Flags of each fixel.
const FLAGS_PER_FIXEL: usize = 4;

/// Columns of the robust model that are no unknowns of [`UNKNOWNS`]: the log-likelihood and the
/// camera's noise.
const OTHERS: usize = 4;

/// Columns of a fixel's offset.
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

/// Layout of a particle: pose, twist, friction, the pusher's lag, warm start, flags, the other
/// unknowns of the robust model, past poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    model: FilterModel,
    fixels: usize,
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
    /// Vector from where the pusher stands to its pose: x, y (m).
    pub const PUSHER_LAG: usize = 10;
    /// First column of the warm start.
    pub const WARM_START: usize = 12;
    /// First column of the flags.
    const FLAGS: usize = Self::WARM_START + WARM;
    /// True if the pusher touches.
    pub const CONTACT_PUSHER: Flag = Self::flag(0);
    /// True if the last step of a particle had no certified solution.
    pub const UNSOLVED: Flag = Self::flag(1);
    /// True if that step had neither a solution nor a proof that there is none.
    pub const FAILED: Flag = Self::flag(2);

    /// True if the pusher ever was so near that contacts with it were sought (robust model).
    pub const PUSHER_WAS_NEAR: Flag = Self::flag(7);

    /// Slip of the object on the pusher.
    pub const SLIP_PUSHER: SlipFlags = SlipFlags {
        stick: Self::flag(8),
        left: Self::flag(9),
    };

    /// The layout for `fixels` fixels and `history` past poses.
    pub fn new(model: FilterModel, fixels: usize, history: usize) -> Self {
        Self {
            model,
            fixels,
            history,
            force: false,
        }
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

    /// c_j: true if fixel j touches.
    pub fn contact_fixel(&self, fixel: usize) -> Flag {
        Self::flag(SINGLE + fixel)
    }

    /// Slip of the object on fixel j.
    pub fn slip_fixel(&self, fixel: usize) -> SlipFlags {
        let first = SINGLE + 2 * self.fixels + 2 * fixel;
        SlipFlags {
            stick: Self::flag(first),
            left: Self::flag(first + 1),
        }
    }

    /// True if fixel j ever was so near that contacts with it were sought (robust model).
    pub fn fixel_was_near(&self, fixel: usize) -> Flag {
        Self::flag(SINGLE + self.fixels + fixel)
    }

    /// First column after the flags.
    fn unknowns(&self) -> usize {
        Self::FLAGS + (SINGLE + FLAGS_PER_FIXEL * self.fixels).div_ceil(BITS)
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

    /// Belief about sensor `fixel`, the numbers of a
    /// [`SensorBelief`](super::touch_channel::SensorBelief) (robust model).
    pub fn sensor(&self, fixel: usize) -> usize {
        let force = if self.force { ForceBias::LEN } else { 0 };
        self.force_bias() + force + BELIEF_LEN * fixel
    }

    /// Returns true if the layout has an unknown: only a force sensor needs its scale.
    pub(crate) fn has(&self, name: Name) -> bool {
        self.force || name != Name::ForceScale
    }

    /// First column of an unknown; of one that every fixel has, that of `fixel` (robust model).
    pub(crate) fn unknown(&self, name: Name, fixel: usize) -> usize {
        let before = UNKNOWNS.iter().take_while(|unknown| unknown.name != name);
        let before = before.filter(|unknown| self.has(unknown.name));
        let before: usize = before.map(|unknown| unknown.numbers).sum();
        self.sensor(self.fixels) + before + OFFSET_LEN * fixel
    }

    /// x of the past pose in ring slot `slot`; y and θ follow.
    pub fn past_pose(&self, slot: usize) -> usize {
        let first = match self.model {
            // behind the last fixel's offset
            FilterModel::Robust => self.unknown(Name::FixelOffset, self.fixels),
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
        ];
        let of_fixels = (0..FIXELS).flat_map(|j| {
            let flags = [columns.contact_fixel(j), columns.fixel_was_near(j)];
            flags.into_iter().chain(of_slip(columns.slip_fixel(j)))
        });
        let identified = (0..4).map(Columns::identified);
        let single = single.into_iter().chain(of_slip(Columns::SLIP_PUSHER));
        single.chain(identified).chain(of_fixels).collect()
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
        numbers.extend((0..FIXELS).map(|j| (columns.sensor(j), BELIEF_LEN)));
        numbers.extend(table::numbers(*columns).map(|number| (number.column, 1)));
        numbers.extend((0..columns.history()).map(|slot| (columns.past_pose(slot), 3)));
        numbers
    }

    #[test]
    fn everything_has_a_place_of_its_own_and_every_column_is_used() {
        let columns = Columns::new(FilterModel::Robust, FIXELS, 3);
        let flags = flags(&columns);
        let places: HashSet<Flag> = flags.iter().copied().collect();
        assert_eq!(flags.len(), SINGLE + FLAGS_PER_FIXEL * FIXELS);
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
