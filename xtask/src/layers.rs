//! Layers inside a crate: a file names only files of its own layer or of a lower one.

use crate::finding::Finding;
use crate::rust_text::{code_only, own_paths, without_tests};
use crate::tree::Tree;

/// Files (`step`, for `step.rs` or `step/mod.rs`) and folders (`ncp/`) that may name each other.
type Layer = &'static [&'static str];

/// Source folders with their layers, the lowest first. Every file but `lib.rs` is in one.
const LAYERED: [(&str, &[Layer]); 2] = [DYNAMICS, ESTIMATOR];

const DYNAMICS: (&str, &[Layer]) = (
    "crates/dynamics/src/",
    &[
        &["se2", "friction"],
        &["geometry/"],
        &["scene", "support", "input", "particles", "start"],
        &["ncp/"],
        &["solver/"],
        &[
            "feet",
            "prepared_scene",
            "assembly",
            "contact_state",
            "solved_contact",
            "stated_problem",
            "block_problems",
        ],
        &[
            "kept_lanes",
            "step_work",
            "by_lane",
            "step",
            "compiled_step",
            "rollout",
        ],
    ],
);

const ESTIMATOR: (&str, &[Layer]) = (
    "crates/estimator/src/",
    &[
        &[
            "angle",
            "belief_mode",
            "contact_slip",
            "counted",
            "covariance",
            "filter_model",
            "gap",
            "quantile",
            "range",
            "trajectory",
            "tuning",
        ],
        &[
            "uncertainty",
            "setup",
            "setup_check",
            "estimate",
            "row",
            "error",
            "pose_clock",
            "log",
            "occlusion",
        ],
        &["pusher/", "options", "outcomes"],
        &[
            "particle/set/",
            "particle/unknown/",
            "particle/transition/",
            "particle/sensor/",
            "particle/estimate/",
            "particle/model",
        ],
        &["particle/"],
        &["tracker", "prepared_log", "baseline/", "run", "diagnosis/"],
        &["particle_budget", "prior_sample"],
    ],
);

/// Every file of the layered folders.
pub fn check(tree: &Tree) -> Vec<Finding> {
    LAYERED
        .iter()
        .flat_map(|(folder, layers)| check_folder(tree, folder, layers))
        .collect()
}

fn check_folder(tree: &Tree, folder: &str, layers: &[Layer]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in tree
        .texts(".rs")
        .filter(|(path, _)| path.starts_with(folder))
    {
        let file = &path[folder.len()..];
        if file == "lib.rs" {
            continue;
        }
        let module = module_of(file);
        let Some(own) = layer_of(layers, &module) else {
            findings.push(Finding {
                file: path.to_string(),
                line: 1,
                rule: "the file is in no layer".to_string(),
                next: "add it to LAYERED in xtask/src/layers.rs".to_string(),
            });
            continue;
        };
        let segments: Vec<&str> = module.split('/').collect();
        for (line, named) in own_paths(&code_only(without_tests(text)), &segments) {
            if layer_of(layers, &named.replace("::", "/")).is_some_and(|layer| layer > own) {
                findings.push(Finding {
                    file: path.to_string(),
                    line,
                    rule: format!("`{named}` lies in a higher layer"),
                    next: "move the type down to a file of its own, or the code up".to_string(),
                });
            }
        }
    }
    findings
}

/// `ncp/rows` for `ncp/rows.rs`, `ncp` for `ncp/mod.rs`.
pub fn module_of(file: &str) -> String {
    let module = file.trim_end_matches(".rs");
    module.trim_end_matches("/mod").to_string()
}

/// The layer of a file, or of something in it.
fn layer_of(layers: &[Layer], path: &str) -> Option<usize> {
    let inside = |entry: &str| {
        let rest = path.strip_prefix(entry.trim_end_matches('/'));
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    };
    layers
        .iter()
        .position(|layer| layer.iter().any(|entry| inside(entry)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYERS: &[Layer] = &[&["words"], &["ncp/"], &["step"]];

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let tree = Tree::of(files);
        check_folder(&tree, "c/src/", LAYERS)
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    #[test]
    fn check_passes_imports_that_point_down_or_across() {
        let step = "use crate::ncp::rows::Row;\nuse crate::words::Pose;\n";
        let rows = "use super::map::Map;\nuse crate::words::Pose;\n#[cfg(test)]\nmod tests {\n use crate::step::Step;\n}\n";
        assert!(
            found(&[
                ("c/src/step.rs", step),
                ("c/src/ncp/rows.rs", rows),
                ("c/src/lib.rs", "use crate::step::X;")
            ])
            .is_empty()
        );
        assert!(
            found(&[
                ("c/src/ncp/mod.rs", "pub mod rows;"),
                ("d/src/x.rs", "use crate::step::X;")
            ])
            .is_empty()
        );
    }

    #[test]
    fn check_finds_imports_that_point_up() {
        for line in [
            "use crate::step::Step;",
            "use crate::{words::Pose, step::Step};",
            "fn f() -> crate::step::Step {}",
            "use super::super::step::Step;",
        ] {
            let found = found(&[("c/src/ncp/rows.rs", &format!("\n{line}"))]);
            assert!(
                found.len() == 1 && found[0].starts_with("c/src/ncp/rows.rs:2: `step::Step`"),
                "{line}: {found:?}"
            );
        }
    }

    #[test]
    fn check_finds_files_without_a_layer() {
        let found = found(&[("c/src/stepping.rs", "")]);
        assert!(
            found.len() == 1 && found[0].contains("in no layer"),
            "{found:?}"
        );
    }
}
