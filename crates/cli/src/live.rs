//! `stickslip live`: rows as JSON lines on standard input, an estimate for each on standard output.

mod latencies;
mod lines;
mod recording;
mod session;
mod shown_row;

use std::io::stdin;
use std::process::exit;

use anyhow::Result;
use stickslip::TrackerOptions;
use stickslip_report::live_page;

use crate::experiment::read_scene_file;
use crate::given::scene_file;
use crate::live_args::LiveArgs;
use crate::output::{Reader, stream_line, talk};
use crate::page_server::{PageServer, serve};
use crate::verdict::Verdict;
use lines::{Lines, Stop};
use recording::Recording;
use session::Session;

/// Runs the command.
pub fn live(args: &LiveArgs) -> Result<Verdict> {
    let scene = scene_file(&args.scene);
    let setup = read_scene_file(&scene)?;
    let options = TrackerOptions {
        model: args.model.into(),
        particles: args.particles,
        seed: args.seed,
        tactile: args.tactile(),
        late: args.late,
        ..TrackerOptions::default()
    };
    let deadline = args.deadline_ms.map(|milliseconds| 1e-3 * milliseconds);
    let mut session = Session::new(&setup, &options, deadline)?;
    let record = |path| Recording::create(path, &setup.scene);
    let mut recording = args.record.as_deref().map(record).transpose()?;
    let mut recorded = Verdict::Done;
    let page = |port| {
        let page = live_page(&setup.scene, &scene.display().to_string());
        serve(page, None, (port, "--page=8321"))
    };
    let page = args.page.map(page).transpose()?;
    let page = page.as_ref().map(PageServer::notices);
    let pool = args.threads.filter_pool(args.particles)?;
    let lines = Lines::read(stdin());
    stop_on_signal(lines.stop());

    // one answer per line, until the source ends or the reader of the answers has left
    let ended = pool.install(|| -> Result<()> {
        for line in lines {
            let arrived = line.arrived;
            let answer = session.answer(line);
            if answer.text.is_empty() {
                continue;
            }
            let reader = stream_line(&answer.text)?;
            session.answered(arrived);
            if let Some(page) = page.filter(|page| page.wants())
                && let Some(shown) = session.shown(&answer, arrived)
            {
                page.show(shown);
            }
            // the robot has its answer, whatever becomes of the recording
            if let Some((kept, row)) = recording.as_mut().zip(answer.row.as_ref())
                && let Err(error) = kept.write(row)
            {
                talk(format_args!(
                    "warning: {error}; the session goes on without recording"
                ));
                recording = None;
                recorded = Verdict::InputLost;
            }
            if reader == Reader::Gone {
                break;
            }
        }
        Ok(())
    });
    match recording.map(Recording::finish) {
        Some(Ok(report)) => talk(report),
        Some(Err(error)) => {
            talk(format_args!("warning: {error}"));
            recorded = Verdict::InputLost;
        }
        None => {}
    }
    ended?;
    for text in session.summary() {
        talk(text);
    }
    Ok(match session.refused() {
        0 => recorded,
        _ => Verdict::InputLost,
    })
}

/// Ends the session at Ctrl-C, SIGTERM or SIGHUP as the end of its source does; ends the program at
/// the second one.
fn stop_on_signal(stop: Stop) {
    /// Exit code of a shell for a program that Ctrl-C has ended.
    const INTERRUPTED: i32 = 130;
    let on_signal = move || {
        if !stop.set() {
            exit(INTERRUPTED);
        }
    };
    if let Err(error) = ctrlc::set_handler(on_signal) {
        talk(format_args!(
            "warning: a signal ends the program and not only its source: {error}"
        ));
    }
}
