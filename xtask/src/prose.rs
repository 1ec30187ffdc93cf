//! Readable prose: sentences, lines and words in documents and doc comments.
//!
//! A sentence has at most 40 words and a line at most 100 columns. Words that the project replaces
//! by the field's terms do not occur. Code, tables, headings and the targets of links do not count.

use crate::finding::Finding;
use crate::tree::Tree;

/// Words in a sentence, at most.
const LONGEST_SENTENCE: usize = 40;

/// Columns in a line, at most.
const LONGEST_LINE: usize = 100;

/// Files that are exempt, by the start of their path.
const EXEMPT: [&str; 1] = ["docs/log/"];

/// Section of `docs/method.md` that is exempt: from its heading to the next of the same level.
const EXEMPT_SECTION: (&str, &str) = ("docs/method.md", "## Contact mode");

/// Phrases that do not occur, in lower case, and the term in their place.
const REPLACED: [(&str, &str); 20] = [
    ("told", "nominal, configured or prior"),
    ("anew", "again, or `resampled from the prior`"),
    ("beside", "next to, with"),
    ("nobody", "no one, or say what happens"),
    ("in the dark", "while the camera is off, occluded"),
    ("goes dark", "the camera turns off"),
    ("is dark", "is off, is occluded"),
    ("dark rows", "occluded rows"),
    ("blackout", "occlusion"),
    ("the camera looks", "the camera is on, sees"),
    ("believes", "estimates"),
    ("believed", "estimated, accepted"),
    ("surely wrong", "overconfident"),
    ("comes to", "equals"),
    ("gives way", "yields"),
    ("give way", "yield"),
    ("gave way", "yielded"),
    ("thins out", "loses diversity"),
    ("made again", "recomputed"),
    ("paper mode", "paper's model"),
];

/// Openings that a doc comment does not have: it begins with a noun phrase or a verb.
const OPENINGS: [&str; 3] = ["What ", "Whether ", "The same "];

/// Every document and every doc comment.
pub fn check(tree: &Tree) -> Vec<Finding> {
    let documents = tree
        .texts(".md")
        .map(|(path, text)| (path, document(path, text)));
    let comments = tree
        .texts(".rs")
        .map(|(path, text)| (path, doc_comments(text)));
    let openings = tree
        .texts(".rs")
        .flat_map(|(path, text)| openings(path, text));
    documents
        .chain(comments)
        .filter(|(path, _)| !EXEMPT.iter().any(|exempt| path.starts_with(exempt)))
        .flat_map(|(path, lines)| wrong(path, &lines))
        .chain(openings)
        .collect()
}

/// Doc comments that begin as none does.
fn openings(path: &str, text: &str) -> Vec<Finding> {
    let lines: Vec<Line<'_>> = doc_comments(text);
    let before = std::iter::once("").chain(lines.iter().map(|line| line.text));
    let first = before.zip(&lines).filter(|(before, _)| before.is_empty());
    let wrong = first.filter_map(|(_, line)| {
        let opening = OPENINGS
            .iter()
            .find(|opening| line.text.trim_start().starts_with(**opening))?;
        Some(Finding {
            file: path.to_string(),
            line: line.number,
            rule: format!("a doc comment that begins with \"{}\"", opening.trim_end()),
            next: "begin with a noun phrase or a verb in the third person".to_string(),
        })
    });
    wrong.collect()
}

/// A line of prose: its number, its columns in the file, its text; empty text ends a paragraph.
struct Line<'a> {
    number: usize,
    columns: usize,
    text: &'a str,
}

/// Lines of a document, the exempt section and front matter left out.
fn document<'a>(path: &str, text: &'a str) -> Vec<Line<'a>> {
    let mut exempt = false;
    let lines = text.lines().enumerate().map(|(index, line)| {
        if path == EXEMPT_SECTION.0 && line.starts_with("## ") {
            exempt = line == EXEMPT_SECTION.1;
        }
        Line {
            number: index + 1,
            columns: if exempt { 0 } else { line.chars().count() },
            text: if exempt { "" } else { line },
        }
    });
    lines.collect()
}

