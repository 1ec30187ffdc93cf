//! Names that Rust sources must not contain, and limits on their length.
//!
//! Names are sought as words. Clippy's lists of disallowed methods and types would need every
//! function of `std::fs` by name, and an exception in every test. They would also need a copy of
//! the shared list in each crate, since a crate's own `clippy.toml` replaces that of the workspace.

use crate::finding::Finding;
use crate::layers::module_of;
use crate::rust_text::{code_only, names, own_paths, without_tests};
use crate::tree::Tree;

/// Lines that a file may have, tests included.
const LONGEST_FILE: usize = 450;

/// Files that may hold `unsafe`, each with its reason; none so far.
const UNSAFE_ALLOWED: [(&str, &str); 0] = [];

/// Libraries: pure functions of their input.
const LIBRARIES: [&str; 10] = [
    "crates/lanes/",
    "crates/dynamics/",
    "crates/filter/",
    "crates/estimator/",
    "crates/formats/",
    "crates/report/",
    "crates/testbed/",
    "crates/camera/rendering/",
    "crates/camera/vision/",
    "crates/evaluation/",
];

/// Names that a crate's `src` must not contain outside tests and comments.
struct Ban {
    folders: &'static [&'static str],
    names: &'static [&'static str],
    rule: &'static str,
    next: &'static str,
}

const BANS: [Ban; 4] = [
    Ban {
        folders: &LIBRARIES,
        names: &["fs", "File", "OpenOptions"],
        rule: "a library crate opens no file",
        next: "take a reader, a writer or text, and open the file in crates/cli",
    },
    Ban {
        folders: &LIBRARIES,
        names: &["Instant", "SystemTime"],
        rule: "a library crate reads no clock",
        next: "take the time as an argument, and read the clock in crates/cli",
    },
    Ban {
        folders: &LIBRARIES,
        names: &["thread"],
        rule: "a library crate starts no thread",
        next: "use the ordered loops of crates/filter/src/threads/parallel.rs, on threads that the caller chose",
    },
    Ban {
        folders: &["crates/testbed/src/rig/"],
        names: &[
            "Dynamics",
            "StepInput",
            "StepProblem",
            "StepWork",
            "Solver",
            "solve",
            "Ncp",
        ],
        rule: "the rig shares no stepping code with the filter that it judges",
        next: "write the physics anew in the rig, or run the model in crates/testbed/src/model.rs",
    },
];

/// Every Rust file against the rules; of Python files only the length.
pub fn check(tree: &Tree) -> Vec<Finding> {
    let python = tree
        .texts(".py")
        .flat_map(|(path, text)| too_long(text).map(|wrong| finding(path, wrong)));
    tree.texts(".rs")
        .flat_map(|(path, text)| check_file(path, text))
        .chain(python)
        .collect()
}

