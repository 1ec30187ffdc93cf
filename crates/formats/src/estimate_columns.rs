//! An estimate as columns of numbers, named as in `estimate.csv`: [`estimate_columns`],
//! [`estimate_of_columns`].

use stickslip::{Estimate, EstimateRow, Spread};
use stickslip_dynamics::{Friction, Pose};

use crate::belief_columns;
use crate::estimate_csv::{cross_numbers, header};
use crate::named_columns::{ColumnError, NamedColumns};

/// The columns of `estimate.csv`, one number per row; NaN where the method has no value.
///
/// ```
/// # use stickslip::{Estimate, EstimateRow};
/// let estimate = Estimate { time: vec![0.5], rows: vec![EstimateRow::default()], others: 1, has_tripod: true };
/// let columns = stickslip_formats::estimate_columns(&estimate);
/// assert_eq!(columns[0], ("time".to_owned(), vec![0.5]));
/// assert!(columns[1].0 == "x" && columns[1].1[0].is_nan());
/// ```
///
/// # Panics
/// If `time` and `rows` differ in length, or a row has not one contact probability per fixel and
/// other finger.
#[must_use]
pub fn estimate_columns(estimate: &Estimate) -> Vec<(String, Vec<f64>)> {
    assert_eq!(estimate.time.len(), estimate.rows.len(), "one time per row");
    let names = header(estimate.others).into_iter();
    let mut columns: Vec<(String, Vec<f64>)> = names
        .map(|name| (name, Vec::with_capacity(estimate.rows.len())))
        .collect();
    let mut numbers = Vec::with_capacity(columns.len());
    for (time, row) in estimate.time.iter().zip(&estimate.rows) {
        numbers.clear();
        numbers.push(*time);
        push_row(&mut numbers, row, estimate);
        assert_eq!(numbers.len(), columns.len(), "a number per column");
        for ((_, column), number) in columns.iter_mut().zip(&numbers) {
            column.push(*number);
        }
    }
    columns
}

/// The estimate in such columns, as far as scores need it: times, poses and their standard
/// deviations. Other columns are ignored.
///
/// # Errors
/// `time`, `x`, `y` or `theta` is missing, time does not rise, or a pose is given in part.
pub fn estimate_of_columns(columns: &NamedColumns<'_>) -> Result<Estimate, ColumnError> {
    let pose = columns.require_all(["x", "y", "theta"])?;
    let std = columns.find_all(["std_x", "std_y", "std_theta"])?;
    let row = |row: usize| {
        let spread = match std {
            Some(std) => columns.group(std, row)?,
            None => None,
        };
        Ok(EstimateRow {
            pose: columns.group(pose, row)?.map(pose_of),
            spread: spread.map(|std| Spread {
                pose: pose_of(std),
                cross: None,
                friction: None,
            }),
            ..EstimateRow::default()
        })
    };
    let time = columns.time()?.to_vec();
    Ok(Estimate {
        rows: (0..time.len()).map(row).collect::<Result<_, _>>()?,
        time,
        ..Estimate::default()
    })
}

fn pose_of([x, y, theta]: [f64; 3]) -> Pose {
    Pose::new(x, y, theta)
}

fn push_row(numbers: &mut Vec<f64>, row: &EstimateRow, estimate: &Estimate) {
    let tripod = estimate.has_tripod;
    push(numbers, row.pose.map(pose_numbers));
    push(numbers, row.twist.map(|v| [v.vx, v.vy, v.omega]));
    push(numbers, row.friction.map(|f| friction_numbers(f, tripod)));
    push(numbers, row.contact_pusher.map(|contact| [contact]));
    match &row.contact_others {
        Some(contacts) => numbers.extend(contacts),
        None => numbers.extend(std::iter::repeat_n(f64::NAN, estimate.others)),
    }
    push(numbers, row.spread.map(|std| pose_numbers(std.pose)));
    let spread = row.spread.and_then(|std| std.friction);
    push(numbers, spread.map(|std| friction_numbers(std, tripod)));
    push(numbers, row.ess.map(|ess| [ess]));
    push(
        numbers,
        row.resampled.map(|resampled| [f64::from(resampled)]),
    );
    numbers.push(f64::from(row.visual));
    push(numbers, row.unsolved.map(|count| [f64::from(count)]));
    push(numbers, row.failed.map(|count| [f64::from(count)]));
    let cross = row.spread.and_then(|spread| spread.cross);
    push(numbers, cross.map(cross_numbers));
    let belief = belief_columns::numbers(row, estimate.others).into_iter();
    numbers.extend(belief.map(|number| number.unwrap_or(f64::NAN)));
}

fn push<const N: usize>(numbers: &mut Vec<f64>, values: Option<[f64; N]>) {
    numbers.extend(values.unwrap_or([f64::NAN; N]));
}

fn pose_numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.theta]
}

fn friction_numbers(friction: Friction, has_tripod: bool) -> [f64; 4] {
    let Friction {
        mu_s,
        mu_p,
        mu_f,
        d_tri,
    } = friction;
    [mu_s, mu_p, mu_f, if has_tripod { d_tri } else { f64::NAN }]
}
