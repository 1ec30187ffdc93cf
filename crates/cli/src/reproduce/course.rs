//! How one participant fared on one recording: [`Course`].

use anyhow::Result;
use stickslip::dynamics::Pose;
use stickslip::{Estimate, score};

use super::participant::{
    BLIND, BLIND_OPEN, KALMAN, KALMAN_OPEN, NOMINAL, Participant, TACTILE, TACTILE_OPEN,
};
use super::recording::Recording;
use crate::contest::Rules;
use crate::paper::PaperExperiment;

/// One run with its scores.
#[derive(Clone, Debug)]
pub struct Course {
    /// Who ran.
    pub participant: Participant,
    /// WMSE over all rows (mm).
    pub wmse_mm: f64,
    /// WMSE over the rows after the blackout begins (mm), also where this participant saw them.
    pub dark_mm: f64,
    /// The spread that it gives itself over the same rows (mm); `None` for the nominal simulation.
    pub spread_mm: Option<f64>,
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
pub fn participants(paper: PaperExperiment) -> Vec<Participant> {
    let open = match paper {
        PaperExperiment::A => vec![KALMAN_OPEN, BLIND_OPEN, TACTILE_OPEN],
        _ => vec![TACTILE_OPEN],
    };
    [vec![NOMINAL, KALMAN, BLIND, TACTILE], open].concat()
}

impl Course {
    /// Runs a participant, with the recording's own seed.
    pub fn run(participant: Participant, recording: &Recording, rules: &Rules) -> Result<Self> {
        let Recording {
            experiment,
            blackout,
            seed,
            ..
        } = recording;
        let run = participant.run(experiment, *blackout, rules, *seed, None)?;
        let hidden = blackout.hidden(&experiment.log);
        let scores = score(
            &run.estimate,
            &experiment.reference(),
            &hidden,
            experiment.setup.virtual_radius(),
        );
        let known = "a simulated experiment has a truth for every row";
        Ok(Self {
            participant,
            wmse_mm: scores.wmse_mm.expect(known),
            dark_mm: scores.wmse_occluded_mm.expect(known),
            spread_mm: spread(&run.estimate, &hidden, experiment.setup.virtual_radius()),
            unsolved: run.unsolved,
            estimate: run.estimate,
        })
    }
}

/// Root of the mean variance over the hidden rows, angles weighted as in WMSE (mm): what WMSE would
/// be if the spread told the truth.
fn spread(estimate: &Estimate, hidden: &[bool], virtual_radius: f64) -> Option<f64> {
    let rows = estimate
        .rows
        .iter()
        .zip(hidden)
        .filter(|(_, hidden)| **hidden);
    let spreads: Vec<Pose> = rows.filter_map(|(row, _)| Some(row.spread?.pose)).collect();
    let square = |pose: &Pose| {
        pose.x * pose.x
            + pose.y * pose.y
            + virtual_radius * virtual_radius * pose.theta * pose.theta
    };
    let sum = spreads
        .iter()
        .map(square)
        .fold(0.0, |sum, square| sum + square);
    (!spreads.is_empty()).then(|| 1e3 * (sum / spreads.len() as f64).sqrt())
}

impl Heat {
    /// The run of a participant.
    pub fn course(&self, participant: Participant) -> Option<&Course> {
        self.courses
            .iter()
            .find(|course| course.participant == participant)
    }
}
