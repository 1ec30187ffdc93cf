//! `stickslip render`: camera frames of an experiment, with all that tracking needs.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::Result;
use rayon::prelude::*;
use stickslip_evaluation::Reference;
use stickslip_formats::{BagOptions, Experiment, FrameList, write_frames};
use stickslip_rendering::{
    CaptureSettings, FrameGrabber, Optics, RecordedMotion, Video, encode_png,
};
use stickslip_vision::{BoardOnTable, write_board, write_tags};

use super::args::RenderArgs;
use super::setup::CameraSetup;
use crate::arg_values::Rows;
use crate::experiment::{read_folder, reference_name};
use crate::failure::hinted;
use crate::files::{make_folder, write_out};
use crate::log_files::log_path;
use crate::output::{counted, show, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;

/// Runs the command.
pub fn render(args: &RenderArgs) -> Result<Verdict> {
    let (experiment, verdict) = read_folder(
        &args.folder,
        &args.folder.join("scene.toml"),
        &BagOptions::default(),
    )?;
    let scene = &experiment.setup.scene;
    let recorded = recorded(args, &experiment)?;
    let optics = Optics {
        blur: args.blur,
        ..Optics::default()
    };
    let setup = CameraSetup::new(scene, std::slice::from_ref(&recorded), optics, args.seed)?;
    let settings = CaptureSettings {
        exposure: args.exposure,
        grabber: FrameGrabber {
            repeat: args.repeat,
            seed: args.seed,
        },
        covered: covered(args, &experiment),
        hand_height: setup.hand_height,
    };
    let film = Video {
        renderer: &setup.renderer,
        motion: &recorded,
        settings,
    };

    let pool = args.threads.pool()?;
    let out = Out(&args.out);
    let frames = pool.install(|| out.frames(&film))?;
    let board = pool.install(|| out.board(&setup, args.board_frames))?;
    out.text("board.toml", &write_board(&board))?;
    out.text("tags.toml", &write_tags(&setup.tags))?;
    for name in ["scene.toml", "truth.csv", "truth.json"] {
        if let Ok(bytes) = fs::read(args.folder.join(name)) {
            write(&args.out.join(name), &bytes)?;
        }
    }
    talk(format_args!(
        "wrote {} and {} to {}",
        counted(frames as u64, "frame"),
        counted(u64::from(args.board_frames), "board frame"),
        args.out.display()
    ));
    show(format_args!(
        "stickslip calibrate {0}/board --board {0}/board.toml --out {0}/calibration.toml\n\
         stickslip track {0}/frames --calibration {0}/calibration.toml --tags {0}/tags.toml --sensors {1} --out {0}",
        args.out.display(),
        log_path(&args.folder).display()
    ))?;
    Ok(verdict)
}

/// Poses of object and fingers: the object's by the truth, else by the log.
fn recorded(args: &RenderArgs, experiment: &Experiment) -> Result<RecordedMotion> {
    let reference = Reference::of(experiment).pose;
    let unknown = reference.iter().position(Option::is_none);
    if let Some(row) = unknown {
        let text = format!(
            "{}: {} has no object pose at row {row}",
            args.folder.display(),
            reference_name(experiment)
        );
        return Err(hinted(
            text,
            "give an experiment with truth.csv over all rows of its log",
        ));
    }
    Ok(RecordedMotion {
        time: experiment.log.time.clone(),
        object: reference.into_iter().flatten().collect(),
        pusher: experiment.log.pusher.clone(),
        other_fingers: experiment.log.other_fingers.clone(),
    })
}

/// The frames in which the hand covers the object's tag.
fn covered(args: &RenderArgs, experiment: &Experiment) -> Range<usize> {
    let end = experiment.log.len();
    match (args.cover, experiment.facts.occlude_from) {
        (Some(Rows { from, to }), _) => from.min(end)..to.unwrap_or(end).min(end),
        (None, Some(from)) => from.min(end)..end,
        (None, None) => 0..0,
    }
}

/// The folder that is written to.
struct Out<'a>(&'a Path);

impl Out<'_> {
    /// Frames and frames.csv; returns how many.
    fn frames(&self, film: &Video<'_>) -> Result<usize> {
        let folder = self.folder("frames")?;
        let time = &film.motion.time;
        let progress = bar(time.len(), "frames", Work::Long);
        let file: Vec<String> = (0..time.len())
            .map(|index| format!("{index:06}.png"))
            .collect();
        file.par_iter().enumerate().try_for_each(|(index, name)| {
            let written = write(&folder.join(name), &encode_png(&film.frame(index)));
            progress.inc(1);
            written
        })?;
        progress.finish_and_clear();
        let list = FrameList {
            time: time.clone(),
            file,
        };
        write_out(&folder.join("frames.csv"), |file| write_frames(file, &list))?;
        Ok(time.len())
    }

    /// Frames of the board, and how it lies in the first one.
    fn board(&self, setup: &CameraSetup, count: u16) -> Result<BoardOnTable> {
        let folder = self.folder("board")?;
        let board = setup.board(usize::from(count))?;
        board.frames(setup, |index, frame| {
            write(&folder.join(format!("{index:03}.png")), &encode_png(&frame))
        })?;
        Ok(board.on_table)
    }

    fn text(&self, name: &str, text: &str) -> Result<()> {
        write(&self.0.join(name), text.as_bytes())
    }

    fn folder(&self, name: &str) -> Result<PathBuf> {
        let folder = self.0.join(name);
        make_folder(&folder)?;
        Ok(folder)
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_out(path, |file| file.write_all(bytes))
}
