//! The lines of a drawing: [`Lines`].

use crate::outline::Point;
use crate::outline::error::OutlineProblem;

/// Most points of all lines together: a hundred times as many as a scene takes.
const MOST_POINTS: usize = 100_000;

/// Lines so far, of which a drawing cannot have more than an outline needs.
#[derive(Debug, Default)]
pub(super) struct Lines {
    lines: Vec<Vec<Point>>,
    points: usize,
}

impl Lines {
    /// Adds a line.
    pub(super) fn add(&mut self, line: Vec<Point>) -> Result<(), OutlineProblem> {
        self.check(line.len())?;
        self.points += line.len();
        self.lines.push(line);
        Ok(())
    }

    /// Refuses a drawing that has too many points with so many `more`.
    pub(super) fn check(&self, more: usize) -> Result<(), OutlineProblem> {
        match self.points + more > MOST_POINTS {
            true => Err(OutlineProblem::Points { most: MOST_POINTS }),
            false => Ok(()),
        }
    }

    /// All of them.
    pub(super) fn all(self) -> Vec<Vec<Point>> {
        self.lines
    }
}
