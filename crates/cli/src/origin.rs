//! Origin of a report: [`origin`].

use std::ffi::OsString;
use std::sync::OnceLock;

/// The words of the command line. A process runs one program, but its own arguments may be another
/// one's, Python's.
static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Keeps the words of the command line for [`origin`]; those of the first call count.
pub fn keep_words(words: Vec<OsString>) -> Vec<OsString> {
    let _ = WORDS.set(words.clone());
    words
}

/// Program, command line and further facts, name by name.
pub fn origin(more: impl IntoIterator<Item = (&'static str, String)>) -> Vec<(String, String)> {
    let words = WORDS.get().into_iter().flatten();
    let words = words.map(|word| quoted(&word.to_string_lossy()));
    let command: Vec<String> = ["stickslip".to_owned()].into_iter().chain(words).collect();
    let own = [
        (
            "program",
            format!("stickslip {}", env!("CARGO_PKG_VERSION")),
        ),
        ("command", command.join(" ")),
    ];
    own.into_iter()
        .chain(more)
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// An argument as a shell takes it.
pub fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "-_./:=,+%@".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_quoted_where_a_shell_would_take_them_apart() {
        let words = ["--occlude", "60:", "my log.csv", "it's", ""].map(quoted);
        let expected = ["--occlude", "60:", "'my log.csv'", "'it'\\''s'", "''"];
        assert_eq!(words, expected);
    }
}
