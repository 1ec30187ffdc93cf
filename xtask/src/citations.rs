//! Checks that citations in sources and documents exist: equations and sections of the method and
//! the robust model, sections of the formats, decisions, links between documents.
//!
//! `docs/method.md (7)` and `docs/model.md (33)` cite an equation, `docs/method.md, "Jamming"` a
//! section, `docs/decisions/004...` or `decision 004` a decision; `paper eq. 3` is the paper's own
//! number. The equations of both documents are numbered together. An equation is a line with
//! `\tag{7}`, or one of a block marked `text` that ends with its number.

use crate::finding::Finding;
use crate::rust_text::names;
use crate::tree::Tree;

const METHOD: &str = "docs/method.md";
const MODEL: &str = "docs/model.md";

/// A numbered equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Equation {
    number: usize,
    document: &'static str,
    line: usize,
}

/// Every citation in Rust files and documents.
pub fn check(tree: &Tree) -> Vec<Finding> {
    let method = tree.text(METHOD).unwrap_or_default();
    let mut equations = equations(METHOD, method);
    let model = tree.text(MODEL).unwrap_or_default();
    equations.extend(self::equations(MODEL, model));
    equations.sort_unstable();
    let mut findings: Vec<Finding> = misnumbered(&equations).into_iter().collect();
    findings.extend(missing_names(tree, method));
    let known = Known { tree, equations };
    let mut add = |path: &str, text: &str, wrong: Vec<Wrong>| {
        for (at, rule, next) in wrong {
            let line = text[..at].matches('\n').count() + 1;
            findings.push(finding(path, line, rule, next));
        }
    };
    let own = |path: &str| path.starts_with("xtask/");
    for (path, source) in tree.texts(".rs").filter(|(path, _)| !own(path)) {
        let text = comments_of(source);
        add(path, &text, known.wrong(&text));
        add(path, &text, known.wrong_in_comments(&text));
    }
    add(METHOD, method, known.wrong_numbers(method));
    add(MODEL, model, known.wrong_numbers(model));
    for (path, text) in tree.texts(".md") {
        add(path, text, known.wrong(text));
        add(path, text, known.wrong_links(path, text));
    }
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

/// A document's equations, in the order of the text.
fn equations(document: &'static str, text: &str) -> Vec<Equation> {
    let equation = |number, index| Equation {
        number,
        document,
        line: index + 1,
    };
    let mut equations = Vec::new();
    let mut inside = false;
    for (index, line) in text.lines().enumerate() {
        if line.starts_with("```") {
            inside = line == "```text";
            continue;
        }
        let tag = line
            .split_once("\\tag{")
            .and_then(|(_, rest)| rest.split_once('}'));
        if let Some(number) = tag.and_then(|(n, _)| n.parse().ok()) {
            equations.push(equation(number, index));
            continue;
        }
        let bare = match line.rfind("[paper") {
            Some(at) => &line[..at],
            None => line,
        };
        let bracket = bare
            .trim_end()
            .strip_suffix(')')
            .and_then(|rest| rest.rsplit_once('('));
        if let Some(number) = bracket.and_then(|(_, n)| n.parse().ok()).filter(|_| inside) {
            equations.push(equation(number, index));
        }
    }
    equations
}

/// The first of these sorted equations that is out of order.
fn misnumbered(equations: &[Equation]) -> Option<Finding> {
    let (wrong, expected) = equations
        .iter()
        .zip(1..)
        .find(|(equation, expected)| equation.number != *expected)?;
    let rule = format!(
        "equation ({}) where ({expected}) is missing or used twice",
        wrong.number
    );
    let next = "number the equations of docs/method.md and docs/model.md from 1 without gaps";
    Some(finding(wrong.document, wrong.line, rule, next))
}

/// Names in the method's tables that the file named last in their row does not hold.
fn missing_names(tree: &Tree, method: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, line) in method
        .lines()
        .enumerate()
        .filter(|(_, line)| line.starts_with('|'))
    {
        let words: Vec<&str> = line.split('`').skip(1).step_by(2).collect();
        let Some((file, named)) = words.split_last() else {
            continue;
        };
        let Some(text) = tree.text(file).filter(|_| file.ends_with(".rs")) else {
            continue;
        };
        for (_, name) in named.iter().flat_map(|name| names(name)) {
            if !names(text).any(|(_, found)| found == name) {
                let rule = format!("`{file}` does not hold `{name}`");
                findings.push(finding(METHOD, index + 1, rule, "name what is there now"));
            }
        }
    }
    findings
}

/// The comments of Rust source, the rest blank, so that a citation may run over lines; no line
/// moves.
fn comments_of(source: &str) -> String {
    let comment = |line: &str| {
        let text = line.trim_start();
        text.starts_with("//")
            .then(|| text.trim_start_matches(['/', '!']).to_string())
    };
    let texts: Vec<String> = source
        .lines()
        .map(|line| comment(line).unwrap_or_default())
        .collect();
    texts.join("\n")
}

