//! Which column of the particle set holds what: [`Columns`].

/// Columns of a warm start.
const WARM: usize = stickslip_dynamics::WarmStart::LEN;

/// Flags in a column: the bits of a mantissa, so that a column of flags is never NaN.
const BITS: usize = 52;

/// Flags that do not belong to a fixel.
const SINGLE: usize = 4;

/// A condition of every particle: one bit of a column that holds nothing but such bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flag {
    /// The column.
    pub column: usize,
    /// Number of the bit, below 52.
    pub bit: u32,
}

/// Layout of a particle: pose, twist, friction, the pusher's lag, warm start, flags, past poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    fixels: usize,
    history: usize,
}

impl Columns {
    /// x, y, θ.
    pub const POSE: usize = 0;
    /// vx, vy, ω.
    pub const TWIST: usize = 3;
    /// μ_s, μ_p, μ_f, d_tri.
    pub const FRICTION: usize = 6;
    /// Way from where the pusher stands to its pose: x, y (m).
    pub const PUSHER_LAG: usize = 10;
    /// First column of the warm start.
    pub const WARM_START: usize = 12;
    /// First column of the flags.
    const FLAGS: usize = Self::WARM_START + WARM;
    /// Whether the pusher touches.
    pub const CONTACT_PUSHER: Flag = Self::flag(0);
    /// Whether the last step of a particle had no certified solution.
    pub const UNSOLVED: Flag = Self::flag(1);
    /// Whether it had neither a solution nor a proof that there is none.
    pub const FAILED: Flag = Self::flag(3);
    /// Whether nothing drove the particle in its last step: the pusher stood, or the particle rested
    /// out of its way.
    pub const IDLE: Flag = Self::flag(2);

    /// For `fixels` fixels and `history` past poses.
    pub fn new(fixels: usize, history: usize) -> Self {
        Self { fixels, history }
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

    /// c_j: whether fixel j touches.
    pub fn contact_fixel(&self, fixel: usize) -> Flag {
        Self::flag(SINGLE + fixel)
    }

    /// Contact flag of fixel j in the last step in which the object was driven.
    pub fn driven_contact_fixel(&self, fixel: usize) -> Flag {
        Self::flag(SINGLE + self.fixels + fixel)
    }

    /// x of the past pose in ring slot `slot`; y and θ follow.
    pub fn past_pose(&self, slot: usize) -> usize {
        Self::FLAGS + (SINGLE + 2 * self.fixels).div_ceil(BITS) + 3 * slot
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
    use std::collections::HashSet;

    #[test]
    fn flags_of_many_fixels_lie_apart_and_before_the_past_poses() {
        let columns = Columns::new(50, 1);
        let of_fixels =
            (0..50).flat_map(|j| [columns.contact_fixel(j), columns.driven_contact_fixel(j)]);
        let flags: Vec<Flag> = of_fixels
            .chain([
                Columns::CONTACT_PUSHER,
                Columns::UNSOLVED,
                Columns::IDLE,
                Columns::FAILED,
            ])
            .collect();
        let places: HashSet<(usize, u32)> =
            flags.iter().map(|flag| (flag.column, flag.bit)).collect();
        assert_eq!((flags.len(), places.len()), (104, 104));
        assert!(
            flags
                .iter()
                .all(|flag| flag.column < columns.past_pose(0) && flag.bit < 52)
        );
    }
}