/// A fault in a file: the line, the rule, what to do.
type Wrong = (usize, String, &'static str);

fn check_file(path: &str, text: &str) -> Vec<Finding> {
    let mut wrong: Vec<Wrong> = too_long(text).into_iter().collect();
    if !UNSAFE_ALLOWED.iter().any(|(allowed, _)| *allowed == path) {
        wrong.extend(unsafe_code(&code_only(text)));
    }
    if let Some((_, file)) = path.split_once("/src/") {
        let code = code_only(without_tests(text));
        wrong.extend(banned_names(path, &code));
        if file != "lib.rs" && LIBRARIES.iter().any(|folder| path.starts_with(folder)) {
            wrong.extend(own_face(file, &code));
        }
    }
    wrong
        .into_iter()
        .map(|wrong| finding(path, wrong))
        .collect()
}

fn finding(path: &str, (line, rule, next): Wrong) -> Finding {
    Finding {
        file: path.to_string(),
        line,
        rule,
        next: next.to_string(),
    }
}

fn too_long(text: &str) -> Option<Wrong> {
    let lines = text.lines().count();
    (lines > LONGEST_FILE).then(|| {
        let rule = format!("{lines} lines; a file has at most {LONGEST_FILE}");
        let next = "split it: one noun per file, named after it";
        (LONGEST_FILE + 1, rule, next)
    })
}

fn unsafe_code(code: &str) -> Vec<Wrong> {
    let rule = "`unsafe` in a file that is not allowed it";
    let next =
        "do without, or add the file and the reason to UNSAFE_ALLOWED in xtask/src/sources.rs";
    names(code)
        .filter(|(_, name)| *name == "unsafe")
        .map(|(line, _)| (line, rule.to_string(), next))
        .collect()
}

fn banned_names(path: &str, code: &str) -> Vec<Wrong> {
    let here = |ban: &&Ban| ban.folders.iter().any(|folder| path.starts_with(folder));
    let mut wrong = Vec::new();
    for ban in BANS.iter().filter(here) {
        for (line, name) in names(code).filter(|(_, name)| ban.names.contains(name)) {
            wrong.push((line, format!("`{name}`: {}", ban.rule), ban.next));
        }
    }
    wrong
}

/// Names that a file takes from its crate's `lib.rs` instead of from where they are.
fn own_face(file: &str, code: &str) -> Vec<Wrong> {
    let module = module_of(file);
    let segments: Vec<&str> = module.split('/').collect();
    let faced = |(line, name): (usize, String)| {
        name.starts_with(char::is_uppercase).then(|| {
            let rule = format!("`crate::{name}` goes through the crate's own face");
            (line, rule, "import it from the file that it is in")
        })
    };
    own_paths(code, &segments)
        .into_iter()
        .filter_map(faced)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        check_file(path, text)
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    #[track_caller]
    fn assert_one(found: &[String], start: &str) {
        assert!(found.len() == 1 && found[0].starts_with(start), "{found:?}");
    }

    #[test]
    fn check_file_finds_files_clocks_and_threads_in_libraries() {
        for (line, name) in [
            ("use std::fs;", "fs"),
            ("use std::{io, fs::File as F};", "fs"),
            ("let t = std::time::Instant::now();", "Instant"),
            ("use std::time::SystemTime;", "SystemTime"),
            ("std::thread::spawn(f);", "thread"),
        ] {
            for folder in LIBRARIES {
                let found = found(&format!("{folder}src/a.rs"), &format!("\n{line}\n"));
                assert!(
                    found
                        .iter()
                        .any(|f| f.starts_with(&format!("{folder}src/a.rs:2: `{name}`"))),
                    "{line}: {found:?}"
                );
            }
            assert!(found("crates/cli/src/main.rs", line).is_empty(), "{line}");
        }
    }

    #[test]
    fn check_file_finds_the_filter_s_stepping_in_the_rig_only() {
        let line = "let mut work = StepWork::<1>::default();";
        assert_one(
            &found("crates/testbed/src/rig/machine.rs", line),
            "crates/testbed/src/rig/machine.rs:1: `StepWork`",
        );
        assert!(found("crates/testbed/src/model.rs", line).is_empty());
    }

    #[test]
    fn check_file_lets_comments_strings_and_tests_be() {
        let text = "//! Never std::fs.\nlet x = \"std::fs\";\n#[cfg(test)]\nmod tests {\n    use std::fs;\n}\n";
        assert!(found("crates/formats/src/a.rs", text).is_empty());
        assert!(found("crates/formats/tests/a.rs", "use std::fs;").is_empty());
    }

    #[test]
    fn check_file_finds_imports_through_the_crate_s_own_face() {
        for (line, name) in [
            ("use crate::Pose;", "Pose"),
            ("use crate::{se2::Twist, Shape as S};", "Shape"),
            ("fn f(setup: &crate::Setup) {}", "Setup"),
            ("use crate::{BLOCK, parallel};", "BLOCK"),
        ] {
            assert_one(
                &found("crates/filter/src/a/b.rs", line),
                &format!("crates/filter/src/a/b.rs:1: `crate::{name}`"),
            );
            assert!(found("crates/cli/src/a.rs", line).is_empty(), "{line}");
        }
        let own = "use crate::se2::Pose;\nuse super::Twist;\n#[cfg(test)]\nmod tests {\n use crate::Pose;\n}\n";
        assert!(found("crates/filter/src/a/b.rs", own).is_empty());
    }

    #[test]
    fn check_file_finds_long_files() {
        for path in ["crates/cli/src/a.rs", "crates/cli/tests/a.rs"] {
            assert!(found(path, &"\n".repeat(LONGEST_FILE)).is_empty());
            let start = format!("{path}:451: 451 lines");
            assert_one(&found(path, &"\n".repeat(LONGEST_FILE + 1)), &start);
        }
    }

    #[test]
    fn check_file_finds_unsafe_anywhere_in_code() {
        for path in [
            "crates/cli/src/a.rs",
            "crates/filter/tests/a.rs",
            "xtask/src/a.rs",
        ] {
            assert_one(
                &found(path, "// unsafe\nunsafe { f() }\n"),
                &format!("{path}:2: `unsafe`"),
            );
        }
        assert!(found("crates/cli/src/a.rs", "#![forbid(unsafe_code)]").is_empty());
    }
}
