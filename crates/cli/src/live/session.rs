//! A tracker that survives pauses and errors of its source: [`Session`].

use std::collections::VecDeque;
use std::num::NonZero;
use std::time::Instant;

use anyhow::Result;
use serde::Serialize;
use stickslip::{ParticleBudget, Row, RowError, Setup, StepSize, Tracker, TrackerOptions};
use stickslip_formats::{Pace, estimate_json, read_row_json};

use crate::output::counted;

use super::latencies::Latencies;
use super::lines::Line;
use super::shown_row::ShownRow;

/// Most rows that are remembered to know repeats by.
const REMEMBERED: usize = 10_000;

/// Time between two rows above which a filter cannot follow, and the other side of which is another
/// clock's or comes after a pause (s).
pub const PAUSE: f64 = 5.0;

/// Answer to one line.
pub struct Answer {
    /// One line of JSON; empty where nothing was asked.
    pub text: String,
    /// The row, where it was taken.
    pub row: Option<Row>,
}

/// A tracker with counts of its events.
pub struct Session<'a> {
    setup: &'a Setup,
    options: &'a TrackerOptions,
    tracker: Tracker<'static>,
    /// Rows as late as they may come, to know repeats by.
    recent: VecDeque<Row>,
    /// Time of a row that was refused since it is far from the others (s).
    elsewhere: Option<f64>,
    rows: u64,
    late: u64,
    refused: u64,
    restarts: u64,
    collapses: u64,
    /// Pusher poses that counted as missing.
    left_out: u64,
    latencies: Latencies,
    pacing: Option<Pacing>,
}

/// A deadline, and how many particles meet it.
struct Pacing {
    /// Time from a row's arrival until its answer is due (s).
    deadline: f64,
    budget: ParticleBudget,
    /// Fewest particles that a row had.
    fewest: usize,
}

/// An answer that is no estimate.
#[derive(Serialize)]
struct Refusal {
    line: u64,
    error: String,
}

impl<'a> Session<'a> {
    /// A session that waits for its first row, whose answers are due `deadline` (s) after their
    /// line.
    pub fn new(
        setup: &'a Setup,
        options: &'a TrackerOptions,
        deadline: Option<f64>,
    ) -> Result<Self> {
        let most = u32::try_from(options.particles).ok().and_then(NonZero::new);
        let pacing = deadline.zip(most).map(|(deadline, most)| Pacing {
            deadline,
            budget: ParticleBudget::new(most, deadline),
            fewest: options.particles,
        });
        Ok(Self {
            setup,
            options,
            tracker: Tracker::new(setup, options)?,
            recent: VecDeque::new(),
            elsewhere: None,
            rows: 0,
            late: 0,
            refused: 0,
            restarts: 0,
            collapses: 0,
            left_out: 0,
            latencies: Latencies::new(deadline),
            pacing,
        })
    }

    /// Takes a line: an estimate at the latest row, or an error.
    pub fn answer(&mut self, line: Line) -> Answer {
        let Line {
            number: line,
            arrived,
            text,
        } = line;
        if text.as_deref().is_ok_and(|text| text.trim().is_empty()) {
            return Answer {
                text: String::new(),
                row: None,
            };
        }
        match text.and_then(|text| self.take(&text, arrived)) {
            Ok(row) => {
                self.rows += 1;
                let time = self.tracker.time().unwrap_or(row.time);
                Answer {
                    text: estimate_json(time, self.tracker.estimate(), self.setup, self.pace()),
                    row: Some(row),
                }
            }
            Err(error) => {
                self.refused += 1;
                let refusal = serde_json::to_string(&Refusal { line, error });
                Answer {
                    text: refusal.expect("a number and a text are JSON"),
                    row: None,
                }
            }
        }
    }

    /// Lines that were refused.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Takes that the answer to a line that `arrived` then is there now.
    pub fn answered(&mut self, arrived: Instant) {
        self.latencies.add(arrived);
    }

    /// Message to the live page for an answer to a line that `arrived` then; nothing for a refusal.
    pub fn shown(&self, answer: &Answer, arrived: Instant) -> Option<String> {
        let row = answer.row.as_ref()?;
        let estimate = serde_json::from_str(&answer.text).ok()?;
        let latency = 1e3 * arrived.elapsed().as_secs_f64();
        let missed = self.pacing.as_ref().map(|_| self.latencies.missed());
        let health = (latency, missed, self.collapses());
        let shown = ShownRow::new(row, estimate, self.tracker.particles(), health);
        serde_json::to_string(&shown).ok()
    }

