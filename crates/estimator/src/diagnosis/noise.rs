//! Noise of object and pusher poses against the scene's `[camera]`.

use super::evidence::{Evidence, median};
use super::finding::{Finding, Subject};
use super::lasting::Lasting;
use super::pose_noise::PoseNoise;
use crate::covariance::PoseCovariance;

/// Ratios of measured to stated noise that are worth a warning: of the object, whose noise the
/// robust model learns, and of the pusher.
const FAR_OFF: f64 = 4.0;
const PUSHER_OFF: f64 = 2.0;

/// Ratio of stated to measured noise above which covariances are made up, or in other units: poses
/// then count for nothing.
const MADE_UP: f64 = 30.0;

/// Factor of overconfidence from which on errors that last are worth a warning.
const TOO_SURE: f64 = 1.5;

/// Source of stated noise.
const SCENE: &str = "scene.toml";

/// Noise that needs no statement: that of encoders and rounding.
const NEGLIGIBLE: PoseNoise = PoseNoise {
    position: 2e-5,
    angle: 2e-4,
};

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(camera) = &evidence.setup.camera else {
        let advice = "add position_std and orientation_std; particle and Kalman methods need them";
        return vec![Finding::warning(
            Subject::Noise,
            "the scene has no [camera]",
            advice,
        )];
    };
    let stated = PoseNoise {
        position: camera.position_std,
        angle: camera.orientation_std,
    };
    let mut findings = Vec::new();
    // poses that alternate between two places are not noisy, but seem so
    if evidence.two_places.is_none() {
        findings.push(match (evidence.noise, of_covariances(evidence)) {
            (None, _) => Finding::ok(Subject::Noise, "not measured: too few object poses"),
            (Some(noise), None) => compared(&noise, &stated, evidence.size()),
            (Some(noise), Some(covariances)) => covered(&noise, &covariances),
        });
        let lasting = evidence.lasting.as_ref();
        findings.extend(lasting.and_then(|errors| lasts(errors, &stated)));
    }
    findings.extend(pusher(evidence));
    findings
}

/// Finds pusher poses that scatter by more than the scene states.
pub(super) fn pusher(evidence: &Evidence<'_>) -> Option<Finding> {
    let camera = evidence.setup.camera.as_ref()?;
    let stated = PoseNoise {
        position: camera.pusher_position_std,
        angle: camera.pusher_orientation_std,
    };
    let noise = evidence
        .pusher_noise
        .filter(|noise| is_above(noise, &stated, PUSHER_OFF, &NEGLIGIBLE))?;
    let advice = "set pusher_position_std and pusher_orientation_std under [camera] to the measured values; offline runs use the \
                  measured noise, but `live` and --causal take the scatter for motion, which jerks the object at every row";
    let found = told("pusher", &noise, (SCENE, &stated));
    Some(Finding::warning(Subject::Noise, found, advice))
}

fn compared(noise: &PoseNoise, stated: &PoseNoise, size: f64) -> Finding {
    let found = told("object", noise, (SCENE, stated));
    if let Some(unit) = in_other_units(noise, stated, size) {
        let advice =
            "give position_std in m and orientation_std in rad under [camera], as measured";
        let found = format!("{found}: the scene's noise seems to be in {unit}");
        return Finding::problem(Subject::Noise, found, advice);
    }
    let none = PoseNoise {
        position: 0.0,
        angle: 0.0,
    };
    match is_above(noise, stated, FAR_OFF, &none) {
        true => Finding::warning(
            Subject::Noise,
            found,
            "set position_std and orientation_std under [camera] to the measured values",
        ),
        false => Finding::ok(Subject::Noise, found),
    }
}

/// Noise by the covariances that come with the object poses, in the median; `None` if most poses
/// have none.
fn of_covariances(evidence: &Evidence<'_>) -> Option<PoseNoise> {
    let log = evidence.log;
    let rows = log.object.iter().zip(&log.object_covariance);
    let known = rows.filter_map(|(pose, covariance)| covariance.filter(|_| pose.is_some()));
    let known: Vec<PoseCovariance> = known.collect();
    let poses = log.object.iter().flatten().count();
    (2 * known.len() > poses).then(|| PoseNoise {
        position: median(known.iter().map(|of| (0.5 * (of.x + of.y)).sqrt())),
        angle: median(known.iter().map(|of| of.theta.sqrt())),
    })
}

/// Compares the measured noise with that of the poses' own covariances, by which they count.
fn covered(noise: &PoseNoise, stated: &PoseNoise) -> Finding {
    let found = told("object", noise, ("their covariances", stated));
    let advice = "give the covariances of the poses in m and rad as measured, or zeros where they are not known: [camera] then counts";
    let least = NEGLIGIBLE;
    let ratio = |of: fn(&PoseNoise) -> f64| of(stated).max(of(&least)) / of(noise).max(of(&least));
    let [position, angle] = [ratio(|noise| noise.position), ratio(|noise| noise.angle)];
    match position.max(angle) {
        above if above > MADE_UP => Finding::problem(Subject::Noise, found, advice),
        above if above > FAR_OFF || position.min(angle) < 1.0 / FAR_OFF => {
            Finding::warning(Subject::Noise, found, advice)
        }
        _ => Finding::ok(Subject::Noise, found),
    }
}

/// Finds errors that last. A belief that takes each pose as independent would be overconfident.
fn lasts(errors: &Lasting, stated: &PoseNoise) -> Option<Finding> {
    let Lasting { wander, rows } = errors;
    let worth = |std: f64| std * rows.sqrt();
    if worth(wander.position) < TOO_SURE * stated.position {
        return None;
    }
    let found = format!(
        "poses of the object at rest wander by {:.2} mm, more than they scatter from row to row: the camera's errors last over about {rows:.0} rows",
        1e3 * wander.position
    );
    let advice = format!(
        "the filter is overconfident while the camera is on: set position_std = {:.1e} and orientation_std = {:.1e} under [camera], so that \
         {rows:.0} poses count as one independent pose",
        worth(wander.position),
        worth(wander.angle)
    );
    Some(Finding::warning(Subject::Noise, found, advice))
}

/// Returns the unit of stated noise that is far above the measured one, and as large as the object:
/// a quarter of its radius, or 0.2 rad.
fn in_other_units(noise: &PoseNoise, stated: &PoseNoise, size: f64) -> Option<&'static str> {
    let above =
        |stated: f64, measured: f64, large: f64| stated > FAR_OFF * measured && stated > large;
    if above(stated.position, noise.position, 0.25 * size) {
        return Some("mm");
    }
    above(stated.angle, noise.angle, 0.2).then_some("degrees")
}

/// Returns true if a noise is above `ratio` times the stated one, and above what needs no
/// statement.
fn is_above(measured: &PoseNoise, stated: &PoseNoise, ratio: f64, negligible: &PoseNoise) -> bool {
    let is = |pick: fn(&PoseNoise) -> f64| {
        pick(measured) > ratio * pick(stated) && pick(measured) > pick(negligible)
    };
    is(|noise| noise.position) || is(|noise| noise.angle)
}

/// The measured noise of a body's poses, and the stated one with its source.
fn told(body: &str, noise: &PoseNoise, (source, stated): (&str, &PoseNoise)) -> String {
    format!(
        "noise of {body} poses {:.2} mm and {:.4} rad; {source}: {:.2} mm and {:.4} rad",
        1e3 * noise.position,
        noise.angle,
        1e3 * stated.position,
        stated.angle
    )
}
