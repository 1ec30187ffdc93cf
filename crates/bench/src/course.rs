//! A scene from start to end, timed frame by frame: [`measure`].

use std::io;
use std::ops::Range;

use stickslip_dynamics::{Dynamics, StepInput};

use crate::quantile::median;
use crate::{Batch, Results, Tally};

/// Blocks of 64 particles in a measured batch.
const BLOCKS: u32 = 8;

/// What is measured.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name in the results.
    pub name: String,
    /// Scene and instructions.
    pub dynamics: Dynamics,
    /// One step per frame.
    pub inputs: Vec<StepInput>,
}

/// What one case cost, frame by frame.
#[derive(Clone, Debug)]
pub struct Course {
    name: String,
    /// Per frame: time per particle in each round (ns).
    times: Vec<Vec<f64>>,
    /// Per frame.
    tallies: Vec<Tally>,
}

/// A course over some frames.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Median over the frames of the median over the rounds, time per particle-step (ns).
    pub nanoseconds: f64,
    /// The frames' steps.
    pub tally: Tally,
}

/// Runs every case from start to end `rounds` times, case after case in every round, after one
/// round that is not counted; 512 scattered particles, one thread.
#[must_use]
pub fn measure(cases: &[Case], rounds: usize) -> Vec<Course> {
    let mut courses: Vec<Course> = cases.iter().map(Course::new).collect();
    for round in 0..=rounds {
        for (case, course) in cases.iter().zip(&mut courses) {
            course.run(case, round > 0);
        }
    }
    courses
}

impl Course {
    fn new(case: &Case) -> Self {
        let frames = case.inputs.len();
        Self {
            name: case.name.clone(),
            times: vec![Vec::new(); frames],
            tallies: vec![Tally::default(); frames],
        }
    }

    fn run(&mut self, case: &Case, counted: bool) {
        let mut batch = Batch::scattered(&case.dynamics, BLOCKS);
        for (frame, input) in case.inputs.iter().enumerate() {
            let time = batch.step(&case.dynamics, input);
            if counted {
                self.times[frame].push(time);
                batch
                    .reports()
                    .for_each(|report| self.tallies[frame].count(report));
            }
        }
    }

    /// What some frames cost.
    #[must_use]
    pub fn over(&self, frames: Range<usize>) -> Summary {
        let times: Vec<f64> = self.times[frames.clone()]
            .iter()
            .map(|rounds| median(rounds))
            .collect();
        let mut tally = Tally::default();
        self.tallies[frames]
            .iter()
            .for_each(|of_frame| tally.add(of_frame));
        Summary {
            nanoseconds: median(&times),
            tally,
        }
    }

    /// Writes time, iterations, residual and routes of some frames.
    ///
    /// # Errors
    /// The results cannot be written.
    pub fn write(
        &self,
        phase: &str,
        frames: Range<usize>,
        results: &mut Results,
    ) -> io::Result<()> {
        let Summary { nanoseconds, tally } = self.over(frames);
        let name = format!("{} / {phase}", self.name);
        results.write(&name, nanoseconds, "ns/particle-step")?;
        results.write(
            &format!("{name} / iterations"),
            tally.mean_iterations(),
            "1",
        )?;
        results.write(
            &format!("{name} / worst residual"),
            tally.worst_residual(),
            "m/s",
        )?;
        results.write(
            &format!("{name} / unsolved"),
            tally.unsolved() as f64 / tally.steps() as f64,
            "1",
        )?;
        for (route, share) in tally.route_shares() {
            results.write(&format!("{name} / by {route}"), share, "1")?;
        }
        Ok(())
    }
}
