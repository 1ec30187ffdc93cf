//! Check of each tactile sensor against the gap of its fixel: sensor k is on the k-th fixel.
//! Those of a hand's fingers are not checked.

use super::evidence::{Evidence, median, mm};
use super::finding::{Finding, Subject};
use crate::counted::counted;

/// Fewest readings of 1 that tell.
const FEWEST: usize = 5;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let (sensors, fixels) = (
        evidence.log.tactile.len(),
        evidence.setup.scene.fixels.len(),
    );
    let of_fingers = evidence.setup.scene.sensors() - fixels;
    if sensors > fixels + of_fingers {
        let found = format!(
            "the log has {}, the scene {}",
            counted(sensors as u64, "sensor"),
            counted(fixels as u64, "fixel")
        );
        return vec![Finding::problem(
            Subject::Sensor(fixels + 1),
            found,
            "give each sensor its [[fixel]], in the same order",
        )];
    }
    let judged = (0..sensors.min(fixels)).map(|sensor| judge(evidence, sensor));
    let moving = (fixels..sensors).map(|sensor| {
        Finding::ok(
            Subject::Sensor(sensor + 1),
            "not checked: it is on a finger",
        )
    });
    let without = (sensors > 0 && sensors < fixels).then(|| {
        let found = format!(
            "the log has {}, the scene {}: sensor k is on the k-th fixel, the others have none",
            counted(sensors as u64, "sensor"),
            counted(fixels as u64, "fixel")
        );
        Finding::ok(Subject::Sensor(sensors + 1), found)
    });
    judged.chain(moving).chain(without).collect()
}

fn judge(evidence: &Evidence<'_>, sensor: usize) -> Finding {
    let subject = Subject::Sensor(sensor + 1);
    let reads = |value: bool| rows(evidence, sensor, value);
    let (touched, clear) = (reads(true), reads(false));
    let near = 2.0 * evidence.tolerance();
    if touched.len() < FEWEST {
        return silent(evidence, sensor, &clear);
    }
    let own = fixel_distance(evidence, &touched, sensor);
    let shown = format!(
        "reads 1 in {}, median gap to fixel {} {}",
        counted(touched.len() as u64, "row"),
        sensor + 1,
        mm(own)
    );
    if own.abs() < near {
        return Finding::ok(subject, shown);
    }
    let readings = touched.len() + clear.len();
    if touched.len() as f64 <= evidence.setup.tactile.false_positive * readings as f64 {
        let found = format!("{shown}, which may be false positives, of {readings} readings");
        return Finding::ok(subject, found);
    }
    // a sensor that reads 0 for a touch is nearer where it reads 0, if it does so at all
    let may_be_swapped = clear.len() < FEWEST || fixel_distance(evidence, &clear, sensor) < own;
    let (false_touches, free) = free_rows(evidence, sensor, near);
    if may_be_swapped && 2 * false_touches > free {
        let found =
            format!("{shown}, and 1 in {false_touches} of {free} rows without a fixel near");
        let (seems, advice) = inverted(clear.len() < FEWEST);
        return Finding::problem(subject, format!("{found}: {seems}"), advice);
    }
    let others = (0..evidence.setup.scene.fixels.len()).filter(|&fixel| fixel != sensor);
    let nearest = others
        .map(|fixel| (fixel, fixel_distance(evidence, &touched, fixel)))
        .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    match nearest {
        Some((fixel, gap)) if gap.abs() < near => {
            let found = format!(
                "{shown}, to fixel {} only {}: sensors are swapped",
                fixel + 1,
                mm(gap)
            );
            Finding::problem(
                subject,
                found,
                format!(
                    "sensor {} belongs to fixel {}: swap the columns or the [[fixel]] tables",
                    sensor + 1,
                    fixel + 1
                ),
            )
        }
        _ if may_be_swapped && touched.len() > clear.len() => Finding::problem(
            subject,
            format!("{shown}: 0 and 1 seem to be swapped"),
            "write 1 for a touch, 0 for none",
        ),
        _ => Finding::problem(
            subject,
            shown,
            "the outline, the fixel's position or a tag's place on the object is wrong, or the sensor reports touches that cannot be",
        ),
    }
}

/// Describes a sensor that reads 1 where nothing is near, and what to do. `always` is true if it
/// hardly ever reads 0.
fn inverted(always: bool) -> (&'static str, &'static str) {
    match always {
        true => (
            "the sensor is stuck at 1, or 0 and 1 seem to be swapped",
            "test the sensor, and leave its cells empty if it is broken; 1 is a touch, 0 none",
        ),
        false => (
            "0 and 1 seem to be swapped",
            "write 1 for a touch, 0 for none",
        ),
    }
}

/// Judges a sensor that hardly ever reads 1.
fn silent(evidence: &Evidence<'_>, sensor: usize, clear: &[usize]) -> Finding {
    let subject = Subject::Sensor(sensor + 1);
    let gaps = || {
        clear
            .iter()
            .filter_map(|row| evidence.fixel_gap(*row, sensor))
    };
    let found = format!("reads 1 in fewer than {FEWEST} rows");
    let Some(nearest) = gaps().reduce(f64::min) else {
        let found = format!("{found}, and no row has both a reading and an object pose");
        return Finding::ok(subject, found);
    };
    // half of the rows of an object that leans on the fixel are nearer than this
    let leaning = gaps().filter(|gap| *gap < evidence.position_std()).count();
    if leaning > clear.len() / 10 {
        let found = format!(
            "{found}, but fixel {} is within {} of the object in {leaning} rows",
            sensor + 1,
            mm(evidence.position_std())
        );
        let advice = "check the fixel's position and the sensor";
        return Finding::warning(subject, found, advice);
    }
    Finding::ok(
        subject,
        format!(
            "{found}, smallest gap to fixel {} {}",
            sensor + 1,
            mm(nearest)
        ),
    )
}

/// Rows in which the sensor reads `value` and the object is seen.
fn rows(evidence: &Evidence<'_>, sensor: usize, value: bool) -> Vec<usize> {
    let readings = &evidence.log.tactile[sensor];
    (0..readings.len())
        .filter(|&row| readings[row] == Some(value) && evidence.log.object[row].is_some())
        .collect()
}

/// Counts the rows in which no fixel is within `near` (m): first those in which the sensor reads 1,
/// then all.
fn free_rows(evidence: &Evidence<'_>, sensor: usize, near: f64) -> (usize, usize) {
    let fixels = evidence.setup.scene.fixels.len();
    let is_free = |row: &usize| {
        (0..fixels).all(|fixel| {
            evidence
                .fixel_gap(*row, fixel)
                .is_some_and(|gap| gap > near)
        })
    };
    let count = |value: bool| {
        rows(evidence, sensor, value)
            .iter()
            .filter(|row| is_free(row))
            .count()
    };
    let (touched, clear) = (count(true), count(false));
    (touched, touched + clear)
}

/// Median gap of a fixel over `rows` (m).
fn fixel_distance(evidence: &Evidence<'_>, rows: &[usize], fixel: usize) -> f64 {
    median(
        rows.iter()
            .filter_map(|row| evidence.fixel_gap(*row, fixel)),
    )
}
