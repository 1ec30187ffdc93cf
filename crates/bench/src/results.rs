//! The file of results: [`Results`].

use std::fs::{File, OpenOptions, create_dir_all};
use std::io::{self, Write};
use std::path::Path;

use crate::machine::{date, processor};

/// Folder of the files of results, from this crate.
const FOLDER: &str = "../../bench/results";

/// Prints measurements and appends them to `bench/results/<machine>-<date>.csv`: columns
/// `name,value,unit`.
#[derive(Debug)]
pub struct Results {
    file: File,
}

impl Results {
    /// Opens today's file of this machine, with its header where it is new.
    ///
    /// # Errors
    /// The file cannot be made or written.
    pub fn open() -> io::Result<Self> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER);
        create_dir_all(&folder)?;
        let (machine, date) = (processor(), date());
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(folder.join(format!("{machine}-{date}.csv")))?;
        if file.metadata()?.len() == 0 {
            writeln!(file, "# machine: {machine}; date: {date}\nname,value,unit")?;
        }
        Ok(Self { file })
    }

    /// One figure, NaN for `None`; `name` holds no comma.
    ///
    /// # Errors
    /// The file or standard output cannot be written.
    pub fn write(
        &mut self,
        name: &str,
        value: impl Into<Option<f64>>,
        unit: &str,
    ) -> io::Result<()> {
        let value: f64 = value.into().unwrap_or(f64::NAN);
        let value = if value != 0.0 && value.abs() < 1e-3 {
            format!("{value:.3e}")
        } else {
            format!("{value:.4}")
        };
        writeln!(io::stdout(), "{name:<58} {value:>14} {unit}")?;
        writeln!(self.file, "{name},{value},{unit}")
    }
}
