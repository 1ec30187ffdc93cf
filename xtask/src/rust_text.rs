//! Rust source as text: without comments and literals ([`code_only`]), without its tests
//! ([`without_tests`]), its names ([`names`]) and the paths of its own crate ([`own_paths`]).

/// The source with every comment, string and character literal blanked out; lines stay where they
/// are.
pub fn code_only(source: &str) -> String {
    let mut code = String::with_capacity(source.len());
    let mut rest = source;
    let mut after_name = false;
    while let Some(first) = rest.chars().next() {
        let length = if after_name { 0 } else { literal(rest) }
            .max(comment(rest))
            .max(quoted(rest));
        if length > 0 {
            code.extend(
                rest[..length]
                    .chars()
                    .map(|c| if c == '\n' { '\n' } else { ' ' }),
            );
        } else {
            code.push(first);
        }
        after_name = length == 0 && (first.is_alphanumeric() || first == '_');
        rest = &rest[length.max(first.len_utf8())..];
    }
    code
}

/// Bytes of the comment that the text begins with; 0 where it begins with none.
fn comment(text: &str) -> usize {
    if text.starts_with("//") {
        return text.find('\n').unwrap_or(text.len());
    }
    if !text.starts_with("/*") {
        return 0;
    }
    let mut depth = 0;
    let mut at = 0;
    while at < text.len() {
        let (step, change) = match &text.as_bytes()[at..] {
            [b'/', b'*', ..] => (2, 1),
            [b'*', b'/', ..] => (2, -1),
            _ => (1, 0),
        };
        depth += change;
        at += step;
        if depth == 0 {
            break;
        }
    }
    at
}

/// Bytes of the string or character that the text begins with, `"..."` or `'.'`; 0 for none, as for
/// a lifetime.
fn quoted(text: &str) -> usize {
    if let Some(after) = text.strip_prefix('"') {
        return 1 + closing(after, '"');
    }
    let Some(after) = text.strip_prefix('\'') else {
        return 0;
    };
    let mut next = after.chars();
    match (next.next(), next.next()) {
        (Some('\\'), _) => 1 + closing(after, '\''),
        (Some(c), Some('\'')) => 2 + c.len_utf8(),
        _ => 0,
    }
}

/// Bytes of the prefixed literal that the text begins with, `r"..."`, `r#"..."#`, `b"..."`,
/// `br"..."`, `c"..."`, `b'.'`; 0 for none.
fn literal(text: &str) -> usize {
    let prefix = text.len() - text.trim_start_matches(['b', 'c', 'r']).len();
    let after = &text[prefix..];
    if prefix == 0 || prefix > 2 {
        return 0;
    }
    if !text[..prefix].contains('r') {
        let length = quoted(after);
        return if length == 0 { 0 } else { prefix + length };
    }
    let hashes = after.len() - after.trim_start_matches('#').len();
    let Some(content) = after[hashes..].strip_prefix('"') else {
        return 0;
    };
    let end = format!("\"{}", "#".repeat(hashes));
    prefix
        + hashes
        + 1
        + content
            .find(&end)
            .map_or(content.len(), |at| at + end.len())
}

/// Bytes up to and with the closing quote, which is not one behind a backslash.
fn closing(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        if c == quote && !escaped {
            return at + 1;
        }
        escaped = c == '\\' && !escaped;
    }
    text.len()
}

/// The source up to its module of tests: `#[cfg(test)]` with `mod ... {` below it.
pub fn without_tests(source: &str) -> &str {
    let mut start = 0;
    let mut marked = None;
    for line in source.split_inclusive('\n') {
        let text = line.trim();
        if text == "#[cfg(test)]" {
            marked = Some(start);
        } else if text.starts_with("mod ") && text.ends_with('{') && marked.is_some() {
            break;
        } else if !text.starts_with("#[") {
            marked = None;
        }
        start += line.len();
    }
    &source[..marked.unwrap_or(source.len())]
}

/// Every name in code, with its line from 1.
pub fn names(code: &str) -> impl Iterator<Item = (usize, &str)> {
    code.lines().enumerate().flat_map(|(index, line)| {
        let words = line.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        words
            .filter(|word| !word.is_empty())
            .map(move |word| (index + 1, word))
    })
}

