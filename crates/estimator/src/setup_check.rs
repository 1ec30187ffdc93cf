//! Check that the numbers of a [`Setup`] are possible: [`Setup::check`].
//!
//! A scene file's numbers are checked at their place when it is read. A program may put any numbers
//! into a setup.

use stickslip_dynamics::{Feet, Friction, Scene, Shape};

use crate::range::{Rule, SetupError, Unit};
use crate::setup::{Camera, FilterSettings, ForceSensor, Limits, Setup, Tactile};
use crate::uncertainty::Uncertainty;

/// A number with its name, its rule and its unit.
type Number = (&'static str, f64, Rule, Unit);

impl Setup {
    /// Refuses impossible numbers.
    ///
    /// # Errors
    /// The first such number, with its name and what it must be.
    pub fn check(&self) -> Result<(), SetupError> {
        let camera = self.camera.iter().flat_map(camera);
        let parts = scene(&self.scene).into_iter().chain(camera);
        let parts = parts
            .chain(tactile(&self.tactile))
            .chain(self.wrench.iter().flat_map(wrench))
            .chain(filter(&self.filter))
            .chain(uncertainty(&self.uncertainty));
        for (name, value, rule, unit) in parts {
            check(name, value, rule, unit)?;
        }
        Ok(())
    }
}

/// Refuses an impossible number.
pub(crate) fn check(name: &str, value: f64, rule: Rule, unit: Unit) -> Result<(), SetupError> {
    match rule.broken_by(value, unit) {
        None => Ok(()),
        Some(rule) => Err(SetupError {
            name: name.to_owned(),
            value,
            unit,
            rule,
        }),
    }
}

fn scene(scene: &Scene) -> Vec<Number> {
    use Rule::{Finite, Positive, PositiveOrInfinite};
    let stall = scene.pusher.stall_force.unwrap_or(f64::INFINITY);
    let size = scene.object.shape.bounding_radius();
    let mut numbers = vec![
        (
            "scene.gravity",
            scene.gravity,
            Positive,
            Unit::MetrePerSecond2,
        ),
        (
            "scene.object.mass",
            scene.object.mass,
            Positive,
            Unit::Kilogram,
        ),
        (
            "scene.object.inertia",
            scene.object.inertia,
            Positive,
            Unit::KilogramMetre2,
        ),
        (
            "the radius of scene.object.shape",
            size,
            Positive,
            Unit::Metre,
        ),
        (
            "scene.pusher.stall_force",
            stall,
            PositiveOrInfinite,
            Unit::Newton,
        ),
    ];
    let fingers = scene.pusher.fingers.iter().map(Shape::bounding_radius);
    numbers.extend(fingers.map(|radius| ("the radius of a finger", radius, Positive, Unit::Metre)));
    numbers.extend(friction(&scene.nominal));
    if let Feet::Known { positions, loads } = &scene.feet {
        let positions = positions.iter().flatten();
        numbers.extend(positions.map(|x| ("scene.feet.positions", *x, Finite, Unit::Metre)));
        numbers.extend(loads.map(|load| ("scene.feet.loads", load, Rule::Share, Unit::None)));
    }
    for fixel in &scene.fixels {
        numbers.extend([
            ("the x of a fixel", fixel.pose.x, Finite, Unit::Metre),
            ("the y of a fixel", fixel.pose.y, Finite, Unit::Metre),
            (
                "the angle of a fixel",
                fixel.pose.theta,
                Rule::Turn,
                Unit::Radian,
            ),
        ]);
    }
    numbers
}

fn friction(nominal: &Friction<f64>) -> [Number; 4] {
    use Rule::{NotNegative, Positive};
    [
        ("scene.nominal.mu_s", nominal.mu_s, NotNegative, Unit::None),
        ("scene.nominal.mu_p", nominal.mu_p, NotNegative, Unit::None),
        ("scene.nominal.mu_f", nominal.mu_f, NotNegative, Unit::None),
        ("scene.nominal.d_tri", nominal.d_tri, Positive, Unit::Metre),
    ]
}

fn camera(camera: &Camera) -> [Number; 5] {
    use Rule::{NotNegative, Positive};
    [
        (
            "camera.position_std",
            camera.position_std,
            Positive,
            Unit::Metre,
        ),
        (
            "camera.orientation_std",
            camera.orientation_std,
            Positive,
            Unit::Radian,
        ),
        ("camera.latency", camera.latency, NotNegative, Unit::Second),
        (
            "camera.pusher_position_std",
            camera.pusher_position_std,
            NotNegative,
            Unit::Metre,
        ),
        (
            "camera.pusher_orientation_std",
            camera.pusher_orientation_std,
            NotNegative,
            Unit::Radian,
        ),
    ]
}

fn wrench(wrench: &ForceSensor) -> [Number; 3] {
    [
        (
            "wrench.force_std",
            wrench.force_std,
            Rule::Positive,
            Unit::Newton,
        ),
        (
            "wrench.bias_std",
            wrench.bias_std,
            Rule::NotNegative,
            Unit::Newton,
        ),
        (
            "wrench.scale_std",
            wrench.scale_std,
            Rule::NotNegative,
            Unit::None,
        ),
    ]
}

fn tactile(tactile: &Tactile) -> [Number; 4] {
    use Rule::{NotNegative, Probability};
    [
        (
            "tactile.false_positive",
            tactile.false_positive,
            Probability,
            Unit::None,
        ),
        (
            "tactile.false_negative",
            tactile.false_negative,
            Probability,
            Unit::None,
        ),
        (
            // else no sensor works
            "tactile.false_positive + tactile.false_negative",
            tactile.false_positive + tactile.false_negative,
            Probability,
            Unit::None,
        ),
        (
            "tactile.touch_force",
            tactile.touch_force,
            NotNegative,
            Unit::Newton,
        ),
    ]
}

fn filter(filter: &FilterSettings) -> Vec<Number> {
    use Rule::{NotNegative, Positive, Share};
    let Friction {
        mu_s,
        mu_p,
        mu_f,
        d_tri,
    } = filter.limits;
    let mut numbers = vec![
        (
            "filter.force_std",
            filter.force_std,
            NotNegative,
            Unit::None,
        ),
        (
            "filter.parameter_std",
            filter.parameter_std,
            NotNegative,
            Unit::None,
        ),
        (
            "filter.resample_below",
            filter.resample_below,
            Share,
            Unit::None,
        ),
        (
            "filter.likelihood_scale",
            filter.likelihood_scale,
            Positive,
            Unit::None,
        ),
    ];
    let limits = [
        ("filter.limits.mu_s", mu_s, NotNegative, Unit::None),
        ("filter.limits.mu_p", mu_p, NotNegative, Unit::None),
        ("filter.limits.mu_f", mu_f, NotNegative, Unit::None),
        ("filter.limits.d_tri", d_tri, Positive, Unit::Metre),
    ];
    for (name, Limits { min, max }, rule, unit) in limits {
        numbers.extend([(name, min, rule, unit), (name, max, rule, unit)]);
    }
    let widths = [
        ("the width of filter.limits.mu_s", mu_s),
        ("the width of filter.limits.mu_p", mu_p),
        ("the width of filter.limits.mu_f", mu_f),
        ("the width of filter.limits.d_tri", d_tri),
    ];
    numbers.extend(widths.map(|(name, limits)| {
        (
            name,
            (limits.max - limits.min).min(0.0),
            NotNegative,
            Unit::None,
        )
    }));
    numbers
}

fn uncertainty(unknown: &Uncertainty) -> Vec<Number> {
    use Rule::{NotNegative, Positive, Share};
    let friction = unknown.friction.fields();
    let names = [
        "uncertainty.mu_s",
        "uncertainty.mu_p",
        "uncertainty.mu_f",
        "uncertainty.d_tri",
    ];
    let plain = [
        ("uncertainty.centre_of_friction", unknown.centre_of_friction),
        ("uncertainty.foot_stretch", unknown.foot_stretch),
        ("uncertainty.force_std", unknown.force_std),
        ("uncertainty.roughness", unknown.roughness),
        ("uncertainty.camera_noise", unknown.camera_noise),
    ];
    let lengths = [
        ("uncertainty.pusher_offset", unknown.pusher_offset),
        ("uncertainty.fixel_position", unknown.fixel_position),
    ];
    let positive = [
        ("uncertainty.pusher_lag", unknown.pusher_lag),
        ("uncertainty.touch_gap", unknown.touch_gap),
    ];
    let friction = names
        .into_iter()
        .zip(friction)
        .map(|(name, std)| (name, *std));
    let mut numbers: Vec<Number> = friction
        .chain(plain)
        .map(|(name, value)| (name, value, NotNegative, Unit::None))
        .collect();
    numbers.extend(lengths.map(|(name, value)| (name, value, NotNegative, Unit::Metre)));
    numbers.extend(positive.map(|(name, value)| (name, value, Positive, Unit::Metre)));
    let angle = unknown.tripod_angle;
    numbers.push(("uncertainty.tripod_angle", angle, NotNegative, Unit::Radian));
    numbers.push(("uncertainty.latency", unknown.latency, Share, Unit::Second));
    let factor = unknown.well_measured;
    numbers.push(("uncertainty.well_measured", factor, Share, Unit::None));
    numbers
}
