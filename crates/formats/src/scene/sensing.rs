//! `[camera]`, `[tactile]` and `[filter]`.

use stickslip::dynamics::Friction;
use stickslip::{Camera, FilterSettings, Limits, Rule, Tactile, Unit};

use super::document::Table;
use super::error::SceneError;
use super::quantity::Quantity;

type Result<T> = std::result::Result<T, SceneError>;

const POSITION_STD: Quantity = Quantity::new(
    "position_std",
    "the standard deviation of one object position",
    Unit::Metre,
    Rule::Positive,
);
const ORIENTATION_STD: Quantity = Quantity::new(
    "orientation_std",
    "the standard deviation of one object orientation",
    Unit::Radian,
    Rule::Positive,
);
const LATENCY: Quantity = Quantity::new(
    "latency",
    "the time by which object poses lag the pusher's",
    Unit::Second,
    Rule::NotNegative,
);
const PUSHER_POSITION_STD: Quantity = Quantity::new(
    "pusher_position_std",
    "the standard deviation of one pusher position, 0 for exact ones,",
    Unit::Metre,
    Rule::NotNegative,
);
const PUSHER_ORIENTATION_STD: Quantity = Quantity::new(
    "pusher_orientation_std",
    "the standard deviation of one pusher orientation, 0 for exact ones,",
    Unit::Radian,
    Rule::NotNegative,
);

const FALSE_POSITIVE: Quantity = Quantity::new(
    "false_positive",
    "the probability that an untouched sensor reads 1",
    Unit::None,
    Rule::Probability,
);
const FALSE_NEGATIVE: Quantity = Quantity::new(
    "false_negative",
    "the probability that a touched sensor reads 0",
    Unit::None,
    Rule::Probability,
);
const TOUCH_FORCE: Quantity = Quantity::new(
    "touch_force",
    "the force at which the sensor switches",
    Unit::Newton,
    Rule::NotNegative,
);

const FORCE_STD: Quantity = Quantity::new(
    "force_std",
    "the disturbance per step of 1/30 s as a share of the friction impulse",
    Unit::None,
    Rule::NotNegative,
);
const PARAMETER_STD: Quantity = Quantity::new(
    "parameter_std",
    "the relative change of the friction parameters per step of 1/30 s",
    Unit::None,
    Rule::NotNegative,
);
const RESAMPLE_BELOW: Quantity = Quantity::new(
    "resample_below",
    "the share of effective particles below which the set is resampled",
    Unit::None,
    Rule::Share,
);
const LIKELIHOOD_SCALE: Quantity = Quantity::new(
    "likelihood_scale",
    "the factor that widens the camera's standard deviations",
    Unit::None,
    Rule::Positive,
);
const MU_S: Quantity = Quantity::new(
    "mu_s",
    "the limits of mu_s as [smallest, largest]",
    Unit::None,
    Rule::NotNegative,
);
const MU_P: Quantity = Quantity::new(
    "mu_p",
    "the limits of mu_p as [smallest, largest]",
    Unit::None,
    Rule::NotNegative,
);
const MU_F: Quantity = Quantity::new(
    "mu_f",
    "the limits of mu_f as [smallest, largest]",
    Unit::None,
    Rule::NotNegative,
);
const D_TRI: Quantity = Quantity::new(
    "d_tri",
    "the limits of the tripod radius as [smallest, largest]",
    Unit::Metre,
    Rule::Positive,
);

/// `[camera]`; the pusher's deviations default to 1e-4 m and 2e-3 rad, the latency to 0.
pub(super) fn camera(table: &Table<'_>) -> Result<Camera> {
    Ok(Camera {
        position_std: table.number(&POSITION_STD)?,
        orientation_std: table.number(&ORIENTATION_STD)?,
        latency: table.number_or(&LATENCY, 0.0)?,
        pusher_position_std: table.number_or(&PUSHER_POSITION_STD, 1.0e-4)?,
        pusher_orientation_std: table.number_or(&PUSHER_ORIENTATION_STD, 2.0e-3)?,
    })
}

/// `[tactile]`.
pub(super) fn tactile(table: &Table<'_>) -> Result<Tactile> {
    let default = Tactile::default();
    Ok(Tactile {
        false_positive: table.number_or(&FALSE_POSITIVE, default.false_positive)?,
        false_negative: table.number_or(&FALSE_NEGATIVE, default.false_negative)?,
        touch_force: table.number_or(&TOUCH_FORCE, default.touch_force)?,
    })
}

/// `[filter]`; values that it leaves out are those of `default`.
pub(super) fn filter(table: &Table<'_>, default: FilterSettings) -> Result<FilterSettings> {
    Ok(FilterSettings {
        force_std: table.number_or(&FORCE_STD, default.force_std)?,
        parameter_std: table.number_or(&PARAMETER_STD, default.parameter_std)?,
        resample_below: table.number_or(&RESAMPLE_BELOW, default.resample_below)?,
        likelihood_scale: table.number_or(&LIKELIHOOD_SCALE, default.likelihood_scale)?,
        limits: Friction {
            mu_s: limits(table, &MU_S, default.limits.mu_s)?,
            mu_p: limits(table, &MU_P, default.limits.mu_p)?,
            mu_f: limits(table, &MU_F, default.limits.mu_f)?,
            d_tri: limits(table, &D_TRI, default.limits.d_tri)?,
        },
    })
}

fn limits(table: &Table<'_>, quantity: &Quantity, default: Limits) -> Result<Limits> {
    let Some(node) = table.optional(quantity.key) else {
        return Ok(default);
    };
    let [min, max] = node.pair(quantity)?;
    if min <= max {
        Ok(Limits { min, max })
    } else {
        Err(node.out_of_range("the smaller limit first", quantity))
    }
}
