//! Values that several commands take: [`Rows`], [`ThreadArgs`] and checked numbers.

use std::num::NonZero;
use std::str::FromStr;
use std::thread::available_parallelism;

use clap::Args;
use rayon::{ThreadPool, ThreadPoolBuilder};
use stickslip::useful_threads;

/// Threads that are started for one processor, at most: more than one is never faster, and shows
/// that results do not depend on it.
const PER_PROCESSOR: usize = 4;

/// Number of threads to work on.
#[derive(Clone, Debug, Args)]
pub struct ThreadArgs {
    /// Threads, at most 4 per processor; results do not depend on it [default: 1 per processor, at
    /// most 1 per 128 particles of a filter]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Asks for a run on input that is found to be wrong.
#[derive(Debug, Args)]
pub struct ForceArgs {
    /// Run also if units, frames or columns are found to be wrong
    #[arg(long)]
    pub force: bool,
}

/// A range of log rows, `FROM[:TO]`; `FROM:` also runs to the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// First row.
    pub from: usize,
    /// First row after them; `None`: to the end.
    pub to: Option<usize>,
}

impl FromStr for Rows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let row = |part: &str| {
            part.parse::<usize>()
                .map_err(|_| format!("`{part}` is not a row number from 0 up"))
        };
        let (from, to) = match text.split_once(':') {
            Some((from, "")) => (row(from)?, None),
            Some((from, to)) => (row(from)?, Some(row(to)?)),
            None => (row(text)?, None),
        };
        if to.is_some_and(|to| to <= from) {
            Err("TO must come after FROM".to_owned())
        } else {
            Ok(Self { from, to })
        }
    }
}

impl ThreadArgs {
    /// Threads for many runs, frames or files.
    pub fn pool(&self) -> anyhow::Result<ThreadPool> {
        start(self.count(usize::MAX))
    }

    /// Threads for one particle filter.
    pub fn filter_pool(&self, particles: usize) -> anyhow::Result<ThreadPool> {
        start(self.count(useful_threads(particles)))
    }

    /// As many as asked for or else one per processor, of which `useful` can do something.
    fn count(&self, useful: usize) -> usize {
        let asked = self.threads.map_or_else(processors, usize::from);
        asked.min(useful).min(PER_PROCESSOR * processors()).max(1)
    }
}

fn processors() -> usize {
    available_parallelism().map_or(1, NonZero::get)
}

fn start(threads: usize) -> anyhow::Result<ThreadPool> {
    Ok(ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// A positive number.
pub fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("must be positive".to_owned())
    }
}

/// A number of particles, from 1 up.
pub fn particles(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("must be a whole number from 1 up".to_owned()),
        Ok(count) => Ok(count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_is_what_was_asked_for_up_to_what_can_help() {
        let of = |threads| ThreadArgs { threads };
        assert_eq!(of(Some(3)).count(8), 3);
        assert_eq!(of(Some(1000)).count(3), 3);
        assert!(of(Some(1000)).count(usize::MAX) <= PER_PROCESSOR * processors());
        assert_eq!(of(None).count(1), 1);
    }

    #[test]
    fn rows_parse_from_and_to() {
        assert_eq!("3".parse(), Ok(Rows { from: 3, to: None }));
        assert_eq!("3:".parse(), Ok(Rows { from: 3, to: None }));
        assert_eq!(
            "3:7".parse(),
            Ok(Rows {
                from: 3,
                to: Some(7)
            })
        );
        for bad in ["", "x", "7:3", "3:3", ":3", "-1"] {
            assert!(bad.parse::<Rows>().is_err(), "{bad}");
        }
    }
}
