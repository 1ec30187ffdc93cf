//! How one contender fared on one recording: [`Course`].

use anyhow::Result;
use stickslip::{Estimate, score};

use super::contender::{BLIND, BLIND_OPEN, Contender, KALMAN, KALMAN_OPEN, NOMINAL, TACTILE, TACTILE_OPEN};
use super::recording::Recording;
use crate::contest::Rules;
use crate::paper::PaperExperiment;

/// One run with its scores.
#[derive(Clone, Debug)]
pub struct Course {
    /// Who ran.
    pub contender: Contender,
    /// WMSE over all rows (mm).
    pub wmse_mm: f64,
    /// WMSE over the rows after the blackout begins (mm), also where this contender saw them.
    pub dark_mm: f64,
    /// Particle-steps without a certified solution.
    pub unsolved: u64,
    /// What it said, row by row.
    pub estimate: Estimate,
}

/// A recording with all runs on it.
#[derive(Clone, Debug)]
pub struct Heat {
    /// The recording.
    pub recording: Recording,
    /// The runs.
    pub courses: Vec<Course>,
}

/// Who takes part in an experiment.
pub fn contenders(paper: PaperExperiment) -> Vec<Contender> {
    let open = match paper {
        PaperExperiment::A => vec![KALMAN_OPEN, BLIND_OPEN, TACTILE_OPEN],
        _ => vec![TACTILE_OPEN],
    };
    [vec![NOMINAL, KALMAN, BLIND, TACTILE], open].concat()
}

impl Course {
    /// Runs a contender, with the recording's own seed.
    pub fn run(contender: Contender, recording: &Recording, rules: &Rules) -> Result<Self> {
        let Recording { experiment, blackout, seed, .. } = recording;
        let run = contender.run(experiment, *blackout, rules, *seed)?;
        let hidden = blackout.hidden(&experiment.log);
        let scores = score(&run.estimate, &experiment.reference(), &hidden, experiment.setup.virtual_radius());
        let known = "a simulated experiment has a truth for every row";
        Ok(Self {
            contender,
            wmse_mm: scores.wmse_mm.expect(known),
            dark_mm: scores.wmse_occluded_mm.expect(known),
            unsolved: run.unsolved,
            estimate: run.estimate,
        })
    }
}

impl Heat {
    /// The run of a contender.
    pub fn course(&self, contender: Contender) -> Option<&Course> {
        self.courses.iter().find(|course| course.contender == contender)
    }
}
