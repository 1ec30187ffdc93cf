//! `[uncertainty]`, the uncertainty of the other numbers.

use stickslip::Uncertainty;
use stickslip::dynamics::Friction;

use super::document::Table;
use super::error::SceneError;

/// Default uncertainty for a support. Feet that are given are exact, and so is the angle of a
/// tripod that is given.
pub(super) fn with_support(support: &Table<'_>) -> Uncertainty {
    let given = |key: &str| support.optional(key).is_some();
    let mut unknown = Uncertainty::default();
    if given("feet") {
        unknown = unknown.with_known_feet();
    }
    if given("tripod_angle") {
        unknown.tripod_angle = 0.0;
    }
    unknown
}

/// `[uncertainty]`, over the uncertainty of `default`.
pub(super) fn uncertainty(
    table: &Table<'_>,
    default: Uncertainty,
) -> Result<Uncertainty, SceneError> {
    let number = |name: &str, default: f64| table.number_or(name, default);
    let (fixel_position, outline, latency) = (
        number("fixel_position", default.fixel_position)?,
        number("outline", default.outline)?,
        number("latency", default.latency)?,
    );
    // who says that a rig is measured worse than most means all of it
    let told_rough = fixel_position > default.fixel_position
        || outline > default.outline
        || latency > default.latency;
    let well_measured = if told_rough {
        1.0
    } else {
        default.well_measured
    };
    Ok(Uncertainty {
        friction: Friction {
            mu_s: number("mu_s", default.friction.mu_s)?,
            mu_p: number("mu_p", default.friction.mu_p)?,
            mu_f: number("mu_f", default.friction.mu_f)?,
            d_tri: number("d_tri", default.friction.d_tri)?,
        },
        centre_of_friction: number("centre_of_friction", default.centre_of_friction)?,
        tripod_angle: number("tripod_angle", default.tripod_angle)?,
        drift: number("drift", default.drift)?,
        variation: number("variation", default.variation)?,
        variation_length: number("variation_length", default.variation_length)?,
        force_std: number("force_std", default.force_std)?,
        force_spread: number("force_spread", default.force_spread)?,
        creep: number("creep", default.creep)?,
        pusher_offset: number("pusher_offset", default.pusher_offset)?,
        pusher_lag: number("pusher_lag", default.pusher_lag)?,
        fixel_position,
        outline,
        roughness: number("roughness", default.roughness)?,
        well_measured: number("well_measured", well_measured)?,
        camera_noise: number("camera_noise", default.camera_noise)?,
        latency,
        touch_gap: number("touch_gap", default.touch_gap)?,
    })
}