/// Targets that can be cited.
struct Known<'a> {
    tree: &'a Tree,
    equations: Vec<Equation>,
}

/// A wrong citation: where it stands, the rule, what to do.
type Wrong = (usize, String, &'static str);

impl Known<'_> {
    /// Wrong citations of any text.
    fn wrong(&self, text: &str) -> Vec<Wrong> {
        let mut wrong = self.wrong_decisions(text);
        for document in [METHOD, MODEL] {
            let has = |number: &usize| {
                let mut equations = self.equations.iter();
                equations.any(|e| e.number == *number && e.document == document)
            };
            for (at, after) in occurrences(text, document) {
                let unknown = numbers(after).filter(|number| !has(number));
                wrong.extend(unknown.map(|number| {
                    let rule = format!("{document} has no equation ({number})");
                    (at, rule, "cite one that is there")
                }));
            }
        }
        for document in [METHOD, MODEL, "docs/guide/formats.md"] {
            let titles: Vec<&str> = self.titles(document).collect();
            for (at, after) in occurrences(text, document) {
                let title = quoted(after).filter(|title| !titles.contains(&title.as_str()));
                wrong.extend(title.map(|title| {
                    let rule = format!("{document} has no section \"{title}\"");
                    (at, rule, "cite one that is there")
                }));
            }
        }
        wrong
    }

    /// Numbers in brackets that no equation has, in a document with equations.
    fn wrong_numbers(&self, text: &str) -> Vec<Wrong> {
        let number = |after: &str| after.split(')').next()?.parse::<usize>().ok();
        let unknown = |(at, after)| {
            let number = number(after).filter(|n| !(1..=self.equations.len()).contains(n))?;
            let rule = format!("there is no equation ({number})");
            Some((at, rule, "name one that is there"))
        };
        occurrences(text, "(").filter_map(unknown).collect()
    }

    fn wrong_decisions(&self, text: &str) -> Vec<Wrong> {
        let mut wrong = Vec::new();
        for start in ["docs/decisions/", "decision "] {
            for (at, after) in occurrences(text, start) {
                let number: String = after.chars().take_while(char::is_ascii_digit).collect();
                if number.len() == 3 && !self.has_decision(&number) {
                    let rule = format!("there is no docs/decisions/{number}-...md");
                    wrong.push((at, rule, "cite one that is there, or write it"));
                }
            }
        }
        wrong
    }

    /// Wrong citations of comments besides: documents and equations from elsewhere.
    fn wrong_in_comments(&self, text: &str) -> Vec<Wrong> {
        let mut wrong = Vec::new();
        for (at, after) in occurrences(text, "eq. ") {
            let number = after.trim_start_matches('(');
            if number.starts_with(|c: char| c.is_ascii_digit())
                && !text[..at].trim_end().ends_with("paper")
            {
                let rule = "an equation without its document".to_string();
                wrong.push((at, rule, "cite docs/method.md (n), or say `paper eq. n`"));
            }
        }
        for (at, word) in words(text).filter(|(_, word)| word.ends_with(".md")) {
            if !self.tree.exists(word) {
                let rule = format!("`{word}` is not in the repository");
                wrong.push((at, rule, "cite a document by its path from the root"));
            }
        }
        wrong
    }

    fn titles(&self, document: &str) -> impl Iterator<Item = &str> {
        let text = self.tree.text(document).unwrap_or_default();
        text.lines().filter_map(heading)
    }

    fn has_decision(&self, number: &str) -> bool {
        let start = format!("docs/decisions/{number}-");
        self.tree
            .texts(".md")
            .any(|(path, _)| path.starts_with(&start))
    }

    /// Links of a document: the file must be there, and the heading in it.
    fn wrong_links(&self, path: &str, text: &str) -> Vec<Wrong> {
        let mut wrong = Vec::new();
        for (at, after) in occurrences(text, "](") {
            // the site's API reference is made of the package and the crates
            let elsewhere = |target: &&str| target.contains("://") || target.starts_with("../api/");
            let target = after.split(')').next();
            let Some(target) = target.filter(|target| !elsewhere(target)) else {
                continue;
            };
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = match file {
                "" => path.to_string(),
                file => resolved(path, file),
            };
            let there = anchor.is_empty() || self.titles(&file).any(|title| slug(title) == anchor);
            if !there || !self.tree.exists(&file) {
                let rule = format!("the link to `{target}` leads nowhere");
                wrong.push((at, rule, "link what is there now"));
            }
        }
        wrong
    }
}

/// Positions of `word`, each with the text that follows it, blanks left out.
fn occurrences<'a>(text: &'a str, word: &str) -> impl Iterator<Item = (usize, &'a str)> {
    let length = word.len();
    text.match_indices(word)
        .map(move |(at, _)| (at, text[at + length..].trim_start()))
}

/// The numbers of `(7), (8) and (9) to (11)`.
fn numbers(text: &str) -> impl Iterator<Item = usize> {
    let mut rest = text;
    std::iter::from_fn(move || {
        for joint in [",", "to ", "and "] {
            rest = rest.trim_start().strip_prefix(joint).unwrap_or(rest);
        }
        let (number, after) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
        rest = after;
        number.parse().ok()
    })
}

