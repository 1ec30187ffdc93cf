//! A log as columns of numbers, named as in `log.csv`: [`log_columns`], [`log_of_columns`].

use stickslip::{Log, PoseCovariance};
use stickslip_dynamics::Pose;

use crate::log_csv::{
    COVARIANCE, FORCE, OBJECT, PUSHER, TACTILE, covariance, covariance_numbers, finger_names,
    forget_empty, header,
};
use crate::log_warning::LogWarning;
use crate::named_columns::{ColumnError, NamedColumns};

/// The columns of `log.csv`, one number per row; NaN where nothing was measured.
///
/// # Panics
/// If the columns differ in length.
#[must_use]
pub fn log_columns(log: &Log) -> Vec<(String, Vec<f64>)> {
    crate::log_csv::assert_equal_columns(log);
    let of_poses = |poses: &[Option<Pose>]| {
        let pick = |of: fn(&Pose) -> f64| {
            let number = |pose: &Option<Pose>| pose.as_ref().map_or(f64::NAN, of);
            poses.iter().map(number).collect::<Vec<f64>>()
        };
        [
            pick(|pose| pose.x),
            pick(|pose| pose.y),
            pick(|pose| pose.theta),
        ]
    };
    let tactile = log.tactile.iter().map(|sensor| {
        let number = |reading: &Option<bool>| reading.map_or(f64::NAN, f64::from);
        sensor.iter().map(number).collect()
    });
    let force = (0..if log.force.is_empty() { 0 } else { 2 }).map(|axis| {
        let number = |force: &Option<[f64; 2]>| force.map_or(f64::NAN, |force| force[axis]);
        log.force.iter().map(number).collect()
    });
    let covariance = (0..if log.object_covariance.is_empty() {
        0
    } else {
        6
    })
        .map(|k| {
            let number = |own: &Option<PoseCovariance>| {
                own.as_ref()
                    .map_or(f64::NAN, |own| covariance_numbers(own)[k])
            };
            log.object_covariance.iter().map(number).collect()
        });
    let columns = [log.time.clone()]
        .into_iter()
        .chain(of_poses(&log.object))
        .chain(of_poses(&log.pusher))
        .chain(log.other_fingers.iter().flat_map(|poses| of_poses(poses)))
        .chain(tactile)
        .chain(force)
        .chain(covariance);
    header(log).into_iter().zip(columns).collect()
}

/// The log that such columns hold; columns that the format does not have are named in a warning,
/// with `name` for the file.
///
/// # Errors
/// A column is missing, time does not rise, sensors are not numbered from 1 on, a pose, force or
/// covariance is given in part, or a reading is neither 0, 1 nor NaN.
///
/// ```
/// # use stickslip_formats::{NamedColumns, log_of_columns};
/// let (zero, missing) = ([0.0], [f64::NAN]);
/// let names = ["time", "object_x", "object_y", "object_theta", "pusher_x", "pusher_y", "pusher_theta"];
/// let columns = names.map(|name| (name.to_owned(), if name.starts_with("object") { &missing[..] } else { &zero[..] }));
/// let (log, _) = log_of_columns(&NamedColumns::new(columns.to_vec())?, "log")?;
/// assert!(log.object[0].is_none() && log.pusher[0].is_some());
/// # Ok::<(), stickslip_formats::ColumnError>(())
/// ```
pub fn log_of_columns(
    columns: &NamedColumns<'_>,
    name: &str,
) -> Result<(Log, Vec<LogWarning>), ColumnError> {
    let time = columns.time()?;
    let poses = |names| {
        let group = columns.require_all(names)?;
        let pose = |row| {
            let numbers = columns.group(group, row)?;
            Ok(numbers.map(|[x, y, theta]| Pose::new(x, y, theta)))
        };
        (0..time.len()).map(pose).collect::<Result<Vec<_>, _>>()
    };
    let (object, pusher) = (poses(OBJECT)?, poses(PUSHER)?);
    let fingers = finger_names(|name| columns.find(name).is_some()).iter();
    let sensors = sensors(columns)?;
    let tactile = sensors.iter().map(|sensor| readings(columns, sensor));
    let force = match columns.find_all(FORCE)? {
        None => Vec::new(),
        Some(group) => {
            let forces = (0..time.len()).map(|row| columns.group(group, row));
            forces.collect::<Result<_, _>>()?
        }
    };
    let mut object_covariance = match columns.find_all(COVARIANCE)? {
        None => Vec::new(),
        Some(group) => {
            let own = (0..time.len()).map(|row| Ok(columns.group(group, row)?.map(covariance)));
            own.collect::<Result<_, ColumnError>>()?
        }
    };
    forget_empty(&mut object_covariance);
    let log = Log {
        time: time.to_vec(),
        object,
        object_covariance,
        pusher,
        other_fingers: fingers
            .map(|names| poses(*names))
            .collect::<Result<_, _>>()?,
        tactile: tactile.collect::<Result<_, _>>()?,
        force,
    };
    let known = header(&log);
    let is_extra =
        |column: &&str| !known.iter().any(|known| known == column) && !COVARIANCE.contains(column);
    let extra: Vec<String> = columns
        .names()
        .filter(is_extra)
        .map(str::to_owned)
        .collect();
    let warning = (!extra.is_empty()).then(|| LogWarning::ExtraColumns {
        file: name.to_owned(),
        columns: extra,
    });
    Ok((log, warning.into_iter().collect()))
}

/// The names tactile_1 ... tactile_n.
fn sensors(columns: &NamedColumns<'_>) -> Result<Vec<String>, ColumnError> {
    let is_sensor = |name: &&str| {
        name.strip_prefix(TACTILE)
            .is_some_and(|k| !k.is_empty() && k.bytes().all(|c| c.is_ascii_digit()))
    };
    let found: Vec<&str> = columns.names().filter(is_sensor).collect();
    let names: Vec<String> = (1..=found.len()).map(|k| format!("{TACTILE}{k}")).collect();
    match names.iter().find(|name| columns.find(name).is_none()) {
        None => Ok(names),
        Some(missing) => {
            let odd = found
                .iter()
                .find(|name| !names.iter().any(|own| own == *name));
            Err(ColumnError::SensorNumber {
                found: odd.map_or_else(String::new, |name| (*name).to_owned()),
                missing: missing.clone(),
            })
        }
    }
}

fn readings(columns: &NamedColumns<'_>, name: &str) -> Result<Vec<Option<bool>>, ColumnError> {
    let reading = |(row, value): (usize, &f64)| match *value {
        0.0 => Ok(Some(false)),
        1.0 => Ok(Some(true)),
        value if value.is_nan() => Ok(None),
        value => Err(ColumnError::NotBinary {
            row,
            column: name.to_owned(),
            value,
        }),
    };
    columns
        .require(name)?
        .iter()
        .enumerate()
        .map(reading)
        .collect()
}
