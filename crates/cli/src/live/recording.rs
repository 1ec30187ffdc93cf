//! Record of a live session: [`Recording`].

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip::Row;
use stickslip_formats::{CsvRecorder, McapRecorder};

use crate::failure::hinted;
use crate::files::ready_file;
use crate::output::counted;

/// Time of rows in a chunk (s); a chunk is lost where the program is killed.
const CHUNK: f64 = 1.0;

/// Most times that are remembered to know repeats by.
const REMEMBERED: usize = 10_000;

/// A file that grows with the session.
pub struct Recording {
    path: PathBuf,
    recorder: Recorder,
    /// Time of the latest row (s).
    latest: f64,
    /// Time of the first row of the chunk at hand (s).
    chunk: f64,
    /// Times of rows, by the nanosecond, and whether they had poses of object and pusher.
    seen: BTreeMap<i64, [bool; 2]>,
    left_out: u64,
}

enum Recorder {
    Csv(CsvRecorder<BufWriter<File>>),
    Mcap(Box<McapRecorder<BufWriter<File>>>),
}

impl Recording {
    /// Begins a recording, as CSV or MCAP by the ending of its name; a file that is there is
    /// refused.
    pub fn create(path: &Path, sensors: usize, scene: &Path) -> Result<Self> {
        let help = "name a new file that ends in .mcap or .csv";
        if path.exists() {
            return Err(hinted(format!("{} is there already", path.display()), help));
        }
        ready_file(path, &[scene])?;
        let failed = |error: &dyn std::fmt::Display| {
            hinted(
                format!("{}: cannot be written: {error}", path.display()),
                help,
            )
        };
        let file = || {
            File::create(path)
                .map(BufWriter::new)
                .map_err(|error| failed(&error))
        };
        let recorder = match path.extension().and_then(|ending| ending.to_str()) {
            Some("mcap") => {
                let recorder = McapRecorder::new(file()?, sensors);
                Recorder::Mcap(Box::new(recorder.map_err(|error| failed(&error))?))
            }
            Some("csv") => {
                Recorder::Csv(CsvRecorder::new(file()?, sensors).map_err(|error| failed(&error))?)
            }
            _ => {
                return Err(hinted(
                    format!("{}: a recording is MCAP or CSV", path.display()),
                    help,
                ));
            }
        };
        Ok(Self {
            path: path.to_owned(),
            recorder,
            latest: f64::NEG_INFINITY,
            chunk: f64::NEG_INFINITY,
            seen: BTreeMap::new(),
            left_out: 0,
        })
    }

    /// Writes a row, unless the file could not be read with it: a late one into CSV, a second pose
    /// of a body at one time into MCAP.
    pub fn write(&mut self, row: &Row) -> Result<()> {
        let failed = |error: &dyn std::fmt::Display| {
            let message = format!("{}: cannot be written: {error}", self.path.display());
            hinted(message, "what was written before can be read")
        };
        match &mut self.recorder {
            Recorder::Csv(csv) if row.time > self.latest => {
                csv.write(row).map_err(|error| failed(&error))?
            }
            Recorder::Csv(_) => self.left_out += 1,
            Recorder::Mcap(mcap) => {
                let stamp = (1e9 * row.time).round() as i64;
                let [object, pusher] = self.seen.entry(stamp).or_default();
                let again = (*object && row.object.is_some()) || (*pusher && row.pusher.is_some());
                if again || row.time < 0.0 {
                    self.left_out += 1;
                    return Ok(());
                }
                (*object, *pusher) = (
                    *object || row.object.is_some(),
                    *pusher || row.pusher.is_some(),
                );
                if self.seen.len() > REMEMBERED {
                    self.seen.pop_first();
                }
                mcap.write(row).map_err(|error| failed(&error))?;
                if row.time - self.chunk >= CHUNK {
                    mcap.flush().map_err(|error| failed(&error))?;
                    self.chunk = row.time;
                }
            }
        }
        self.latest = if row.time > self.latest {
            row.time
        } else {
            self.latest
        };
        Ok(())
    }

    /// Ends the recording; returns a report of what was written.
    pub fn finish(self) -> Result<String> {
        if let Recorder::Mcap(mcap) = self.recorder {
            mcap.finish()?;
        }
        let left_out = match self.left_out {
            0 => String::new(),
            count => format!(
                " without {}: late, repeated or negative times",
                counted(count, "row")
            ),
        };
        Ok(format!("wrote {}{left_out}", self.path.display()))
    }
}
