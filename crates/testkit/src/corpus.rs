//! A fixed corpus of hard step problems: [`Corpus`], its problems sorted into [`Family`]s.
//!
//! Problem `index` is a pure function of (seed, index). Families follow each other cyclically, so
//! that `Family::ALL.len()` successive indices hold each once and failures are counted per family.
//!
//! Not every problem has a rigid solution: a rigid pusher into a jam and fixels that overlap from
//! two sides have none, and the solver must say so. The function [`crate::gap_margin`] detects some
//! of them; [`Corpus::witness`] gives a solution where one is known by construction.

use stickslip_dynamics::{StepProblem, StepSolution, Twist, Wrench};

use crate::manufactured::{Motion, manufactured};
use crate::problem_builder::{Other, ProblemBuilder};
use crate::rng::SplitMix64;
use crate::vector::left;

/// Difficulty of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// No contact; slides on or stops within the step.
    Sliding,
    /// Remains at rest under load, with up to three contacts; impulses are not unique. Has a
    /// witness.
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
    /// Jam with a drive that may stall.
    StalledJam,
    /// A face of the pusher against a face of fixels, half of them with a drive that may stall.
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
        let mut builder = ProblemBuilder::new(SplitMix64::stream(self.seed, index));
        let family = self.family(index);
        if let Some((motion, contacts)) = prescribed_motion(family, &mut builder) {
            let (problem, witness) = manufactured(builder, motion, contacts);
            return (problem, Some(witness));
        }
        compose(family, &mut builder);
        (builder.problem, None)
    }
}

/// The motion and the number of contacts of the families that are made from their solution.
fn prescribed_motion(family: Family, builder: &mut ProblemBuilder) -> Option<(Motion, usize)> {
    let foot = builder.rng.below(3);
    match family {
        Family::Resting => {
            builder.problem.twist = Twist::default();
            Some((Motion::Rest, builder.rng.below(4)))
        }
        Family::Pivoting => Some((Motion::Pivot(foot), builder.rng.below(2))),
        Family::Manufactured => {
            let motions = [
                Motion::Rest,
                Motion::Pivot(foot),
                Motion::WithPusher,
                Motion::Any,
            ];
            Some((motions[builder.rng.below(4)], builder.rng.below(9)))
        }
        _ => None,
    }
}

fn compose(family: Family, builder: &mut ProblemBuilder) {
    match family {
        Family::Kicked => kicked(builder),
        Family::SinglePush => single_push(builder),
        Family::CentralPush => central_push(builder),
        Family::FacePush => face_push(builder),
        Family::RotatingPusher => rotating_pusher(builder),
        Family::Scattered => scatter(builder, 8),
        Family::Jam => jam(builder),
        Family::StalledJam => stalled(builder, jam),
        Family::FaceJam => face_jam(builder),
        Family::Grasp => grasp(builder),
        Family::Overlapping => overlapping(builder),
        Family::Duplicated => duplicated(builder),
        Family::Frictionless => frictionless(builder),
        Family::Painleve => painleve(builder),
        Family::SlipperySupport => slippery_support(builder),
        Family::TinyTripod => tiny_tripod(builder),
        Family::UnloadedFoot => unloaded_foot(builder),
        Family::Creeping => creeping(builder),
        Family::Sliding | Family::Resting | Family::Pivoting | Family::Manufactured => {}
    }
}

fn any_other(builder: &mut ProblemBuilder) -> Other {
    if builder.rng.one_in(2) {
        Other::Pusher
    } else {
        Other::Fixel
    }
}

fn scatter(builder: &mut ProblemBuilder, most: usize) {
    for _ in 0..=builder.rng.below(most) {
        let (other, normal) = (any_other(builder), builder.rng.direction());
        let contact = builder.contact_anywhere(other, normal);
        builder.add(contact);
    }
}

fn kicked(builder: &mut ProblemBuilder) {
    let share = builder.rng.log_within(1e-2, 1e2);
    builder.load(share);
    if builder.rng.one_in(2) {
        scatter(builder, 2);
    }
}

fn single_push(builder: &mut ProblemBuilder) {
    builder.add_push(1.2);
    if builder.rng.one_in(3) {
        builder.limit_drive();
    }
}

fn central_push(builder: &mut ProblemBuilder) {
    let normal = builder.drive();
    let push = builder.contact(Other::Pusher, normal, 0.0);
    builder.add(push);
    if builder.rng.one_in(2) {
        let normal = builder.rng.direction();
        let stop = builder.contact(Other::Fixel, normal, 0.0);
        builder.add(stop);
    }
}

fn face_push(builder: &mut ProblemBuilder) {
    let drive = builder.drive();
    let normal = builder.tilted(drive, 0.5);
    builder.add_face(Other::Pusher, normal);
    if builder.rng.one_in(3) {
        builder.limit_drive();
    }
}

