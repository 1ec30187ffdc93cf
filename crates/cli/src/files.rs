//! Writing files and folders: the fault, and the next step.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip_report::{Drawing, Report, ReportedExperiment, png_of};

use crate::failure::hinted;

/// Next step where the folder of `--out` cannot be written to.
const OTHER_OUT: &str = "give a folder that can be written to with --out";

/// Next step where a file cannot be written.
const OTHER_FILE: &str = "give a place that can be written to";

/// Makes a folder named by `--out`.
pub fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| {
        hinted(
            format!("{}: cannot be made: {error}", folder.display()),
            OTHER_OUT,
        )
    })
}

/// Refuses a folder named by `--out` that cannot be written to, before the work whose results go
/// there.
pub fn ready_folder(folder: &Path) -> Result<()> {
    let is_new = !folder.exists();
    make_folder(folder)?;
    let tried = try_place(&folder.join("stickslip"));
    if is_new {
        // left empty for the time being, it would speak of results that may never come
        let _ = fs::remove_dir(folder);
    }
    tried.map_err(|error| unwritable(folder, &error, OTHER_OUT))
}

/// Refuses a file named on the command line that cannot be written or would take the place of one
/// of `inputs`, before the work whose results go there.
pub fn ready_file(path: &Path, inputs: &[&Path]) -> Result<()> {
    refuse_inputs(path, inputs)?;
    let tried = make_parent(path).and_then(|()| match path.is_dir() {
        true => Err(ErrorKind::IsADirectory.into()),
        false => try_place(path),
    });
    tried.map_err(|error| unwritable(path, &error, OTHER_FILE))
}

/// Refuses a place where one of `inputs` is.
pub fn refuse_inputs(path: &Path, inputs: &[&Path]) -> Result<()> {
    let is_input = |input: &&Path| match (fs::canonicalize(path), fs::canonicalize(input)) {
        (Ok(path), Ok(input)) => path == input,
        _ => false,
    };
    if !inputs.iter().any(is_input) {
        return Ok(());
    }
    let message = format!(
        "{}: writing there would destroy what is read",
        path.display()
    );
    Err(hinted(message, "give another place"))
}

/// Writes a file into a folder named by `--out`, which is made where it is missing; other files
/// there stay as they are.
pub fn write_out(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    write_whole(path, content).map_err(|error| unwritable(path, &error, OTHER_OUT))
}

/// Writes a file; its folder is made where it is missing.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = write_whole(path, |file| file.write_all(bytes));
    written.map_err(|error| unwritable(path, &error, OTHER_FILE))
}

/// Writes a file whole or not at all: next to its place first, then in one move over the file that
/// was there. Two programs that write one file leave the one or the other, and a full disk leaves
/// the old file.
fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    make_parent(path)?;
    if is_stream(path) {
        let mut stream = BufWriter::new(File::create(path)?);
        content(&mut stream)?;
        return stream.flush();
    }
    // a link stays, and what it leads to is written
    let path = fs::canonicalize(path).unwrap_or(path.to_owned());
    let beside = beside(&path);
    let write = || {
        let mut file = BufWriter::new(File::create(&beside)?);
        content(&mut file)?;
        file.into_inner()?.sync_all()?;
        fs::rename(&beside, &path)
    };
    write().inspect_err(|_| drop(fs::remove_file(&beside)))
}

/// Checks that a file can be written at `path`, without touching a file that is there.
fn try_place(path: &Path) -> io::Result<()> {
    if is_stream(path) {
        return File::options().write(true).open(path).map(drop);
    }
    let beside = beside(&fs::canonicalize(path).unwrap_or(path.to_owned()));
    File::create(&beside)?;
    fs::remove_file(&beside)
}

/// Returns true if something is there that no file can take the place of, as `/dev/stdout`.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Path at which the file for `path` is written first.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}

/// Writes the figures of an experiment into a folder as SVG and PNG, their names after the
/// experiment's; returns how many.
pub fn write_figures(folder: &Path, experiment: &ReportedExperiment<'_>) -> Result<usize> {
    let figures = experiment.figures();
    for figure in &figures {
        let name = format!("{}-{}", experiment.name, figure.name);
        write_figure(folder, &name, &figure.drawing)?;
    }
    Ok(figures.len())
}

/// Writes a figure into a folder as SVG and PNG, for print.
pub fn write_figure(folder: &Path, name: &str, drawing: &Drawing) -> Result<()> {
    let svg = drawing.to_print_svg();
    write_file(&folder.join(format!("{name}.png")), &png_of(&svg)?)?;
    write_file(&folder.join(format!("{name}.svg")), svg.as_bytes())
}

/// Writes a report as one HTML file.
pub fn write_report(path: PathBuf, report: &Report) -> Result<PathBuf> {
    write_file(&path, report.to_html().as_bytes())?;
    Ok(path)
}

fn make_parent(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("")))
}

fn unwritable(path: &Path, error: &io::Error, help: &str) -> anyhow::Error {
    hinted(
        format!("{}: cannot be written: {error}", path.display()),
        help,
    )
}
