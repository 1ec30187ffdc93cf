//! Noise of object and pusher poses against the scene's `[camera]`.

use super::evidence::{Evidence, PoseNoise, pose_noise};
use super::finding::{Finding, Subject};

/// Ratio of measured and stated noise that is worth a warning.
const FAR_OFF: f64 = 4.0;

/// Noise that needs no statement: that of encoders and rounding.
const NEGLIGIBLE: PoseNoise = PoseNoise {
    position: 2e-5,
    angle: 2e-4,
};

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(camera) = &evidence.setup.camera else {
        let advice =
            "add position_std and orientation_std: the particle and Kalman methods need them";
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
    let mut findings = vec![match evidence.noise {
        None => Finding::ok(
            Subject::Noise,
            "too few object poses to measure their noise",
        ),
        Some(noise) => compared(&noise, &stated),
    }];
    let stated = PoseNoise {
        position: camera.pusher_position_std,
        angle: camera.pusher_orientation_std,
    };
    if let Some(noise) =
        pose_noise(&evidence.log.pusher).filter(|noise| is_far_off(noise, &stated, &NEGLIGIBLE))
    {
        let advice = "set pusher_position_std and pusher_orientation_std under [camera] to what is measured: what is taken for exact jerks \
                      the object at every row";
        findings.push(Finding::warning(
            Subject::Noise,
            told("pusher", &noise, &stated),
            advice,
        ));
    }
    findings
}

fn compared(noise: &PoseNoise, stated: &PoseNoise) -> Finding {
    let found = told("object", noise, stated);
    match is_far_off(
        noise,
        stated,
        &PoseNoise {
            position: 0.0,
            angle: 0.0,
        },
    ) {
        true => Finding::warning(
            Subject::Noise,
            found,
            "set position_std and orientation_std under [camera] to what is measured",
        ),
        false => Finding::ok(Subject::Noise, found),
    }
}

/// Whether a noise is far above the stated one, and above what needs no statement.
fn is_far_off(measured: &PoseNoise, stated: &PoseNoise, negligible: &PoseNoise) -> bool {
    let is = |pick: fn(&PoseNoise) -> f64| {
        pick(measured) > FAR_OFF * pick(stated) && pick(measured) > pick(negligible)
    };
    is(|noise| noise.position) || is(|noise| noise.angle)
}

fn told(body: &str, noise: &PoseNoise, stated: &PoseNoise) -> String {
    format!(
        "{body} poses scatter by {:.2} mm and {:.4} rad, the scene says {:.2} mm and {:.4} rad",
        1e3 * noise.position,
        noise.angle,
        1e3 * stated.position,
        stated.angle
    )
}
