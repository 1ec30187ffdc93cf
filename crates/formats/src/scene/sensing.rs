//! `[camera]`, `[tactile]`, `[wrench]` and `[filter]`.

use stickslip::dynamics::Friction;
use stickslip::{Camera, FilterSettings, ForceSensor, Limits, Tactile};

use super::document::Table;
use super::error::SceneError;

type Result<T> = std::result::Result<T, SceneError>;

/// `[camera]`; the pusher's deviations default to 1e-4 m and 2e-3 rad, the latency to 0.
pub(super) fn camera(table: &Table<'_>) -> Result<Camera> {
    Ok(Camera {
        position_std: table.number("position_std")?,
        orientation_std: table.number("orientation_std")?,
        latency: table.number_or("latency", 0.0)?,
        pusher_position_std: table.number_or("pusher_position_std", 1.0e-4)?,
        pusher_orientation_std: table.number_or("pusher_orientation_std", 2.0e-3)?,
    })
}

/// `[tactile]`.
pub(super) fn tactile(table: &Table<'_>) -> Result<Tactile> {
    let default = Tactile::default();
    Ok(Tactile {
        false_positive: table.number_or("false_positive", default.false_positive)?,
        false_negative: table.number_or("false_negative", default.false_negative)?,
        touch_force: table.number_or("touch_force", default.touch_force)?,
    })
}

/// `[wrench]`; the bias defaults to [`BIAS_STD`], the scale to [`SCALE_STD`].
pub(super) fn wrench(table: &Table<'_>) -> Result<ForceSensor> {
    Ok(ForceSensor {
        force_std: table.number("force_std")?,
        bias_std: table.number_or("bias_std", BIAS_STD)?,
        scale_std: table.number_or("scale_std", SCALE_STD)?,
    })
}

/// Bias of a tared force sensor (N).
const BIAS_STD: f64 = 0.1;

/// Share by which a table's friction differs from place to place.
const SCALE_STD: f64 = 0.1;

/// `[filter]`; values that it leaves out are those of `default`.
pub(super) fn filter(table: &Table<'_>, default: FilterSettings) -> Result<FilterSettings> {
    Ok(FilterSettings {
        force_std: table.number_or("force_std", default.force_std)?,
        parameter_std: table.number_or("parameter_std", default.parameter_std)?,
        resample_below: table.number_or("resample_below", default.resample_below)?,
        likelihood_scale: table.number_or("likelihood_scale", default.likelihood_scale)?,
        limits: Friction {
            mu_s: limits(table, "mu_s", default.limits.mu_s)?,
            mu_p: limits(table, "mu_p", default.limits.mu_p)?,
            mu_f: limits(table, "mu_f", default.limits.mu_f)?,
            d_tri: limits(table, "d_tri", default.limits.d_tri)?,
        },
    })
}

fn limits(table: &Table<'_>, name: &str, default: Limits) -> Result<Limits> {
    let Some(node) = table.optional(name) else {
        return Ok(default);
    };
    let [min, max] = node.pair()?;
    if min <= max {
        Ok(Limits { min, max })
    } else {
        Err(node.out_of_range("the smaller limit first"))
    }
}
