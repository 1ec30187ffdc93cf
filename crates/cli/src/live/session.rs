//! A tracker that outlives what its source does: [`Session`].

use std::collections::VecDeque;

use anyhow::Result;
use serde::Serialize;
use stickslip::{Row, RowError, Setup, Tracker, TrackerOptions};
use stickslip_formats::{estimate_json, read_row_json};

/// Most rows that are remembered to know repeats by.
const REMEMBERED: usize = 10_000;

/// What is said to one line.
pub struct Answer {
    /// One line of JSON; empty where nothing was asked.
    pub text: String,
    /// The row, where it was taken.
    pub row: Option<Row>,
}

/// A tracker with what happened to it.
pub struct Session<'a> {
    setup: &'a Setup,
    options: &'a TrackerOptions,
    tracker: Tracker<'static>,
    /// Rows as late as they may come, to know repeats by.
    recent: VecDeque<Row>,
    /// Time of a row that was refused since it came long after the one before (s).
    ahead: Option<f64>,
    rows: u64,
    late: u64,
    refused: u64,
    restarts: u64,
    collapses: u64,
}

/// An answer that is no estimate.
#[derive(Serialize)]
struct Refusal {
    line: u64,
    error: String,
}

impl<'a> Session<'a> {
    /// A session that waits for its first row.
    pub fn new(setup: &'a Setup, options: &'a TrackerOptions) -> Result<Self> {
        Ok(Self {
            setup,
            options,
            tracker: Tracker::new(setup, options)?,
            recent: VecDeque::new(),
            ahead: None,
            rows: 0,
            late: 0,
            refused: 0,
            restarts: 0,
            collapses: 0,
        })
    }

    /// Takes a line: an estimate at the latest row, or an error.
    pub fn answer(&mut self, line: u64, text: Result<String, String>) -> Answer {
        if text.as_deref().is_ok_and(|text| text.trim().is_empty()) {
            return Answer {
                text: String::new(),
                row: None,
            };
        }
        match text.and_then(|text| self.take(&text)) {
            Ok(row) => {
                self.rows += 1;
                let time = self.tracker.time().unwrap_or(row.time);
                Answer {
                    text: estimate_json(time, self.tracker.estimate(), self.setup),
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

    /// What happened, in words.
    pub fn summary(&self) -> String {
        let collapses = self.collapses + u64::from(self.tracker.collapses());
        format!(
            "{} rows, {} of them late; {} lines refused; {} restarts after pauses; {collapses} collapses",
            self.rows, self.late, self.refused, self.restarts
        )
    }

    fn take(&mut self, text: &str) -> Result<Row, String> {
        let row = read_row_json(text).map_err(|error| error.to_string())?;
        if self.recent.contains(&row) {
            return Err(format!(
                "the row at {} s was taken already; it counts once. Send each row once",
                row.time
            ));
        }
        let latest = self.tracker.time();
        match self.tracker.push(&row).err() {
            None => self.ahead = None,
            Some(RowError::Pause { to, .. }) if self.follows_a_pause(to) => self.restart(&row)?,
            Some(error) => return Err(error.to_string()),
        }
        self.late += u64::from(latest.is_some_and(|latest| row.time <= latest));
        self.remember(&row);
        Ok(row)
    }

    /// Whether the row before came as long after the others, so that this is no single wrong time.
    fn follows_a_pause(&mut self, to: f64) -> bool {
        /// Longest time between the two (s).
        const NEAR: f64 = 1.0;
        let before = self.ahead.replace(to);
        before.is_some_and(|before| to >= before && to - before <= NEAR)
    }

    /// Starts anew, as at the first row.
    fn restart(&mut self, row: &Row) -> Result<(), String> {
        let words = |error: &dyn std::error::Error| error.to_string();
        let mut tracker = Tracker::new(self.setup, self.options).map_err(|error| words(&error))?;
        tracker.push(row).map_err(|error| words(&error))?;
        self.collapses += u64::from(self.tracker.collapses());
        self.tracker = tracker;
        self.recent.clear();
        self.restarts += 1;
        self.ahead = None;
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
