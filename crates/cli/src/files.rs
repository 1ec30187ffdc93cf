//! Writing files and folders: what went wrong, and what to do about it.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip_report::{Drawing, Report, ReportedExperiment, png_of};

use crate::failure::hinted;

/// What to do where the folder of `--out` cannot be written to.
const OTHER_OUT: &str = "give a folder that can be written to with --out";

/// Makes a folder named by `--out`.
pub fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| {
        hinted(
            format!("{}: cannot be made: {error}", folder.display()),
            OTHER_OUT,
        )
    })
}

/// Writes a file into a folder named by `--out`, which is made where it is missing; other files
/// there stay as they are.
pub fn write_out(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    let write = || {
        make_parent(path)?;
        let mut file = BufWriter::new(File::create(path)?);
        content(&mut file)?;
        file.flush()
    };
    write().map_err(|error| unwritable(path, &error, OTHER_OUT))
}

/// Writes a file; its folder is made where it is missing.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = make_parent(path).and_then(|()| fs::write(path, bytes));
    written.map_err(|error| unwritable(path, &error, "give a place that can be written to"))
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
