//! Allowed dependencies between crates: the output of `cargo metadata` against [`CRATES`].

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::finding::Finding;

/// A crate of the workspace by its folder, and its allowed dependencies.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Folder from the root.
    pub folder: &'static str,
    /// Folders of the workspace crates that it may name under `[dependencies]`.
    pub may_use: &'static [&'static str],
    /// Further ones that it may name under `[dev-dependencies]`.
    pub may_test_with: &'static [&'static str],
    /// Crates from elsewhere that it must not name.
    pub must_not_use: &'static [&'static str],
}

/// Only tests may use it, with any crate's `[dev-dependencies]`.
const TESTKIT: &str = "crates/testkit";

/// Off the program: its own binaries, tests and benchmarks use it.
const EXPERIMENTS: &str = "crates/experiments";

/// Randomness and threads: not for crates that are pure functions of one thread.
const CHANCE_AND_THREADS: &[&str] = &["rand", "rand_distr", "rand_core", "rayon"];

/// The workspace. Arrows run one way: bytes, formats, estimator, then filter and dynamics, then
/// lanes, which depends on no other crate. Testbed, rendering and vision stand next to the
/// estimator, and evaluation brings all together.
pub const CRATES: [Rules; 17] = [
    Rules {
        must_not_use: CHANCE_AND_THREADS,
        ..Rules::of("crates/lanes", &[])
    },
    Rules {
        must_not_use: CHANCE_AND_THREADS,
        ..Rules::of("crates/dynamics", &["crates/lanes"])
    },
    Rules::of("crates/filter", &["crates/lanes"]),
    // examples in the documentation read a log
    Rules {
        may_test_with: &["crates/formats"],
        ..Rules::of(
            "crates/estimator",
            &["crates/lanes", "crates/dynamics", "crates/filter"],
        )
    },
    Rules::of("crates/formats", &["crates/estimator", "crates/dynamics"]),
    Rules {
        must_not_use: CHANCE_AND_THREADS,
        ..Rules::of("crates/testbed", &["crates/dynamics", "crates/filter"])
    },
    Rules::of(
        "crates/camera/rendering",
        &["crates/dynamics", "crates/filter"],
    ),
    // rendered frames have a truth to be judged by; random numbers are the filter's
    Rules {
        may_test_with: &["crates/camera/rendering", "crates/filter"],
        ..Rules::of("crates/camera/vision", &["crates/dynamics"])
    },
    Rules::of(
        "crates/evaluation",
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
            "crates/testbed",
        ],
    ),
    Rules::of(
        "crates/fit",
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
            "crates/evaluation",
        ],
    ),
    Rules::of(
        "crates/report",
        &[
            "crates/dynamics",
            "crates/estimator",
            "crates/formats",
            "crates/evaluation",
        ],
    ),
    Rules::of(
        "crates/cli",
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
            "crates/testbed",
            "crates/camera/rendering",
            "crates/camera/vision",
            "crates/evaluation",
            "crates/fit",
            "crates/report",
        ],
    ),
    Rules::of(
        "crates/python",
        &[
            "crates/dynamics",
            "crates/estimator",
            "crates/formats",
            "crates/evaluation",
            "crates/fit",
            "crates/cli",
        ],
    ),
    Rules::of(TESTKIT, &["crates/dynamics"]),
    Rules::of(
        EXPERIMENTS,
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
            "crates/evaluation",
            TESTKIT,
        ],
    ),
    // recorded experiments
    Rules {
        may_test_with: &[EXPERIMENTS],
        ..Rules::of(
            "crates/bench",
            &[
                "crates/lanes",
                "crates/dynamics",
                "crates/filter",
                "crates/estimator",
                "crates/formats",
            ],
        )
    },
    Rules::of("xtask", &[]),
];

impl Rules {
    const fn of(folder: &'static str, may_use: &'static [&'static str]) -> Self {
        Self {
            folder,
            may_use,
            may_test_with: &[],
            must_not_use: &[],
        }
    }
}

/// A crate of the workspace, as Cargo sees it.
#[derive(Clone, Debug)]
pub struct Package {
    name: String,
    folder: String,
    dependencies: Vec<Dependency>,
}

/// One entry under `[dependencies]` or a table like it, under the package's own name.
#[derive(Clone, Debug)]
struct Dependency {
    package: String,
    dev: bool,
}

/// Asks Cargo for the crates of the workspace.
///
/// # Errors
/// Cargo does not start, or does not read a manifest.
pub fn packages(root: &Path) -> Result<Vec<Package>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(root)
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--format-version",
            "1",
        ])
        .output()
        .map_err(|error| format!("cargo did not start: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let json =
        serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))?;
    parse(&json).ok_or_else(|| "cargo metadata has another form than expected".to_string())
}

fn parse(metadata: &Value) -> Option<Vec<Package>> {
    let root = metadata["workspace_root"].as_str()?;
    let package = |package: &Value| {
        let folder = package["manifest_path"].as_str()?.strip_prefix(root)?;
        let dependency = |dependency: &Value| {
            Some(Dependency {
                package: dependency["name"].as_str()?.to_string(),
                dev: dependency["kind"] == "dev",
            })
        };
        Some(Package {
            name: package["name"].as_str()?.to_string(),
            folder: folder
                .strip_suffix("Cargo.toml")?
                .replace('\\', "/")
                .trim_matches('/')
                .to_string(),
            dependencies: package["dependencies"]
                .as_array()?
                .iter()
                .map(dependency)
                .collect::<Option<_>>()?,
        })
    };
    metadata["packages"]
        .as_array()?
        .iter()
        .map(package)
        .collect()
}

