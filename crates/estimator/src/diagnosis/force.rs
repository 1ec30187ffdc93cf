//! The pusher's force: its sign, its frame, its tare, and the friction that it shows.

use super::evidence::{Evidence, median};
use super::finding::{Finding, Subject};
use crate::setup::ForceSensor;

/// Fewest rows that tell.
const FEWEST: usize = 10;

/// Time to both sides of a row over which the pusher's motion is taken (s).
const ABOUT: f64 = 0.1;

/// Standard deviations of the bias up to which a sensor counts as tared.
const TARED: f64 = 3.0;

/// Standard deviations of its priors by which friction may differ.
const EXPECTED: f64 = 2.5;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    if evidence.log.force.iter().flatten().next().is_none() {
        return Vec::new();
    }
    let Some(sensor) = evidence.setup.wrench else {
        return vec![Finding::ok(
            Subject::Force,
            "the log has forces, which are not used: the scene has no [wrench]",
        )];
    };
    let mut findings = Vec::new();
    findings.extend(tare(evidence, &sensor));
    let forces = pushing(evidence);
    if forces.len() >= FEWEST {
        // a finger of a hand may move against the force of all together
        let alone = evidence.setup.scene.pusher.fingers.len() == 1;
        let direction = direction(&forces).filter(|_| alone);
        findings.push(direction.unwrap_or_else(|| friction(evidence, &forces, &sensor)));
    }
    if findings.is_empty() {
        findings.push(Finding::ok(
            Subject::Force,
            "not measured: too few forces on a moving object",
        ));
    }
    findings
}

/// Force of a pusher that is apart from the object.
fn tare(evidence: &Evidence<'_>, sensor: &ForceSensor) -> Option<Finding> {
    let apart = |row: &usize| {
        let gap = evidence.pusher_gap(*row, evidence.latency());
        gap.is_some_and(|gap| gap > 2.0 * evidence.tolerance())
    };
    let forces: Vec<[f64; 2]> = (0..evidence.log.len())
        .filter(apart)
        .filter_map(|row| evidence.log.force[row])
        .collect();
    if forces.len() < FEWEST {
        return None;
    }
    let [x, y] = [0, 1].map(|axis| median(forces.iter().map(|force| force[axis])));
    let size = libm::hypot(x, y);
    let most = TARED * sensor.bias_std.hypot(sensor.force_std);
    (size > most).then(|| {
        Finding::warning(
            Subject::Force,
            format!("the force is {size:.2} N while the pusher is apart from the object"),
            "tare the sensor, or raise wrench.bias_std",
        )
    })
}

/// Forces (N) while the object moves, each with its part along the pusher's motion.
fn pushing(evidence: &Evidence<'_>) -> Vec<(f64, f64)> {
    let rows = (0..evidence.log.len()).filter(|row| evidence.moving[*row]);
    let along = |row: usize| {
        let [x, y] = evidence.log.force[row]?;
        let time = evidence.log.time[row];
        let (from, to) = (
            evidence.pusher_at(time - ABOUT)?,
            evidence.pusher_at(time + ABOUT)?,
        );
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let way = libm::hypot(dx, dy);
        (way > evidence.tolerance() * 0.1).then(|| (libm::hypot(x, y), (x * dx + y * dy) / way))
    };
    rows.filter_map(along).collect()
}

/// A force that does not point where the pusher goes.
fn direction(forces: &[(f64, f64)]) -> Option<Finding> {
    let cosine = median(forces.iter().map(|(size, along)| along / size.max(1e-12)));
    let angle = libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
    let found =
        format!("the force on the moving object points {angle:.0} degrees off the pusher's motion");
    match cosine {
        cosine if cosine < -0.7 => Some(Finding::problem(
            Subject::Force,
            found,
            "change its sign: the log needs the force of the pusher on the object",
        )),
        cosine if cosine < 0.5 => Some(Finding::problem(
            Subject::Force,
            found,
            "turn it from the sensor's frame into the world frame",
        )),
        _ => None,
    }
}

/// The friction that the force shows, against the scene's.
fn friction(evidence: &Evidence<'_>, forces: &[(f64, f64)], sensor: &ForceSensor) -> Finding {
    let (scene, unsure) = (&evidence.setup.scene, &evidence.setup.uncertainty);
    let size = median(forces.iter().map(|(size, _)| *size));
    let shown = size / (scene.object.mass * scene.gravity);
    let stated = scene.nominal.mu_s;
    let found = format!(
        "force over weight {shown:.2} while the object moves, and support.friction {stated:.2}"
    );
    let most = EXPECTED * unsure.friction.mu_s.hypot(sensor.scale_std);
    match libm::log(shown / stated).abs() > most {
        false => Finding::ok(Subject::Force, found),
        true => Finding::warning(
            Subject::Force,
            found,
            "check the unit of the force, object.mass and support.friction",
        ),
    }
}
