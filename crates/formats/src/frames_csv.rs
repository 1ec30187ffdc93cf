//! `frames.csv`, the images of a recording and their times: [`FrameList`], [`read_frames`],
//! [`write_frames`].

use std::io::{Read, Write};

use crate::csv_error::CsvError;
use crate::csv_table::CsvTable;
use crate::number;

/// The images of a recording, in the order of their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameList {
    /// Time of each image, in the middle of its exposure (s), strictly rising.
    pub time: Vec<f64>,
    /// Its file, relative to the folder of the list.
    pub file: Vec<String>,
}

/// Reads the columns time and file; other columns are ignored. `name` is shown in errors.
///
/// # Errors
/// One of the two is missing or has an empty cell, a time is no finite number or does not rise, or
/// there is no row.
///
/// ```
/// let frames = stickslip_formats::read_frames("time,file\n0,a.png\n0.033,b.png\n".as_bytes(), "frames.csv")?;
/// assert_eq!((frames.time[1], frames.file[1].as_str()), (0.033, "b.png"));
/// # Ok::<(), stickslip_formats::CsvError>(())
/// ```
pub fn read_frames(reader: impl Read, name: &str) -> Result<FrameList, CsvError> {
    let table = CsvTable::read(reader, name)?;
    let [time, file] = table.require_all(["time", "file"])?;
    let mut frames = FrameList::default();
    for row in table.rows()? {
        let row = row?;
        frames
            .time
            .push(row.time(time, frames.time.last().copied())?);
        frames.file.push(row.text(file)?.to_owned());
    }
    Ok(frames)
}

/// Writes a list of frames; times read back to the same bits.
///
/// # Errors
/// Those of `writer`.
///
/// # Panics
/// If the columns differ in length.
pub fn write_frames(mut writer: impl Write, frames: &FrameList) -> std::io::Result<()> {
    assert_eq!(
        frames.time.len(),
        frames.file.len(),
        "columns of equal length"
    );
    writeln!(writer, "time,file")?;
    let quoted = |file: &str| {
        if file.contains([',', '"']) {
            format!("\"{}\"", file.replace('"', "\"\""))
        } else {
            file.to_owned()
        }
    };
    frames
        .time
        .iter()
        .zip(&frames.file)
        .try_for_each(|(time, file)| writeln!(writer, "{},{}", number::text(*time), quoted(file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn write_frames_reads_back() {
        let files = ["a.png", "run 1, take 2.png", "say \"x\".png"]
            .map(str::to_owned)
            .to_vec();
        let frames = FrameList {
            time: vec![0.0, 1.0 / 30.0, 2.0 / 30.0],
            file: files,
        };
        let mut bytes = Vec::new();
        write_frames(&mut bytes, &frames).unwrap();
        assert_eq!(read_frames(bytes.as_slice(), "f").unwrap(), frames);
    }

    #[test]
    fn read_frames_names_line_column_rule_and_next_step() {
        for (text, words) in [
            ("time,image\n0,a.png\n", "f:1: the column `file` is missing"),
            (
                "time,file\n0,a.png\n0,b.png\n",
                "f:3: column 1 (time): time 0 s comes after 0 s; it must rise strictly",
            ),
            (
                "time,file\n0,\n",
                "f:2: column 2 (file): the cell is empty; every row needs a value here",
            ),
            ("time,file\n", "f:1: the file has a header and no rows"),
            (
                "time,file\nnow,a.png\n",
                "f:2: column 1 (time): `now` is not a number",
            ),
        ] {
            let error = read_frames(text.as_bytes(), "f").unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }
}