/// Every crate against its rules.
pub fn check(packages: &[Package]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for package in packages {
        let Some(rules) = CRATES.iter().find(|rules| rules.folder == package.folder) else {
            findings.push(Finding {
                file: "Cargo.toml".to_string(),
                line: 1,
                rule: format!(
                    "member `{}` has no rule for what it may depend on",
                    package.folder
                ),
                next: "add it to CRATES in xtask/src/arrows.rs and to ARCHITECTURE.md".to_string(),
            });
            continue;
        };
        let broken = package
            .dependencies
            .iter()
            .filter_map(|d| judge(rules, d, packages));
        findings.extend(broken.map(|(rule, next)| Finding {
            file: format!("{}/Cargo.toml", rules.folder),
            line: 1,
            rule,
            next: next.to_string(),
        }));
    }
    findings
}

/// The fault of one dependency, if any, and what to do.
fn judge(
    rules: &Rules,
    Dependency { package, dev }: &Dependency,
    packages: &[Package],
) -> Option<(String, &'static str)> {
    let folder = rules.folder;
    if rules.must_not_use.contains(&package.as_str()) && !dev {
        return Some((
            format!("{folder} must not depend on `{package}`"),
            "move what needs it to a crate that may",
        ));
    }
    let used = packages
        .iter()
        .find(|other| other.name == *package)?
        .folder
        .as_str();
    if rules.may_use.contains(&used)
        || (*dev && (used == TESTKIT || rules.may_test_with.contains(&used)))
    {
        return None;
    }
    if used == TESTKIT {
        return Some((
            format!("`{package}` is for tests only"),
            "move it to [dev-dependencies]",
        ));
    }
    let allowed = if rules.may_use.is_empty() {
        "no crate of the workspace".to_string()
    } else {
        rules.may_use.join(", ")
    };
    Some((
        format!("{folder} must not depend on `{package}`; it may use {allowed}"),
        "move the code to where the arrow runs the right way, or tests that need both to the crate that may use both",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Findings in a workspace of four crates, one of which has this dependency.
    fn found(folder: &str, package: &str, kind: &str) -> Vec<String> {
        let entry = |name: &str, of: &str| {
            let dependencies = if of == folder {
                format!("{{\"name\": \"{package}\", \"kind\": {kind}, \"rename\": \"e\"}}")
            } else {
                String::new()
            };
            format!(
                "{{\"name\": \"{name}\", \"manifest_path\": \"/w/{of}/Cargo.toml\", \"dependencies\": [{dependencies}]}}"
            )
        };
        let packages = [
            entry("stickslip-dynamics", "crates/dynamics"),
            entry("stickslip", "crates/estimator"),
            entry("stickslip-testkit", "crates/testkit"),
            entry("stickslip-vision", "crates/camera/vision"),
            entry("stickslip-rendering", "crates/camera/rendering"),
        ];
        let json = format!(
            "{{\"workspace_root\": \"/w\", \"packages\": [{}]}}",
            packages.join(", ")
        );
        let packages = parse(&serde_json::from_str(&json).expect("JSON")).expect("metadata");
        check(&packages).iter().map(Finding::to_string).collect()
    }

    #[track_caller]
    fn assert_one(found: &[String], start: &str, word: &str) {
        assert!(
            found.len() == 1 && found[0].starts_with(start) && found[0].contains(word),
            "{found:?}"
        );
    }

    #[test]
    fn check_passes_arrows_that_run_the_right_way() {
        assert!(found("crates/estimator", "stickslip-dynamics", "null").is_empty());
        assert!(found("crates/dynamics", "stickslip-testkit", "\"dev\"").is_empty());
        assert!(found("crates/dynamics", "rand", "\"dev\"").is_empty());
        assert!(found("crates/dynamics", "libm", "null").is_empty());
    }

    #[test]
    fn check_finds_an_arrow_that_runs_back() {
        for kind in ["null", "\"dev\"", "\"build\""] {
            assert_one(
                &found("crates/dynamics", "stickslip", kind),
                "crates/dynamics/Cargo.toml:1: ",
                "must not depend on `stickslip`",
            );
        }
    }

    #[test]
    fn check_lets_some_crates_into_tests_only() {
        assert!(found("crates/camera/vision", "stickslip-rendering", "\"dev\"").is_empty());
        assert_one(
            &found("crates/camera/vision", "stickslip-rendering", "null"),
            "crates/camera/vision/Cargo.toml:1: ",
            "must not depend on `stickslip-rendering`",
        );
        assert_one(
            &found("crates/estimator", "stickslip-testkit", "null"),
            "crates/estimator/Cargo.toml:1: ",
            "[dev-dependencies]",
        );
    }

    #[test]
    fn check_finds_randomness_and_threads_in_dynamics() {
        for package in ["rand", "rayon"] {
            assert_one(
                &found("crates/dynamics", package, "null"),
                "crates/dynamics/Cargo.toml:1: ",
                package,
            );
        }
    }

    #[test]
    fn check_finds_a_member_without_a_rule() {
        let package = Package {
            name: "x".to_string(),
            folder: "crates/unknown".to_string(),
            dependencies: Vec::new(),
        };
        let found: Vec<String> = check(&[package]).iter().map(Finding::to_string).collect();
        assert_one(&found, "Cargo.toml:1: ", "ARCHITECTURE.md");
    }

    #[test]
    fn packages_are_those_of_this_workspace() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .expect("a workspace");
        let packages = packages(root).expect("metadata");
        let dynamics = packages
            .iter()
            .find(|p| p.folder == "crates/dynamics")
            .expect("dynamics");
        assert_eq!(dynamics.name, "stickslip-dynamics");
        assert!(
            dynamics
                .dependencies
                .iter()
                .any(|d| d.package == "stickslip-testkit" && d.dev)
        );
    }
}
