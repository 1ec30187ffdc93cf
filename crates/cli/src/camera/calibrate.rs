//! `stickslip calibrate`: a camera from frames of a tag board.

use std::path::Path;

use anyhow::{Context, Result};
use image::GrayImage;
use serde::Serialize;
use stickslip_report::Table;
use stickslip_vision::{
    BoardOnTable, Calibration, Camera, Lens, TableFit, find_table, read_board, read_camera_info,
    read_lens, search_board, write_camera,
};

use super::args::CalibrateArgs;
use super::bag_images::BagImages;
use super::frames::FrameFolder;
use crate::experiment::text_of;
use crate::failure::hinted;
use crate::files::{ready_file, write_file};
use crate::output::{counted, show_result, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;

/// Names of a lens's numbers, in the order of their standard deviations.
const LENS: [&str; 8] = [
    "fx (px)", "fy (px)", "cx (px)", "cy (px)", "k1", "k2", "p1", "p2",
];

/// Number of images of a bag that a lens is found from.
const FRAMES: usize = 30;

/// Printed result of a calibration.
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

/// Printed result of a table that was found alone.
#[derive(Debug, Serialize)]
struct TableSummary {
    tags: usize,
    tags_left_out: usize,
    misfit_px: f64,
    camera_height_m: f64,
    place_std_mm: [f64; 3],
    turn_std_deg: [f64; 3],
}

/// Runs the command.
pub fn calibrate(args: &CalibrateArgs) -> Result<Verdict> {
    let board = read_board(
        &text_of(&args.board, "board")?,
        &args.board.display().to_string(),
    )?;
    let inputs: Vec<&Path> = [Some(args.board.as_path()), args.lens.as_deref()]
        .into_iter()
        .flatten()
        .collect();
    ready_file(&args.out, &inputs)?;
    let bag = BagImages::find(&args.frames, &args.topics)?;
    let lens = args.lens.as_deref().map(lens_of).transpose()?;
    match (bag, lens) {
        (Some(bag), lens) => {
            let number = args.flat.as_deref().map_or(Ok(1), number)?;
            match lens.map_or_else(|| bag.lens(), |lens| Ok(Some(lens)))? {
                Some(lens) => table(args, &board, &lens, bag.frame(number)?),
                None => lens_and_table_of_bag(args, &board, &bag, number),
            }
        }
        (None, Some(lens)) => {
            let folder = FrameFolder::list(&args.frames)?;
            let frame = folder.load(flat(args, &folder)?)?;
            table(args, &board, &lens, frame)
        }
        (None, None) => lens_and_table_of_folder(args, &board),
    }
}

/// Finds the lens and the table from a folder of images.
fn lens_and_table_of_folder(args: &CalibrateArgs, board: &BoardOnTable) -> Result<Verdict> {
    let folder = FrameFolder::list(&args.frames)?;
    let flat = flat(args, &folder)?;
    lens_and_table(args, board, flat, folder.names.len(), |index| {
        folder.load(index)
    })
}

/// Finds the lens and the table from images of a bag, of which one shows the board on the table.
fn lens_and_table_of_bag(
    args: &CalibrateArgs,
    board: &BoardOnTable,
    bag: &BagImages,
    number: usize,
) -> Result<Verdict> {
    let numbers = spread(bag.count()?, number);
    let flat = numbers.iter().position(|other| *other == number);
    let frames = bag.frames(&numbers)?;
    talk(format_args!(
        "note: the lens is calibrated from {} of the bag",
        counted(frames.len() as u64, "image")
    ));
    let load = |index: usize| Ok(frames[index].clone());
    lens_and_table(args, board, flat.unwrap_or(0), frames.len(), load)
}

/// Finds the lens and the table from so many frames; in the one at `flat` the board lies on the
/// table.
fn lens_and_table(
    args: &CalibrateArgs,
    board: &BoardOnTable,
    flat: usize,
    count: usize,
    load: impl Fn(usize) -> Result<(String, GrayImage)> + Sync,
) -> Result<Verdict> {
    let progress = bar(count, "frames", Work::Long);
    let pool = args.threads.pool()?;
    let load = |index: usize| {
        progress.inc(1);
        load(index)
    };
    let recording = pool.install(|| search_board(count, load));
    progress.finish_and_clear();
    let calibration = stickslip_vision::calibrate(&recording?, board, flat)
        .with_context(|| args.frames.display().to_string())?;
    write(args, &calibration.camera)?;
    let summary = Summary::new(&calibration);
    show_result(args.json, &summary, || summary.text())?;
    talk(format_args!("wrote {}", args.out.display()));
    Ok(Verdict::Done)
}

/// Numbers, from 1, of images that a lens is found from: all, or [`FRAMES`] from the first to the
/// last evenly, and the one that is `needed` if there is such an image.
fn spread(count: usize, needed: usize) -> Vec<usize> {
    let mut numbers: Vec<usize> = match count {
        0..=FRAMES => (1..=count).collect(),
        _ => (0..FRAMES)
            .map(|k| 1 + k * (count - 1) / (FRAMES - 1))
            .collect(),
    };
    numbers.push(needed);
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Finds the table from one image, through a lens that is known.
fn table(
    args: &CalibrateArgs,
    board: &BoardOnTable,
    lens: &Lens,
    frame: (String, GrayImage),
) -> Result<Verdict> {
    let recording = search_board(1, |_| anyhow::Ok(frame.clone()))?;
    let fit =
        find_table(&recording, board, lens).with_context(|| args.frames.display().to_string())?;
    write(args, &fit.camera)?;
    let summary = TableSummary::new(&fit);
    show_result(args.json, &summary, || summary.text())?;
    talk(format_args!("wrote {}", args.out.display()));
    Ok(Verdict::Done)
}

fn write(args: &CalibrateArgs, camera: &Camera) -> Result<()> {
    write_file(&args.out, write_camera(camera).as_bytes())
}

/// The lens in a file.
fn lens_of(path: &Path) -> Result<Lens> {
    let (text, name) = (text_of(path, "lens")?, path.display().to_string());
    if path.extension().is_some_and(|ending| ending == "toml") {
        return Ok(read_lens(&text, &name)?);
    }
    let lens = read_camera_info(&text, &name)?.lens(&name)?;
    lens.ok_or_else(|| {
        hinted(
            format!("{name}: the camera was not calibrated: its focal length is 0"),
            "leave --lens out, and give a folder with frames of the board tilted to all sides",
        )
    })
}

/// The number of an image of a bag.
fn number(text: &str) -> Result<usize> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| {
        hinted(
            format!("--flat {text}: images of a bag have no names"),
            "give the number of an image, from 1",
        )
    })
}

