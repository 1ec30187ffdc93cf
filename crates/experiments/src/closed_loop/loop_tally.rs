//! Outcomes of the steps of random scenes: [`LoopTally`].

use std::fmt;
use std::time::Duration;

use stickslip_testkit::Tally;

/// Address of a particle-step among all scenes of a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct StepAddress {
    /// Index of the scene.
    pub scene: u64,
    /// Row of the log that the step led to, from 0.
    pub frame: usize,
    /// The particle, from 0.
    pub particle: usize,
}

/// Steps of one or many scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoopTally {
    /// Scenes.
    pub scenes: u64,
    /// Frames that the filter made, the first of each scene not counted.
    pub frames: u64,
    /// Outcomes of the particle-steps; failed and contradicted ones by the index of their scene.
    /// The residual is the largest of the solver's own and of the independent ones.
    pub steps: Tally,
    /// Solved steps whose independent residual was taken.
    pub checked: u64,
    /// Of these, how many exceed the tolerance.
    pub refuted: u64,
    /// Proofs that there is no solution that were checked.
    pub proofs_checked: u64,
    /// Of these, how many the gaps alone confirm.
    pub proofs_confirmed: u64,
    /// Steps in which the pusher pressed on the object.
    pub pushed: u64,
    /// Steps in which a fixel did.
    pub held: u64,
    /// The first failed steps.
    pub failed_at: Vec<StepAddress>,
    /// The first steps that were said to have no solution although they have one.
    pub contradicted_at: Vec<StepAddress>,
    /// The first steps that were said to be solved and are not.
    pub refuted_at: Vec<StepAddress>,
    /// Most Newton steps of one particle-step.
    pub most_systems: u32,
    /// Longest particle-step of those timed alone, and its scene.
    pub slowest_step: (Duration, u64),
    /// Longest frame of all particles, and its scene.
    pub slowest_frame: (Duration, u64),
}

impl LoopTally {
    /// Failed and contradicted steps that are remembered.
    pub const REMEMBERED: usize = 20;

    /// The columns of its [`Display`](fmt::Display).
    #[must_use]
    pub fn titles() -> String {
        format!(
            "scenes {}   pushed    held  proofs  wrong refuted  systems   step ms   (scene)  frame ms   (scene)",
            Tally::TITLES
        )
    }

    /// Returns true if no step failed, and no proof or certificate was found wrong.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.steps.failed.is_empty() && self.steps.contradicted.is_empty() && self.refuted == 0
    }

    /// Counts the steps of another tally too.
    pub fn add(&mut self, other: &Self) {
        self.scenes += other.scenes;
        self.frames += other.frames;
        self.steps.add(other.steps.clone());
        self.checked += other.checked;
        self.refuted += other.refuted;
        self.proofs_checked += other.proofs_checked;
        self.proofs_confirmed += other.proofs_confirmed;
        self.pushed += other.pushed;
        self.held += other.held;
        remember(&mut self.failed_at, &other.failed_at);
        remember(&mut self.contradicted_at, &other.contradicted_at);
        remember(&mut self.refuted_at, &other.refuted_at);
        self.most_systems = self.most_systems.max(other.most_systems);
        self.slowest_step = self.slowest_step.max(other.slowest_step);
        self.slowest_frame = self.slowest_frame.max(other.slowest_frame);
    }
}

/// Adds the first addresses of `from`, as far as there is room.
pub(super) fn remember(to: &mut Vec<StepAddress>, from: &[StepAddress]) {
    let room = LoopTally::REMEMBERED.saturating_sub(to.len());
    to.extend(from.iter().take(room));
}

impl fmt::Display for LoopTally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |count: u64| 100.0 * count as f64 / self.steps.problems.max(1) as f64;
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        write!(
            f,
            "{:>6} {} {:>7.1}% {:>6.1}% {:>7} {:>6} {:>7} {:>11} {:>9.3} {:>9} {:>9.3} {:>9}",
            self.scenes,
            self.steps,
            share(self.pushed),
            share(self.held),
            self.proofs_checked,
            self.steps.contradicted.len(),
            self.refuted,
            self.most_systems,
            milliseconds(self.slowest_step.0),
            self.slowest_step.1,
            milliseconds(self.slowest_frame.0),
            self.slowest_frame.1,
        )
    }
}