    /// Summary of the session, in words.
    pub fn summary(&self) -> Vec<String> {
        let rows = format!(
            "{}, {} late; {} refused; {} after pauses; {}",
            counted(self.rows, "row"),
            self.late,
            counted(self.refused, "line"),
            counted(self.restarts, "restart"),
            counted(self.collapses(), "collapse")
        );
        let pacing = self.pacing.as_ref().map(|pacing| {
            let (fewest, most) = (pacing.fewest, self.options.particles);
            format!("{fewest} to {most} particles, to meet the deadline")
        });
        let left_out = self.left_out + u64::from(self.tracker.pusher_poses_left_out());
        let left_out = (left_out > 0).then(|| {
            format!(
                "{} that the pusher cannot have reached, counted as missing",
                counted(left_out, "pusher pose")
            )
        });
        let lines = [Some(rows), left_out, self.latencies.summary(), pacing];
        lines.into_iter().flatten().collect()
    }

    /// Collapses since the session began.
    fn collapses(&self) -> u64 {
        self.collapses + u64::from(self.tracker.collapses())
    }

    /// Effect of the deadline so far.
    fn pace(&self) -> Option<Pace> {
        self.pacing.as_ref().map(|_| Pace {
            particles: self.tracker.particles().map_or(0, |view| view.len()),
            missed: self.latencies.missed(),
        })
    }

    /// Gives a row to the tracker, with as many particles as will be in time.
    fn push(&mut self, row: &Row, arrived: Instant) -> Result<(), RowError> {
        let Some(pacing) = &mut self.pacing else {
            return self.tracker.push(row).map(|_| ());
        };
        let mut step = None;
        let from = Instant::now();
        self.tracker.push_sized(row, |size| {
            let left = pacing.deadline - arrived.elapsed().as_secs_f64();
            let particles = pacing.budget.particles(size, left);
            pacing.fewest = pacing.fewest.min(particles.get() as usize);
            step = Some(StepSize { particles, ..size });
            particles
        })?;
        if let Some(step) = step {
            pacing.budget.took(step, from.elapsed().as_secs_f64());
        }
        Ok(())
    }

    fn take(&mut self, text: &str, arrived: Instant) -> Result<Row, String> {
        let row = read_row_json(text).map_err(|error| error.to_string())?;
        if self.recent.contains(&row) {
            return Err(format!(
                "the row at {} s was taken already; it counts once. Send each row once",
                row.time
            ));
        }
        let latest = self.tracker.time();
        match self.push(&row, arrived).err() {
            None => self.elsewhere = None,
            Some(error) => match far_time(&error) {
                Some(time) if self.goes_on_from(time) => self.restart(&row)?,
                Some(_) => {
                    let next = "The session restarts if the next row follows within 1 s";
                    return Err(format!("{error}. {next}"));
                }
                None => return Err(error.to_string()),
            },
        }
        self.late += u64::from(latest.is_some_and(|latest| row.time <= latest));
        self.remember(&row);
        Ok(row)
    }

    /// Returns true if the row before was as far from the others, so that this is no single wrong
    /// time.
    fn goes_on_from(&mut self, time: f64) -> bool {
        /// Longest time between the two (s).
        const NEAR: f64 = 1.0;
        let before = self.elsewhere.replace(time);
        before.is_some_and(|before| (0.0..=NEAR).contains(&(time - before)))
    }

    /// Starts over, as at the first row.
    fn restart(&mut self, row: &Row) -> Result<(), String> {
        let words = |error: &dyn std::error::Error| error.to_string();
        let mut tracker = Tracker::new(self.setup, self.options).map_err(|error| words(&error))?;
        tracker.push(row).map_err(|error| words(&error))?;
        self.collapses += u64::from(self.tracker.collapses());
        self.left_out += u64::from(self.tracker.pusher_poses_left_out());
        self.tracker = tracker;
        self.recent.clear();
        self.restarts += 1;
        self.elsewhere = None;
        Ok(())
    }

    fn remember(&mut self, row: &Row) {
        let oldest = self.tracker.time().unwrap_or(row.time) - self.options.late;
        while self.recent.len() >= REMEMBERED
            || self.recent.front().is_some_and(|row| row.time < oldest)
        {
            self.recent.pop_front();
        }
        self.recent.push_back(row.clone());
    }
}

/// Time of a row (s) that is too far before or after the latest one for a filter to follow.
fn far_time(error: &RowError) -> Option<f64> {
    match *error {
        RowError::Pause { to, .. } => Some(to),
        RowError::TooLate { time, latest, .. } => Some(time).filter(|time| latest - time > PAUSE),
        _ => None,
    }
}