/// Words that may be paths, with where they stand.
fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let apart = |c: char| !(c.is_alphanumeric() || "._-/".contains(c));
    let words = text.split(apart).map(|word| word.trim_end_matches('.'));
    words.map(move |word| (word.as_ptr() as usize - text.as_ptr() as usize, word))
}

/// The title of a heading.
fn heading(line: &str) -> Option<&str> {
    line.starts_with('#')
        .then(|| line.trim_start_matches('#').trim())
}

/// The title in `, "..."`, which may run over lines.
fn quoted(text: &str) -> Option<String> {
    let after = text.strip_prefix(',')?.trim_start();
    let title = after.strip_prefix('"')?.split('"').next()?;
    Some(title.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The anchor that a heading gets.
fn slug(title: &str) -> String {
    let kept = title
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// The path from the root of a link in the document `from`.
fn resolved(from: &str, link: &str) -> String {
    let mut folders: Vec<&str> = from.split('/').collect();
    folders.pop();
    for part in link.split('/') {
        match part {
            ".." => drop(folders.pop()),
            "." | "" => {}
            name => folders.push(name),
        }
    }
    folders.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    const THE_METHOD: &str = "# The method\n## Jamming\n```text\na = b (1)  [paper eq. 1]\n```\n$$\nc = d \\tag{2}\n$$\n```algorithm\nstep (1)\n```\n| x | `Pose::advance` | `crates/a/src/lib.rs` |\n";

    fn found(path: &str, text: &str) -> Vec<String> {
        let tree = Tree::from([
            (METHOD, THE_METHOD),
            ("docs/guide/formats.md", "## Scoring a run\n"),
            ("docs/decisions/004-stalled-pusher.md", ""),
            ("crates/a/src/lib.rs", "struct Pose; fn advance() {}"),
            (path, text),
        ]);
        check(&tree).iter().map(Finding::to_string).collect()
    }

    #[test]
    fn check_passes_what_is_there() {
        for line in [
            "//! See docs/method.md (1), (2) and docs/method.md (1) to (2); paper eq. 3.",
            "/// As in docs/method.md\n/// (2), docs/method.md, \"Jamming\", docs/guide/formats.md, \"Scoring a\n/// run\".",
            "// docs/decisions/004-stalled-pusher.md, decision 004; the decision 1 of 2",
            "const GUIDE: &str = include_str!(\"../../../docs/method.md\");",
        ] {
            let found = found("crates/b/src/x.rs", line);
            assert!(found.is_empty(), "{line}: {found:?}");
        }
        let links = "[a](../method.md#jamming), [b](004-stalled-pusher.md), [c](https://a.b/c.md), [d](#top)\n# Top\n";
        let found = found("docs/decisions/005-x.md", links);
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn check_finds_what_is_not_there() {
        for (path, line, word) in [
            (
                "crates/b/src/x.rs",
                "// docs/method.md (1), (3)",
                "no equation (3)",
            ),
            (
                "crates/b/src/x.rs",
                "// docs/method.md\n// (3)",
                "no equation (3)",
            ),
            (
                "crates/b/src/x.rs",
                "// docs/method.md, \"Jam\"",
                "no section \"Jam\"",
            ),
            (
                "crates/b/src/x.rs",
                "// docs/guide/formats.md, \"Scores\"",
                "no section",
            ),
            (
                "crates/b/src/x.rs",
                "// docs/decisions/009",
                "no docs/decisions/009",
            ),
            (
                "crates/b/tests/x.rs",
                "// as decision 009 has it",
                "no docs/decisions/009",
            ),
            (
                "crates/b/src/x.rs",
                "// model.md, \"Jamming\"",
                "`model.md`",
            ),
            (
                "crates/b/src/x.rs",
                "// as in eq. (3)",
                "without its document",
            ),
            ("docs/guide/x.md", "docs/method.md (3)", "no equation (3)"),
            ("docs/guide/x.md", "[x](../method.md#jam)", "leads nowhere"),
            ("docs/guide/x.md", "[x](y.md)", "leads nowhere"),
        ] {
            let found = found(path, line);
            assert!(
                found.len() == 1 && found[0].contains(word),
                "{line}: {found:?}"
            );
            assert!(found[0].starts_with(&format!("{path}:1: ")), "{found:?}");
        }
    }

    #[test]
    fn check_finds_gaps_in_the_numbers_and_names_that_moved() {
        let unknown = THE_METHOD.replace("step (1)", "step (7)");
        let renumbered = THE_METHOD.replace("tag{2}", "tag{3}");
        let moved = THE_METHOD.replace("advance", "retreat");
        for (method, word) in [
            (unknown, "no equation (7)"),
            (renumbered, "(2) is missing"),
            (moved, "`retreat`"),
        ] {
            let found = found(METHOD, &method);
            assert!(found.len() == 1 && found[0].contains(word), "{found:?}");
        }
    }
}
