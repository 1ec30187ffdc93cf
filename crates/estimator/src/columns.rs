//! Which column of the particle set holds what: [`Columns`].

/// Columns of a warm start.
const WARM: usize = stickslip_dynamics::WarmStart::LEN;

/// Layout of a particle: pose, twist, friction, contacts, outcome, warm start, contacts with fixels, past poses.
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
    /// 1 where the pusher touches.
    pub const CONTACT_PUSHER: usize = 10;
    /// 1 where the last step of a particle had no certified solution.
    pub const UNSOLVED: usize = 11;
    /// 1 where nothing drove the particle in its last step: the pusher stands, or the particle is at rest and out of its way.
    pub const IDLE: usize = 12;
    /// How far the pusher stands behind its pose (m).
    pub const PUSHER_LAG: usize = 13;
    /// First column of the warm start.
    pub const WARM_START: usize = 14;

    /// For `fixels` fixels and `history` past poses.
    pub fn new(fixels: usize, history: usize) -> Self {
        Self { fixels, history }
    }

    /// c_j of every fixel.
    pub fn contact_fixels(&self) -> std::ops::Range<usize> {
        self.contact_fixel(0)..self.contact_fixel(self.fixels)
    }

    /// c_j, 1 where fixel j touches.
    pub fn contact_fixel(&self, fixel: usize) -> usize {
        Self::WARM_START + WARM + fixel
    }

    /// c_j in the particle's last step under the pusher or in motion: whether fixel j bears it when it is pressed on.
    pub fn against_fixel(&self, fixel: usize) -> usize {
        self.contact_fixel(self.fixels) + fixel
    }

    /// x of the past pose in ring slot `slot`; y and θ follow.
    pub fn past_pose(&self, slot: usize) -> usize {
        self.against_fixel(self.fixels) + 3 * slot
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
