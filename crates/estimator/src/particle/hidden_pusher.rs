//! Possible place of a pusher that is not seen: [`HiddenPusher`] (robust model; docs/model.md
//! (44)).

use stickslip_dynamics::{Placed, Pose, Scene, StepInput, Twist};

use crate::gap::gap;
use crate::particle::step_plan::UnseenPusher;

/// Gap of the object and an unseen pusher up to which the pusher counts as having reached the
/// object (m).
const REACHED: f64 = 1e-3;

/// State of the pusher when it was last seen, and its motion since.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HiddenPusher {
    /// Its last twist, and where it is if it goes on like that; `None` before it was seen.
    last: Option<(Twist, Pose)>,
    /// True if it moved then, as far as its track can tell.
    moved: bool,
    /// True if it would have reached the object by now.
    reached: bool,
    /// Time for which it has been seen again (s): 0 while it is not seen, infinite if it was never
    /// hidden.
    back_for: f64,
}

/// Time for which a pusher that is seen again counts as just back (s): bodies that have come to
/// overlap meanwhile part.
const JUST_BACK: f64 = 0.2;

impl Default for HiddenPusher {
    fn default() -> Self {
        Self {
            last: None,
            moved: false,
            reached: false,
            back_for: f64::INFINITY,
        }
    }
}

impl HiddenPusher {
    /// Returns true if it was not seen at the latest row.
    pub fn is_hidden(&self) -> bool {
        self.back_for == 0.0
    }

    /// Takes a row at which it is seen, `h` (s) after the one before, that ends with the substep
    /// `last`. `moves` is true if it moves. Returns true if it is just back.
    pub fn seen(&mut self, h: f64, last: &StepInput, moves: bool) -> bool {
        let Some(motion) = last.pusher else {
            return false;
        };
        let then = motion.pose.advance(motion.twist, last.h);
        let just_back = self.back_for < JUST_BACK;
        *self = Self {
            last: Some((motion.twist, then)),
            moved: moves,
            reached: false,
            back_for: self.back_for + h,
        };
        just_back
    }

    /// Takes a row at which it is not seen, `h` (s) after the one before. `hidden_object` is the
    /// estimated place of the object if that is not seen, either.
    ///
    /// Returns what the pusher may do to the object. It does nothing to a hidden object if it stood
    /// when it was last seen, since it has been lifted then.
    pub fn unseen(
        &mut self,
        scene: &Scene,
        h: f64,
        hidden_object: Option<Pose>,
    ) -> Option<UnseenPusher> {
        self.back_for = 0.0;
        let reached_before = self.reached;
        if let Some((twist, at)) = &mut self.last {
            *at = at.advance(*twist, h);
            let hidden_object = hidden_object.filter(|_| self.moved && !reached_before);
            let pusher = Placed::new(&scene.pusher.shape, *at);
            let gap_to = |object| gap(&Placed::new(&scene.object.shape, object), &pusher);
            self.reached |= hidden_object
                .and_then(gap_to)
                .is_some_and(|gap| gap < REACHED);
        }
        (self.moved || hidden_object.is_none()).then_some(UnseenPusher {
            twist: self.last.map(|(twist, _)| twist).unwrap_or_default(),
            reached: self.reached,
            reaches: self.reached && !reached_before,
        })
    }
}
