//! The nominal simulation: Γ with fixed nominal friction from the first observed pose, driven by
//! the recorded pusher.

use stickslip_dynamics::{Body, Dynamics, Outcome, Particle, Pose, StepInput, StepWork};

use crate::estimate::{Estimate, EstimateRow};
use crate::particle::set::observer::SolvedStep;
use crate::prepared_log::PreparedLog;
use crate::setup::Setup;

/// Simulates the rows of `prepared` once.
pub(crate) fn simulate(
    setup: &Setup,
    prepared: &PreparedLog<'_>,
    progress: &mut dyn FnMut(usize),
) -> Estimate {
    let dynamics = Dynamics::new(setup.scene.clone());
    let mut particle = Particle {
        pose: prepared.start,
        ..Particle::default()
    };
    let mut work = StepWork::<1>::default();
    let mut estimate = prepared.empty_estimate(setup);
    estimate.rows[prepared.first] = row(&particle, None, Outcome::Solved);
    for k in prepared.first..prepared.log.len() - 1 {
        particle.limit_pusher_lag(setup.most_pusher_lag());
        let outcome = advance(&dynamics, prepared, k, &mut particle, &mut work);
        let last = prepared.schedule.step(k).last();
        let touch = touch(setup, &work, last, &estimate.rows[k]);
        estimate.rows[k + 1] = row(&particle, touch, outcome);
        progress(k + 1);
    }
    estimate
}

/// Runs the substeps from row `k` to the next; returns how the worst of them ended.
fn advance(
    dynamics: &Dynamics,
    prepared: &PreparedLog<'_>,
    k: usize,
    particle: &mut Particle,
    work: &mut StepWork<1>,
) -> Outcome {
    let friction = [dynamics.scene().nominal];
    let mut worst = Outcome::Solved;
    for input in prepared.schedule.step(k) {
        let mut one = [*particle];
        let [report] = dynamics.step(input, &friction, &mut one, work);
        worst = match (worst, report.outcome) {
            (Outcome::Failed, _) | (_, Outcome::Solved) => worst,
            (_, outcome) => outcome,
        };
        [*particle] = one;
        if let Some(observer) = prepared.observer {
            observer.on_step(&SolvedStep {
                problem: &work.problem(0),
                bodies: &work.bodies(0),
                solution: &work.solution(0),
                report,
            });
        }
    }
    worst
}

/// Contacts of the first particle with the pusher and with each other body in the `last` substep to
/// a row: 1 or 0 each. A row that no step leads to touches what the row `before` did.
pub(super) fn touch<const W: usize>(
    setup: &Setup,
    work: &StepWork<W>,
    last: Option<&StepInput>,
    before: &EstimateRow,
) -> Option<(f64, Vec<f64>)> {
    match last {
        Some(step) => Some(touch_flags(setup, work, step.h)),
        None => before.contact_pusher.zip(before.contact_others.clone()),
    }
}

/// Contacts of the first particle with the pusher and with each fixel and other finger after a step
/// of `h` seconds: 1 or 0 each.
fn touch_flags<const W: usize>(setup: &Setup, work: &StepWork<W>, h: f64) -> (f64, Vec<f64>) {
    let flag = |touches: bool| f64::from(u8::from(touches));
    let touch_impulse = setup.tactile.touch_force * h;
    let least = |body: Body| match body {
        Body::Finger(_) => 0.0,
        Body::Fixel(_) => touch_impulse,
    };
    let touches = |body: Body| flag(work.normal_impulse(0, body) > least(body));
    let others = (0..setup.scene.others()).map(|j| touches(setup.scene.other(j)));
    (touches(Body::Finger(0)), others.collect())
}

fn row(particle: &Particle, touch: Option<(f64, Vec<f64>)>, outcome: Outcome) -> EstimateRow {
    let (contact_pusher, contact_others) = touch.unzip();
    let pose: Pose = particle.pose;
    EstimateRow {
        pose: Some(pose),
        twist: Some(particle.twist),
        contact_pusher,
        contact_others,
        unsolved: Some(u32::from(outcome != Outcome::Solved)),
        failed: Some(u32::from(outcome == Outcome::Failed)),
        ..EstimateRow::default()
    }
}
