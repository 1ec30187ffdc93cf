//! One experiment, several builds and numbers of threads, the same estimate byte for byte.

use std::path::Path;

use crate::program::{build, experiments, filter, fnv1a};

/// Folder of the program's own experiments.
const EXPERIMENTS: &str = "crates/cli/demo";

/// Build and threads of each run; all are compared with the first.
const RUNS: [(&str, u32); 4] = [("release", 1), ("release", 2), ("release", 3), ("dev", 1)];

/// Filters the first embedded experiment once per entry of [`RUNS`] and compares the estimates.
///
/// # Errors
/// A run fails, or its estimate differs from the first one's.
pub fn check(root: &Path) -> Result<String, String> {
    let found = experiments(&root.join(EXPERIMENTS))?;
    let experiment = found.first().ok_or("the demo has no experiment")?;
    let mut reference: Option<Vec<u8>> = None;
    for (profile, threads) in RUNS {
        let options = ["--threads".to_string(), threads.to_string()];
        let estimate = filter(&build(root, profile)?, experiment, &options)?;
        match &reference {
            None => reference = Some(estimate),
            Some(expected) => same(expected, &estimate).map_err(|line| {
                let (first, at) = (RUNS[0], experiment.display());
                format!(
                    "determinism: {at}: estimate.csv of {profile} on {threads} threads differs from {} on {} at line {line}; \
                     look for a sum whose order follows threads, a fused operation, or memory shared between particles",
                    first.0, first.1
                )
            })?,
        }
    }
    let digest = fnv1a(&reference.unwrap_or_default());
    let runs = RUNS
        .map(|(profile, threads)| format!("{profile}/{threads}"))
        .join(", ");
    Ok(format!("determinism: {digest:016x} from {runs} threads"))
}

/// Compares two files. If they differ, the error is the first line, from 1, that does.
fn same(expected: &[u8], found: &[u8]) -> Result<(), usize> {
    if expected == found {
        return Ok(());
    }
    let agree = expected
        .iter()
        .zip(found)
        .take_while(|(a, b)| a == b)
        .count();
    Err(expected[..agree]
        .iter()
        .filter(|byte| **byte == b'\n')
        .count()
        + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_names_the_first_line_that_differs() {
        assert_eq!(same(b"a\nb\nc\n", b"a\nb\nc\n"), Ok(()));
        assert_eq!(same(b"a\nb\nc\n", b"a\nB\nc\n"), Err(2));
        assert_eq!(same(b"a\nb\nc\n", b"a\nb\n"), Err(3));
    }
}
