//! Hashes of the estimates of many experiments, to be kept before a change and compared after it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::program::{build, experiments, filter, fnv1a};

/// Filters every experiment below `folders` in every way; the lines, or a word of agreement with
/// those of `against`.
///
/// A line is the experiment's folder, the options in brackets and the hash of the estimate, or
/// `failed`.
///
/// # Errors
/// The program does not build, a folder or file cannot be read, or a line differs from `against`.
pub fn check(root: &Path, folders: &[&str], against: Option<&Path>) -> Result<String, String> {
    let kept = against
        .map(|file| fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display())))
        .transpose()?;
    let program = build(root, "release")?;
    let mut lines = Vec::new();
    for folder in folders {
        for experiment in experiments(Path::new(folder))? {
            let truth = fs::read_to_string(experiment.join("truth.json")).unwrap_or_default();
            for options in ways(&truth) {
                let words: Vec<String> = options.split_whitespace().map(str::to_string).collect();
                let hash = filter(&program, &experiment, &words)
                    .map_or("failed".to_string(), |bytes| {
                        format!("{:016x}", fnv1a(&bytes))
                    });
                lines.push(format!("{} [{options}] {hash}", experiment.display()));
            }
        }
    }
    let Some(kept) = kept else {
        return Ok(lines.join("\n"));
    };
    let differences = differences(&kept, &lines);
    if differences.is_empty() {
        return Ok(format!("digest: {} estimates, all as before", lines.len()));
    }
    Err(format!(
        "{}\ndigest: {} differences in {} estimates",
        differences.join("\n"),
        differences.len(),
        lines.len()
    ))
}

/// The ways in which an experiment is filtered: with the camera off as truth.json says, else for
/// the middle second.
fn ways(truth: &str) -> Vec<String> {
    let truth: serde_json::Value = serde_json::from_str(truth).unwrap_or_default();
    let dark = match truth["occlude_from"].as_u64() {
        Some(row) => format!("--occlude {row}"),
        None => "--occlude-middle 1.0".to_string(),
    };
    let others = [
        "--causal",
        "--method kalman",
        "--method nominal",
        "--no-tactile",
    ];
    let mut ways = vec![dark.clone(), String::new()];
    ways.extend(others.map(|option| format!("{dark} {option}")));
    ways
}

/// Differences between lines that were kept and those found: changed, new, missing.
fn differences(kept: &str, found: &[String]) -> Vec<String> {
    fn table<'a>(lines: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, &'a str> {
        lines.filter_map(|line| line.rsplit_once(' ')).collect()
    }
    let (kept, found) = (table(kept.lines()), table(found.iter().map(String::as_str)));
    let mut differences: Vec<String> = found
        .iter()
        .filter(|(run, hash)| kept.get(*run) != Some(hash))
        .map(|(run, hash)| {
            format!(
                "{run} {hash}, was {}",
                kept.get(run).unwrap_or(&"not there")
            )
        })
        .collect();
    let missing = kept.keys().filter(|run| !found.contains_key(*run));
    differences.extend(missing.map(|run| format!("{run} is missing")));
    differences
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_hide_the_camera_where_the_truth_says() {
        let ways_with_row = ways("{\"occlude_from\": 240}");
        assert_eq!(ways_with_row.len(), 6);
        assert_eq!(ways_with_row[2], "--occlude 240 --causal");
        for truth in ["", "{\"occlude_from\": null}"] {
            assert_eq!(ways(truth)[0], "--occlude-middle 1.0", "{truth}");
        }
        assert_eq!(ways("")[1], "");
    }

    #[test]
    fn differences_name_changed_new_and_missing_runs() {
        let kept = "a [] 1\nb [--causal] 2\nc [] 3\n";
        let found = |lines: &[&str]| {
            lines
                .iter()
                .map(|line| (*line).to_string())
                .collect::<Vec<_>>()
        };
        assert!(differences(kept, &found(&["c [] 3", "a [] 1", "b [--causal] 2"])).is_empty());
        let changed = differences(kept, &found(&["a [] 1", "b [--causal] 9", "d [] 4"]));
        assert_eq!(
            changed,
            [
                "b [--causal] 9, was 2",
                "d [] 4, was not there",
                "c [] is missing"
            ]
        );
    }
}
