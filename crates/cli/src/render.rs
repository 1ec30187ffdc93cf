//! `stickslip render`: camera frames of an experiment, with all that tracking needs.

use std::fs::{self, File};
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use rayon::prelude::*;
use stickslip::dynamics::Pose;
use stickslip_formats::{Experiment, FrameList, write_frames};
use stickslip_testbed::camera::{
    self, Camera, Film, Grabber, Lens, Optics, Props, Recorded, Stage, Studio, TagMount, Take, calibration_poses, encode_png,
};
use stickslip_vision::{Board, BoardOnTable, BodyTag, TagPlace, Tags, tag_cells, write_board, write_tags};

use crate::args::Rows;
use crate::camera_args::RenderArgs;
use crate::experiment::{read_folder, reference_name};
use crate::failure::hinted;
use crate::output::{show, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;

const OBJECT_TAG: u16 = 0;
const PUSHER_TAG: u16 = 1;
/// Room of the plate about what happens (m).
const PLATE_ROOM: f64 = 0.06;
/// Frames of the board are numbered from here, away from those of the experiment.
const BOARD_FRAMES: u64 = 1 << 40;
/// A board of 7 x 5 tags.
const BOARD: Board = Board { rows: 5, columns: 7, tag_size: 0.026, gap: 0.008, first_tag: 100 };
/// Its thickness (m).
const THICKNESS: f64 = 0.003;

/// Runs the command.
pub fn render(args: &RenderArgs) -> Result<Verdict> {
    let experiment = read_folder(&args.folder, "scene.toml")?;
    let recorded = recorded(args, &experiment)?;
    let scene = &experiment.setup.scene;
    let mut props = Props::of(scene, cells(OBJECT_TAG), cells(PUSHER_TAG), recorded.push_direction());
    let [low, high] = recorded.bounds(scene, &props);
    props.plate = [low.map(|x| x - PLATE_ROOM), high.map(|x| x + PLATE_ROOM)];
    let camera = Camera::over(Lens::industrial(), [low, high])?;
    let studio = Studio::new(camera, Stage::new(scene, &props), Optics { blur: args.blur, ..Optics::default() }, args.seed);
    let take = Take {
        exposure: args.exposure,
        grabber: Grabber { repeat: args.repeat, seed: args.seed },
        covered: covered(args, &experiment),
        hand_height: (props.hand.heights[0] + props.hand.heights[1]) / 2.0,
    };
    let film = Film { studio: &studio, recorded: &recorded, take };

    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.map_or(0, usize::from)).build()?;
    let out = Out(&args.out);
    let frames = pool.install(|| out.frames(&film))?;
    let board = pool.install(|| out.board(&studio, args.board_frames))?;
    out.text("board.toml", &write_board(&board))?;
    out.text("tags.toml", &write_tags(&tags(&props)))?;
    for name in ["scene.toml", "truth.csv", "truth.json"] {
        if let Ok(bytes) = fs::read(args.folder.join(name)) {
            write(&args.out.join(name), &bytes)?;
        }
    }
    talk(format_args!("wrote {frames} frames and {} of the board to {}", args.board_frames, args.out.display()));
    show(format_args!(
        "stickslip calibrate {0}/board --board {0}/board.toml --out {0}/calibration.toml\n\
         stickslip track {0}/frames --calibration {0}/calibration.toml --tags {0}/tags.toml --sensors {1} --out {0}",
        args.out.display(),
        args.folder.join("log.csv").display()
    ))?;
    Ok(Verdict::Done)
}

/// Where object and pusher are: the object as the truth has it, else as the log.
fn recorded(args: &RenderArgs, experiment: &Experiment) -> Result<Recorded> {
    let reference = experiment.reference().pose;
    let unknown = reference.iter().position(Option::is_none);
    if let Some(row) = unknown {
        let text = format!("{}: {} has no object pose at row {row}", args.folder.display(), reference_name(experiment));
        return Err(hinted(text, "give an experiment with truth.csv over all rows of its log"));
    }
    Ok(Recorded {
        time: experiment.log.time.clone(),
        object: reference.into_iter().flatten().collect(),
        pusher: experiment.log.pusher.clone(),
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

fn cells(id: u16) -> camera::TagCells {
    tag_cells(id).expect("the family has this tag")
}

fn tags(props: &Props) -> Tags {
    let of = |id: u16, mount: &Option<TagMount>| {
        let TagMount { tag, pose, height } = mount.expect("the standard props have both tags");
        BodyTag { id, place: TagPlace { size: tag.size, height, pose } }
    };
    Tags { object: of(OBJECT_TAG, &props.object_tag), pusher: of(PUSHER_TAG, &props.pusher_tag) }
}

/// The folder that is written to.
struct Out<'a>(&'a Path);

impl Out<'_> {
    /// Frames and frames.csv; returns how many.
    fn frames(&self, film: &Film<'_>) -> Result<usize> {
        let folder = self.folder("frames")?;
        let time = &film.recorded.time;
        let progress = bar(time.len(), "frames", Work::Long);
        let file: Vec<String> = (0..time.len()).map(|index| format!("{index:06}.png")).collect();
        file.par_iter().enumerate().try_for_each(|(index, name)| {
            let written = write(&folder.join(name), &encode_png(&film.frame(index)));
            progress.inc(1);
            written
        })?;
        progress.finish_and_clear();
        let list = folder.join("frames.csv");
        let created = File::create(&list).with_context(|| list.display().to_string())?;
        write_frames(created, &FrameList { time: time.clone(), file }).with_context(|| list.display().to_string())?;
        Ok(time.len())
    }

    /// Frames of the board, and how it lies in the first one.
    fn board(&self, studio: &Studio, count: u16) -> Result<BoardOnTable> {
        let folder = self.folder("board")?;
        let tags = BOARD.tags().map(cells).collect();
        let print = camera::Board { columns: usize::from(BOARD.columns), tag_size: BOARD.tag_size, gap: BOARD.gap, tags };
        let poses = calibration_poses(studio.camera(), &print, THICKNESS, usize::from(count))?;
        poses.par_iter().enumerate().try_for_each(|(index, pose)| {
            let frame = studio.board_frame(BOARD_FRAMES + index as u64, &print, pose);
            write(&folder.join(format!("{index:03}.png")), &encode_png(&frame))
        })?;
        let [x, y, _] = poses[0].origin;
        Ok(BoardOnTable { board: BOARD, thickness: THICKNESS, pose: Pose::new(x, y, 0.0) })
    }

    fn text(&self, name: &str, text: &str) -> Result<()> {
        write(&self.0.join(name), text.as_bytes())
    }

    fn folder(&self, name: &str) -> Result<PathBuf> {
        let folder = self.0.join(name);
        fs::create_dir_all(&folder).map_err(|error| {
            hinted(format!("{}: cannot be made: {error}", folder.display()), "give a folder that can be written to with --out")
        })?;
        Ok(folder)
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).map_err(|error| {
        hinted(format!("{}: cannot be written: {error}", path.display()), "give a folder that can be written to with --out")
    })
}
