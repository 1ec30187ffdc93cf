//! A playback as compact JSON, as `crates/report/page/player.js` reads it: whole numbers in small
//! units.

use serde_json::{Value, json};
use stickslip::dynamics::Pose;

use crate::drawing::path;
use crate::outline::{Outline, bounds};
use crate::playback::{MethodTrack, Playback, Touch};

/// Units per m, rad and mm or degree.
const LENGTH: f64 = 1e5;
const ANGLE: f64 = 1e4;
const ERROR: f64 = 1e3;

/// The least height of the picture as a share of its width, and the most.
const ASPECT: [f64; 2] = [0.62, 0.8];

/// All that is played back.
pub(crate) fn data(playback: &Playback) -> Value {
    let rows = playback.shown();
    let time = &playback.time[rows.clone()];
    let row_at = |time: f64| playback.time[rows.clone()].partition_point(|t| *t < time - 1e-6);
    let within = |time: f64| {
        playback.time[rows.clone()]
            .first()
            .zip(playback.time[rows.clone()].last())
            .is_some_and(|(a, b)| (*a..=*b).contains(&time))
    };
    let marks = playback
        .marks
        .iter()
        .filter(|mark| within(mark.time))
        .map(|mark| json!([row_at(mark.time), mark.name]));
    let hidden: Vec<u8> = rows
        .clone()
        .map(|row| u8::from(playback.hidden.get(row).copied().unwrap_or(false)))
        .collect();
    json!({
        "time": time.iter().map(|time| whole(*time, 1e3)).collect::<Vec<_>>(),
        "first": rows.start,
        "poster": playback.poster.clamp(rows.start, rows.end.max(rows.start + 1) - 1) - rows.start,
        "start": 0,
        "view": view(playback),
        "reach": 1e3 * playback.object.areas.iter().flatten().map(|[x, y]| x.hypot(*y)).fold(0.001, f64::max),
        "object": body(&playback.object),
        "pusher": body(&playback.pusher),
        "fixels": playback.fixels.iter().map(body).collect::<Vec<_>>(),
        "truth": poses(&playback.reference, rows.clone()),
        "pusherPose": poses(&playback.pusher_poses, rows.clone()),
        "dark": runs(&hidden),
        "hidden": hidden,
        "touches": playback.touches.iter().map(|touch| contact(touch, rows.clone())).collect::<Vec<_>>(),
        "marks": marks.collect::<Vec<_>>(),
        "order": order(playback),
        "methods": playback.methods.iter().map(|track| method(track, playback.touches.len(), rows.clone())).collect::<Vec<_>>(),
    })
}

/// Every method once, the lowest one first.
fn order(playback: &Playback) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::new();
    for method in playback
        .lowest_first
        .iter()
        .copied()
        .chain(0..playback.methods.len())
    {
        if method < playback.methods.len() && !order.contains(&method) {
            order.push(method);
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
fn body(outline: &Outline) -> Value {
    let text = |lines: &[Vec<[f64; 2]>], closed: bool| -> String {
        lines
            .iter()
            .map(|line| path(line.iter().map(|[x, y]| [1e3 * x, 1e3 * y]), closed))
            .collect()
    };
    let middle = outline.bounds().map_or([0.0; 2], |[low, high]| {
        [0, 1].map(|k| 500.0 * (low[k] + high[k]))
    });
    json!({ "area": text(&outline.areas, true), "line": text(&outline.lines, false), "middle": middle })
}

fn poses(poses: &[Option<Pose>], rows: std::ops::Range<usize>) -> Value {
    let column = |of: fn(&Pose) -> f64, units: f64| -> Vec<Value> {
        rows.clone()
            .map(|row| {
                poses
                    .get(row)
                    .copied()
                    .flatten()
                    .filter(Pose::is_finite)
                    .map_or(Value::Null, |pose| whole(of(&pose), units))
            })
            .collect()
    };
    json!({ "x": column(|p| p.x, LENGTH), "y": column(|p| p.y, LENGTH), "theta": column(|p| p.theta, ANGLE) })
}

fn method(track: &MethodTrack, bodies: usize, rows: std::ops::Range<usize>) -> Value {
    let error = |of: fn(&crate::courses::PoseError) -> f64| -> Vec<Value> {
        rows.clone()
            .map(|row| {
                track
                    .errors
                    .get(row)
                    .map_or(Value::Null, |error| whole(of(error), ERROR))
            })
            .collect()
    };
    let contact = |body: usize| -> Vec<Value> {
        let probability = |row: usize| track.contacts.get(row)?.as_ref()?.get(body).copied();
        rows.clone()
            .map(|row| probability(row).map_or(Value::Null, |p| whole(p, 100.0)))
            .collect()
    };
    let knows_contacts = track.contacts.iter().any(Option::is_some);
    let has_cloud = track.cloud.iter().any(|row| !row.is_empty());
    json!({
        "name": track.name,
        "colour": track.colour.hex(),
        "pose": poses(&track.poses, rows.clone()),
        "error": error(crate::courses::PoseError::distance_mm),
        "turn": error(|error| error.turn_deg),
        "contact": knows_contacts.then(|| (0..bodies).map(contact).collect::<Vec<_>>()),
        "cloud": has_cloud.then(|| rows.clone().map(|row| cloud(track, row)).collect::<Vec<_>>()),
    })
}

/// Particles of a row from the estimate on: three numbers each.
fn cloud(track: &MethodTrack, row: usize) -> Value {
    let (Some(Some(pose)), Some(particles)) = (track.poses.get(row), track.cloud.get(row)) else {
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

fn contact(touch: &Touch, rows: std::ops::Range<usize>) -> Value {
    let truth = |truth: &Vec<bool>| -> Vec<Value> {
        rows.clone()
            .map(|row| {
                truth
                    .get(row)
                    .map_or(Value::Null, |touches| json!(u8::from(*touches)))
            })
            .collect()
    };
    let sensed = |sensed: &Vec<Option<bool>>| -> Vec<Value> {
        rows.clone()
            .map(|row| {
                sensed
                    .get(row)
                    .copied()
                    .flatten()
                    .map_or(Value::Null, |reads| json!(u8::from(reads)))
            })
            .collect()
    };
    json!({ "name": touch.name, "truth": touch.truth.as_ref().map(truth), "sensed": touch.sensed.as_ref().map(sensed) })
}

/// Runs of ones: first row and the row after the last.
fn runs(flags: &[u8]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (row, _) in flags.iter().enumerate().filter(|(_, flag)| **flag == 1) {
        match runs.last_mut() {
            Some([_, end]) if *end == row => *end = row + 1,
            _ => runs.push([row, row + 1]),
        }
    }
    runs
}

/// Left, low, width and height (mm) of what holds the object and the pusher on their way, and the
/// fixels.
fn view(playback: &Playback) -> [f64; 4] {
    let rows = playback.shown();
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
    let all = fixels
        .chain(swept(&playback.object, &playback.reference))
        .chain(swept(&playback.pusher, &playback.pusher_poses));
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
