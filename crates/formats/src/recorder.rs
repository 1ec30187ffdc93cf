//! Logs that are written row by row, as a live source brings them: [`CsvRecorder`],
//! [`McapRecorder`].

use std::io::{Seek, Write};

use stickslip::{Log, Row};
use stickslip_dynamics::Scene;

use crate::log_csv::{cells, header};
use crate::log_mcap::{LogMessages, McapWriteError, Topics};

/// Writes rows as `log.csv`.
pub struct CsvRecorder<W: Write> {
    writer: W,
    sensors: usize,
    fingers: usize,
}

/// Writes rows as a recording of ROS 2 messages.
pub struct McapRecorder<W: Write + Seek> {
    fingers: usize,
    messages: LogMessages<W>,
    sensors: usize,
}

impl<W: Write> CsvRecorder<W> {
    /// Writes the header of a log of `scene` with forces, covariances, and a column for each
    /// tactile sensor that its bodies may have.
    ///
    /// # Errors
    /// Those of `writer`.
    pub fn new(mut writer: W, scene: &Scene) -> std::io::Result<Self> {
        let (sensors, fingers) = (scene.sensors(), scene.pusher.fingers.len() - 1);
        let first = one_row(&Row::default(), sensors, fingers);
        writeln!(writer, "{}", header(&first).join(","))?;
        Ok(Self {
            writer,
            sensors,
            fingers,
        })
    }

    /// Writes a row, up to the operating system. Times must rise from row to row for the log to be
    /// read.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&mut self, row: &Row) -> std::io::Result<()> {
        let log = one_row(row, self.sensors, self.fingers);
        writeln!(self.writer, "{}", cells(&log, 0).join(","))?;
        self.writer.flush()
    }
}

impl<W: Write + Seek> McapRecorder<W> {
    /// Begins a recording of `scene` with forces, covariances, and a topic for each tactile sensor
    /// that its bodies may have.
    ///
    /// # Errors
    /// Those of `writer`.
    pub fn new(writer: W, scene: &Scene) -> Result<Self, McapWriteError> {
        let (sensors, fingers) = (scene.sensors(), scene.pusher.fingers.len() - 1);
        let log = one_row(&Row::default(), sensors, fingers);
        let messages = LogMessages::new(writer, &log, &Topics::default())?;
        Ok(Self {
            fingers,
            messages,
            sensors,
        })
    }

    /// Writes a row into the chunk at hand.
    ///
    /// # Errors
    /// A time that a stamp cannot hold, or what the writer says.
    pub fn write(&mut self, row: &Row) -> Result<(), McapWriteError> {
        self.messages
            .write(&one_row(row, self.sensors, self.fingers))
    }

    /// Ends the chunk at hand and writes it, up to the operating system: data written by then can
    /// be read whatever happens to the program.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn flush(&mut self) -> Result<(), McapWriteError> {
        self.messages.flush()
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(self) -> Result<(), McapWriteError> {
        self.messages.finish()
    }
}

/// A log of one row.
fn one_row(row: &Row, sensors: usize, fingers: usize) -> Log {
    let finger = |k: usize| vec![row.other_fingers.get(k).copied().flatten()];
    let reading = |k: usize| vec![row.tactile.get(k).copied().flatten()];
    Log {
        time: vec![row.time],
        object: vec![row.object],
        object_covariance: vec![row.object_covariance],
        pusher: vec![row.pusher],
        other_fingers: (0..fingers).map(finger).collect(),
        tactile: (0..sensors).map(reading).collect(),
        force: vec![row.force],
    }
}
