//! `stickslip print`: tags and the calibration board on paper.

use std::fs;

use anyhow::{Context, Result};
use stickslip_vision::{print_board, print_tags, read_board};

use super::print_args::PrintArgs;
use crate::failure::hinted;
use crate::files::{ready_file, write_file};
use crate::output::show;
use crate::verdict::Verdict;

/// Runs the command.
pub fn print(args: &PrintArgs) -> Result<Verdict> {
    let board = args.board.as_deref();
    ready_file(&args.out, board.as_slice())?;
    let sheet = match board {
        Some(path) => {
            let name = path.display().to_string();
            let text = fs::read_to_string(path).with_context(|| name.clone())?;
            print_board(&read_board(&text, &name)?.board, args.paper)
        }
        None => print_tags(&args.tags, args.size, args.paper),
    };
    let sheet =
        sheet.map_err(|error| hinted(error.to_string(), "see --size, --paper and board.toml"))?;
    let ending = args.out.extension().and_then(|ending| ending.to_str());
    match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "pdf" => write_file(&args.out, &sheet.pdf())?,
        _ => write_file(&args.out, sheet.svg().as_bytes())?,
    }
    show(format_args!(
        "wrote {}; print it at 100 %, then measure the ruler of 100 mm and the black squares",
        args.out.display()
    ))?;
    Ok(Verdict::Done)
}
