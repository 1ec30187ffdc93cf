//! `stickslip print`: tags and the calibration board on paper.

use std::fs;

use anyhow::{Context, Result};
use stickslip_vision::{board_svg, read_board, tags_svg};

use crate::failure::hinted;
use crate::files::{ready_file, write_file};
use crate::output::show;
use crate::print_args::PrintArgs;
use crate::verdict::Verdict;

/// Runs the command.
pub fn print(args: &PrintArgs) -> Result<Verdict> {
    let board = args.board.as_deref();
    ready_file(&args.out, board.as_slice())?;
    let svg = match board {
        Some(path) => {
            let name = path.display().to_string();
            let text = fs::read_to_string(path).with_context(|| name.clone())?;
            board_svg(&read_board(&text, &name)?.board, args.paper)
        }
        None => tags_svg(&args.tags, args.size, args.paper),
    };
    let svg =
        svg.map_err(|error| hinted(error.to_string(), "see --size, --paper and board.toml"))?;
    write_file(&args.out, svg.as_bytes())?;
    show(format_args!(
        "wrote {}; print it at 100 %, measure the ruler: 100 mm, and the black squares",
        args.out.display()
    ))?;
    Ok(Verdict::Done)
}
