//! A playback as compact JSON, as `crates/report/page/player.js` reads it: whole numbers in small
//! units.

use std::iter::StepBy;
use std::ops::Range;

use serde_json::{Value, json};
use stickslip::dynamics::Pose;

use crate::curves::PoseError;
use crate::drawing::path_on_grid;
use crate::intervals::row_ranges;
use crate::marks::Mark;
use crate::outline::{Outline, bounds};
use crate::playback::{Playback, PlaybackRun, Touch};

/// Units per m, rad and mm or degree.
const LENGTH: f64 = 1e5;
const ANGLE: f64 = 1e4;
const ERROR: f64 = 1e3;

/// The least height of the picture as a share of its width, and the most.
const ASPECT: [f64; 2] = [0.62, 0.8];

/// Rows that are played back.
type Rows = StepBy<Range<usize>>;

/// All that is played back.
pub(crate) fn data(playback: &Playback) -> Value {
    // the times of the rows shown, and the events among them
    let rows = playback.shown();
    let stride = playback.stride();
    let time: Vec<f64> = rows.clone().map(|row| playback.time[row]).collect();
    let within = |mark: &&Mark| {
        let ends = time.first().zip(time.last());
        ends.is_some_and(|(first, last)| (*first..=*last).contains(&mark.time))
    };
    let marks = playback.marks.iter().filter(within).map(|mark| {
        let row = time.partition_point(|t| *t < mark.time - 1e-6);
        json!([row, mark.name])
    });

    // rows at which the camera is off
    let is_hidden = |row: usize| playback.hidden.get(row) == Some(&true);
    let hidden: Vec<u8> = rows.clone().map(|row| u8::from(is_hidden(row))).collect();

    // the bodies, and how far the object reaches from its origin (mm)
    let corners = playback.object.areas.iter().flatten();
    let reach = 1e3 * corners.map(|[x, y]| x.hypot(*y)).fold(0.001, f64::max);
    let last = time.len().saturating_sub(1);
    let place = |row: usize| (row / stride).min(last);
    let bodies = playback.touches.len();
    json!({
        "time": time.iter().map(|time| whole(*time, 1e3)).collect::<Vec<_>>(),
        "stride": stride,
        "poster": place(playback.poster),
        "start": place(playback.focus.start),
        "view": view(playback),
        "reach": reach,
        "object": body(&playback.object),
        "feet": playback.feet.iter().map(|foot| foot.map(|x| whole(x, LENGTH))).collect::<Vec<_>>(),
        "fingers": playback.fingers.iter().map(body).collect::<Vec<_>>(),
        "fixels": playback.fixels.iter().map(body).collect::<Vec<_>>(),
        "truth": poses(&playback.reference, rows.clone()),
        "fingerPoses": playback.finger_poses.iter().map(|column| poses(column, rows.clone())).collect::<Vec<_>>(),
        "dark": row_ranges(hidden.iter().map(|flag| *flag == 1)),
        "hidden": hidden,
        "touches": playback.touches.iter().map(|touch| contact(touch, rows.clone())).collect::<Vec<_>>(),
        "marks": marks.collect::<Vec<_>>(),
        "order": order(playback),
        "methods": playback.runs.iter().map(|shown| run(shown, bodies, rows.clone())).collect::<Vec<_>>(),
    })
}

/// Every run once, the lowest one first.
fn order(playback: &Playback) -> Vec<usize> {
    let runs = playback.runs.len();
    let mut order: Vec<usize> = Vec::new();
    for run in playback.lowest_first.iter().copied().chain(0..runs) {
        if run < runs && !order.contains(&run) {
            order.push(run);
        }
    }
    order
}

/// A number in whole units; null where it is not finite.
fn whole(value: f64, units: f64) -> Value {
    let rounded = (units * value).round();
    if rounded.is_finite() {
        json!(rounded as i64)
    } else {
        Value::Null
    }
}

/// Inside and boundary as paths (mm, upwards), and the middle.
pub(crate) fn body(outline: &Outline) -> Value {
    let text = |lines: &[Vec<[f64; 2]>], closed: bool| -> String {
        lines
            .iter()
            .map(|line| path_on_grid(line.iter().map(|[x, y]| [1e3 * x, 1e3 * y]), closed, 100.0))
            .collect()
    };
    let middle = outline.bounds().map_or([0.0; 2], |[low, high]| {
        [0, 1].map(|k| 500.0 * (low[k] + high[k]))
    });
    json!({ "area": text(&outline.areas, true), "line": text(&outline.lines, false), "middle": middle })
}

fn poses(poses: &[Option<Pose>], rows: Rows) -> Value {
    let column = |of: fn(&Pose) -> f64, units: f64| -> Vec<Value> {
        let pose = |row: usize| poses.get(row).copied()?.filter(Pose::is_finite);
        let cell = |row| pose(row).map_or(Value::Null, |pose| whole(of(&pose), units));
        rows.clone().map(cell).collect()
    };
    json!({ "x": column(|p| p.x, LENGTH), "y": column(|p| p.y, LENGTH), "theta": column(|p| p.theta, ANGLE) })
}

