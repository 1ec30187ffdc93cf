//! `[start]`.

use std::f64::consts::{PI, TAU};

use stickslip::{Rule, Unit};
use stickslip_dynamics::{SpeedProfile, Start};

use super::document::{Node, Table};
use super::error::SceneError;

type Result<T> = std::result::Result<T, SceneError>;

/// `[start]`, with what the `[[finger]]` tables say of it.
pub(super) fn start(table: &Table<'_>, fingers: &[Table<'_>]) -> Result<Start> {
    let direction = table.number_or("direction", 0.0)?;
    let finger = |other: &Table<'_>| {
        let opposite = (direction + TAU).rem_euclid(TAU) - PI;
        let direction = other.number_or("direction", opposite)?;
        Ok((other.required("start")?.pose()?, direction))
    };
    Ok(Start {
        object: table.required("object")?.pose()?,
        pusher: table.required("pusher")?.pose()?,
        direction,
        other_fingers: fingers.iter().map(finger).collect::<Result<_>>()?,
        speed: speed(&table.required("speed")?)?,
        duration: table.number("duration")?,
    })
}

/// One number, or knots of time and speed.
fn speed(node: &Node<'_>) -> Result<SpeedProfile> {
    if !node.is_list() {
        return node.number().map(SpeedProfile::constant);
    }
    let mut knots: Vec<[f64; 2]> = Vec::new();
    for knot in node.items()? {
        let [time, speed] = knot.exactly::<2>()?;
        let seconds = time.number_in(Unit::Second, Rule::NotNegative)?;
        if knots.last().is_some_and(|[before, _]| seconds < *before) {
            return Err(time.out_of_range_in("at or after the time above it", Unit::Second));
        }
        knots.push([seconds, speed.number()?]);
    }
    SpeedProfile::new(knots).ok_or_else(|| node.empty())
}
