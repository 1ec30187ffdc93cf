//! Writing files and folders: the fault, and the next step. Files that belong together are
//! [`Results`].

use std::ffi::OsString;
use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip_report::{Drawing, Report, ReportedExperiment};

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

/// Files of one result in a folder named by `--out`. They take their places when all are written,
/// so that no file of this result lies next to one of an older result, even if the program is
/// killed.
#[derive(Default)]
pub struct Results(Vec<Part>);

impl Results {
    /// Writes a file next to its place.
    pub fn add(
        &mut self,
        path: PathBuf,
        content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<()> {
        let part = Part::write(&path, content);
        self.0
            .push(part.map_err(|error| unwritable(&path, &error, OTHER_OUT))?);
        Ok(())
    }

    /// Moves the files to their places, and returns these. Older files there but the first are
    /// removed before.
    pub fn place(self) -> Result<Vec<PathBuf>> {
        let failed = |path: &Path, error: &io::Error| unwritable(path, error, OTHER_OUT);
        for Part { place, .. } in self.0.iter().skip(1) {
            match fs::remove_file(place) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(failed(place, &error));
                }
                _ => {}
            }
        }
        let placed = self.0.into_iter().map(|part| {
            let place = part.place.clone();
            part.move_to_place()
                .map_err(|error| failed(&place, &error))?;
            Ok(place)
        });
        placed.collect()
    }
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
    Part::write(path, content)?.move_to_place()
}

/// Checks that a file can be written at `path`, without touching a file that is there.
fn try_place(path: &Path) -> io::Result<()> {
    if is_stream(path) {
        return File::options().write(true).open(path).map(drop);
    }
    Part::create(path).map(drop)
}

/// Returns true if something is there that no file can take the place of, as `/dev/stdout`.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// A file that is written next to its place first; it is removed unless it is moved there.
struct Part {
    beside: PathBuf,
    place: PathBuf,
}

impl Part {
    /// Makes an empty file next to `path`, with the permissions of the file that is there. Its name
    /// is random: programs in several containers may have one number and share a folder.
    fn create(path: &Path) -> io::Result<(Self, File)> {
        // a link stays, and what it leads to is written
        let place = fs::canonicalize(path).unwrap_or(path.to_owned());
        let there = fs::metadata(&place).ok().map(|there| there.permissions());
        if there.as_ref().is_some_and(Permissions::readonly) {
            let words = "the file there is write-protected";
            return Err(io::Error::new(ErrorKind::PermissionDenied, words));
        }
        let mut name = OsString::from(".");
        name.push(place.file_name().unwrap_or_default());
        let random = getrandom::u32().map_err(io::Error::other)?;
        name.push(format!(".{random:08x}.part"));
        let beside = place.with_file_name(name);
        let mut options = File::options();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if there.is_some() {
            // not for others, not even as long as it is empty
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        }
        let file = options.open(&beside)?;
        let part = Self { beside, place };
        if let Some(permissions) = there {
            file.set_permissions(permissions)?;
        }
        Ok((part, file))
    }

    /// Writes a file next to its place.
    fn write(
        path: &Path,
        content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> io::Result<Self> {
        make_parent(path)?;
        let (part, file) = Self::create(path)?;
        let mut file = BufWriter::new(file);
        content(&mut file)?;
        file.into_inner()?.sync_all()?;
        Ok(part)
    }

    fn move_to_place(self) -> io::Result<()> {
        fs::rename(&self.beside, &self.place)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // nothing is there where it was moved to its place
        let _ = fs::remove_file(&self.beside);
    }
}

/// Formats of figures.
pub const FIGURE_FORMATS: &str = if cfg!(feature = "png") {
    "SVG and PNG"
} else {
    "SVG"
};

/// Writes the figures of an experiment into a folder, their names after the experiment's; returns
/// how many.
pub fn write_figures(folder: &Path, experiment: &ReportedExperiment<'_>) -> Result<usize> {
    let figures = experiment.figures();
    for figure in &figures {
        let name = format!("{}-{}", experiment.name, figure.name);
        write_figure(folder, &name, &figure.drawing)?;
    }
    Ok(figures.len())
}

/// Writes a figure into a folder, for print.
pub fn write_figure(folder: &Path, name: &str, drawing: &Drawing) -> Result<()> {
    let svg = drawing.to_print_svg();
    #[cfg(feature = "png")]
    write_file(
        &folder.join(format!("{name}.png")),
        &stickslip_report::png_of(&svg)?,
    )?;
    write_file(&folder.join(format!("{name}.svg")), svg.as_bytes())
}

/// Writes a report as one HTML file.
pub fn write_report(path: PathBuf, report: &Report) -> Result<PathBuf> {
    write_file(&path, report.to_html().as_bytes())?;
    Ok(path)
}

/// Makes the folder of a file.
pub fn make_parent(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("")))
}

fn unwritable(path: &Path, error: &io::Error, help: &str) -> anyhow::Error {
    hinted(
        format!("{}: cannot be written: {error}", path.display()),
        help,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Programs with one process number, in two containers that share a folder, write one file.
    #[test]
    fn parts_of_one_file_have_names_of_their_own_and_are_removed() {
        let folder = std::env::temp_dir().join(format!("stickslip-parts-{}", std::process::id()));
        make_folder(&folder).unwrap();
        let parts = [(); 2].map(|()| Part::create(&folder.join("log.csv")).unwrap().0);
        assert_ne!(parts[0].beside, parts[1].beside);
        assert!(parts.iter().all(|part| part.beside.exists()));
        drop(parts);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir(&folder).unwrap();
    }
}
