//! Rust source as text: without comments and literals ([`code_only`]), without its tests
//! ([`without_tests`]), and its names ([`names`]).

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
}
