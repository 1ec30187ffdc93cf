//! Rust source as text: without comments and literals ([`code_only`]), without its tests
//! ([`without_tests`]), its names ([`names`]) and the paths of its own crate ([`own_paths`]).

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};

/// The source without comments and literals, its tokens in their lines; doc comments leave
/// `#[doc=]`. Empty for what is no Rust.
pub fn code_only(source: &str) -> String {
    let mut code = Code::default();
    code.push_all(source.parse().unwrap_or_default());
    code.text
}

#[derive(Default)]
struct Code {
    text: String,
    /// Lines begun after the first one.
    lines: usize,
}

impl Code {
    fn push_all(&mut self, tokens: TokenStream) {
        for token in tokens {
            match token {
                TokenTree::Group(group) => {
                    let (open, close) = match group.delimiter() {
                        Delimiter::Parenthesis => ("(", ")"),
                        Delimiter::Brace => ("{", "}"),
                        Delimiter::Bracket => ("[", "]"),
                        Delimiter::None => ("", ""),
                    };
                    self.push(open, group.span_open());
                    self.push_all(group.stream());
                    self.push(close, group.span_close());
                }
                TokenTree::Ident(name) => self.push(&name.to_string(), name.span()),
                TokenTree::Punct(sign) => self.push(&sign.to_string(), sign.span()),
                TokenTree::Literal(_) => {}
            }
        }
    }

    /// Names stand apart from each other.
    fn push(&mut self, token: &str, span: Span) {
        while self.lines + 1 < span.start().line {
            self.text.push('\n');
            self.lines += 1;
        }
        let in_name = |c: char| c.is_alphanumeric() || c == '_';
        if self.text.ends_with(in_name) && token.starts_with(in_name) {
            self.text.push(' ');
        }
        self.text += token;
    }
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

    #[test]
    fn code_only_leaves_out_comments_and_literals_and_keeps_lines() {
        let source = "a // fs\n/* fs /* fs */ fs\n*/ b r#\"fs \" fs\"# b'\\'' \"\\\"fs\"\nfn f<'a>(x: &'a str) { crate::c as d }";
        assert_eq!(
            code_only(source),
            "a\n\nb\nfn f<'a>(x:&'a str){crate::c as d}"
        );
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