/// Number of the image in a folder that shows the board on the table.
fn flat(args: &CalibrateArgs, folder: &FrameFolder) -> Result<usize> {
    let Some(name) = &args.flat else {
        return Ok(0);
    };
    let names = &folder.names;
    names.iter().position(|other| other == name).ok_or_else(|| {
        let (first, last) = (&names[0], &names[names.len() - 1]);
        hinted(
            format!("--flat {name}: there is no such image; the first is {first}, the last {last}"),
            "give the name of an image without its folder",
        )
    })
}

impl Summary {
    fn new(calibration: &Calibration) -> Self {
        Self {
            frames: calibration.frames,
            tags: calibration.tags,
            tags_left_out: calibration.left_out,
            misfit_px: calibration.rms,
            lens: calibration.camera.lens().calibrated(),
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
            "{}, {}, {tags_left_out} left out; misfit {misfit_px:.3} px, camera {camera_height_m:.3} m above the table\n\n{table}",
            counted(*frames as u64, "frame"),
            counted(*tags as u64, "tag")
        )
    }
}

impl TableSummary {
    fn new(fit: &TableFit) -> Self {
        Self {
            tags: fit.tags,
            tags_left_out: fit.left_out,
            misfit_px: fit.rms,
            camera_height_m: fit.camera.centre()[2],
            place_std_mm: fit.translation_std.map(|std| 1e3 * std),
            turn_std_deg: fit.rotation_std.map(f64::to_degrees),
        }
    }

    fn text(&self) -> String {
        let Self {
            tags,
            tags_left_out,
            misfit_px,
            camera_height_m,
            place_std_mm,
            turn_std_deg,
        } = self;
        let mut table = Table::new(["board in the camera frame", "std mm", "std deg"]);
        for (axis, (place, turn)) in ["x", "y", "z"]
            .iter()
            .zip(place_std_mm.iter().zip(turn_std_deg))
        {
            table.push([
                (*axis).to_owned(),
                format!("{place:.4}"),
                format!("{turn:.4}"),
            ]);
        }
        format!(
            "{}, {tags_left_out} left out; misfit {misfit_px:.3} px, camera {camera_height_m:.3} m above the table, with the given lens\n\n{table}",
            counted(*tags as u64, "tag")
        )
    }
}
