//! The project's own checks: `cargo xtask tidy` and `cargo xtask determinism`.
//!
//! Exit codes: 0 all well, 1 something was found, 2 bad arguments.

mod arrows;
mod determinism;
mod documents;
mod finding;
mod rust_text;
mod sources;
mod tree;

use std::path::Path;
use std::process::ExitCode;

use finding::Finding;
use tree::Tree;

const USAGE: &str = "usage: cargo xtask tidy | determinism

tidy         crate arrows, what libraries must not name, file lengths, paths in the documents
determinism  the same estimate, byte for byte, in debug and release and on 1, 2 and 3 threads";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(root) = Path::new(env!("CARGO_MANIFEST_DIR")).parent() else {
        eprintln!("xtask must lie in a folder of the workspace");
        return ExitCode::FAILURE;
    };
    let outcome = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["tidy"] => tidy(root),
        ["determinism"] => determinism::check(root),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(message) => {
            println!("{message}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn tidy(root: &Path) -> Result<String, String> {
    let tree = Tree::read(root)?;
    let mut findings = arrows::check(&tree);
    findings.extend(sources::check(&tree));
    findings.extend(documents::check(&tree));
    if findings.is_empty() {
        return Ok(format!("tidy: {} files, nothing found", tree.len()));
    }
    findings.sort();
    let lines: Vec<String> = findings.iter().map(Finding::to_string).collect();
    Err(format!(
        "{}\ntidy: {} found",
        lines.join("\n"),
        findings.len()
    ))
}
