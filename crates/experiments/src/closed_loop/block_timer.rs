//! Times the steps of a block of particles: [`BlockTimer`].
//!
//! A thread that has to wait for a processor seems slow. Where a block seems slower than all before
//! it, its steps are repeated, all together and one by one, and the shorter time counts.

use std::time::{Duration, Instant};

use stickslip_dynamics::{
    Dynamics, Particles, Report, StepInput, StepProblem, StepSolution, StepWork,
};

/// Lanes of the chunks that a filter steps.
pub(super) const LANES: usize = 8;

/// Factor over the longest block so far from which a block's steps are repeated.
const LONGER: f64 = 1.2;

/// Repetitions of a particle-step that seems to be the slowest.
const REPETITIONS: usize = 3;

/// A particle-step and the time it takes alone.
#[derive(Clone, Debug)]
pub(super) struct TimedStep {
    pub took: Duration,
    pub particle: usize,
    pub problem: StepProblem,
    pub solution: StepSolution,
    pub report: Report,
}

/// Times of the blocks of one run.
#[derive(Debug, Default)]
pub(super) struct BlockTimer {
    /// Input of the current block.
    input: Option<StepInput>,
    particles: Vec<Particles<LANES>>,
    began: Option<Instant>,
    /// Longest block so far.
    longest: Duration,
    together: StepWork<LANES>,
    alone: StepWork<1>,
}

impl BlockTimer {
    /// A block's step begins.
    pub fn begin(&mut self, input: &StepInput, particles: &[Particles<LANES>]) {
        self.input = Some(*input);
        self.particles.clear();
        self.particles.extend_from_slice(particles);
        self.began = Some(Instant::now());
    }

    /// The time of the block that has ended by `now`, returned once; also its slowest particle-step
    /// where it is the longest block so far.
    pub fn end(
        &mut self,
        now: Instant,
        dynamics: &Dynamics,
    ) -> Option<(Duration, Option<TimedStep>)> {
        let took = now - self.began.take()?;
        let input = self.input?;
        if took.as_secs_f64() <= LONGER * self.longest.as_secs_f64() {
            return Some((took, None));
        }
        let took = took.min(self.repeat(&input, dynamics));
        if took <= self.longest {
            return Some((took, None));
        }
        self.longest = took;
        Some((took, self.slowest_step(&input, dynamics)))
    }

    /// Makes the block's step once more.
    fn repeat(&mut self, input: &StepInput, dynamics: &Dynamics) -> Duration {
        let mut particles = self.particles.clone();
        let began = Instant::now();
        dynamics.step_block(input, &mut particles, &mut self.together);
        began.elapsed()
    }

    /// Makes each particle's step alone; lanes past the last particle repeat it.
    fn slowest_step(&mut self, input: &StepInput, dynamics: &Dynamics) -> Option<TimedStep> {
        let mut slowest: Option<TimedStep> = None;
        for particle in 0..self.particles.len() * LANES {
            let mut took = Duration::MAX;
            for _ in 0..REPETITIONS {
                took = took.min(self.time_alone(input, dynamics, particle));
                if slowest.as_ref().is_some_and(|slowest| took <= slowest.took) {
                    break;
                }
            }
            if slowest.as_ref().is_none_or(|slowest| took > slowest.took) {
                slowest = Some(TimedStep {
                    took,
                    particle,
                    problem: self.alone.problem(0),
                    solution: self.alone.solution(0),
                    report: self.alone.reports()[0][0],
                });
            }
        }
        slowest
    }

    fn time_alone(&mut self, input: &StepInput, dynamics: &Dynamics, particle: usize) -> Duration {
        let (chunk, lane) = (&self.particles[particle / LANES], particle % LANES);
        let friction = chunk.friction.map(|x| x.0[lane]);
        let mut state = [chunk.get(lane)];
        let began = Instant::now();
        let _ = dynamics.step(input, &[friction], &mut state, &mut self.alone);
        began.elapsed()
    }
}
