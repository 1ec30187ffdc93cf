//! What Rust sources must not name, and how long they may be.

use crate::finding::Finding;
use crate::rust_text::{code_only, names, without_tests};
use crate::tree::Tree;

/// Lines that a file under `src` may have without its tests.
const LONGEST_FILE: usize = 400;

/// Files that may hold `unsafe`, each with its reason; none so far.
const UNSAFE_ALLOWED: [(&str, &str); 0] = [];

/// Libraries: pure functions of their input.
const LIBRARIES: [&str; 8] = [
    "crates/dynamics/",
    "crates/filter/",
    "crates/estimator/",
    "crates/formats/",
    "crates/rendering/",
    "crates/report/",
    "crates/testbed/",
    "crates/vision/",
];

/// Names that a crate's `src` must not contain outside tests and comments.
struct Ban {
    folders: &'static [&'static str],
    names: &'static [&'static str],
    rule: &'static str,
    next: &'static str,
}

const BANS: [Ban; 6] = [
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
        next: "use the ordered loops of crates/filter/src/parallel.rs, on threads that the caller chose",
    },
    Ban {
        folders: &["crates/dynamics/"],
        names: &["rand", "rand_core", "rand_distr"],
        rule: "dynamics draws no random number",
        next: "take the noise as an impulse, and draw it in crates/estimator",
    },
    Ban {
        folders: &["crates/dynamics/"],
        names: &["rayon"],
        rule: "dynamics knows no threads",
        next: "step one block of particles, and share blocks among threads in crates/filter",
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

/// Every Rust file against the rules.
pub fn check(tree: &Tree) -> Vec<Finding> {
    tree.texts(".rs")
        .flat_map(|(path, text)| check_file(path, text))
        .collect()
}

fn check_file(path: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut found = |line, rule: String, next: &str| {
        findings.push(Finding {
            file: path.to_string(),
            line,
            rule,
            next: next.to_string(),
        });
    };

    if !UNSAFE_ALLOWED.iter().any(|(allowed, _)| *allowed == path) {
        for (line, _) in names(&code_only(text)).filter(|(_, name)| *name == "unsafe") {
            found(
                line,
                "`unsafe` in a file that is not allowed it".to_string(),
                "do without, or add the file and the reason to UNSAFE_ALLOWED in xtask/src/sources.rs",
            );
        }
    }

    if !path.contains("/src/") {
        return findings;
    }
    let body = without_tests(text);
    let lines = body.lines().count();
    if lines > LONGEST_FILE {
        let rule = format!("{lines} lines without tests; a file has at most {LONGEST_FILE}");
        found(
            LONGEST_FILE + 1,
            rule,
            "split it: one noun per file, named after it",
        );
    }
    let code = code_only(body);
    for ban in BANS
        .iter()
        .filter(|ban| ban.folders.iter().any(|folder| path.starts_with(folder)))
    {
        for (line, name) in names(&code).filter(|(_, name)| ban.names.contains(name)) {
            found(line, format!("`{name}`: {}", ban.rule), ban.next);
        }
    }
    findings
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
    fn check_file_finds_randomness_and_threads_in_dynamics_only() {
        for line in ["use rand::Rng;", "rayon::join(a, b);"] {
            assert_one(
                &found("crates/dynamics/src/a.rs", line),
                "crates/dynamics/src/a.rs:1: ",
            );
            assert!(found("crates/filter/src/a.rs", line).is_empty());
        }
    }

    #[test]
    fn check_file_finds_the_filter_s_stepping_in_the_rig_only() {
        let line = "let mut work = StepWork::<1>::default();";
        assert_one(
            &found("crates/testbed/src/rig/state.rs", line),
            "crates/testbed/src/rig/state.rs:1: `StepWork`",
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
    fn check_file_finds_long_files_but_not_long_tests() {
        let tests = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", "\n".repeat(500));
        assert!(found("crates/cli/src/a.rs", &("\n".repeat(LONGEST_FILE) + &tests)).is_empty());
        assert_one(
            &found(
                "crates/cli/src/a.rs",
                &("\n".repeat(LONGEST_FILE + 1) + &tests),
            ),
            "crates/cli/src/a.rs:401: 401 lines",
        );
        assert!(found("crates/cli/tests/a.rs", &"\n".repeat(500)).is_empty());
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
