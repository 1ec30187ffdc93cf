//! The columns of `estimate.csv` that describe the belief, in a row and body by body: [`names`],
//! [`numbers`].

use stickslip::{ContactSlip, EstimateRow};

/// Those that do not belong to a body.
pub(crate) const OF_ROW: [&str; 8] = [
    "collapsed",
    "distinct",
    "ancestors",
    "modes",
    "mode_weight",
    "mode_x",
    "mode_y",
    "mode_theta",
];

/// Those of each body.
const OF_BODY: [&str; 3] = ["stick", "left", "right"];

/// The last one.
const HELD: &str = "p_held";

/// Number of columns.
pub(crate) const fn count(others: usize) -> usize {
    OF_ROW.len() + OF_BODY.len() * (1 + others) + 1
}

/// Their names, in the order of the file.
pub(crate) fn names(others: usize) -> impl Iterator<Item = String> {
    let others = (1..=others).map(|k| k.to_string());
    let bodies = std::iter::once("pusher".to_owned()).chain(others);
    let of_bodies = bodies.flat_map(|body| OF_BODY.map(|how| format!("{how}_{body}")));
    let of_row = OF_ROW.map(str::to_owned).into_iter();
    of_row.chain(of_bodies).chain([HELD.to_owned()])
}

/// Numbers of a row in these columns; `None` where the method has no value.
///
/// # Panics
/// If the row says how the object slips on another number of bodies than there are.
pub(crate) fn numbers(row: &EstimateRow, others: usize) -> Vec<Option<f64>> {
    let likeliest = row.modes.first();
    let mode = likeliest.map(|mode| {
        let count = row.modes.len() as f64;
        let pose = mode.pose;
        [count, mode.weight, pose.x, pose.y, pose.theta]
    });
    let mut numbers = vec![
        row.collapsed
            .map(|collapsed| f64::from(u8::from(collapsed))),
        row.distinct.map(f64::from),
        row.ancestors.map(f64::from),
    ];
    numbers.extend(optional(mode));
    match &row.slip {
        Some(bodies) => {
            assert_eq!(bodies.len(), 1 + others, "the pusher and every fixel");
            let of_bodies = bodies.iter().flat_map(|slip| {
                let ContactSlip { stick, left, right } = *slip;
                [stick, left, right]
            });
            numbers.extend(of_bodies.map(Some));
        }
        None => numbers.resize(count(others) - 1, None),
    }
    numbers.push(row.held);
    numbers
}

fn optional<const N: usize>(numbers: Option<[f64; N]>) -> [Option<f64>; N] {
    numbers.map_or([None; N], |numbers| numbers.map(Some))
}
