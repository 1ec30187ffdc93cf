//! Which crate may depend on which: the workspace's `Cargo.toml` files against [`CRATES`].

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::finding::Finding;
use crate::tree::Tree;

/// A crate of the workspace by its folder, and what it may depend on.
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

/// The workspace. Arrows run one way: bytes, formats, estimator, then filter and dynamics, which
/// know of nobody; the testbed and vision stand beside the estimator.
pub const CRATES: [Rules; 12] = [
    Rules {
        must_not_use: &["rand", "rand_distr", "rand_core", "rayon"],
        ..Rules::of("crates/dynamics", &[])
    },
    Rules::of("crates/filter", &[]),
    Rules::of("crates/estimator", &["crates/dynamics", "crates/filter"]),
    Rules::of("crates/formats", &["crates/estimator", "crates/dynamics"]),
    Rules::of(
        "crates/evaluation",
        &["crates/formats", "crates/testbed", "crates/estimator"],
    ),
    Rules::of(
        "crates/report",
        &[
            "crates/evaluation",
            "crates/formats",
            "crates/estimator",
            "crates/dynamics",
        ],
    ),
    Rules {
        must_not_use: &["rand", "rand_distr", "rand_core", "rayon"],
        ..Rules::of("crates/testbed", &["crates/dynamics", "crates/filter"])
    },
    // rendered frames have a truth to be judged by; random numbers are the filter's
    Rules {
        may_test_with: &["crates/testbed", "crates/filter"],
        ..Rules::of("crates/vision", &["crates/dynamics"])
    },
    Rules::of(
        "crates/cli",
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
            "crates/evaluation",
            "crates/report",
            "crates/testbed",
            "crates/vision",
        ],
    ),
    Rules::of(
        TESTKIT,
        &["crates/dynamics", "crates/estimator", "crates/formats"],
    ),
    Rules::of(
        "crates/bench",
        &[
            "crates/dynamics",
            "crates/filter",
            "crates/estimator",
            "crates/formats",
        ],
    ),
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

/// One entry under `[dependencies]` or a table like it.
#[derive(Clone, Debug)]
struct Dependency {
    package: String,
    line: usize,
    dev: bool,
}

/// A `Cargo.toml`, taken apart.
#[derive(Clone, Debug, Default)]
struct Manifest {
    package: Option<String>,
    members: Vec<(String, usize)>,
    dependencies: Vec<Dependency>,
    /// Package by key, where a dependency of the workspace is renamed.
    renamed: BTreeMap<String, String>,
}

/// Everything the manifests name against the rules.
pub fn check(tree: &Tree) -> Vec<Finding> {
    let root = match read(tree, "Cargo.toml", &BTreeMap::new()) {
        Ok(root) => root,
        Err(finding) => return vec![finding],
    };
    let mut findings = Vec::new();
    let mut manifests = Vec::new();
    for (member, line) in &root.members {
        let Some(rules) = CRATES.iter().find(|c| c.folder == member) else {
            findings.push(Finding {
                file: "Cargo.toml".to_string(),
                line: *line,
                rule: format!("member `{member}` has no rule for what it may depend on"),
                next: "add it to CRATES in xtask/src/arrows.rs and to ARCHITECTURE.md".to_string(),
            });
            continue;
        };
        match read(tree, &format!("{member}/Cargo.toml"), &root.renamed) {
            Ok(manifest) => manifests.push((rules, manifest)),
            Err(finding) => findings.push(finding),
        }
    }
    let folders: BTreeMap<&str, &str> = manifests
        .iter()
        .filter_map(|(rules, manifest)| Some((manifest.package.as_deref()?, rules.folder)))
        .collect();
    for (rules, manifest) in &manifests {
        findings.extend(
            manifest
                .dependencies
                .iter()
                .filter_map(|dependency| judge(rules, dependency, &folders)),
        );
    }
    findings
}

