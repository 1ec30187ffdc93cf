//! `stickslip calibrate`: a camera from frames of a tag board.

use anyhow::{Context, Result};
use serde::Serialize;
use stickslip_vision::{Calibration, read_board, search_board, write_camera};

use crate::camera_args::CalibrateArgs;
use crate::experiment::text_of;
use crate::failure::hinted;
use crate::files::{ready_file, write_file};
use crate::frames::FrameFolder;
use crate::output::{show_result, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;
use stickslip_report::Table;

/// Names of a lens's numbers, in the order of their standard deviations.
const LENS: [&str; 8] = [
    "fx (px)", "fy (px)", "cx (px)", "cy (px)", "k1", "k2", "p1", "p2",
];

/// What is printed of a calibration.
#[derive(Debug, Serialize)]
struct Summary {
    frames: usize,
    tags: usize,
    tags_left_out: usize,
    misfit_px: f64,
    lens: [f64; 8],
    lens_std: [f64; 8],
    camera_height_m: f64,
}

/// Runs the command.
pub fn calibrate(args: &CalibrateArgs) -> Result<Verdict> {
    let board = read_board(
        &text_of(&args.board, "board")?,
        &args.board.display().to_string(),
    )?;
    ready_file(&args.out, &[&args.board])?;
    let folder = FrameFolder::list(&args.frames)?;
    let flat = match &args.flat {
        None => 0,
        Some(name) => folder
            .names
            .iter()
            .position(|other| other == name)
            .ok_or_else(|| no_such_frame(name, &folder))?,
    };
    let progress = bar(folder.names.len(), "frames", Work::Long);
    let pool = args.threads.pool()?;
    let load = |index: usize| {
        progress.inc(1);
        folder.load(index)
    };
    let recording = pool.install(|| search_board(folder.names.len(), load));
    progress.finish_and_clear();
    let calibration = stickslip_vision::calibrate(&recording?, &board, flat)
        .with_context(|| args.frames.display().to_string())?;
    write_file(&args.out, write_camera(&calibration.camera).as_bytes())?;
    let summary = Summary::new(&calibration);
    show_result(args.json, &summary, || summary.text())?;
    talk(format_args!("wrote {}", args.out.display()));
    Ok(Verdict::Done)
}

fn no_such_frame(name: &str, folder: &FrameFolder) -> anyhow::Error {
    let (first, last) = (&folder.names[0], &folder.names[folder.names.len() - 1]);
    hinted(
        format!("--flat {name}: there is no such frame; they go from {first} to {last}"),
        "give the name of one without its folder",
    )
}

impl Summary {
    fn new(calibration: &Calibration) -> Self {
        let lens = calibration.camera.lens();
        let pairs = [lens.focal, lens.centre, lens.radial, lens.tangential];
        Self {
            frames: calibration.frames,
            tags: calibration.tags,
            tags_left_out: calibration.left_out,
            misfit_px: calibration.rms,
            lens: std::array::from_fn(|k| pairs[k / 2][k % 2]),
            lens_std: calibration.lens_std,
            camera_height_m: calibration.camera.centre()[2],
        }
    }

    fn text(&self) -> String {
        let Self {
            frames,
            tags,
            tags_left_out,
            misfit_px,
            camera_height_m,
            ..
        } = self;
        let mut table = Table::new(["lens", "value", "std"]);
        for (name, (value, std)) in LENS.iter().zip(self.lens.iter().zip(self.lens_std)) {
            table.push([
                (*name).to_owned(),
                format!("{value:.5}"),
                format!("{std:.5}"),
            ]);
        }
        format!(
            "{frames} frames, {tags} tags, {tags_left_out} tags left out; misfit {misfit_px:.3} px, camera {camera_height_m:.3} m above the \
             table\n\n{table}"
        )
    }
}
