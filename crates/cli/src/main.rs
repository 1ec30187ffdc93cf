//! The program `stickslip`: arguments, files, progress and exit codes around the library of the
//! same name.

#![warn(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "they panic where the reader has left; `output` does not"
)]

mod arg_values;
mod args;
mod bag_images;
mod calibrate;
mod camera_args;
mod camera_setup;
mod check;
mod compare;
mod demo;
mod experiment;
mod failure;
mod files;
mod filter;
mod fit;
mod fit_args;
mod frames;
mod info;
mod live;
mod live_args;
mod log_files;
mod new;
mod origin;
mod output;
mod print;
mod print_args;
mod progress;
mod render;
mod reported_run;
mod reproduce;
mod simulate;
mod simulation_args;
mod topic_args;
mod track;
mod verdict;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Command, Program};

fn main() -> ExitCode {
    let result = match Program::parse().command {
        Command::Demo(args) => demo::demo(&args),
        Command::Filter(args) => filter::filter(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Fit(args) => fit::fit(&args),
        Command::Simulate(args) => simulate::simulate(&args),
        Command::Reproduce(args) => reproduce::reproduce(&args),
        Command::New(args) => new::new(&args),
        Command::Print(args) => print::print(&args),
        Command::Check(args) => check::check(&args),
        Command::Info(args) => info::info(&args),
        Command::Live(args) => live::live(&args),
        Command::Calibrate(args) => calibrate::calibrate(&args),
        Command::Track(args) => track::track(&args),
        Command::Render(args) => render::render(&args),
    };
    result
        .unwrap_or_else(|error| output::tell(&error))
        .exit_code()
}