/// Lines of the doc comments of a Rust file; code between them ends a paragraph.
fn doc_comments(text: &str) -> Vec<Line<'_>> {
    let lines = text.lines().enumerate().map(|(index, line)| {
        let bare = line.trim_start();
        let doc = bare.strip_prefix("///").or(bare.strip_prefix("//!"));
        Line {
            number: index + 1,
            columns: doc.map_or(0, |_| line.chars().count()),
            text: doc.unwrap_or(""),
        }
    });
    lines.collect()
}

/// Faults in the lines of one file.
fn wrong(path: &str, lines: &[Line<'_>]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut add = |line: usize, rule: String, next: &str| {
        findings.push(Finding {
            file: path.to_string(),
            line,
            rule,
            next: next.to_string(),
        });
    };
    let mut paragraph = String::new();
    let mut start = 0;
    let mut fenced = false;
    for line in lines {
        let text = line.text.trim();
        let fence = text.starts_with("```") || text == "$$";
        fenced ^= fence;
        let table = text.starts_with('|');
        if fence || fenced || table || text.is_empty() || text.starts_with(['#', '<', '!']) {
            if table {
                replaced(&plain(text), line.number, &mut add);
            }
            finish(&mut paragraph, start, &mut add);
            continue;
        }
        let linked = text.contains("](") || text.contains("http");
        if line.columns > LONGEST_LINE && !linked {
            let rule = format!(
                "{} columns; a line has at most {LONGEST_LINE}",
                line.columns
            );
            add(line.number, rule, "wrap it");
        }
        if is_item(text) {
            finish(&mut paragraph, start, &mut add);
        }
        if paragraph.is_empty() {
            start = line.number;
        }
        paragraph.push(' ');
        paragraph.push_str(item_text(text));
    }
    finish(&mut paragraph, start, &mut add);
    findings
}

/// Sentences and words of the paragraph that began at line `start`; empties it.
fn finish(paragraph: &mut String, start: usize, add: &mut impl FnMut(usize, String, &str)) {
    let text = plain(paragraph);
    paragraph.clear();
    replaced(&text, start, add);
    for sentence in sentences(&text) {
        let words = sentence
            .split_whitespace()
            .filter(|word| word.contains(char::is_alphanumeric))
            .count();
        if words > LONGEST_SENTENCE {
            let first: Vec<&str> = sentence.split_whitespace().take(5).collect();
            let rule = format!(
                "a sentence of {words} words, \"{} …\"; a sentence has at most {LONGEST_SENTENCE}",
                first.join(" ")
            );
            add(start, rule, "split it: one claim a sentence");
        }
    }
}

/// Replaced phrases in plain text.
fn replaced(text: &str, line: usize, add: &mut impl FnMut(usize, String, &str)) {
    let words: Vec<String> = text
        .split_whitespace()
        .map(|word| {
            word.trim_matches(|c: char| !c.is_alphanumeric())
                .to_lowercase()
        })
        .collect();
    let text = format!(" {} ", words.join(" "));
    for (phrase, term) in REPLACED {
        if text.contains(&format!(" {phrase} ")) {
            let rule = format!("\"{phrase}\" is not a term of the field");
            add(line, rule, &format!("write: {term}"));
        }
    }
}

/// Sentences of plain text. They end at a full stop, a question mark, an exclamation mark, or a
/// colon that a capital or a code span follows.
fn sentences(text: &str) -> Vec<&str> {
    let mut sentences = Vec::new();
    let mut from = 0;
    let ends = text.match_indices(['.', '?', '!', ':']);
    for (at, end) in ends {
        let after = &text[at + end.len()..];
        let next = after.trim_start().chars().next();
        let begins = next.is_some_and(|c| c.is_uppercase() || "\"“([`".contains(c));
        if after.starts_with([' ', ')', '"']) && begins {
            sentences.push(text[from..=at].trim());
            from = at + end.len();
        }
    }
    sentences.push(text[from..].trim());
    sentences
}

