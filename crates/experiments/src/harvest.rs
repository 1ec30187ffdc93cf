//! Steps of recorded experiments: [`harvest`] runs the particle filter over one and judges every
//! step that it solves; a sample of them, cold-started and disturbed, joins the corpus of hard
//! problems ([`survey_steps`]).

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use stickslip::{FilterModel, Observer, RunError, RunOptions, SolvedStep, run_observed};
use stickslip_dynamics::{Outcome, StepProblem, StepSolution};

use crate::recorded_case::RecordedCase;
use stickslip_testkit::judged_residual;
use stickslip_testkit::{SplitMix64, mix};
use stickslip_testkit::{Tally, judge};

/// Most particles of a harvest: one block, whose steps come in a fixed order, so that the same ones
/// are kept each time.
pub const MOST_PARTICLES: usize = 64;

/// Largest residual of a step that counts as solved (m/s; docs/method.md, "The certificate").
const TOLERANCE: f64 = 1e-9;

/// Disturbed forms of each harvested step.
const DISTURBED: u64 = 2;

/// A step of a recorded experiment, with the answer of the filter's solver.
#[derive(Clone, Debug, PartialEq)]
pub struct HarvestedStep {
    /// The problem.
    pub problem: StepProblem,
    /// The solution, where it was solved.
    pub witness: Option<StepSolution>,
}

/// The steps of one run.
#[derive(Clone, Debug, Default)]
pub struct Harvest {
    /// Outcomes of the steps; residuals are the larger of the solver's own and [`judged_residual`].
    pub tally: Tally,
    /// Some of those with contacts.
    pub kept: Vec<HarvestedStep>,
    /// Those that failed, or whose residual is above the tolerance.
    pub refuted: Vec<StepProblem>,
}

/// Options of a harvest.
#[derive(Clone, Copy, Debug)]
pub struct HarvestOptions {
    /// Particles of the filter, at most [`MOST_PARTICLES`].
    pub particles: usize,
    /// One step with contacts in so many is kept.
    pub keep_one_in: u64,
}

/// Runs the particle filter over an experiment, as the program does by default, and judges every
/// step.
///
/// # Errors
/// The experiment cannot be run.
///
/// # Panics
/// With more than [`MOST_PARTICLES`]: their steps would come in no fixed order.
pub fn harvest(case: &RecordedCase, options: &HarvestOptions) -> Result<Harvest, RunError> {
    assert!(
        options.particles <= MOST_PARTICLES,
        "{} particles, at most {MOST_PARTICLES}",
        options.particles
    );
    let run_options = RunOptions {
        model: FilterModel::Paper,
        particles: options.particles,
        occlusion: case.occlusion,
        ..RunOptions::default()
    };
    let collector = StepCollector {
        options: *options,
        harvest: Mutex::default(),
    };
    run_observed(
        &case.setup,
        &case.log,
        &run_options,
        &collector,
        &mut |_| (),
    )?;
    Ok(collector
        .harvest
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner))
}

/// Judges every step of a run, and keeps some.
#[derive(Debug)]
struct StepCollector {
    options: HarvestOptions,
    harvest: Mutex<Harvest>,
}

impl Observer for StepCollector {
    fn on_step(&self, step: &SolvedStep<'_>) {
        let mut harvest = self.harvest.lock().unwrap_or_else(PoisonError::into_inner);
        let mut tally = Tally::of_report(harvest.tally.problems, &step.report);
        let solved = step.report.outcome == Outcome::Solved;
        if solved {
            tally.worst_residual = tally
                .worst_residual
                .max(judged_residual(step.problem, step.solution));
        }
        if step.report.outcome == Outcome::Failed || tally.worst_residual > TOLERANCE {
            harvest.refuted.push(step.problem.clone());
        }
        harvest.tally.add(tally);
        if !step.problem.contacts.is_empty()
            && fingerprint(step.problem).is_multiple_of(self.options.keep_one_in)
        {
            harvest.kept.push(HarvestedStep {
                problem: step.problem.clone(),
                witness: solved.then(|| step.solution.clone()),
            });
        }
    }
}

