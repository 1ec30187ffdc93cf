//! `[uncertainty]`, the uncertainty of the other numbers.

use stickslip::dynamics::Friction;
use stickslip::{Rule, Uncertainty, Unit};

use super::document::Table;
use super::error::SceneError;
use super::quantity::Quantity;

const MU_S: Quantity = Quantity::new(
    "mu_s",
    "the relative standard deviation of the friction with the support",
    Unit::None,
    Rule::NotNegative,
);
const MU_P: Quantity = Quantity::new(
    "mu_p",
    "the relative standard deviation of the friction with the pusher",
    Unit::None,
    Rule::NotNegative,
);
const MU_F: Quantity = Quantity::new(
    "mu_f",
    "the relative standard deviation of the friction with the fixels",
    Unit::None,
    Rule::NotNegative,
);
const D_TRI: Quantity = Quantity::new(
    "d_tri",
    "the relative standard deviation of the tripod radius",
    Unit::None,
    Rule::NotNegative,
);
const CENTRE_OF_FRICTION: Quantity = Quantity::new(
    "centre_of_friction",
    "the standard deviation of the centre of friction beside the centre of mass as a share of the radius of gyration",
    Unit::None,
    Rule::NotNegative,
);
const TRIPOD_ANGLE: Quantity = Quantity::new(
    "tripod_angle",
    "the standard deviation of the direction of the first foot",
    Unit::Radian,
    Rule::NotNegative,
);
const DRIFT: Quantity = Quantity::new(
    "drift",
    "the relative change of the friction parameters per step of 1/30 s",
    Unit::None,
    Rule::NotNegative,
);
const VARIATION: Quantity = Quantity::new(
    "variation",
    "the relative standard deviation of friction from place to place",
    Unit::None,
    Rule::NotNegative,
);
const VARIATION_LENGTH: Quantity = Quantity::new(
    "variation_length",
    "the way over which friction varies",
    Unit::Metre,
    Rule::Positive,
);
const FORCE_STD: Quantity = Quantity::new(
    "force_std",
    "the disturbance per step of 1/30 s as a share of the friction impulse",
    Unit::None,
    Rule::NotNegative,
);
const FORCE_SPREAD: Quantity = Quantity::new(
    "force_spread",
    "the relative standard deviation of a factor of the disturbance",
    Unit::None,
    Rule::Share,
);
const CREEP: Quantity = Quantity::new(
    "creep",
    "the share of the object's speed at which a contact slips where friction comes to its bound",
    Unit::None,
    Rule::Share,
);
const PUSHER_OFFSET: Quantity = Quantity::new(
    "pusher_offset",
    "the standard deviation of the offset between the pusher's frame and the camera's",
    Unit::Metre,
    Rule::NotNegative,
);
const PUSHER_LAG: Quantity = Quantity::new(
    "pusher_lag",
    "the standard deviation of the way by which a held pusher is behind its logged pose",
    Unit::Metre,
    Rule::Positive,
);
const FIXEL_POSITION: Quantity = Quantity::new(
    "fixel_position",
    "the standard deviation of a fixel's position",
    Unit::Metre,
    Rule::NotNegative,
);
const OUTLINE: Quantity = Quantity::new(
    "outline",
    "the standard deviation of the distance by which the object's outline lies outside its shape",
    Unit::Metre,
    Rule::NotNegative,
);
const CAMERA_NOISE: Quantity = Quantity::new(
    "camera_noise",
    "the relative standard deviation of the camera's noise",
    Unit::None,
    Rule::NotNegative,
);
const ROUGHNESS: Quantity = Quantity::new(
    "roughness",
    "the relative standard deviation of a factor of these offsets",
    Unit::None,
    Rule::NotNegative,
);
const WELL_MEASURED: Quantity = Quantity::new(
    "well_measured",
    "the factor of fixel_position and latency on the smoother half of rigs",
    Unit::None,
    Rule::Share,
);
const LATENCY: Quantity = Quantity::new(
    "latency",
    "the mean time, up to 1 s, by which the camera lags more than told",
    Unit::Second,
    Rule::Share,
);
const TOUCH_GAP: Quantity = Quantity::new(
    "touch_gap",
    "the gap at which bodies may touch already, beside the errors of their poses and shapes,",
    Unit::Metre,
    Rule::Positive,
);

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
    let number = |quantity: &Quantity, default: f64| table.number_or(quantity, default);
    let (fixel_position, outline, latency) = (
        number(&FIXEL_POSITION, default.fixel_position)?,
        number(&OUTLINE, default.outline)?,
        number(&LATENCY, default.latency)?,
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
            mu_s: number(&MU_S, default.friction.mu_s)?,
            mu_p: number(&MU_P, default.friction.mu_p)?,
            mu_f: number(&MU_F, default.friction.mu_f)?,
            d_tri: number(&D_TRI, default.friction.d_tri)?,
        },
        centre_of_friction: number(&CENTRE_OF_FRICTION, default.centre_of_friction)?,
        tripod_angle: number(&TRIPOD_ANGLE, default.tripod_angle)?,
        drift: number(&DRIFT, default.drift)?,
        variation: number(&VARIATION, default.variation)?,
        variation_length: number(&VARIATION_LENGTH, default.variation_length)?,
        force_std: number(&FORCE_STD, default.force_std)?,
        force_spread: number(&FORCE_SPREAD, default.force_spread)?,
        creep: number(&CREEP, default.creep)?,
        pusher_offset: number(&PUSHER_OFFSET, default.pusher_offset)?,
        pusher_lag: number(&PUSHER_LAG, default.pusher_lag)?,
        fixel_position,
        outline,
        roughness: number(&ROUGHNESS, default.roughness)?,
        well_measured: number(&WELL_MEASURED, well_measured)?,
        camera_noise: number(&CAMERA_NOISE, default.camera_noise)?,
        latency,
        touch_gap: number(&TOUCH_GAP, default.touch_gap)?,
    })
}
