//! Lines of standard input as they arrive: [`Lines`], until a [`Stop`] ends them.

use std::io::{BufRead, BufReader, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

/// Longest line (bytes); a row with a thousand sensors takes 20 kB.
const LONGEST: usize = 1 << 16;

/// Lines that wait for their answers; the source then waits too.
const WAITING: usize = 1024;

/// A line as it arrived.
pub struct Line {
    /// Its number, from 1.
    pub number: u64,
    /// Time at which it was there as a whole.
    pub arrived: Instant,
    /// Its text, or the reason why it has none.
    pub text: Result<String, String>,
}

/// Lines in the order of their arrival.
pub struct Lines {
    /// `None` is their end.
    lines: Receiver<Option<Line>>,
    stop: Stop,
}

/// Ends the lines before their source ends.
#[derive(Clone)]
pub struct Stop {
    is_set: Arc<AtomicBool>,
    wake: SyncSender<Option<Line>>,
}

impl Stop {
    /// Ends the lines; returns false where they had ended.
    pub fn set(&self) -> bool {
        let is_first = !self.is_set.swap(true, Ordering::Relaxed);
        // where it is full, the reader is awake
        let _ = self.wake.try_send(None);
        is_first
    }
}

impl Lines {
    /// The lines of a source, read by a thread of their own, so that their time of arrival is
    /// known.
    pub fn read(source: impl Read + Send + 'static) -> Self {
        let (sender, lines) = sync_channel(WAITING);
        let stop = Stop {
            is_set: Arc::new(AtomicBool::new(false)),
            wake: sender.clone(),
        };
        thread::spawn(move || {
            let mut source = BufReader::new(source);
            for number in 1.. {
                let Some(text) = next_line(&mut source) else {
                    break;
                };
                let arrived = Instant::now();
                let line = Line {
                    number,
                    arrived,
                    text,
                };
                if sender.send(Some(line)).is_err() {
                    return;
                }
            }
            let _ = sender.send(None);
        });
        Self { lines, stop }
    }

    /// Flag that ends them.
    pub fn stop(&self) -> Stop {
        self.stop.clone()
    }
}

impl Iterator for Lines {
    type Item = Line;

    fn next(&mut self) -> Option<Line> {
        let next = self.lines.recv().ok().flatten();
        next.filter(|_| !self.stop.is_set.load(Ordering::Relaxed))
    }
}

/// The next line without its end; `None` where the source ends or cannot be read any more.
fn next_line(source: &mut impl BufRead) -> Option<Result<String, String>> {
    let mut bytes = Vec::new();
    let limit = LONGEST as u64 + 1;
    source.take(limit).read_until(b'\n', &mut bytes).ok()?;
    if bytes.is_empty() {
        return None;
    }
    if bytes.len() > LONGEST && bytes.last() != Some(&b'\n') {
        let rest = skip_line(source);
        return Some(Err(format!(
            "the line has {} bytes, more than the {LONGEST} that a row can have. Send one row per line",
            bytes.len() + rest
        )));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = 1 + error.utf8_error().valid_up_to();
        format!("the line is no UTF-8 text from byte {at} on. Send rows as JSON")
    });
    Some(text)
}

/// Reads to the end of the line, and keeps nothing; how many bytes that are.
fn skip_line(source: &mut impl BufRead) -> usize {
    let mut skipped = 0;
    loop {
        let Ok(bytes) = source.fill_buf() else {
            return skipped;
        };
        if bytes.is_empty() {
            return skipped;
        }
        let end = bytes.iter().position(|byte| *byte == b'\n');
        let used = end.map_or(bytes.len(), |end| end + 1);
        source.consume(used);
        skipped += used;
        if end.is_some() {
            return skipped;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_apart_whatever_is_in_them() {
        let long = "x".repeat(LONGEST + 1);
        let text = format!("a\n{long}\nb\r\n\n{}", "y".repeat(LONGEST));
        let bytes = [text.as_bytes(), b"\n\xff\nlast"].concat();
        let lines: Vec<Line> = Lines::read(std::io::Cursor::new(bytes)).collect();
        let texts: Vec<Result<&str, &str>> = lines
            .iter()
            .map(|line| line.text.as_deref().map_err(String::as_str))
            .collect();
        assert_eq!(
            (texts[0], texts[2], texts[3]),
            (Ok("a\n"), Ok("b\r\n"), Ok("\n"))
        );
        assert!(texts[1].is_err_and(|why| why.starts_with("the line has 65538 bytes")));
        assert_eq!(texts[4].map(str::len), Ok(LONGEST + 1));
        assert!(texts[5].is_err_and(|why| why.contains("from byte 1 on")));
        assert_eq!((texts[6], lines[6].number, lines.len()), (Ok("last"), 7, 7));
    }

    #[test]
    fn stop_ends_lines_of_a_source_that_goes_on() {
        let mut lines = Lines::read(std::io::repeat(b'\n'));
        assert!(lines.next().is_some());
        let stop = lines.stop();
        assert!(stop.set() && !stop.set());
        assert!(lines.next().is_none());

        // a source that says nothing is waited for, until it is stopped
        let (silent, _source) = std::io::pipe().unwrap();
        let mut lines = Lines::read(silent);
        let stop = lines.stop();
        let waiting = thread::spawn(move || lines.next().is_none());
        assert!(stop.set() && waiting.join().unwrap());
    }
}
