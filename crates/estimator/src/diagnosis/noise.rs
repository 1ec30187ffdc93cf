//! Noise of object poses against the scene's `[camera]`.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};

/// Ratio of stated and measured noise, either way, that is worth a warning.
const FAR_OFF: f64 = 4.0;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(camera) = &evidence.setup.camera else {
        let advice = "add position_std and orientation_std: the particle and Kalman methods need them";
        return vec![Finding::warning(Subject::Noise, "the scene has no [camera]", advice)];
    };
    let Some(noise) = evidence.noise else {
        return vec![Finding::ok(Subject::Noise, "too few object poses to measure their noise")];
    };
    let found = format!(
        "object poses scatter by {:.2} mm and {:.4} rad, the scene says {:.2} mm and {:.4} rad",
        1e3 * noise.position,
        noise.angle,
        1e3 * camera.position_std,
        camera.orientation_std
    );
    let off = |measured: f64, stated: f64| measured > FAR_OFF * stated;
    vec![match off(noise.position, camera.position_std) || off(noise.angle, camera.orientation_std) {
        true => Finding::warning(Subject::Noise, found, "set position_std and orientation_std under [camera] to what is measured"),
        false => Finding::ok(Subject::Noise, found),
    }]
}