/// What is wrong with one dependency, if anything.
fn judge(
    rules: &Rules,
    dependency: &Dependency,
    folders: &BTreeMap<&str, &str>,
) -> Option<Finding> {
    let Dependency { package, line, dev } = dependency;
    let finding = |rule: String, next: &str| {
        Some(Finding {
            file: format!("{}/Cargo.toml", rules.folder),
            line: *line,
            rule,
            next: next.to_string(),
        })
    };
    if rules.must_not_use.contains(&package.as_str()) && !dev {
        return finding(
            format!("{} must not depend on `{package}`", rules.folder),
            "move what needs it to a crate that may",
        );
    }
    let used = *folders.get(package.as_str())?;
    if rules.may_use.contains(&used)
        || (*dev && (used == TESTKIT || rules.may_test_with.contains(&used)))
    {
        return None;
    }
    if used == TESTKIT {
        return finding(
            format!("`{package}` is for tests only"),
            "move it to [dev-dependencies]",
        );
    }
    let allowed = if rules.may_use.is_empty() {
        "no crate of the workspace".to_string()
    } else {
        rules.may_use.join(", ")
    };
    finding(
        format!(
            "{} must not depend on `{package}`; it may use {allowed}",
            rules.folder
        ),
        "move the code to where the arrow runs the right way, or tests that need both to the crate that may use both",
    )
}

fn read(tree: &Tree, path: &str, renamed: &BTreeMap<String, String>) -> Result<Manifest, Finding> {
    let refused = |line, rule: String| Finding {
        file: path.to_string(),
        line,
        rule,
        next: "make it a manifest that Cargo reads".to_string(),
    };
    let text = tree
        .text(path)
        .ok_or_else(|| refused(1, "there is no such file".to_string()))?;
    let line_of = |span: Range<usize>| text[..span.start].matches('\n').count() + 1;
    let document = DeTable::parse(text)
        .map_err(|e| refused(e.span().map_or(1, line_of), e.message().to_string()))?;
    let document = document.get_ref();

    let mut manifest = Manifest::default();
    if let Some(name) = table(document, "package").and_then(|package| string(package, "name")) {
        manifest.package = Some(name);
    }
    if let Some(workspace) = table(document, "workspace") {
        if let Some(DeValue::Array(members)) = workspace.get("members").map(Spanned::get_ref) {
            manifest.members = members
                .iter()
                .filter_map(|m| Some((m.get_ref().as_str()?.to_string(), line_of(m.span()))))
                .collect();
        }
        for (key, value) in table(workspace, "dependencies").into_iter().flatten() {
            if let Some(package) = value
                .get_ref()
                .as_table()
                .and_then(|t| string(t, "package"))
            {
                manifest.renamed.insert(key.get_ref().to_string(), package);
            }
        }
    }
    let mut scopes = vec![document];
    scopes.extend(
        table(document, "target")
            .into_iter()
            .flatten()
            .filter_map(|(_, target)| target.get_ref().as_table()),
    );
    for scope in scopes {
        for (section, dev) in [
            ("dependencies", false),
            ("build-dependencies", false),
            ("dev-dependencies", true),
        ] {
            for (key, value) in table(scope, section).into_iter().flatten() {
                let name = key.get_ref().to_string();
                let own = value
                    .get_ref()
                    .as_table()
                    .and_then(|t| string(t, "package"));
                let package = own.or_else(|| renamed.get(&name).cloned()).unwrap_or(name);
                manifest.dependencies.push(Dependency {
                    package,
                    line: line_of(key.span()),
                    dev,
                });
            }
        }
    }
    Ok(manifest)
}

fn table<'a, 'i>(parent: &'a DeTable<'i>, key: &str) -> Option<&'a DeTable<'i>> {
    parent.get(key)?.get_ref().as_table()
}

