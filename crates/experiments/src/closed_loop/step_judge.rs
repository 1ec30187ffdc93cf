//! Check of every step of a run: [`StepJudge`] counts outcomes, checks residuals and proofs, and
//! takes times.

use std::fmt::Debug;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use stickslip::{Observer, ParticleView, SolvedStep};
use stickslip_dynamics::{
    Dynamics, Outcome, Particles, Report, Route, StepInput, StepProblem, StepSolution,
};

use super::block_timer::{BlockTimer, LANES};
use super::existence::Existence;
use super::loop_tally::{LoopTally, StepAddress, remember};
use stickslip_testkit::Tally;
use stickslip_testkit::judged_residual;

/// Of the steps that the Newton iteration solved, one in so many is checked.
const CHECK_ONE_IN: u64 = 50;

/// Largest independent residual of a solved step (m/s): the tolerance of the solver, twice, since
/// the two residuals round differently.
const LARGEST_RESIDUAL: f64 = 2e-9;

/// Proofs checked per scene: the first ones, then one in so many; of the first one all modes of its
/// nearest contacts.
const FIRST_PROOFS: u64 = 4;
const PROOFS_ONE_IN: u64 = 100;

/// A noteworthy step.
#[derive(Clone, Debug)]
pub struct NotedStep {
    /// Address of the step.
    pub address: StepAddress,
    /// The problem.
    pub problem: StepProblem,
    /// Answer of the solver.
    pub solution: StepSolution,
    /// Outcome of the step.
    pub report: Report,
}

/// Noteworthy steps of one scene.
#[derive(Clone, Debug, Default)]
pub struct NotedSteps {
    /// The first ones that failed.
    pub failed: Vec<NotedStep>,
    /// The first ones said to have no solution.
    pub infeasible: Vec<NotedStep>,
    /// The first ones counted as solved whose independent residual is too large.
    pub refuted: Vec<NotedStep>,
    /// The slowest one that was timed.
    pub slowest: Option<NotedStep>,
}

/// The observer of one scene's run.
#[derive(Debug)]
pub(super) struct StepJudge<'a> {
    dynamics: &'a Dynamics,
    scene: u64,
    /// Steps of each outcome that are noted.
    notes: usize,
    state: Mutex<State>,
}

/// Results of a run so far.
#[derive(Debug, Default)]
pub(super) struct State {
    pub tally: LoopTally,
    pub noted: NotedSteps,
    /// Rows seen.
    rows: usize,
    /// Steps seen of the current block.
    particle: usize,
    timer: BlockTimer,
    /// Time of the current frame so far.
    frame_time: Duration,
}

impl<'a> StepJudge<'a> {
    /// For a run of scene `scene`; the first `notes` steps of each outcome are noted.
    pub fn new(dynamics: &'a Dynamics, scene: u64, notes: usize) -> Self {
        let state = State {
            tally: LoopTally {
                scenes: 1,
                ..LoopTally::default()
            },
            ..State::default()
        };
        Self {
            dynamics,
            scene,
            notes,
            state: Mutex::new(state),
        }
    }

    /// Results of what it has checked.
    pub fn into_state(self) -> State {
        self.state
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for StepJudge<'_> {
    fn before_step(&self, input: &StepInput, particles: &[Particles<LANES>]) {
        let mut state = self.state();
        state.particle = 0;
        state.timer.begin(input, particles);
    }

    fn on_step(&self, step: &SolvedStep<'_>) {
        let now = Instant::now();
        let mut state = self.state();
        let address = StepAddress {
            scene: self.scene,
            frame: state.rows,
            particle: state.particle,
        };
        state.take_time(now, self.dynamics, address);
        let sound = state.count(step, address);
        state.note(step, sound, address, self.notes);
        state.particle += 1;
    }

    fn on_row(&self, _: usize, _: &ParticleView<'_>) {
        let mut state = self.state();
        let State {
            tally,
            rows,
            frame_time,
            ..
        } = &mut *state;
        tally.slowest_frame = tally.slowest_frame.max((*frame_time, self.scene));
        tally.frames += u64::from(*rows > 0);
        *frame_time = Duration::ZERO;
        *rows += 1;
    }
}

impl State {
    /// The block's time, when its first step is shown.
    fn take_time(&mut self, now: Instant, dynamics: &Dynamics, first: StepAddress) {
        let Some((took, slowest)) = self.timer.end(now, dynamics) else {
            return;
        };
        self.frame_time += took;
        if let Some(step) = slowest
            && step.took > self.tally.slowest_step.0
        {
            self.tally.slowest_step = (step.took, first.scene);
            self.noted.slowest = Some(NotedStep {
                address: StepAddress {
                    particle: step.particle,
                    ..first
                },
                problem: step.problem,
                solution: step.solution,
                report: step.report,
            });
        }
    }

    /// Counts a step; false where it is called solved and is not.
    fn count(&mut self, step: &SolvedStep<'_>, address: StepAddress) -> bool {
        let SolvedStep {
            problem,
            solution,
            report,
            ..
        } = *step;
        let tally = &mut self.tally;
        let mut one = Tally::of_report(address.scene, &report);
        match report.outcome {
            Outcome::Solved => {
                let easy = report.route == Route::Newton;
                if !easy || tally.steps.problems.is_multiple_of(CHECK_ONE_IN) {
                    one.worst_residual = one.worst_residual.max(judged_residual(problem, solution));
                    tally.checked += 1;
                }
            }
            Outcome::Infeasible => tally.check_proof(problem, address, &mut one),
            Outcome::Failed => remember(&mut tally.failed_at, &[address]),
        }
        let sound = one.worst_residual <= LARGEST_RESIDUAL;
        if !sound {
            tally.refuted += 1;
            remember(&mut tally.refuted_at, &[address]);
        }
        tally.steps.add(one);
        tally.most_systems = tally.most_systems.max(report.systems);
        tally.pushed += u64::from(presses(problem, solution, true));
        tally.held += u64::from(presses(problem, solution, false));
        sound
    }

    fn note(&mut self, step: &SolvedStep<'_>, sound: bool, address: StepAddress, most: usize) {
        let noted = match step.report.outcome {
            Outcome::Solved if sound => return,
            Outcome::Solved => &mut self.noted.refuted,
            Outcome::Failed => &mut self.noted.failed,
            Outcome::Infeasible => &mut self.noted.infeasible,
        };
        if noted.len() < most {
            noted.push(NotedStep {
                address,
                problem: step.problem.clone(),
                solution: step.solution.clone(),
                report: step.report,
            });
        }
    }
}

impl LoopTally {
    /// Checks some of the proofs that a step has no solution.
    fn check_proof(&mut self, problem: &StepProblem, address: StepAddress, one: &mut Tally) {
        let proofs = self.steps.infeasible;
        if proofs >= FIRST_PROOFS && !proofs.is_multiple_of(PROOFS_ONE_IN) {
            return;
        }
        self.proofs_checked += 1;
        let existence = match proofs {
            0 => Existence::enumerated(problem),
            _ => Existence::of(problem),
        };
        match existence {
            Existence::Certain => {
                one.contradicted.push(address.scene);
                remember(&mut self.contradicted_at, &[address]);
            }
            Existence::Excluded => self.proofs_confirmed += 1,
            Existence::Unknown => {}
        }
    }
}

/// Returns true if the pusher, or a fixel, presses on the object.
fn presses(problem: &StepProblem, solution: &StepSolution, pusher: bool) -> bool {
    let mut contacts = problem.contacts.iter().zip(&solution.normal);
    contacts.any(|(contact, p_n)| contact.yields.is_some() == pusher && *p_n > 0.0)
}
