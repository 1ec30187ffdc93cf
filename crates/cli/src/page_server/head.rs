//! Head of a request: [`Head`].

use std::io::{BufRead, Read};

/// Longest head of a request (bytes).
const LONGEST_HEAD: u64 = 16 << 10;

/// Head of a request: its first line and its fields.
pub struct Head(Vec<String>);

impl Head {
    /// Reads up to the empty line after it; what cannot be read is left out.
    pub fn read(reader: &mut impl BufRead) -> Self {
        let lines = reader.take(LONGEST_HEAD).lines().map_while(Result::ok);
        Self(lines.take_while(|line| !line.is_empty()).collect())
    }

    /// Method, as `GET`.
    pub fn method(&self) -> &str {
        self.word(0)
    }

    /// Path without its first slash and the query.
    pub fn path(&self) -> &str {
        let path = self.word(1).split('?').next().unwrap_or_default();
        path.strip_prefix('/').unwrap_or(path)
    }

    /// Text after the question mark.
    pub fn query(&self) -> Option<&str> {
        self.word(1).split_once('?').map(|(_, query)| query)
    }

    fn word(&self, index: usize) -> &str {
        let first = self.0.first().map_or("", String::as_str);
        first.split(' ').nth(index).unwrap_or_default()
    }

    /// Value of a field whose name is in small letters.
    pub fn field(&self, name: &str) -> Option<&str> {
        self.0.iter().skip(1).find_map(|line| {
            let (own, value) = line.split_once(':')?;
            own.eq_ignore_ascii_case(name).then_some(value.trim())
        })
    }
}
