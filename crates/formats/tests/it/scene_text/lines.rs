//! A scene by its lines, those behind `#` included.

/// A line with a key or, where the key is empty, with the name of a table.
#[derive(Debug)]
pub struct Line<'a> {
    pub table: &'a str,
    pub key: &'a str,
    pub value: &'a str,
    pub comment: &'a str,
    pub is_off: bool,
}

/// All such lines.
pub fn lines(text: &str) -> Vec<Line<'_>> {
    let mut current = "";
    let line = |line| {
        let bare = str::strip_prefix(line, "# ").unwrap_or(line);
        let (content, comment) = bare.split_once(" # ").unwrap_or((bare, ""));
        let (name, value) = content.split_once(" = ").unwrap_or((content, ""));
        let is_key = name.chars().all(|c| c.is_lowercase() || c == '_');
        if content.starts_with('[') {
            current = content.trim().trim_matches(['[', ']']);
        } else if value.is_empty() || !is_key {
            return None;
        }
        Some(Line {
            table: current,
            key: if value.is_empty() { "" } else { name },
            value: value.trim(),
            comment,
            is_off: bare.len() < line.len(),
        })
    };
    text.lines().filter_map(line).collect()
}

/// The keys of `[support]` of which one pair excludes the other.
pub const FEET: [&str; 2] = ["feet", "foot_loads"];
pub const TRIPOD: [&str; 2] = ["tripod_radius", "tripod_angle"];

/// The scene with all of its keys but those of `[support]` in `without`.
pub fn all_keys(text: &str, without: [&str; 2]) -> String {
    let shown = |line: &Line<'_>| match (line.table, line.key, line.value) {
        ("fixel" | "finger", "", _) => format!("[[{}]]\n", line.table),
        (table, "", _) => format!("[{table}]\n"),
        ("support", key, _) if without.contains(&key) => String::new(),
        (_, key, value) => format!("{key} = {value}\n"),
    };
    lines(text).iter().map(shown).collect()
}