fn run(run: &PlaybackRun, bodies: usize, rows: Rows) -> Value {
    let error = |of: fn(&PoseError) -> f64| -> Vec<Value> {
        let error = |row| run.errors.get(row).map(|error| whole(of(error), ERROR));
        rows.clone().map(|row| json!(error(row))).collect()
    };
    let contact = |body: usize| -> Vec<Value> {
        let probability = |row: usize| run.contacts.get(row)?.as_ref()?.get(body).copied();
        let cell = |row| probability(row).map(|p| whole(p, 100.0));
        rows.clone().map(|row| json!(cell(row))).collect()
    };
    json!({
        "name": run.name,
        "colour": run.colour.hex(),
        "dashes": run.line.dashes(),
        "pose": poses(&run.poses, rows.clone()),
        "error": error(PoseError::distance_mm),
        "turn": error(|error| error.turn_deg),
        "contact": knows_contacts(run).then(|| (0..bodies).map(contact).collect::<Vec<_>>()),
        "cloud": has_cloud(run).then(|| rows.clone().map(|row| cloud(run, row)).collect::<Vec<_>>()),
    })
}

/// Returns true if a run has probabilities of contact.
pub(crate) fn knows_contacts(run: &PlaybackRun) -> bool {
    run.contacts.iter().any(Option::is_some)
}

/// Returns true if particles of a run are drawn.
pub(crate) fn has_cloud(run: &PlaybackRun) -> bool {
    run.cloud.iter().any(|row| !row.is_empty())
}

/// Particles of a row from the estimate on: three numbers each.
fn cloud(run: &PlaybackRun, row: usize) -> Value {
    let (Some(Some(pose)), Some(particles)) = (run.poses.get(row), run.cloud.get(row)) else {
        return json!([]);
    };
    // what is drawn is the sum of two rounded numbers
    let from = |value: f64, base: f64, units: f64| {
        whole((units * value).round() - (units * base).round(), 1.0)
    };
    let numbers = particles
        .iter()
        .filter(|particle| particle.is_finite() && pose.is_finite())
        .flat_map(|particle| {
            let turn = (particle.theta - pose.theta + std::f64::consts::PI)
                .rem_euclid(std::f64::consts::TAU)
                - std::f64::consts::PI;
            [
                from(particle.x, pose.x, LENGTH),
                from(particle.y, pose.y, LENGTH),
                whole(turn, ANGLE),
            ]
        });
    Value::Array(numbers.collect())
}

fn contact(touch: &Touch, rows: Rows) -> Value {
    let truth = |truth: &Vec<bool>| -> Vec<Option<u8>> {
        let touches = |row| truth.get(row).map(|touches| u8::from(*touches));
        rows.clone().map(touches).collect()
    };
    let sensed = |sensed: &Vec<Option<bool>>| -> Vec<Option<u8>> {
        let reads = |row| sensed.get(row).copied().flatten().map(u8::from);
        rows.clone().map(reads).collect()
    };
    json!({ "name": touch.name, "truth": touch.truth.as_ref().map(truth), "sensed": touch.sensed.as_ref().map(sensed) })
}

/// Left, low, width and height (mm) of the box that contains the object and the fingers in the part
/// that is played first, and the fixels. Without a reference, the object's way is that of the run
/// whose contacts are shown, or of the first run.
fn view(playback: &Playback) -> [f64; 4] {
    let rows = playback.focus.clone();
    let swept = |outline: &Outline, poses: &[Option<Pose>]| -> Vec<[f64; 2]> {
        let poses = rows
            .clone()
            .filter_map(|row| poses.get(row).copied().flatten());
        poses
            .filter_map(|pose| outline.at(&pose).bounds())
            .flatten()
            .collect()
    };
    let fixels = playback.fixels.iter().filter_map(Outline::bounds).flatten();
    let mut runs = playback.runs.iter();
    let guess = runs.clone().find(|run| knows_contacts(run)).or(runs.next());
    let guessed = |row: usize| guess?.poses.get(row).copied()?;
    let reference = playback.reference.iter().enumerate();
    let object: Vec<Option<Pose>> = reference
        .map(|(row, known)| known.or_else(|| guessed(row)))
        .collect();
    let fingers = playback.fingers.iter().zip(&playback.finger_poses);
    let all = fixels
        .chain(swept(&playback.object, &object))
        .chain(fingers.flat_map(|(finger, poses)| swept(finger, poses)));
    let [[left, low], [right, high]] = bounds(all)
        .unwrap_or([[-0.05; 2], [0.05; 2]])
        .map(|corner| corner.map(|length| 1e3 * length));
    let room = 0.05 * (right - left).max(high - low) + 1.0;
    let width = (right - left + 2.0 * room).max((high - low + 2.0 * room) / ASPECT[1]);
    let height = (high - low + 2.0 * room).max(ASPECT[0] * width);
    [
        0.5 * (left + right) - 0.5 * width,
        0.5 * (low + high) - 0.5 * height,
        width,
        height,
    ]
    .map(|length| (10.0 * length).round() / 10.0)
}
