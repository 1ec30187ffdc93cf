//! Contacts and motion of a step: [`Involved`].

use stickslip_dynamics::{Friction, Mask};

use crate::particle::set::chunk::LANES;

/// Parts of a step that were involved (Φ) and its outcome, by lane of a chunk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Involved {
    pub(crate) pusher: Mask<LANES>,
    pub(crate) fixel: Mask<LANES>,
    pub(crate) moved: Mask<LANES>,
    pub(crate) unsolved: Mask<LANES>,
    pub(crate) failed: Mask<LANES>,
}

impl Involved {
    pub(crate) const NOTHING: Self = {
        let no = Mask::splat(false);
        Self {
            pusher: no,
            fixel: no,
            moved: no,
            unsolved: no,
            failed: no,
        }
    };

    /// Φ: the parameters that took part (docs/method.md (21); paper Table I).
    #[inline(always)]
    pub(crate) fn phi(&self) -> Friction<Mask<LANES>> {
        Friction {
            mu_s: self.moved,
            mu_p: self.pusher,
            mu_f: self.fixel,
            d_tri: self.moved,
        }
    }
}
