//! A fixed corpus of step problems that are meant to hurt: [`Corpus`], its problems sorted into
//! [`Family`]s.
//!
//! Problem `index` is a pure function of (seed, index). Families follow each other cyclically, so
//! that any run of `Family::ALL.len()` indices holds each once and failures can be counted per
//! family.
//!
//! Not every problem has a rigid solution: a rigid pusher into a jam and fixels that overlap from
//! two sides have none, and the solver must say so. [`crate::gap_margin`] tells some of them;
//! [`Corpus::witness`] gives a solution where one is known by construction.

use stickslip_dynamics::{StepProblem, StepSolution, Twist, Wrench};

use crate::draft::{Body, Draft};
use crate::manufactured::{Motion, manufactured};
use crate::residual::left;
use crate::rng::SplitMix64;

/// What is hard about a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// No contact; slides on or comes to rest within the step.
    Sliding,
    /// Remains at rest under load, touched by nothing, fixels or a resting pusher; impulses not
    /// unique. Has a witness.
    Resting,
    /// Turns about one stuck foot under load. Has a witness.
    Pivoting,
    /// A load of one hundredth to a hundred times the support friction, up to two contacts.
    Kicked,
    /// One pusher contact.
    SinglePush,
    /// One or two contacts whose normals pass exactly through the centre of mass.
    CentralPush,
    /// Two parallel pusher contacts.
    FacePush,
    /// One or two contacts of a pusher that turns as it moves.
    RotatingPusher,
    /// One to eight contacts, normals anywhere.
    Scattered,
    /// A rigid pusher presses the object against one to three fixels that face it.
    Jam,
    /// The same with a drive that may give way.
    StalledJam,
    /// A face of the pusher against a face of fixels, half of them with a drive that may give way.
    FaceJam,
    /// The pusher and two or three fixels around the object.
    Grasp,
    /// One to four contacts that overlap by up to 2 mm at the start.
    Overlapping,
    /// One to three contacts, each present two to four times.
    Duplicated,
    /// Up to eight contacts without friction; the cone program knows the answer.
    Frictionless,
    /// Long levers and large friction, where the tangential impulse drives the object into the
    /// contact (Painlevé).
    Painleve,
    /// Contacts without any support friction.
    SlipperySupport,
    /// A tripod of less than half a millimetre.
    TinyTripod,
    /// Feet with next to no load.
    UnloadedFoot,
    /// Everything below 0.1 mm/s.
    Creeping,
    /// Up to eight contacts with a known solution. Has a witness.
    Manufactured,
}

impl Family {
    /// All families in the order in which a corpus cycles through them.
    pub const ALL: [Self; 22] = [
        Self::Sliding,
        Self::Resting,
        Self::Pivoting,
        Self::Kicked,
        Self::SinglePush,
        Self::CentralPush,
        Self::FacePush,
        Self::RotatingPusher,
        Self::Scattered,
        Self::Jam,
        Self::StalledJam,
        Self::FaceJam,
        Self::Grasp,
        Self::Overlapping,
        Self::Duplicated,
        Self::Frictionless,
        Self::Painleve,
        Self::SlipperySupport,
        Self::TinyTripod,
        Self::UnloadedFoot,
        Self::Creeping,
        Self::Manufactured,
    ];
}

/// An endless fixed sequence of problems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corpus {
    /// Different seeds give unrelated corpora.
    pub seed: u64,
}

impl Corpus {
    /// The family of problem `index`.
    #[must_use]
    pub fn family(&self, index: u64) -> Family {
        Family::ALL[(index % Family::ALL.len() as u64) as usize]
    }

    /// Problem `index`.
    #[must_use]
    pub fn problem(&self, index: u64) -> StepProblem {
        self.draw(index).0
    }

    /// A solution of problem `index` that is known by construction; it need not be the only one.
    #[must_use]
    pub fn witness(&self, index: u64) -> Option<StepSolution> {
        self.draw(index).1
    }