fn rotating_pusher(builder: &mut ProblemBuilder) {
    builder.pusher.omega = builder.rng.within(-0.2, 0.2) / builder.gyration;
    if builder.rng.one_in(2) {
        builder.add_push(1.2)
    } else {
        face_push(builder)
    }
}

/// The object between pusher and fixels: touching or nearly so.
fn jam(builder: &mut ProblemBuilder) {
    builder.add_push(0.3);
    let [x, y] = builder.drive();
    for _ in 0..=builder.rng.below(3) {
        let normal = builder.tilted([-x, -y], 0.6);
        let contact = builder.contact_anywhere(Other::Fixel, normal);
        builder.add(contact);
    }
    close_up(builder);
}

fn close_up(builder: &mut ProblemBuilder) {
    let reachable = 0.01 * builder.problem.h;
    for contact in &mut builder.problem.contacts {
        contact.gap = if builder.rng.one_in(2) {
            0.0
        } else {
            reachable * builder.rng.within(-1.0, 1.0)
        };
    }
}

fn stalled(builder: &mut ProblemBuilder, arrangement: fn(&mut ProblemBuilder)) {
    arrangement(builder);
    builder.limit_drive();
}

fn face_jam(builder: &mut ProblemBuilder) {
    let normal = builder.drive();
    builder.add_face(Other::Pusher, normal);
    let opposite = builder.tilted([-normal[0], -normal[1]], 0.01);
    builder.add_face(Other::Fixel, opposite);
    close_up(builder);
    if builder.rng.one_in(2) {
        builder.limit_drive();
    }
}

fn grasp(builder: &mut ProblemBuilder) {
    builder.add_push(0.2);
    let [x, y] = builder.drive();
    let t = left([x, y]);
    for side in [1.0, -1.0, 0.2].into_iter().take(2 + builder.rng.below(2)) {
        let normal = builder.tilted(
            [-0.6 * x + 0.8 * side * t[0], -0.6 * y + 0.8 * side * t[1]],
            0.2,
        );
        let length = libm::hypot(normal[0], normal[1]);
        let contact = builder.contact_anywhere(Other::Fixel, normal.map(|n| n / length));
        builder.add(contact);
    }
    if builder.rng.one_in(2) {
        builder.limit_drive();
    }
}

fn overlapping(builder: &mut ProblemBuilder) {
    scatter(builder, 4);
    for i in 0..builder.problem.contacts.len() {
        builder.problem.contacts[i].gap = builder.overlap();
    }
}

fn duplicated(builder: &mut ProblemBuilder) {
    scatter(builder, 3);
    let originals = builder.problem.contacts.clone();
    for _ in 0..=builder.rng.below(3) {
        builder.problem.contacts.extend_from_slice(&originals);
    }
}

fn frictionless(builder: &mut ProblemBuilder) {
    let towards = builder.rng.direction();
    for _ in 0..builder.rng.below(9) {
        // Normals within a half-plane leave an escape, so that most of these have a solution.
        let (other, normal) = (any_other(builder), builder.tilted(towards, 1.5));
        let contact = builder.contact_anywhere(other, normal);
        builder.add(contact);
    }
    builder
        .problem
        .contacts
        .iter_mut()
        .for_each(|contact| contact.mu = 0.0);
    if builder.rng.one_in(3) {
        builder.limit_drive();
    }
}

fn painleve(builder: &mut ProblemBuilder) {
    for _ in 0..=builder.rng.below(2) {
        let (other, normal) = (any_other(builder), builder.rng.direction());
        let lever = builder.rng.sign() * builder.rng.within(0.8, 1.8);
        let mut contact = builder.contact(other, normal, lever);
        contact.mu = builder.rng.within(0.8, 1.5);
        builder.add(contact);
    }
    builder.scale_support(0.1);
}

fn slippery_support(builder: &mut ProblemBuilder) {
    builder.scale_support(0.0);
    scatter(builder, 4);
}

fn tiny_tripod(builder: &mut ProblemBuilder) {
    builder.stand_on_tripod(1e-4, 5e-4);
    scatter(builder, 2);
}

fn unloaded_foot(builder: &mut ProblemBuilder) {
    builder.stand_unevenly(1e-9);
    scatter(builder, 2);
}

fn creeping(builder: &mut ProblemBuilder) {
    let scale = builder.rng.log_within(1e-6, 3e-4);
    let slow = |v: Twist| Twist {
        vx: scale * v.vx,
        vy: scale * v.vy,
        omega: scale * v.omega,
    };
    builder.problem.twist = slow(builder.problem.twist);
    builder.pusher = slow(builder.pusher);
    builder.load(1.0);
    let Wrench { fx, fy, torque } = builder.problem.applied;
    builder.problem.applied = Wrench {
        fx: scale * fx,
        fy: scale * fy,
        torque: scale * torque,
    };
    builder.add_push(0.5);
    builder.problem.contacts[0].gap *= scale;
}
