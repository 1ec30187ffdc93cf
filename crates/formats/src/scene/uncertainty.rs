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
        unknown.friction.d_tri = 0.0;
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
    let fixel_position = number("fixel_position", default.fixel_position)?;
    // who says that a rig is measured worse than most means all of it
    let well_measured = match fixel_position > default.fixel_position {
        true => 1.0,
        false => default.well_measured,
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
        foot_stretch: number("foot_stretch", default.foot_stretch)?,
        force_std: number("force_std", default.force_std)?,
        pusher_offset: number("pusher_offset", default.pusher_offset)?,
        pusher_lag: number("pusher_lag", default.pusher_lag)?,
        fixel_position,
        roughness: number("roughness", default.roughness)?,
        well_measured: number("well_measured", well_measured)?,
        camera_noise: number("camera_noise", default.camera_noise)?,
        latency: number("latency", default.latency)?,
        touch_gap: number("touch_gap", default.touch_gap)?,
    })
}
