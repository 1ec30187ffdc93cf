//! Sizes of the code: files, lines, public items, circles of files, lengths of functions.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::layers::module_of;
use crate::rust_text::{code_only, functions, own_paths, without_tests};
use crate::tree::Tree;

/// Longest functions that are listed.
const LISTED: usize = 20;

/// A function of more lines is long.
const LONG: usize = 60;

/// Starts of lines that make an item public outside its crate.
const PUBLIC: [&str; 10] = [
    "pub fn ",
    "pub const ",
    "pub struct ",
    "pub enum ",
    "pub trait ",
    "pub type ",
    "pub use ",
    "pub mod ",
    "pub static ",
    "pub unsafe ",
];

/// Size of one crate, tests left out but for its lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Size {
    files: usize,
    /// Lines of `src`, tests included.
    lines: usize,
    public: usize,
    circles: usize,
}

/// A function and where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Length {
    lines: usize,
    place: String,
}

/// Tables of all crates, and of the lengths of all functions outside tests.
pub fn report(tree: &Tree) -> String {
    let (crates, mut lengths) = measure(tree);
    let mut text = format!(
        "{:24} {:>6} {:>7} {:>7} {:>8}\n",
        "crate", "files", "lines", "public", "circles"
    );
    let mut total = Size::default();
    for (name, size) in &crates {
        row(&mut text, name, size);
        total.files += size.files;
        total.lines += size.lines;
        total.public += size.public;
        total.circles += size.circles;
    }
    row(&mut text, "all", &total);
    lengths.sort_by(|a, b| b.lines.cmp(&a.lines).then_with(|| a.place.cmp(&b.place)));
    let long = lengths.iter().filter(|length| length.lines > LONG).count();
    let _ = write!(
        text,
        "\n{} functions: median {} lines, 99th percentile {}, {long} ({:.1} %) over {LONG}\n",
        lengths.len(),
        percentile(&lengths, 50),
        percentile(&lengths, 99),
        100.0 * long as f64 / lengths.len().max(1) as f64,
    );
    for length in lengths.iter().take(LISTED) {
        let _ = write!(text, "\n{:5}  {}", length.lines, length.place);
    }
    text
}

fn row(
    text: &mut String,
    name: &str,
    Size {
        files,
        lines,
        public,
        circles,
    }: &Size,
) {
    let _ = writeln!(
        text,
        "{name:24} {files:>6} {lines:>7} {public:>7} {circles:>8}"
    );
}

/// Lines of which this share of the functions, sorted from long to short, have no more.
fn percentile(lengths: &[Length], percent: usize) -> usize {
    let above = lengths.len() * (100 - percent) / 100;
    lengths.get(above).map_or(0, |length| length.lines)
}

fn measure(tree: &Tree) -> (BTreeMap<&str, Size>, Vec<Length>) {
    let mut crates: BTreeMap<&str, Size> = BTreeMap::new();
    let mut imports: BTreeMap<&str, Vec<(String, Vec<String>)>> = BTreeMap::new();
    let mut lengths = Vec::new();
    for (path, text) in tree.texts(".rs") {
        let Some((folder, file)) = path.split_once("/src/") else {
            continue;
        };
        let code = code_only(without_tests(text));
        let size = crates.entry(folder).or_default();
        size.files += 1;
        size.lines += text.lines().count();
        let starts = |line: &&str| {
            PUBLIC
                .iter()
                .any(|start| line.trim_start().starts_with(start))
        };
        size.public += code.lines().filter(starts).count();
        lengths.extend(functions(&code).iter().map(|f| Length {
            lines: f.lines,
            place: format!("{path}:{} {}", f.line, f.name),
        }));
        let module = module_of(file);
        if module != "lib" {
            let segments: Vec<&str> = module.split('/').collect();
            let named = own_paths(&code, &segments).into_iter();
            let named = named.map(|(_, path)| path.replace("::", "/")).collect();
            imports.entry(folder).or_default().push((module, named));
        }
    }
    for (folder, files) in &imports {
        if let Some(size) = crates.get_mut(folder) {
            size.circles = circles(files);
        }
    }
    (crates, lengths)
}

/// Groups of two or more files of which each leads to each other by imports.
fn circles(files: &[(String, Vec<String>)]) -> usize {
    let count = files.len();
    let names = |path: &str, module: &str| {
        path.strip_prefix(module)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    };
    // a file names the one whose module path is the longest
    let named = |path: &String| {
        (0..count)
            .filter(|&k| names(path, &files[k].0))
            .max_by_key(|&k| files[k].0.len())
    };
    let mut leads = vec![vec![false; count]; count];
    for (from, (_, paths)) in files.iter().enumerate() {
        for to in paths.iter().filter_map(named).filter(|to| *to != from) {
            leads[from][to] = true;
        }
    }
    for middle in 0..count {
        for from in 0..count {
            for to in 0..count {
                leads[from][to] |= leads[from][middle] && leads[middle][to];
            }
        }
    }
    let first_of_its_circle =
        |k: &usize| leads[*k][*k] && !(0..*k).any(|other| leads[*k][other] && leads[other][*k]);
    (0..count).filter(first_of_its_circle).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measure_counts_files_lines_public_items_and_circles() {
        let tree = Tree::from([
            ("crates/a/src/lib.rs", "mod x;\npub use x::X;\n"),
            (
                "crates/a/src/x.rs",
                "use crate::y::z::Z;\npub struct X;\nfn f() {\n}\n",
            ),
            (
                "crates/a/src/y/z.rs",
                "use crate::x::X;\n#[cfg(test)]\nmod tests {\n fn g() {}\n}\n",
            ),
            ("crates/a/src/w.rs", "use crate::x::X;\n"),
            ("crates/a/tests/t.rs", "fn h() {}"),
        ]);
        let (crates, lengths) = measure(&tree);
        let expected = Size {
            files: 4,
            lines: 12,
            public: 2,
            circles: 1,
        };
        assert_eq!(
            crates.into_iter().collect::<Vec<_>>(),
            [("crates/a", expected)]
        );
        let place = "crates/a/src/x.rs:3 f".to_string();
        assert_eq!(lengths, [Length { lines: 2, place }]);
    }

    #[test]
    fn percentile_is_of_the_sorted_lengths() {
        let lengths: Vec<Length> = (0..100)
            .map(|k| Length {
                lines: 100 - k,
                place: String::new(),
            })
            .collect();
        assert_eq!(
            (percentile(&lengths, 50), percentile(&lengths, 99)),
            (50, 99)
        );
        assert_eq!(percentile(&[], 50), 0);
    }
}
