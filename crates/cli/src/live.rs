//! `stickslip live`: rows as JSON lines on standard input, an estimate for each on standard output.

mod lines;
mod recording;
mod session;

use std::io::stdin;
use std::time::{Duration, Instant};

use anyhow::Result;
use stickslip::TrackerOptions;

use crate::experiment::read_scene_file;
use crate::live_args::LiveArgs;
use crate::output::{Reader, stream_line, talk};
use crate::verdict::Verdict;
use lines::Lines;
use recording::Recording;
use session::Session;

/// How long the answers took (ms), and how many were late.
#[derive(Default)]
struct Latencies {
    taken: Vec<f32>,
    missed: usize,
}

/// Runs the command.
pub fn live(args: &LiveArgs) -> Result<Verdict> {
    let setup = read_scene_file(&args.scene)?;
    let options = TrackerOptions {
        mode: args.mode.into(),
        particles: args.particles,
        seed: args.seed,
        tactile: args.tactile(),
        late: args.late,
        ..TrackerOptions::default()
    };
    let mut session = Session::new(&setup, &options)?;
    let sensors = setup.scene.fixels.len();
    let mut recording = args
        .record
        .as_deref()
        .map(|path| Recording::create(path, sensors, &args.scene))
        .transpose()?;
    let pool = args.threads.filter_pool(args.particles)?;
    let lines = Lines::read(stdin());

    // one answer per line, until the source ends or nobody reads the answers
    let mut latencies = Latencies::default();
    let ended = pool.install(|| -> Result<()> {
        for line in lines {
            let answer = session.answer(line.number, line.text);
            if answer.text.is_empty() {
                continue;
            }
            if let Some((recording, row)) = recording.as_mut().zip(answer.row.as_ref()) {
                recording.write(row)?;
            }
            let reader = stream_line(&answer.text)?;
            latencies.add(line.arrived, args.deadline_ms);
            if reader == Reader::Gone {
                break;
            }
        }
        Ok(())
    });
    if let Some(recording) = recording {
        talk(recording.finish()?);
    }
    ended?;
    talk(session.summary());
    if let Some(text) = latencies.summary(args.deadline_ms) {
        talk(text);
    }
    Ok(if session.refused() == 0 {
        Verdict::Done
    } else {
        Verdict::InputLost
    })
}

impl Latencies {
    /// Takes the time since a line arrived.
    fn add(&mut self, arrived: Instant, deadline: Option<f64>) {
        /// Answers that are kept for the quantiles: a day at 100 Hz, in 40 MB.
        const MOST: usize = 10_000_000;
        let taken: Duration = arrived.elapsed();
        let milliseconds = 1e3 * taken.as_secs_f64();
        self.missed += usize::from(deadline.is_some_and(|deadline| milliseconds > deadline));
        if self.taken.len() < MOST {
            self.taken.push(milliseconds as f32);
        }
    }

    fn summary(mut self, deadline: Option<f64>) -> Option<String> {
        self.taken.sort_by(f32::total_cmp);
        let last = self.taken.len().checked_sub(1)?;
        let [median, late, most] = [last / 2, last * 99 / 100, last].map(|index| self.taken[index]);
        let missed = deadline.map_or(String::new(), |deadline| {
            format!("; {} missed the deadline of {deadline} ms", self.missed)
        });
        Some(format!(
            "answered within {median:.2} ms (median), {late:.2} ms (99 %), {most:.2} ms (all){missed}"
        ))
    }
}
