//! Record of a live session: [`Recording`].

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use stickslip::Row;
use stickslip::dynamics::Scene;
use stickslip_formats::{CsvRecorder, McapRecorder, McapWriteError};

use super::session::PAUSE;
use crate::failure::hinted;
use crate::files::make_parent;
use crate::output::counted;

/// Time of rows in a chunk (s); a chunk is lost where the program is killed.
const CHUNK: f64 = 1.0;

/// Most times that are remembered to know repeats by.
const REMEMBERED: usize = 10_000;

/// A file that grows with the session.
pub struct Recording {
    path: PathBuf,
    recorder: Recorder,
    /// The first row, until the second one shows whether its time is that of the others.
    first: First,
    /// Time of the latest row (s).
    latest: f64,
    /// Time of the first row of the chunk at hand (s).
    chunk: f64,
    /// Times of rows, by the nanosecond, and whether they had poses of object and pusher.
    seen: BTreeMap<i64, [bool; 2]>,
    left_out: u64,
}

enum First {
    Awaited,
    Kept(Box<Row>),
    Written,
}

enum Recorder {
    Csv(CsvRecorder<BufWriter<File>>),
    Mcap(Box<McapRecorder<BufWriter<File>>>),
}

impl Recording {
    /// Begins a recording, as CSV or MCAP by the ending of its name; a file that is there is
    /// refused. Of two sessions that begin one file, one is refused.
    pub fn create(path: &Path, scene: &Scene) -> Result<Self> {
        let help = "name a new file that ends in .mcap or .csv";
        let failed = |error: &dyn std::fmt::Display| {
            hinted(
                format!("{}: cannot be written: {error}", path.display()),
                help,
            )
        };
        let file = || {
            let file = make_parent(path).and_then(|()| File::create_new(path));
            file.map(BufWriter::new)
                .map_err(|error| match error.kind() {
                    ErrorKind::AlreadyExists => {
                        hinted(format!("{} is there already", path.display()), help)
                    }
                    _ => failed(&error),
                })
        };
        let recorder = match path.extension().and_then(|ending| ending.to_str()) {
            Some("mcap") => {
                let recorder = McapRecorder::new(file()?, scene);
                Recorder::Mcap(Box::new(recorder.map_err(|error| failed(&error))?))
            }
            Some("csv") => {
                Recorder::Csv(CsvRecorder::new(file()?, scene).map_err(|error| failed(&error))?)
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
            first: First::Awaited,
            latest: f64::NEG_INFINITY,
            chunk: f64::NEG_INFINITY,
            seen: BTreeMap::new(),
            left_out: 0,
        })
    }

    /// Writes a row, unless the file could not be read with it: a late one into CSV, a second pose
    /// of a body at one time into MCAP. The first row is left out if the second one is far from it.
    ///
    /// After an error the file is as far as it got.
    pub fn write(&mut self, row: &Row) -> Result<()> {
        match std::mem::replace(&mut self.first, First::Written) {
            First::Awaited => {
                self.first = First::Kept(Box::new(row.clone()));
                return Ok(());
            }
            First::Kept(first) if (row.time - first.time).abs() > PAUSE => self.left_out += 1,
            First::Kept(first) => self.append(&first)?,
            First::Written => {}
        }
        self.append(row)
    }

    fn append(&mut self, row: &Row) -> Result<()> {
        let failed = |error: &dyn std::fmt::Display| {
            anyhow!(
                "{}: cannot be written: {error}; what was written before can be read",
                self.path.display()
            )
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
                if again {
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
                match mcap.write(row) {
                    Err(McapWriteError::Time { .. }) => {
                        self.left_out += 1;
                        return Ok(());
                    }
                    written => written.map_err(|error| failed(&error))?,
                }
                // the clock may be set back
                if (row.time - self.chunk).abs() >= CHUNK {
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
    pub fn finish(mut self) -> Result<String> {
        if let First::Kept(first) = std::mem::replace(&mut self.first, First::Written) {
            self.append(&first)?;
        }
        let path = self.path.display();
        if let Recorder::Mcap(mcap) = self.recorder {
            mcap.finish().map_err(|error| {
                anyhow!("{path}: cannot be ended: {error}; what was written before can be read")
            })?;
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