/// A number that distinguishes steps: their twist and the noise impulse differ.
fn fingerprint(problem: &StepProblem) -> u64 {
    let numbers = [
        problem.twist.vx,
        problem.twist.vy,
        problem.twist.omega,
        problem.applied.fx,
        problem.applied.fy,
    ];
    numbers
        .iter()
        .fold(0, |hash, number| mix(hash ^ number.to_bits()))
}

/// Results of the solver on harvested steps from a cold start: as they are, and disturbed. They do
/// not depend on the number of threads.
///
/// The disturbance of step k is a pure function of (seed, k).
#[must_use]
pub fn survey_steps(steps: &[HarvestedStep], seed: u64) -> [(&'static str, Tally); 2] {
    let cold = (0..steps.len() as u64).into_par_iter().map(|k| {
        let step = &steps[k as usize];
        judge(k, &step.problem, step.witness.as_ref())
    });
    let disturbed = (0..steps.len() as u64 * DISTURBED)
        .into_par_iter()
        .map(|k| {
            judge(
                k,
                &disturbed_step(
                    &steps[(k / DISTURBED) as usize].problem,
                    &mut SplitMix64::stream(seed, k),
                ),
                None,
            )
        });
    [
        ("harvested", cold.reduce(Tally::default, Tally::sum)),
        ("disturbed", disturbed.reduce(Tally::default, Tally::sum)),
    ]
}

/// The step with twist, gaps and friction scaled by factors of up to two; twist and gaps are
/// shifted a little besides.
fn disturbed_step(step: &StepProblem, rng: &mut SplitMix64) -> StepProblem {
    let mut problem = step.clone();
    let gyration = (problem.inertia / problem.mass).sqrt();
    for (speed, scale) in [
        (&mut problem.twist.vx, 1.0),
        (&mut problem.twist.vy, 1.0),
        (&mut problem.twist.omega, gyration),
    ] {
        *speed = *speed * rng.log_within(0.5, 2.0) + rng.within(-0.01, 0.01) / scale;
    }
    let (shift, friction, support) = (
        rng.log_within(1e-7, 1e-3),
        rng.log_within(0.5, 2.0),
        rng.log_within(0.5, 2.0),
    );
    for contact in &mut problem.contacts {
        contact.gap = contact.gap * rng.log_within(0.5, 2.0) + rng.within(-shift, shift);
        contact.mu *= friction;
    }
    for foot in &mut problem.feet {
        foot.bound *= support;
    }
    problem
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::{Foot, Report, Twist, solve};

    use super::*;

    fn collector() -> StepCollector {
        StepCollector {
            options: HarvestOptions {
                particles: 1,
                keep_one_in: 1,
            },
            harvest: Mutex::default(),
        }
    }

    /// A block that slides on three feet, solved.
    fn sliding() -> (StepProblem, StepSolution, Report) {
        let arms = [[0.02, 0.0], [-0.01, 0.017], [-0.01, -0.017]];
        let feet = arms.map(|arm| Foot { arm, bound: 0.01 });
        let twist = Twist {
            vx: 0.3,
            vy: 0.1,
            omega: 1.0,
        };
        let problem = StepProblem {
            mass: 0.5,
            inertia: 2e-4,
            h: 0.03,
            twist,
            feet,
            ..StepProblem::default()
        };
        let (solution, report) = solve(&problem);
        (problem, solution, report)
    }

    #[test]
    fn on_step_counts_a_solved_step() {
        let (problem, solution, report) = sliding();
        let collector = collector();
        collector.on_step(&SolvedStep {
            problem: &problem,
            bodies: &[],
            solution: &solution,
            report,
        });
        let harvest = collector.harvest.into_inner().expect("one thread");
        assert_eq!(
            (
                harvest.tally.problems,
                harvest.tally.solved.iter().sum::<u64>(),
                harvest.refuted.len()
            ),
            (1, 1, 0)
        );
    }

    #[test]
    fn on_step_refutes_a_step_that_the_solver_certifies_wrongly() {
        let (problem, mut solution, report) = sliding();
        solution.twist.vx += 1e-8;
        let collector = collector();
        collector.on_step(&SolvedStep {
            problem: &problem,
            bodies: &[],
            solution: &solution,
            report,
        });
        let harvest = collector.harvest.into_inner().expect("one thread");
        assert_eq!(harvest.refuted, [problem]);
        assert!(harvest.tally.worst_residual > 9e-9);
    }
}
