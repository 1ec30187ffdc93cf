//! `stickslip track`: object and pusher through camera frames, into a log.

use std::io::{Cursor, Write};
use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use stickslip::{Log, quantile};
use stickslip_formats::{BagOptions, Readings, Topics, write_log, write_log_mcap};
use stickslip_report::{Table, number};
use stickslip_vision::{
    BodyTag, Camera, ConfigError, ConfigProblem, FrameSighting, Measurement, Sighting, Tags, Track,
    TrackError, read_camera, read_camera_with, read_tags, write_poses,
};

use super::args::TrackArgs;
use super::bag_images::{BagImages, TrackedBag};
use super::frames::FrameFolder;
use crate::experiment::text_of;
use crate::failure::hinted;
use crate::files::{Results, ready_folder};
use crate::log_files::LogFiles;
use crate::output::{counted, show_result, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;

/// Rows of two logs this close are at the same time (s).
const SAME_TIME: f64 = 1e-4;
/// A tag seen larger or smaller by this share than given was given wrongly, or its height was.
const SIZE_OFF: f64 = 0.02;

/// Printed result of a body.
#[derive(Debug, Serialize)]
struct BodySummary {
    measured: usize,
    missing: usize,
    distorted: usize,
    twice: usize,
    median_position_std_mm: Option<f64>,
    median_orientation_std_deg: Option<f64>,
    median_tag_size_m: Option<f64>,
}

/// Printed result of a track.
#[derive(Debug, Serialize)]
struct Summary {
    frames: usize,
    repeated: usize,
    object: BodySummary,
    pusher: BodySummary,
}

/// Runs the command.
pub fn track(args: &TrackArgs) -> Result<Verdict> {
    let tags = read_tags(
        &text_of(&args.tags, "tags file")?,
        &args.tags.display().to_string(),
    )?;
    ready_folder(&args.out)?;
    let TrackedBag {
        time,
        track: found,
        readings,
        verdict,
    } = match BagImages::find(&args.frames, &args.topics)? {
        Some(bag) => of_bag(args, &bag, &tags)?,
        None => of_folder(args, &tags)?,
    };
    let log = Log {
        object: found.object(),
        object_covariance: Vec::new(),
        pusher: found.pusher(),
        other_fingers: Vec::new(),
        time,
        tactile: readings.tactile,
        force: readings.force,
    };
    let (log, sensors) = with_sensors(args, log)?;
    let verdict = verdict.and(sensors);
    write(&args.out, &log, &found)?;
    let summary = Summary::new(&found);
    show_result(args.json, &summary, || summary.text())?;
    for (body, seen, given) in [
        ("object", &summary.object, tags.object),
        ("pusher", &summary.pusher, tags.pusher),
    ] {
        warn_of_size(body, seen, given);
    }
    talk(format_args!(
        "wrote {}, log.mcap and poses.csv",
        args.out.join("log.csv").display()
    ));
    Ok(verdict)
}

/// Poses in a bag of images.
fn of_bag(args: &TrackArgs, bag: &BagImages, tags: &Tags) -> Result<TrackedBag> {
    if let Some(rate) = args.rate {
        return Err(hinted(
            format!(
                "{}: the bag's images have times, and --rate {rate} gives others",
                args.frames.display()
            ),
            "leave --rate out",
        ));
    }
    let camera = match bag.lens()? {
        None => camera(args)?,
        Some(lens) => {
            let (text, name) = calibration(args)?;
            read_camera_with(&text, &name, &lens).map_err(other_lens)?
        }
    };
    bag.track(&camera, tags, &args.threads)
}

/// Adds the option by which the command line chooses the lens of the images.
fn other_lens(error: ConfigError) -> anyhow::Error {
    match error.problem {
        ConfigProblem::OtherLens { .. } => hinted(
            error.to_string(),
            "or take the lens of the calibration for the images, too, with --topic info=",
        ),
        _ => error.into(),
    }
}

/// Poses in a folder of images.
fn of_folder(args: &TrackArgs, tags: &Tags) -> Result<TrackedBag> {
    let camera = camera(args)?;
    let folder = FrameFolder::list(&args.frames)?;
    Ok(TrackedBag {
        time: times(args, &folder)?,
        track: found(args, &folder, &camera, tags)?,
        readings: Readings::default(),
        verdict: Verdict::Done,
    })
}

/// The calibration's text and name.
fn calibration(args: &TrackArgs) -> Result<(String, String)> {
    let text = text_of(&args.calibration, "calibration")?;
    Ok((text, args.calibration.display().to_string()))
}

fn camera(args: &TrackArgs) -> Result<Camera> {
    let (text, name) = calibration(args)?;
    Ok(read_camera(&text, &name)?)
}

/// Times of the frames: those of frames.csv, else by the rate.
fn times(args: &TrackArgs, folder: &FrameFolder) -> Result<Vec<f64>> {
    match (&folder.time, args.rate) {
        (Some(_), Some(rate)) => Err(hinted(
            format!(
                "{}: frames.csv gives times, and --rate {rate} others",
                args.frames.display()
            ),
            "leave --rate out, or move frames.csv away",
        )),
        (Some(time), None) => Ok(time.clone()),
        (None, Some(rate)) => match &folder.question {
            Some(question) => Err(hinted(
                format!("{}: {question}", args.frames.display()),
                "write frames.csv (time,file) into the folder, or rename the images",
            )),
            None => Ok((0..folder.names.len())
                .map(|index| index as f64 / rate)
                .collect()),
        },
        (None, None) => Err(hinted(
            format!(
                "{}: there is no frames.csv, so the frames have no times",
                args.frames.display()
            ),
            "write frames.csv (time,file), or give the frames per second with --rate",
        )),
    }
}

/// Finds the poses in the frames, on as many threads as asked for.
fn found(args: &TrackArgs, folder: &FrameFolder, camera: &Camera, tags: &Tags) -> Result<Track> {
    let progress = bar(folder.names.len(), "frames", Work::Long);
    let pool = args.threads.pool()?;
    let load = |index: usize| {
        progress.inc(1);
        folder.load(index)
    };
    let track = pool.install(|| stickslip_vision::track(folder.names.len(), load, camera, tags));
    progress.finish_and_clear();
    track.map_err(|error| {
        if error.is::<TrackError>() {
            error.context(args.frames.display().to_string())
        } else {
            error
        }
    })
}

/// The log with the readings of another one at the same times, and whether all of that could be
/// read.
fn with_sensors(args: &TrackArgs, log: Log) -> Result<(Log, Verdict)> {
    let Some(path) = &args.sensors else {
        return Ok((log, Verdict::Done));
    };
    let files = LogFiles::find(path)?;
    let (sensors, warnings) = files.read(&BagOptions::default())?;
    let verdict = files.told(&warnings);
    let differ = || {
        (0..log.len().max(sensors.len()))
            .find(|row| differs(log.time.get(*row), sensors.time.get(*row)))
    };
    if let Some(row) = differ() {
        let shown =
            |time: Option<&f64>| time.map_or("nothing".to_owned(), |time| format!("{time} s"));
        return Err(hinted(
            format!(
                "{}: row {row} is at {}, frame {row} at {}",
                path.display(),
                shown(sensors.time.get(row)),
                shown(log.time.get(row))
            ),
            "give a log with one row for each frame, at its time",
        ));
    }
    Ok((
        Log {
            tactile: sensors.tactile,
            force: sensors.force,
            // they have no tags
            other_fingers: sensors.other_fingers,
            ..log
        },
        verdict,
    ))
}

fn differs(a: Option<&f64>, b: Option<&f64>) -> bool {
    a.zip(b).is_none_or(|(a, b)| (a - b).abs() > SAME_TIME)
}

/// Writes log.csv, poses.csv and log.mcap into `folder`; other files there stay as they are.
fn write(folder: &Path, log: &Log, track: &Track) -> Result<()> {
    let mut results = Results::default();
    results.add(folder.join("log.csv"), |file| write_log(file, log))?;
    results.add(folder.join("poses.csv"), |file| {
        write_poses(file, &log.time, track)
    })?;
    let path = folder.join("log.mcap");
    let mut bytes = Cursor::new(Vec::new());
    let packed = write_log_mcap(&mut bytes, log, &Topics::default()).map_err(|error| {
        hinted(
            format!("{}: {error}", path.display()),
            "log.csv and poses.csv are written; log.mcap needs other times in frames.csv",
        )
    });
    if packed.is_ok() {
        results.add(path, |file| file.write_all(&bytes.into_inner()))?;
    }
    results.place()?;
    packed
}

fn warn_of_size(body: &str, seen: &BodySummary, given: BodyTag) {
    let Some(size) = seen
        .median_tag_size_m
        .filter(|size| (size / given.place.size - 1.0).abs() > SIZE_OFF)
    else {
        return;
    };
    talk(format_args!(
        "warning: {body} tag {:.1} mm wide at height {} m; tags.toml: {body}.size {:.1} mm. Measure the edge of its black square, and its height",
        1e3 * size,
        given.place.height,
        1e3 * given.place.size
    ));
}

impl BodySummary {
    fn new(track: &Track, body: impl Fn(&FrameSighting) -> Sighting) -> Self {
        let seen: Vec<Sighting> = track
            .frames
            .iter()
            .filter(|frame| !frame.repeated)
            .map(body)
            .collect();
        let measured: Vec<&Measurement> = seen
            .iter()
            .filter_map(|s| {
                if let Sighting::Measured(m) = s {
                    Some(m)
                } else {
                    None
                }
            })
            .collect();
        let median = |of: &dyn Fn(&Measurement) -> f64| {
            let numbers: Vec<f64> = measured.iter().map(|m| of(m)).collect();
            quantile(&numbers, 0.5)
        };
        let count = |kind: Sighting| seen.iter().filter(|s| **s == kind).count();
        Self {
            measured: measured.len(),
            missing: count(Sighting::Missing),
            distorted: count(Sighting::Distorted),
            twice: count(Sighting::Twice),
            median_position_std_mm: median(&|m| {
                1e3 * ((m.covariance[(0, 0)] + m.covariance[(1, 1)]) / 2.0).sqrt()
            }),
            median_orientation_std_deg: median(&|m| m.std()[2].to_degrees()),
            median_tag_size_m: median(&|m| m.size),
        }
    }
}

impl Summary {
    fn new(track: &Track) -> Self {
        Self {
            frames: track.frames.len(),
            repeated: track.frames.iter().filter(|frame| frame.repeated).count(),
            object: BodySummary::new(track, |frame| frame.object),
            pusher: BodySummary::new(track, |frame| frame.pusher),
        }
    }

    fn text(&self) -> String {
        let mut table = Table::new([
            "body",
            "measured",
            "missing",
            "distorted",
            "twice",
            "std mm",
            "std deg",
        ]);
        for (name, body) in [("object", &self.object), ("pusher", &self.pusher)] {
            let counts = [body.measured, body.missing, body.distorted, body.twice]
                .map(|count| count.to_string());
            let stds = [
                number(body.median_position_std_mm, 4),
                number(body.median_orientation_std_deg, 4),
            ];
            table.push([name.to_owned()].into_iter().chain(counts).chain(stds));
        }
        format!(
            "{}, {} repeated\n\n{table}",
            counted(self.frames as u64, "frame"),
            self.repeated
        )
    }
}