    /// Problem `index` with its witness.
    pub(crate) fn draw(&self, index: u64) -> (StepProblem, Option<StepSolution>) {
        let mut draft = Draft::new(SplitMix64::stream(self.seed, index));
        let family = self.family(index);
        if let Some((motion, contacts)) = prescribed_motion(family, &mut draft) {
            let (problem, witness) = manufactured(draft, motion, contacts);
            return (problem, Some(witness));
        }
        compose(family, &mut draft);
        (draft.problem, None)
    }
}

/// The motion and the number of contacts of the families that are made from their solution.
fn prescribed_motion(family: Family, draft: &mut Draft) -> Option<(Motion, usize)> {
    let foot = draft.rng.below(3);
    match family {
        Family::Resting => {
            draft.problem.twist = Twist::default();
            Some((Motion::Rest, draft.rng.below(4)))
        }
        Family::Pivoting => Some((Motion::Pivot(foot), draft.rng.below(2))),
        Family::Manufactured => {
            let motions = [
                Motion::Rest,
                Motion::Pivot(foot),
                Motion::WithPusher,
                Motion::Any,
            ];
            Some((motions[draft.rng.below(4)], draft.rng.below(9)))
        }
        _ => None,
    }
}

fn compose(family: Family, draft: &mut Draft) {
    match family {
        Family::Kicked => kicked(draft),
        Family::SinglePush => single_push(draft),
        Family::CentralPush => central_push(draft),
        Family::FacePush => face_push(draft),
        Family::RotatingPusher => rotating_pusher(draft),
        Family::Scattered => scatter(draft, 8),
        Family::Jam => jam(draft),
        Family::StalledJam => stalled(draft, jam),
        Family::FaceJam => face_jam(draft),
        Family::Grasp => grasp(draft),
        Family::Overlapping => overlapping(draft),
        Family::Duplicated => duplicated(draft),
        Family::Frictionless => frictionless(draft),
        Family::Painleve => painleve(draft),
        Family::SlipperySupport => slippery_support(draft),
        Family::TinyTripod => tiny_tripod(draft),
        Family::UnloadedFoot => unloaded_foot(draft),
        Family::Creeping => creeping(draft),
        Family::Sliding | Family::Resting | Family::Pivoting | Family::Manufactured => {}
    }
}

fn any_body(draft: &mut Draft) -> Body {
    if draft.rng.one_in(2) {
        Body::Pusher
    } else {
        Body::Fixel
    }
}

fn scatter(draft: &mut Draft, most: usize) {
    for _ in 0..=draft.rng.below(most) {
        let (body, normal) = (any_body(draft), draft.rng.direction());
        let contact = draft.contact_anywhere(body, normal);
        draft.add(contact);
    }
}

fn kicked(draft: &mut Draft) {
    let share = draft.rng.log_within(1e-2, 1e2);
    draft.load(share);
    if draft.rng.one_in(2) {
        scatter(draft, 2);
    }
}

fn single_push(draft: &mut Draft) {
    draft.add_push(1.2);
    if draft.rng.one_in(3) {
        draft.limit_drive();
    }
}

fn central_push(draft: &mut Draft) {
    let normal = draft.drive();
    let push = draft.contact(Body::Pusher, normal, 0.0);
    draft.add(push);
    if draft.rng.one_in(2) {
        let normal = draft.rng.direction();
        let stop = draft.contact(Body::Fixel, normal, 0.0);
        draft.add(stop);
    }
}

fn face_push(draft: &mut Draft) {
    let drive = draft.drive();
    let normal = draft.tilted(drive, 0.5);
    draft.add_face(Body::Pusher, normal);
    if draft.rng.one_in(3) {
        draft.limit_drive();
    }
}

fn rotating_pusher(draft: &mut Draft) {
    draft.pusher.omega = draft.rng.within(-0.2, 0.2) / draft.gyration;
    if draft.rng.one_in(2) {
        draft.add_push(1.2)
    } else {
        face_push(draft)
    }
}

/// The object between pusher and fixels: touching or nearly so.
fn jam(draft: &mut Draft) {
    draft.add_push(0.3);
    let [x, y] = draft.drive();
    for _ in 0..=draft.rng.below(3) {
        let normal = draft.tilted([-x, -y], 0.6);
        let contact = draft.contact_anywhere(Body::Fixel, normal);
        draft.add(contact);
    }
    close_up(draft);
}

