//! The documents: paths that they name exist, every crate has its section and invariant, the README
//! is short.
//!
//! A path stands in backticks and either begins with a name at the root (`crates/...`), ends in
//! `/`, or has an ending; in fenced blocks only the first counts. Of `name.rs` and `folder/name.rs`
//! there must be a file, in the folder in the heading above where that names one.

use crate::arrows::folders;
use crate::finding::Finding;
use crate::tree::Tree;

const README: &str = "README.md";
const ARCHITECTURE: &str = "ARCHITECTURE.md";

/// Lines of the README, at most.
const README_LINES: usize = 90;

/// Endings by which a slashed word is known as a path.
const ENDINGS: [&str; 8] = ["rs", "md", "toml", "csv", "json", "svg", "png", "txt"];

/// All documents against the rules.
pub fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in [README, ARCHITECTURE] {
        if tree.text(file).is_none() {
            let rule = "there is no such file".to_string();
            findings.push(finding(file, 1, rule, "write it"));
        }
    }
    for (file, text) in tree.texts(".md") {
        if [README, ARCHITECTURE].contains(&file) || file.starts_with("docs/") {
            findings.extend(missing_paths(tree, file, text));
        }
    }
    let lines = tree.text(README).map_or(0, |text| text.lines().count());
    if lines > README_LINES {
        let rule = format!("{lines} lines; the README has at most {README_LINES}");
        findings.push(finding(
            README,
            README_LINES,
            rule,
            "move detail to docs/ or ARCHITECTURE.md",
        ));
    }
    findings.extend(missing_crates(tree.text(ARCHITECTURE).unwrap_or_default()));
    findings
}

fn finding(file: &str, line: usize, rule: String, next: &str) -> Finding {
    Finding {
        file: file.to_string(),
        line,
        rule,
        next: next.to_string(),
    }
}

/// Crates without a heading or without an invariant below it.
fn missing_crates(text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    for folder in folders() {
        let heading = text
            .lines()
            .position(|line| heading_folder(line) == Some(&*folder));
        let Some(at) = heading else {
            findings.push(finding(
                ARCHITECTURE,
                1,
                format!("no heading names `{folder}`"),
                "describe the crate there",
            ));
            continue;
        };
        let mut section = text
            .lines()
            .skip(at + 1)
            .take_while(|line| !line.starts_with('#'));
        if folder.starts_with("crates/") && !section.any(|line| line.contains("**Invariant:**")) {
            findings.push(finding(
                ARCHITECTURE,
                at + 1,
                format!("`{folder}` has no **Invariant:**"),
                "say what it must never do",
            ));
        }
    }
    findings
}

/// The folder that a heading names in backticks.
fn heading_folder(line: &str) -> Option<&str> {
    line.starts_with('#')
        .then(|| line.split('`').nth(1))
        .flatten()
}

fn missing_paths(tree: &Tree, file: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut fenced = false;
    let mut folder = None;
    for (index, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        if !fenced && line.starts_with('#') {
            folder = heading_folder(line);
        }
        let words: Vec<&str> = if fenced {
            line.split_whitespace().collect()
        } else {
            line.split('`').skip(1).step_by(2).collect()
        };
        for path in words
            .into_iter()
            .filter_map(|word| missing(tree, word, fenced, folder))
        {
            let next = "name what is there now, or put it there";
            findings.push(finding(
                file,
                index + 1,
                format!("`{path}` does not exist"),
                next,
            ));
        }
    }
    findings
}

/// The path that a word names, where there is no such file or folder.
fn missing(tree: &Tree, word: &str, fenced: bool, folder: Option<&str>) -> Option<String> {
    let word = word.trim_start_matches("./");
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if word.is_empty()
        || !word.chars().all(plain)
        || word.starts_with('/')
        || word.starts_with("..")
    {
        return None;
    }
    let ending = word.rsplit_once('.').map(|(_, ending)| ending);
    let first = word.split_once('/').map(|(first, _)| first);
    if first.is_some_and(|first| first != "target" && tree.exists(first)) {
        return (!tree.exists(word)).then(|| word.to_string());
    }
    if fenced {
        return None;
    }
    if ending == Some("rs") {
        let there = tree.has_file(folder.unwrap_or_default(), word);
        return (!there).then(|| word.to_string());
    }
    let names_one = match first {
        Some(_) => word.ends_with('/') || ending.is_some_and(|e| ENDINGS.contains(&e)),
        None => ending == Some("md") || word.starts_with("LICENSE"),
    };
    (names_one && !tree.exists(word)).then(|| word.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missing(text: &str) -> Vec<String> {
        let tree = Tree::from([
            ("crates/a/src/lib.rs", ""),
            ("crates/a/src/x/mod.rs", ""),
            ("docs/p.svg", ""),
            ("README.md", ""),
        ]);
        missing_paths(&tree, "README.md", text)
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    #[test]
    fn missing_paths_passes_what_exists_and_what_is_no_path() {
        for text in [
            "`crates/a`, `crates/a/`, `./crates/a/src/lib.rs`, `lib.rs`, `x/mod.rs`",
            "## `crates/a`\nsee `lib.rs`, `mod.rs` and `x/mod.rs-less` speeds of 1 `m/s`, `I/O`, `scene.toml`, `../shared/data`, `/tmp/x.csv`",
            "```\ncargo run -- filter my/log.csv --out out/\ncrates/a/src\n```",
        ] {
            assert!(missing(text).is_empty(), "{:?}", missing(text));
        }
    }

    #[test]
    fn missing_paths_finds_what_is_gone() {
        for text in [
            "\n`crates/b`",
            "\n`crates/a/src/gone.rs`",
            "\n`gone/`",
            "\n`gone/a.md`",
            "\n`GONE.md`",
            "\n`gone.rs`",
            "# `crates/a`\n`gone.rs`",
            "# `docs`\n`lib.rs`",
            "```\ncrates/gone  # a crate\n```",
        ] {
            let found = missing(text);
            assert!(
                found.len() == 1
                    && found[0].starts_with("README.md:2: ")
                    && found[0].to_lowercase().contains("does not exist"),
                "{text}: {found:?}"
            );
        }
    }

    #[test]
    fn check_finds_a_long_readme_and_missing_documents() {
        let long = "\n".repeat(README_LINES + 1);
        let found = check(&Tree::from([("README.md", long.as_str())]));
        assert!(
            found
                .iter()
                .any(|f| f.file == README && f.rule.starts_with("91 lines")),
            "{found:?}"
        );
        assert!(
            found
                .iter()
                .any(|f| f.file == ARCHITECTURE && f.rule == "there is no such file"),
            "{found:?}"
        );
    }

    #[test]
    fn missing_crates_wants_a_heading_and_an_invariant_each() {
        let all: String = folders()
            .map(|folder| format!("### `{folder}`\n**Invariant:** x\n"))
            .collect();
        assert!(missing_crates(&all).is_empty());
        let found = missing_crates(&all.replace(
            "### `crates/filter`\n**Invariant:**",
            "### `crates/filter`\n",
        ));
        assert!(
            found.len() == 1
                && found[0]
                    .rule
                    .contains("`crates/filter` has no **Invariant:**"),
            "{found:?}"
        );
        let found = missing_crates(&all.replace("`crates/cli`", "cli"));
        assert!(
            found.len() == 1 && found[0].rule.contains("`crates/cli`"),
            "{found:?}"
        );
    }
}
