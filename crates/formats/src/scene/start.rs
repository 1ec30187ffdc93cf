//! `[start]`.

use stickslip::{Rule, Unit};
use stickslip_dynamics::{Pose, SpeedProfile, Start};

use super::document::{Node, Table};
use super::error::SceneError;
use super::quantity::Quantity;

type Result<T> = std::result::Result<T, SceneError>;

const OBJECT: &str = "the object's pose as [x, y, theta] in m and rad";
const PUSHER: &str = "the pusher's pose as [x, y, theta] in m and rad";
const PLACE: Quantity = Quantity::new(
    "object",
    "a coordinate of the pose",
    Unit::Metre,
    Rule::Finite,
);
const ANGLE: Quantity = Quantity::new(
    "object",
    "the angle of the pose",
    Unit::Radian,
    Rule::Finite,
);
const DIRECTION: Quantity = Quantity::new(
    "direction",
    "the direction of the pusher's motion in the world",
    Unit::Radian,
    Rule::Finite,
);
const SPEED: Quantity = Quantity::new(
    "speed",
    "the pusher's speed",
    Unit::MetrePerSecond,
    Rule::Finite,
);
const TIME: Quantity = Quantity::new(
    "speed",
    "a time that does not come before the one above it",
    Unit::Second,
    Rule::NotNegative,
);
const DURATION: Quantity = Quantity::new(
    "duration",
    "how long the experiment lasts",
    Unit::Second,
    Rule::Positive,
);
const PROFILE: &str =
    "the pusher's speed in m/s, or its course as [[time, speed], ...] in s and m/s";

/// `[start]`.
pub(super) fn start(table: &Table<'_>) -> Result<Start> {
    Ok(Start {
        object: pose(&table.required("object", OBJECT)?, OBJECT)?,
        pusher: pose(&table.required("pusher", PUSHER)?, PUSHER)?,
        direction: table.number_or(&DIRECTION, 0.0)?,
        speed: speed(&table.required("speed", PROFILE)?)?,
        duration: table.number(&DURATION)?,
    })
}

fn pose(node: &Node<'_>, what: &str) -> Result<Pose> {
    let [x, y, theta] = node.exactly::<3>(what)?;
    Ok(Pose::new(
        x.number(&PLACE)?,
        y.number(&PLACE)?,
        theta.number(&ANGLE)?,
    ))
}

/// One number, or knots of time and speed.
fn speed(node: &Node<'_>) -> Result<SpeedProfile> {
    if !node.is_list() {
        return node.number(&SPEED).map(SpeedProfile::constant);
    }
    let mut knots: Vec<[f64; 2]> = Vec::new();
    for knot in node.items(PROFILE)? {
        let [time, speed] = knot.exactly::<2>(PROFILE)?;
        let seconds = time.number(&TIME)?;
        if knots.last().is_some_and(|[before, _]| seconds < *before) {
            return Err(time.out_of_range("at or after the time above it", &TIME));
        }
        knots.push([seconds, speed.number(&SPEED)?]);
    }
    SpeedProfile::new(knots).ok_or_else(|| node.empty(PROFILE))
}