fn close_up(draft: &mut Draft) {
    let reachable = 0.01 * draft.problem.h;
    for contact in &mut draft.problem.contacts {
        contact.gap = if draft.rng.one_in(2) {
            0.0
        } else {
            reachable * draft.rng.within(-1.0, 1.0)
        };
    }
}

fn stalled(draft: &mut Draft, arrangement: fn(&mut Draft)) {
    arrangement(draft);
    draft.limit_drive();
}

fn face_jam(draft: &mut Draft) {
    let normal = draft.drive();
    draft.add_face(Body::Pusher, normal);
    let opposite = draft.tilted([-normal[0], -normal[1]], 0.01);
    draft.add_face(Body::Fixel, opposite);
    close_up(draft);
    if draft.rng.one_in(2) {
        draft.limit_drive();
    }
}

fn grasp(draft: &mut Draft) {
    draft.add_push(0.2);
    let [x, y] = draft.drive();
    let t = left([x, y]);
    for side in [1.0, -1.0, 0.2].into_iter().take(2 + draft.rng.below(2)) {
        let normal = draft.tilted(
            [-0.6 * x + 0.8 * side * t[0], -0.6 * y + 0.8 * side * t[1]],
            0.2,
        );
        let length = libm::hypot(normal[0], normal[1]);
        let contact = draft.contact_anywhere(Body::Fixel, normal.map(|n| n / length));
        draft.add(contact);
    }
    if draft.rng.one_in(2) {
        draft.limit_drive();
    }
}

fn overlapping(draft: &mut Draft) {
    scatter(draft, 4);
    for i in 0..draft.problem.contacts.len() {
        draft.problem.contacts[i].gap = draft.overlap();
    }
}

fn duplicated(draft: &mut Draft) {
    scatter(draft, 3);
    let originals = draft.problem.contacts.clone();
    for _ in 0..=draft.rng.below(3) {
        draft.problem.contacts.extend_from_slice(&originals);
    }
}

fn frictionless(draft: &mut Draft) {
    let towards = draft.rng.direction();
    for _ in 0..draft.rng.below(9) {
        // Normals within a half-plane leave a way out, so that most of these have a solution.
        let (body, normal) = (any_body(draft), draft.tilted(towards, 1.5));
        let contact = draft.contact_anywhere(body, normal);
        draft.add(contact);
    }
    draft
        .problem
        .contacts
        .iter_mut()
        .for_each(|contact| contact.mu = 0.0);
    if draft.rng.one_in(3) {
        draft.limit_drive();
    }
}

fn painleve(draft: &mut Draft) {
    for _ in 0..=draft.rng.below(2) {
        let (body, normal) = (any_body(draft), draft.rng.direction());
        let lever = draft.rng.sign() * draft.rng.within(0.8, 1.8);
        let mut contact = draft.contact(body, normal, lever);
        contact.mu = draft.rng.within(0.8, 1.5);
        draft.add(contact);
    }
    draft.scale_support(0.1);
}

fn slippery_support(draft: &mut Draft) {
    draft.scale_support(0.0);
    scatter(draft, 4);
}

fn tiny_tripod(draft: &mut Draft) {
    draft.stand_on_tripod(1e-4, 5e-4);
    scatter(draft, 2);
}

fn unloaded_foot(draft: &mut Draft) {
    draft.stand_unevenly(1e-9);
    scatter(draft, 2);
}

fn creeping(draft: &mut Draft) {
    let scale = draft.rng.log_within(1e-6, 3e-4);
    let slow = |v: Twist| Twist {
        vx: scale * v.vx,
        vy: scale * v.vy,
        omega: scale * v.omega,
    };
    draft.problem.twist = slow(draft.problem.twist);
    draft.pusher = slow(draft.pusher);
    draft.load(1.0);
    let Wrench { fx, fy, torque } = draft.problem.applied;
    draft.problem.applied = Wrench {
        fx: scale * fx,
        fy: scale * fy,
        torque: scale * torque,
    };
    draft.add_push(0.5);
    draft.problem.contacts[0].gap *= scale;
}
