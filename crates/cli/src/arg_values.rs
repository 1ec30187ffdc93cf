//! What several commands take: [`Rows`], [`ThreadArgs`] and checked numbers.

use std::str::FromStr;

use clap::Args;

/// How many threads to work on.
#[derive(Debug, Args)]
pub struct ThreadArgs {
    /// Threads [default: one per processor]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
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
    /// As many threads as asked for.
    pub fn pool(&self) -> anyhow::Result<rayon::ThreadPool> {
        let threads = self.threads.map_or(0, usize::from);
        Ok(rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?)
    }
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
