//! One experiment, several builds and numbers of threads, the same estimate byte for byte.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the program's own experiments lie.
const EXPERIMENTS: &str = "crates/cli/demo";

/// Build and threads of each run; all are compared with the first.
const RUNS: [(&str, u32); 4] = [("release", 1), ("release", 2), ("release", 3), ("dev", 1)];

/// Filters the first embedded experiment once per entry of [`RUNS`] and compares the estimates.
///
/// # Errors
/// A run fails, or its estimate differs from the first one's.
pub fn check(root: &Path) -> Result<String, String> {
    let experiment = first_experiment(&root.join(EXPERIMENTS))?;
    let out = std::env::temp_dir().join(format!("stickslip-determinism-{}", std::process::id()));
    let outcome = compare(root, &experiment, &out);
    // the folder is ours; that it could not be removed changes nothing about the outcome
    let _ = fs::remove_dir_all(&out);
    outcome
}

fn compare(root: &Path, experiment: &Path, out: &Path) -> Result<String, String> {
    let mut reference: Option<Vec<u8>> = None;
    for (profile, threads) in RUNS {
        let estimate = filter(
            root,
            experiment,
            profile,
            threads,
            &out.join(format!("{profile}-{threads}")),
        )?;
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

/// The first folder, by name, that holds an experiment.
fn first_experiment(folder: &Path) -> Result<PathBuf, String> {
    let entries = fs::read_dir(folder).map_err(|error| {
        format!(
            "{}: {error}; the demo's experiments must lie there",
            folder.display()
        )
    })?;
    let mut experiments: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|p| p.join("log.csv").is_file())
        .collect();
    experiments.sort();
    experiments
        .into_iter()
        .next()
        .ok_or_else(|| format!("{}: no folder with a log.csv", folder.display()))
}

/// The bytes of `estimate.csv` from one run of the program.
fn filter(
    root: &Path,
    experiment: &Path,
    profile: &str,
    threads: u32,
    out: &Path,
) -> Result<Vec<u8>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root).args([
        "run",
        "--quiet",
        "--package",
        "stickslip-cli",
        "--bin",
        "stickslip",
        "--profile",
        profile,
        "--",
        "filter",
    ]);
    command
        .arg(experiment.join("log.csv"))
        .arg("--scene")
        .arg(experiment.join("scene.toml"));
    command
        .args(["--threads", &threads.to_string()])
        .arg("--out")
        .arg(out);
    let output = command
        .output()
        .map_err(|error| format!("cargo did not start: {error}"))?;
    if !output.status.success() {
        return Err(format!(
            "determinism: {command:?} failed:\n{}",
            String::from_utf8_lossy(&output.stderr)
        ));
    }
    let path = out.join("estimate.csv");
    fs::read(&path)
        .map_err(|error| format!("{}: {error}; `filter --out` must write it", path.display()))
}

/// Whether two files are the same; otherwise the first line, from 1, where they are not.
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

/// 64-bit FNV-1a, to show at a glance whether two machines agree.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
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

    #[test]
    fn fnv1a_matches_published_values() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
