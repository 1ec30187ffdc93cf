//! Where a pusher may be that nobody sees: [`HiddenPusher`] (contact mode; docs/method.md (53)).

use stickslip_dynamics::{Placed, Pose, Scene, StepInput, Twist};

use crate::gap::gap;
use crate::particle::step_plan::UnseenPusher;

/// Gap of object and a pusher that nobody sees, up to which it counts as having reached the object
/// (m).
const REACHED: f64 = 1e-3;

/// The pusher as it was when it was last seen, and what has become of it since.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HiddenPusher {
    /// Its last twist, and where it is if it goes on like that, once it was seen.
    last: Option<(Twist, Pose)>,
    /// Whether it moved then, as far as its track can tell.
    moved: bool,
    /// Whether it would have reached the object by now.
    reached: bool,
    /// For how long it has been seen again (s); 0 while nobody sees it, infinite where it was never
    /// hidden.
    back_for: f64,
}

/// How long a pusher that is seen again counts as just back: bodies that have come to overlap
/// meanwhile part (s).
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
    /// Whether nobody saw it at the latest row.
    pub fn is_hidden(&self) -> bool {
        self.back_for == 0.0
    }

    /// A row at which somebody sees it, `h` (s) after the one before, that ends with this substep,
    /// and whether it moves; says whether it is just back.
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

    /// A row at which nobody sees it, `h` (s) after the one before; `hidden_object` is where the
    /// object is thought to be, where nobody sees that, either. What the pusher may do to it: in
    /// the dark nothing if it stood when it was last seen, since it has been lifted then.
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
