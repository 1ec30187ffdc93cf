//! Allowed dependencies between crates: the output of `cargo metadata` against [`CRATES`].

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::finding::Finding;

/// The workspace by the names of its folders, each with the crates that it may use. Only tests may
/// use those in brackets.
///
/// Arrows run one way: bytes, formats, estimator, then filter and dynamics, then lanes. Testbed,
/// rendering and vision stand next to the estimator, and evaluation brings all together.
const CRATES: [(&str, &str); 17] = [
    ("lanes", ""),
    ("dynamics", "lanes"),
    ("filter", "lanes"),
    ("estimator", "lanes dynamics filter (formats)"),
    ("formats", "dynamics estimator"),
    ("testbed", "dynamics filter"),
    ("rendering", "dynamics filter"),
    ("vision", "dynamics (rendering) (filter)"),
    ("evaluation", "dynamics filter estimator formats testbed"),
    ("fit", "dynamics filter estimator formats evaluation"),
    ("report", "dynamics estimator formats evaluation"),
    (
        "cli",
        "dynamics filter estimator formats testbed rendering vision evaluation fit report",
    ),
    ("python", "dynamics estimator formats evaluation fit cli"),
    ("testkit", "dynamics"),
    (
        "experiments",
        "dynamics filter estimator formats evaluation testkit",
    ),
    (
        "bench",
        "lanes dynamics filter estimator formats (experiments)",
    ),
    ("xtask", ""),
];

/// Tests of any crate may use it.
const TESTKIT: &str = "testkit";

/// Pure functions of one thread, which use neither randomness nor threads.
const PURE: [&str; 3] = ["lanes", "dynamics", "testbed"];
const CHANCE_AND_THREADS: [&str; 4] = ["rand", "rand_distr", "rand_core", "rayon"];

/// Asks Cargo for the crates of the workspace.
///
/// # Errors
/// Cargo does not start, or does not read a manifest.
pub fn metadata(root: &Path) -> Result<Value, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(root)
        .args("metadata --no-deps --offline --format-version 1".split(' '))
        .output()
        .map_err(|error| format!("cargo did not start: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))
}

/// Every crate against its row of the table.
pub fn check(metadata: &Value) -> Vec<Finding> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    packages.flat_map(check_package).collect()
}

fn check_package(package: &Value) -> Vec<Finding> {
    let manifest = package["manifest_path"].as_str().unwrap_or_default();
    let own = folder(manifest.trim_end_matches("/Cargo.toml"));
    let Some((_, allowed)) = CRATES.iter().find(|(name, _)| *name == own) else {
        return vec![Finding {
            file: "Cargo.toml".to_string(),
            line: 1,
            rule: format!("member `{own}` has no rule for what it may depend on"),
            next: "add it to CRATES in xtask/src/arrows.rs and to ARCHITECTURE.md".to_string(),
        }];
    };
    let dependencies = package["dependencies"].as_array().into_iter().flatten();
    let broken = dependencies.filter_map(|dependency| judge(own, allowed, dependency));
    broken
        .map(|(rule, next)| Finding {
            file: format!("{}/Cargo.toml", path(own)),
            line: 1,
            rule,
            next: next.to_string(),
        })
        .collect()
}

/// Folders of all crates from the root.
pub fn folders() -> impl Iterator<Item = String> {
    CRATES.iter().map(|(name, _)| path(name))
}

fn path(name: &str) -> String {
    match name {
        "xtask" => name.to_string(),
        "rendering" | "vision" => format!("crates/camera/{name}"),
        _ => format!("crates/{name}"),
    }
}

/// Last part of a path.
fn folder(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or_default()
}

/// The fault of one dependency, if any, and what to do.
fn judge(own: &str, allowed: &str, dependency: &Value) -> Option<(String, &'static str)> {
    let (package, dev) = (dependency["name"].as_str()?, dependency["kind"] == "dev");
    if PURE.contains(&own) && CHANCE_AND_THREADS.contains(&package) && !dev {
        return Some((
            format!("{own} must not depend on `{package}`"),
            "move what needs it to a crate that may",
        ));
    }
    // crates from elsewhere have no path
    let used = folder(dependency["path"].as_str()?);
    let tests_only = used == TESTKIT || allowed.contains(&format!("({used})"));
    if allowed.split(' ').any(|name| name == used) || dev && tests_only {
        return None;
    }
    Some(match tests_only {
        true => (
            format!("`{package}` is for tests only"),
            "move it to [dev-dependencies]",
        ),
        false => (
            format!("{own} must not depend on `{package}`; it may use: {allowed}"),
            "move the code to where the arrow runs the right way, or tests that need both to the crate that may use both",
        ),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Words of the only finding for a crate with one dependency; empty for none.
    fn found(own: &str, used: &str, kind: &str) -> String {
        let mut dependency = json!({ "name": used, "kind": kind });
        if CRATES.iter().any(|(name, _)| *name == used) {
            dependency["path"] = format!("/w/crates/{used}").into();
        }
        let package = json!({
            "manifest_path": format!("/w/crates/{own}/Cargo.toml"),
            "dependencies": [dependency],
        });
        let found = check(&json!({ "packages": [package] }));
        assert!(found.len() < 2);
        found.iter().map(Finding::to_string).collect()
    }

    #[test]
    fn arrows_that_run_the_right_way_pass() {
        for (own, used, kind) in [
            ("estimator", "dynamics", "normal"),
            ("dynamics", "testkit", "dev"),
            ("dynamics", "rand", "dev"),
            ("dynamics", "libm", "normal"),
            ("vision", "rendering", "dev"),
        ] {
            assert_eq!(found(own, used, kind), "", "{own} {used}");
        }
    }

    #[test]
    fn other_arrows_are_found_with_place_and_next_step() {
        for (own, used, kind, words) in [
            (
                "dynamics",
                "estimator",
                "normal",
                "must not depend on `estimator`",
            ),
            (
                "dynamics",
                "estimator",
                "dev",
                "must not depend on `estimator`",
            ),
            ("dynamics", "rayon", "normal", "must not depend on `rayon`"),
            ("vision", "rendering", "normal", "[dev-dependencies]"),
            ("estimator", "testkit", "build", "[dev-dependencies]"),
        ] {
            let found = found(own, used, kind);
            let place = format!("{}/Cargo.toml:1: ", path(own));
            assert!(
                found.starts_with(&place) && found.contains(words),
                "{found}"
            );
        }
        assert!(found("unknown", "libm", "normal").contains("ARCHITECTURE.md"));
    }

    #[test]
    fn every_crate_of_this_workspace_is_read() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
        let metadata = metadata(root.expect("a workspace")).expect("metadata");
        let packages = metadata["packages"].as_array().expect("packages");
        assert_eq!(packages.len(), CRATES.len());
        let paths = packages.iter().flat_map(|of| of["dependencies"].as_array());
        assert!(
            paths
                .flatten()
                .any(|dependency| folder(dependency["path"].as_str().unwrap_or("")) == TESTKIT)
        );
    }
}