fn string(parent: &DeTable<'_>, key: &str) -> Option<String> {
    Some(parent.get(key)?.get_ref().as_str()?.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: &str =
        "[workspace]\nmembers = [\"crates/dynamics\", \"crates/estimator\", \"crates/testkit\"]\n";
    const DYNAMICS: &str = "[package]\nname = \"stickslip-dynamics\"\n";
    const ESTIMATOR: &str =
        "[package]\nname = \"stickslip\"\n[dependencies]\nstickslip-dynamics.workspace = true\n";
    const TESTKIT: &str = "[package]\nname = \"stickslip-testkit\"\n[dependencies]\nstickslip-dynamics.workspace = true\n";

    fn found(root: &str, dynamics: &str, estimator: &str) -> Vec<String> {
        let tree = Tree::from([
            ("Cargo.toml", root),
            ("crates/dynamics/Cargo.toml", dynamics),
            ("crates/estimator/Cargo.toml", estimator),
            ("crates/testkit/Cargo.toml", TESTKIT),
        ]);
        check(&tree).iter().map(Finding::to_string).collect()
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
        assert!(found(ROOT, DYNAMICS, ESTIMATOR).is_empty());
        let tested = format!(
            "{DYNAMICS}[dev-dependencies]\nstickslip-testkit.workspace = true\nrand = \"1\"\n"
        );
        assert!(found(ROOT, &tested, ESTIMATOR).is_empty());
    }

    #[test]
    fn check_finds_an_arrow_that_runs_back() {
        let back = format!("{DYNAMICS}[dependencies]\nstickslip.workspace = true\n");
        assert_one(
            &found(ROOT, &back, ESTIMATOR),
            "crates/dynamics/Cargo.toml:4: ",
            "may use no crate of the workspace",
        );
    }

    #[test]
    fn check_finds_an_arrow_that_runs_back_under_another_name() {
        let back = format!(
            "{DYNAMICS}[dependencies]\ne = {{ package = \"stickslip\", path = \"../estimator\" }}\n"
        );
        assert_one(
            &found(ROOT, &back, ESTIMATOR),
            "crates/dynamics/Cargo.toml:4: ",
            "`stickslip`",
        );
        let root = format!(
            "{ROOT}[workspace.dependencies]\ne = {{ package = \"stickslip\", path = \"crates/estimator\" }}\n"
        );
        let back = format!("{DYNAMICS}[dependencies]\ne.workspace = true\n");
        assert_one(
            &found(&root, &back, ESTIMATOR),
            "crates/dynamics/Cargo.toml:4: ",
            "`stickslip`",
        );
    }

    #[test]
    fn check_finds_an_arrow_that_runs_back_for_one_target_or_in_tests() {
        let back =
            format!("{DYNAMICS}[target.'cfg(unix)'.dependencies]\nstickslip.workspace = true\n");
        assert_one(
            &found(ROOT, &back, ESTIMATOR),
            "crates/dynamics/Cargo.toml:4: ",
            "must not depend",
        );
        let back = format!("{DYNAMICS}[dev-dependencies]\nstickslip.workspace = true\n");
        assert_one(
            &found(ROOT, &back, ESTIMATOR),
            "crates/dynamics/Cargo.toml:4: ",
            "must not depend",
        );
    }

    #[test]
    fn check_lets_some_crates_into_tests_only() {
        let vision = |section: &str| {
            let manifest = format!(
                "[package]\nname = \"stickslip-vision\"\n[{section}]\nstickslip-testbed.workspace = true\n"
            );
            let tree = Tree::from([
                (
                    "Cargo.toml",
                    "[workspace]\nmembers = [\"crates/testbed\", \"crates/vision\"]\n",
                ),
                (
                    "crates/testbed/Cargo.toml",
                    "[package]\nname = \"stickslip-testbed\"\n",
                ),
                ("crates/vision/Cargo.toml", &manifest),
            ]);
            check(&tree)
                .iter()
                .map(Finding::to_string)
                .collect::<Vec<_>>()
        };
        assert!(vision("dev-dependencies").is_empty());
        assert_one(
            &vision("dependencies"),
            "crates/vision/Cargo.toml:4: ",
            "must not depend on `stickslip-testbed`",
        );
    }

    #[test]
    fn check_finds_testkit_outside_tests() {
        let leaking = format!("{ESTIMATOR}stickslip-testkit.workspace = true\n");
        assert_one(
            &found(ROOT, DYNAMICS, &leaking),
            "crates/estimator/Cargo.toml:5: ",
            "[dev-dependencies]",
        );
    }

    #[test]
    fn check_finds_randomness_and_threads_in_dynamics() {
        for package in ["rand", "rayon"] {
            let random = format!("{DYNAMICS}[dependencies]\n{package} = \"1\"\n");
            assert_one(
                &found(ROOT, &random, ESTIMATOR),
                "crates/dynamics/Cargo.toml:4: ",
                package,
            );
        }
    }

    #[test]
    fn check_finds_a_member_without_a_rule() {
        let root = ROOT.replace("crates/testkit", "crates/unknown");
        assert_one(
            &found(&root, DYNAMICS, ESTIMATOR),
            "Cargo.toml:2: ",
            "ARCHITECTURE.md",
        );
    }

    #[test]
    fn check_finds_a_manifest_that_is_none() {
        assert_one(
            &found(ROOT, "[package\n", ESTIMATOR),
            "crates/dynamics/Cargo.toml:1: ",
            "manifest",
        );
        assert_one(
            &check(&Tree::default())
                .iter()
                .map(Finding::to_string)
                .collect::<Vec<_>>(),
            "Cargo.toml:1: ",
            "no such file",
        );
    }
}