/// Text with each code span as one word, and links by their words alone.
fn plain(text: &str) -> String {
    let spans = text.split('`').enumerate();
    let text: String = spans
        .map(|(index, part)| if index % 2 == 1 { "x" } else { part })
        .collect();
    let formulas = text.split('$').enumerate();
    let text: String = formulas
        .map(|(index, part)| if index % 2 == 1 { "x" } else { part })
        .collect();
    let mut bare = String::new();
    let mut rest = text.as_str();
    while let Some((before, after)) = rest.split_once("](") {
        bare.push_str(before);
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    bare.push_str(rest);
    bare.replace(['[', ']', '*', '_'], "")
}

/// Returns true if a line begins an item of a list.
fn is_item(text: &str) -> bool {
    item_text(text).len() < text.len()
}

/// The text of a line, the mark of a list's item left out.
fn item_text(text: &str) -> &str {
    let digits = text.trim_start_matches(|c: char| c.is_ascii_digit());
    let numbered = (digits.len() < text.len())
        .then(|| digits.strip_prefix(". "))
        .flatten();
    ["- ", "* ", "+ "]
        .iter()
        .find_map(|mark| text.strip_prefix(mark))
        .or(numbered)
        .unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        check(&Tree::from([(path, text)]))
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    /// A sentence, wrapped after each tenth word.
    fn words(count: usize) -> String {
        let word = |k: usize| {
            if k.is_multiple_of(10) {
                "\nword"
            } else {
                " word"
            }
        };
        let rest: String = (1..count).map(word).collect();
        format!("A{rest}.")
    }

    #[test]
    fn check_counts_the_words_of_a_sentence_over_lines() {
        assert!(found("a.md", &words(40)).is_empty());
        let long = found("a.md", &words(41));
        assert!(long.len() == 1 && long[0].contains("41 words"), "{long:?}");
        assert!(found("a.md", &format!("{} {}", words(30), words(30))).is_empty());
        assert!(found("a.md", &format!("- {}\n- {}", words(30), words(30))).is_empty());
    }

    #[test]
    fn check_finds_long_lines_outside_tables_code_and_links() {
        let long = "word ".repeat(21);
        assert_eq!(found("a.md", &long).len(), 1);
        for text in [
            format!("| {long} |"),
            format!("```\n{long}\n```"),
            format!("$$\n{long}\n$$"),
            format!("{long}[a](b)"),
        ] {
            assert!(found("a.md", &text).is_empty(), "{text}");
        }
        assert_eq!(found("a.rs", &format!("/// {long}\nfn f() {{}}")).len(), 1);
        assert!(found("a.rs", &format!("// {long}\nfn f() {{}}")).is_empty());
    }

    #[test]
    fn check_finds_replaced_words_and_leaves_code_be() {
        assert_eq!(found("a.md", "Friction is told.").len(), 1);
        assert_eq!(found("a.md", "| the camera goes dark |").len(), 1);
        assert_eq!(found("a.rs", "//! Draws it\n//! Anew.").len(), 1);
        for text in ["`told`", "foretold", "```\ntold\n```"] {
            assert!(found("a.md", text).is_empty(), "{text}");
        }
    }

    #[test]
    fn check_finds_comments_that_begin_with_a_clause() {
        assert_eq!(found("a.rs", "/// Whether it is.\nfn f() {}").len(), 1);
        assert_eq!(
            found("a.rs", "/// One.\n/// What follows.\nfn f() {}").len(),
            0
        );
    }

    #[test]
    fn check_leaves_logs_and_the_default_model_of_the_method_be() {
        assert!(found("docs/log/a.md", "told").is_empty());
        let method = "## Contact mode\ntold\n### A\ntold\n## Scores\ntold";
        let found = found("docs/method.md", method);
        assert!(
            found.len() == 1 && found[0].starts_with("docs/method.md:6"),
            "{found:?}"
        );
    }
}
