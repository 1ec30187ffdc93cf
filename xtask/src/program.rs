//! The program under test: built and run as a user would.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the program; where it lies. The one of profile `dev` is built as that of the tests: with
/// the features of the whole workspace, so that after `cargo test --workspace` nothing is compiled
/// again.
///
/// # Errors
/// It does not build.
pub fn build(root: &Path, profile: &str) -> Result<PathBuf, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = match profile {
        "dev" => "test --quiet --workspace --no-run".to_owned(),
        _ => format!("build --quiet --package stickslip-cli --bin stickslip --profile {profile}"),
    };
    let status = Command::new(cargo)
        .current_dir(root)
        .args(arguments.split(' '))
        .status()
        .map_err(|error| format!("cargo did not start: {error}"))?;
    if !status.success() {
        return Err(format!("the program does not build with profile {profile}"));
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let folder = if profile == "dev" { "debug" } else { profile };
    let name = format!("stickslip{}", std::env::consts::EXE_SUFFIX);
    Ok(root.join(target).join(folder).join(name))
}

/// `estimate.csv` of `stickslip filter` on the experiment in a folder.
///
/// # Errors
/// The run fails, with its message.
pub fn filter(program: &Path, experiment: &Path, options: &[String]) -> Result<Vec<u8>, String> {
    let out = std::env::temp_dir().join(format!("stickslip-xtask-{}", std::process::id()));
    let output = Command::new(program)
        .arg("filter")
        .arg(experiment.join("log.csv"))
        .arg("--scene")
        .arg(experiment.join("scene.toml"))
        .args(options)
        .arg("--out")
        .arg(&out)
        .output()
        .map_err(|error| format!("{}: {error}", program.display()))?;
    let estimate = fs::read(out.join("estimate.csv"));
    // the folder is ours; that it could not be removed changes nothing about the outcome
    let _ = fs::remove_dir_all(&out);
    // 3 is a run that is done, with input lost
    if !matches!(output.status.code(), Some(0 | 3)) {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!(
            "{}: {}: {said}",
            experiment.display(),
            output.status
        ));
    }
    estimate.map_err(|error| format!("estimate.csv: {error}; `filter --out` must write it"))
}

/// All folders below `folder`, itself included, that hold an experiment; sorted.
///
/// # Errors
/// A folder cannot be read.
pub fn experiments(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    if ["log.csv", "scene.toml"]
        .iter()
        .all(|file| folder.join(file).is_file())
    {
        found.push(folder.to_path_buf());
    }
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            found.extend(experiments(&path)?);
        }
    }
    found.sort();
    Ok(found)
}

/// 64-bit FNV-1a, to show at a glance whether two machines agree.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fnv1a_matches_published_values() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn experiments_are_found_below_a_folder() {
        let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/cli/demo");
        let found = experiments(&demo).expect("the demo's experiments");
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found.is_sorted());
    }
}