/// Every path into the own crate that code names, with its line from 1: `crate::a::B` as `a::B`,
/// `super::c` of module `a::b` as `a::c`, groups taken apart.
pub fn own_paths(code: &str, module: &[&str]) -> Vec<(usize, String)> {
    let mut paths = Vec::new();
    for (word, up) in [("crate::", None), ("super::", Some(1))] {
        for (at, _) in code.match_indices(word) {
            let before = code[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || "_:$".contains(c)) {
                continue;
            }
            let (mut rest, mut keep) = (&code[at + word.len()..], 0);
            if let Some(up) = up {
                let more = rest.len() - rest.trim_start_matches("super::").len();
                rest = &rest[more..];
                keep = module.len().saturating_sub(up + more / "super::".len());
            }
            let line = code[..at].matches('\n').count() + 1;
            let prefix = if keep > 0 {
                module[..keep].join("::") + "::"
            } else {
                String::new()
            };
            let mut found = Vec::new();
            leaves(rest, &prefix, &mut found);
            paths.extend(found.into_iter().map(|path| (line, path)));
        }
    }
    paths.sort();
    paths
}

/// Adds the paths that begin `text`, a path or a group in braces; returns the text that follows
/// them.
fn leaves<'a>(text: &'a str, prefix: &str, paths: &mut Vec<String>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = rest.trim_start().trim_start_matches(',').trim_start();
            if let Some(after) = rest.strip_prefix('}') {
                return after;
            }
            let before = rest.len();
            rest = leaves(rest, prefix, paths);
            if rest.len() == before {
                return rest;
            }
        }
    }
    let end = text
        .find(|c: char| !(c.is_alphanumeric() || c == '_'))
        .unwrap_or(text.len());
    let (name, mut rest) = text.split_at(end);
    if let Some(more) = rest.strip_prefix("::") {
        if more.starts_with(|c: char| c.is_alphabetic() || "_{".contains(c)) {
            return leaves(more, &format!("{prefix}{name}::"), paths);
        }
        rest = more.trim_start_matches('*');
    }
    if !name.is_empty() {
        paths.push(format!("{prefix}{name}"));
    }
    match rest.strip_prefix(" as ") {
        Some(alias) => alias.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_'),
        None => rest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(source: &str) -> Vec<&str> {
        source.split_whitespace().collect()
    }

    #[test]
    fn code_only_blanks_comments_and_keeps_lines() {
        let code = code_only("a // fs\n/* fs /* fs */ fs\n*/ b /// fs\nc");
        assert_eq!(kept(&code), ["a", "b", "c"]);
        assert_eq!(code.lines().count(), 4);
    }

    #[test]
    fn code_only_blanks_literals() {
        for literal in [
            r#""fs \" fs""#,
            r##"r#"fs " fs"#"##,
            r#"b"fs""#,
            "br\"fs\"",
            "'f'",
            r"'\''",
            "'\\u{66}'",
            r"b'\\'",
            "\"\\\\\"",
            "'\"'",
        ] {
            assert_eq!(
                kept(&code_only(&format!("a {literal} b"))),
                ["a", "b"],
                "{literal}"
            );
        }
    }

    #[test]
    fn code_only_keeps_lifetimes_and_raw_names() {
        assert_eq!(
            code_only("fn f<'a>(x: &'a str, y: &'static T)"),
            "fn f<'a>(x: &'a str, y: &'static T)"
        );
        assert_eq!(code_only("r#type + br + cr"), "r#type + br + cr");
        assert_eq!(kept(&code_only("number\"fs\"")), ["number"]);
    }

    #[test]
    fn without_tests_ends_at_the_module_of_tests_only() {
        assert_eq!(
            without_tests("a\n#[cfg(test)]\n#[allow(x)]\nmod tests {\n b\n}\n"),
            "a\n"
        );
        let helper = "a\n#[cfg(test)]\nfn f() {}\nb\n";
        assert_eq!(without_tests(helper), helper);
    }

    #[test]
    fn names_come_with_their_lines() {
        assert_eq!(
            names("a::b\nc_1(d)").collect::<Vec<_>>(),
            [(1, "a"), (1, "b"), (2, "c_1"), (2, "d")]
        );
    }

    #[test]
    fn own_paths_are_taken_apart_and_resolved() {
        let code = "use crate::a::{b::C, d as e, self};\nuse crate::{F,\n g::*};\nx.y(super::h::i(1));\nuse std::crate_::no; $crate::no!();";
        let found = own_paths(code, &["m", "n"]);
        let expected = ["a::b::C", "a::d", "a::self", "F", "g", "m::h::i"];
        let lines = [1, 1, 1, 2, 2, 4];
        let mut expected: Vec<(usize, String)> = lines
            .into_iter()
            .zip(expected.map(str::to_string))
            .collect();
        expected.sort();
        assert_eq!(found, expected);
        assert_eq!(
            own_paths("super::super::k", &["m", "n", "o"]),
            [(1, "m::k".to_string())]
        );
    }
}
