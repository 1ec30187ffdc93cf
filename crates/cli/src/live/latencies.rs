//! Latencies of answers: [`Latencies`].

use std::time::Instant;

/// Answers that are kept for the quantiles: a day at 100 Hz, in 40 MB.
const MOST: usize = 10_000_000;

/// Times from the arrival of a line until its answer was there.
pub struct Latencies {
    /// Deadline of an answer (s).
    deadline: Option<f64>,
    /// Times that answers took (ms).
    taken: Vec<f32>,
    missed: u64,
}

impl Latencies {
    /// No answer yet; each is due `deadline` (s) after its line.
    pub fn new(deadline: Option<f64>) -> Self {
        Self {
            deadline,
            taken: Vec::new(),
            missed: 0,
        }
    }

    /// Takes an answer that is there now.
    pub fn add(&mut self, arrived: Instant) {
        let seconds = arrived.elapsed().as_secs_f64();
        self.missed += u64::from(self.deadline.is_some_and(|deadline| seconds > deadline));
        if self.taken.len() < MOST {
            self.taken.push((1e3 * seconds) as f32);
        }
    }

    /// Answers that came after their deadline.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Median, 99 % and longest, in words; nothing where there was no answer.
    pub fn summary(&self) -> Option<String> {
        let mut taken = self.taken.clone();
        taken.sort_by(f32::total_cmp);
        let last = taken.len().checked_sub(1)?;
        let [median, late, most] = [last / 2, last * 99 / 100, last].map(|index| taken[index]);
        let missed = self.deadline.map_or(String::new(), |deadline| {
            format!(
                "; {} after the deadline of {} ms",
                self.missed,
                1e3 * deadline
            )
        });
        Some(format!(
            "latency of answers {median:.2} ms (median), {late:.2} ms (99th percentile), {most:.2} ms (longest){missed}"
        ))
    }
}
