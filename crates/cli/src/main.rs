//! The binary `stickslip`: [`stickslip_cli::run`] with the words of the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(stickslip_cli::run(std::env::args_os().skip(1)))
}
