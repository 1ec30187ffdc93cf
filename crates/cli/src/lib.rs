//! The program `stickslip`: arguments, files, progress and exit codes around the library of the
//! same name. [`run`] is all of it; the binary calls it, and so does the command of the Python
//! package.

#![warn(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "they panic where the reader has left; `output` does not"
)]

mod arg_values;
mod args;
#[cfg_attr(not(feature = "camera"), path = "no_camera.rs")]
mod camera;
mod check;
mod compare;
mod demo;
mod experiment;
mod failure;
mod files;
mod filter;
mod fit;
mod fit_args;
mod given;
mod in_process;
mod info;
mod live;
mod live_args;
mod log_files;
mod new;
mod origin;
mod output;
mod page_server;
mod progress;
mod reported_run;
mod reproduce;
mod simulate;
mod simulation_args;
mod since_start;
mod topic_args;
mod verdict;
mod view;

use std::ffi::OsString;
use std::io::{self, Write};

use clap::Parser;

use crate::args::{Command, Program};
pub use crate::in_process::{
    ComparedFolder, ComparedRun, ShownScores, bag_info, check_occlusion, check_sense,
    compared_method, comparison_page, fit_page, log_files, read_log_at, run_page, run_player,
};
pub use crate::reported_run::DRAWN;
pub use stickslip_report::CloudSample;

/// Runs the program with the words of a command line, those after its name, and returns its exit
/// code: 0 done, 1 failed, 2 bad arguments, 3 done with input lost. Results go to the process's
/// standard output, all else to its standard error.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words = origin::keep_words(words.into_iter().collect());
    let program = [OsString::from("stickslip")].into_iter();
    let code = match Program::try_parse_from(program.chain(words.iter().cloned())) {
        Ok(program) => command(program.command),
        Err(said) => {
            // help, version, or the error, in clap's words; that they cannot be printed changes
            // nothing
            let _ = said.print();
            u8::try_from(said.exit_code()).unwrap_or(1)
        }
    };
    // a caller that is no Rust program does not flush on the way out
    let _ = io::stdout().flush();
    code
}

fn command(command: Command) -> u8 {
    let result = match command {
        Command::Demo(args) => demo::demo(&args),
        Command::Filter(args) => filter::filter(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Fit(args) => fit::fit(&args),
        Command::Simulate(args) => simulate::simulate(&args),
        Command::Reproduce(args) => reproduce::reproduce(&args),
        Command::New(args) => new::new(&args),
        Command::Print(args) => camera::print(&args),
        Command::Check(args) => check::check(&args),
        Command::Info(args) => info::info(&args),
        Command::Live(args) => live::live(&args),
        Command::View(args) => view::view(&args),
        Command::Calibrate(args) => camera::calibrate(&args),
        Command::Track(args) => camera::track(&args),
        Command::Render(args) => camera::render(&args),
    };
    result.unwrap_or_else(|error| output::tell(&error)).code()
}
