//! The keys that a scene file may have: [`keys_of`], [`key`], [`nearest_key`].
//!
//! One row per key. The reader takes ranges and the words of its errors from here, and the JSON
//! schema all that it says.

use stickslip::Rule::{
    self, Finite, NotNegative, Positive, PositiveOrInfinite, Probability, Share, Turn,
};
use stickslip::Unit::{
    self, Kilogram, KilogramMetre2, Metre, MetrePerSecond, MetrePerSecond2, Newton, Radian, Second,
};

use crate::nearest::nearest;

use Form::{Feet, Number, Pair, Points, Pose, Poses, Shape, Speed, Table, Tables, Triple};
use Need::{Derived, Optional, Or, Required};

/// Kind of a key's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A number.
    Number,
    /// Two numbers.
    Pair,
    /// Three numbers.
    Triple,
    /// `[x, y, theta]` in m and rad.
    Pose,
    /// A table of free names, a pose for each.
    Poses,
    /// Three points.
    Feet,
    /// Three points or more.
    Points,
    /// A number, or `[[time, number], ...]` with times in s.
    Speed,
    /// A list of tables `part`, each of which has exactly one key.
    Shape,
    /// The table of the key's name.
    Table,
    /// A list of tables of the key's name.
    Tables,
}

/// Effect of a missing key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// An error.
    Required,
    /// None.
    Optional,
    /// This value, as TOML and JSON write it.
    Or(&'static str),
    /// A value that other keys determine, in words.
    Derived(&'static str),
}

/// A key of a table of the format.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) form: Form,
    pub(super) unit: Unit,
    pub(super) rule: Rule,
    pub(super) need: Need,
    /// Meaning; completes "Give ...".
    pub(super) what: &'static str,
    /// A sentence to add in the schema, or nothing.
    pub(super) note: &'static str,
}

/// Unit of a number without one.
const PLAIN: Unit = Unit::None;

/// Names of all tables with their keys; the first one is the document itself.
#[rustfmt::skip]
const TABLES: [(&str, &[Key]); 16] = [
    ("", &[
        number("gravity", MetrePerSecond2, Positive, Required,
            "the gravity that presses the object on the support"),
        of(Table, "object", Required,
            "the pushed object; its frame has its origin in the centre of mass"),
        of(Table, "support", Required, "the contact of object and table"),
        of(Table, "pusher", Required, "the pusher"),
        of(Tables, "finger", Optional,
            "each other finger of a hand, as a table [[finger]] with the keys shape, start, direction")
            .note("Friction and stall_force are the pusher's."),
        of(Table, "fixels", Required, "the friction of all fixels"),
        of(Tables, "fixel", Optional,
            "each fixel, a fixed body, as a table [[fixel]] with the keys position, angle, shape")
            .note("Touch sensor k is on the k-th."),
        of(Table, "camera", Optional,
            "the noise of measured poses").note("Particle and Kalman methods need it."),
        of(Table, "tactile", Optional, "the errors of the touch sensors"),
        of(Table, "wrench", Optional, "the errors of the sensor of the pusher's force"),
        of(Table, "filter", Optional,
            "the settings of the particle filter")
            .note("--model robust does not use force_std and parameter_std."),
        of(Table, "uncertainty", Optional,
            "the priors of the robust model: how well the scene's numbers are known"),
        of(Table, "start", Optional,
            "the start of a simulation").note("Only `stickslip simulate` reads it."),
    ]),
    ("object", &[
        number("mass", Kilogram, Positive, Required, "the object's mass"),
        number("inertia", KilogramMetre2, Positive, Derived("that of a uniform plate"),
            "the object's moment of inertia about its centre of mass"),
        of(Shape, "shape", Required, OUTLINE),
        of(Poses, "tags", Optional, TAGS),
    ]),
    ("support", &[
        number("friction", PLAIN, NotNegative, Required,
            "the nominal friction coefficient mu_s between object and support"),
        number("tripod_radius", Metre, Positive, Derived(MEAN_DISTANCE),
            "the nominal radius d_tri of the support tripod"),
        number("tripod_angle", Radian, Turn, Derived("pi / 2, and unknown"),
            "the direction of the first foot in the object frame"),
        list(Feet, "feet", Metre, Finite, Optional,
            "three feet as [[x, y], [x, y], [x, y]] in the object frame")
            .note("They replace tripod_radius and tripod_angle."),
        list(Triple, "foot_loads", PLAIN, Share, Derived("from statics"),
            "the share of the weight on each of the three feet")
            .note("Only with feet; the sum is 1."),
    ]),
    ("pusher", &[
        of(Shape, "shape", Required, OUTLINE),
        number("friction", PLAIN, NotNegative, Required,
            "the nominal friction coefficient mu_p between object and pusher"),
        number("stall_force", Newton, PositiveOrInfinite, Derived(TWENTY_FRICTIONS),
            "the force at which the drive yields").note("inf: it never yields."),
        of(Poses, "tags", Optional, TAGS),
    ]),
    ("finger", &[
        of(Shape, "shape", Required, OUTLINE),
        of(Pose, "start", Optional, "the finger's pose as [x, y, theta] at the start of a simulation")
            .note("Needed where there is [start]. It keeps its angle."),
        number("direction", Radian, Turn, Derived("opposite to start.direction"),
            "the direction of its motion in a simulation"),
    ]),
    ("fixels", &[
        number("friction", PLAIN, NotNegative, Required,
            "the nominal friction coefficient mu_f between object and fixels"),
    ]),
    ("fixel", &[
        list(Pair, "position", Metre, Finite, Required,
            "the fixel's position in the world as [x, y]"),
        number("angle", Radian, Turn, Or("0.0"), "the fixel's angle"),
        of(Shape, "shape", Required, OUTLINE),
    ]),
    ("camera", &[
        number("position_std", Metre, Positive, Required,
            "the standard deviation of one object position, per axis"),
        number("orientation_std", Radian, Positive, Required,
            "the standard deviation of one object orientation"),
        number("latency", Second, NotNegative, Or("0.0"),
            "the time by which object poses lag the pusher's"),
        number("pusher_position_std", Metre, NotNegative, Or("1.0e-4"),
            "the standard deviation of one pusher position, 0 for exact ones,"),
        number("pusher_orientation_std", Radian, NotNegative, Or("2.0e-3"),
            "the standard deviation of one pusher orientation, 0 for exact ones,"),
    ]),
    ("tactile", &[
        number("false_positive", PLAIN, Probability, Or("0.01"),
            "the probability that an untouched sensor reads 1"),
        number("false_negative", PLAIN, Probability, Or("0.05"),
            "the probability that a touched sensor reads 0")
            .note("The sum with false_positive is below 1."),
        number("touch_force", Newton, NotNegative, Or("0.05"),
            "the force at which the sensor switches"),
    ]),
    ("wrench", &[
        number("force_std", Newton, Positive, Required,
            "the standard deviation of one force of the pusher on the object, per axis"),
        number("bias_std", Newton, NotNegative, Or("0.1"),
            "the standard deviation of that sensor's constant error, per axis"),
        number("scale_std", PLAIN, NotNegative, Or("0.1"),
            "the standard deviation of ln of the measured force over the table's friction")
            .note("The sensor's scale, and friction that differs from place to place."),
    ]),
    ("filter", &[
        number("force_std", PLAIN, NotNegative, Or("0.15"),
            FORCE),
        number("parameter_std", PLAIN, NotNegative, Or("0.05"),
            "the standard deviation of the random step of friction per step of 1/30 s, relative"),
        number("resample_below", PLAIN, Share, Or("0.5"),
            "the share of effective particles below which the filter resamples"),
        number("likelihood_scale", PLAIN, Positive, Or("1.5"),
            "the factor on the camera's standard deviations"),
        list(Pair, "mu_s", PLAIN, NotNegative, Or("[0.05, 1.0]"),
            "the limits of mu_s as [smallest, largest]").note(WIDENED),
        list(Pair, "mu_p", PLAIN, NotNegative, Or("[0.02, 1.0]"),
            "the limits of mu_p as [smallest, largest]").note(WIDENED),
        list(Pair, "mu_f", PLAIN, NotNegative, Or("[0.02, 1.0]"),
            "the limits of mu_f as [smallest, largest]").note(WIDENED),
        list(Pair, "d_tri", Metre, Positive, Or("[0.003, 0.04]"),
            "the limits of the tripod radius as [smallest, largest]")
            .note("At least from nominal / 1.6 to 1.6 x nominal."),
    ]),
    ("uncertainty", &[
        number("mu_s", PLAIN, NotNegative, Or("0.35"), "the prior standard deviation of ln mu_s"),
        number("mu_p", PLAIN, NotNegative, Or("0.45"), "the prior standard deviation of ln mu_p"),
        number("mu_f", PLAIN, NotNegative, Or("0.45"), "the prior standard deviation of ln mu_f"),
        number("d_tri", PLAIN, NotNegative, Or("0.25"), "the prior standard deviation of ln d_tri"),
        number("centre_of_friction", PLAIN, NotNegative, Or("0.15"),
            "the standard deviation of the centre of friction per axis, over the radius of gyration")
            .note("0 where support.feet is given."),
        number("tripod_angle", Radian, NotNegative, Or("1.0471975511965979"),
            "the standard deviation of the rotation of the feet")
            .note("pi / 3 is any angle; 0 where support.tripod_angle or support.feet is given."),
        number("foot_stretch", PLAIN, NotNegative, Or("0.3"),
            "the standard deviation of ln of a stretch of the feet's triangle")
            .note("0 where support.feet is given."),
        number("force_std", PLAIN, NotNegative, Or("0.25"),
            FORCE),
        number("pusher_offset", Metre, NotNegative, Or("3.0e-4"),
            "the standard deviation of the pusher frame's offset from the camera's, per axis"),
        number("pusher_lag", Metre, Positive, Or("3.0e-3"),
            "the distance by which a soft drive lags its logged pose in a jam before it stops")
            .note("Times well_measured on the smoother half of rigs."),
        number("fixel_position", Metre, NotNegative, Or("3.0e-4"),
            "the standard deviation of a fixel's position, per axis"),
        number("roughness", PLAIN, NotNegative, Or("0.5"),
            "the standard deviation of ln of a common factor on these offsets"),
        number("well_measured", PLAIN, Share, Or("0.1"),
            "the factor on fixel_position and pusher_lag on the smoother half of rigs")
            .note("1 if fixel_position exceeds its default."),
        number("camera_noise", PLAIN, NotNegative, Or("0.3"),
            "the standard deviation of ln of the camera's noise over that of [camera]"),
        number("latency", Second, Share, Or("0.01"),
            "the median, up to 1 s, of the camera's lag in addition to camera.latency"),
        number("touch_gap", Metre, Positive, Or("2.5e-4"),
            "the gap at which bodies may touch, in addition to errors of poses and shapes"),
    ]),
    ("start", &[
        of(Pose, "object", Required, "the object's pose as [x, y, theta]"),
        of(Pose, "pusher", Required,
            "the pusher's pose as [x, y, theta]").note("It keeps its angle."),
        number("direction", Radian, Turn, Or("0.0"),
            "the direction of the pusher's motion in the world"),
        list(Speed, "speed", MetrePerSecond, Finite, Required,
            "the pusher's speed in m/s, or its course as [[time, speed], ...] in s and m/s")
            .note("Times do not fall."),
        number("duration", Second, Positive, Required, "the duration of the experiment"),
    ]),
    ("part", &[
        list(Points, "polygon", Metre, Finite, Optional,
            "the vertices as [[x, y], ...], counter-clockwise and convex,"),
        of(Table, "disc", Optional, "{ radius = ... } in m"),
        of(Table, "ellipse", Optional, "{ semi_axes = [..., ...] } in m"),
    ]),
    ("disc", &[
        number("radius", Metre, Positive, Required, "the disc's radius"),
        list(Pair, "centre", Metre, Finite, Or("[0.0, 0.0]"), "the centre as [x, y]"),
    ]),
    ("ellipse", &[
        list(Pair, "semi_axes", Metre, Positive, Required,
            "the half lengths of the two axes as [a, b]"),
        list(Pair, "centre", Metre, Finite, Or("[0.0, 0.0]"), "the centre as [x, y]"),
        number("angle", Radian, Turn, Or("0.0"), "the angle of the first axis"),
    ]),
];

const MEAN_DISTANCE: &str = "the mean distance of the outline's inside from the centre of mass";
const TWENTY_FRICTIONS: &str = "20 x support.friction x mass x gravity";
const OUTLINE: &str =
    "the outline as a list of parts, each { polygon = ... }, { disc = ... } or { ellipse = ... }";
const TAGS: &str = "the tags' poses on the body as { FRAME = [x, y, theta], ... }";
const FORCE: &str =
    "the standard deviation of the random force per step of 1/30 s and axis as a share of mu_s m g";
const WIDENED: &str = "At least from half to twice the nominal value.";

const fn of(form: Form, name: &'static str, need: Need, what: &'static str) -> Key {
    list(form, name, PLAIN, Finite, need, what)
}

const fn number(name: &'static str, unit: Unit, rule: Rule, need: Need, what: &'static str) -> Key {
    list(Number, name, unit, rule, need, what)
}

/// A key whose numbers all have one unit and one rule.
const fn list(
    form: Form,
    name: &'static str,
    unit: Unit,
    rule: Rule,
    need: Need,
    what: &'static str,
) -> Key {
    Key {
        name,
        form,
        unit,
        rule,
        need,
        what,
        note: "",
    }
}

impl Key {
    const fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }

    /// The meaning with the unit.
    pub(super) fn order(&self) -> String {
        match (self.form, self.unit) {
            (Pose | Poses, _) => format!("{} in m and rad", self.what),
            (Table, _) if TABLES[0].1.iter().any(|key| key.name == self.name) => format!(
                "the table [{}] with keys among {}",
                self.name,
                names_of(self.name).join(", ")
            ),
            (Speed, _) | (_, Unit::None) => self.what.to_owned(),
            (_, unit) => format!("{} in {}", self.what, unit.symbol()),
        }
    }
}

/// The keys that a table of the format may have; `""` is the document itself.
pub(super) fn keys_of(table: &str) -> &'static [Key] {
    TABLES
        .iter()
        .find(|(name, _)| *name == table)
        .map_or(&[], |(_, keys)| keys)
}

/// The names of these keys.
pub(super) fn names_of(table: &str) -> Vec<&'static str> {
    keys_of(table).iter().map(|key| key.name).collect()
}

/// A key of a table of the format.
///
/// # Panics
/// If the format has no such key.
pub(super) fn key(table: &str, name: &str) -> &'static Key {
    keys_of(table)
        .iter()
        .find(|key| key.name == name)
        .unwrap_or_else(|| panic!("the format has no key {table}.{name}"))
}

/// Replacement of a key that the format no longer has.
pub(super) fn instead_of(path: &str) -> Option<&'static str> {
    let (_, instead) = REMOVED.iter().find(|(removed, _)| *removed == path)?;
    Some(instead)
}

/// Keys of earlier versions, and their replacements.
const REMOVED: [(&str, &str); 6] = [
    (
        "uncertainty.drift",
        "all unknowns take random steps of the same share of their priors",
    ),
    (
        "uncertainty.variation",
        "the random steps of friction also follow its variation from place to place",
    ),
    (
        "uncertainty.variation_length",
        "the random steps of friction also follow its variation from place to place",
    ),
    (
        "uncertainty.outline",
        "uncertainty.pusher_offset and uncertainty.fixel_position also cover a wrong outline",
    ),
    (
        "uncertainty.force_spread",
        "uncertainty.force_std is the same for all particles",
    ),
    ("uncertainty.creep", "contacts follow Coulomb's law"),
];

/// The known key that was probably meant: a near miss in `table`, else the same key in the table
/// that has it.
pub(super) fn nearest_key(name: &str, table: &str) -> String {
    let (here, distance) = nearest(name, names_of(table)).unwrap_or_default();
    let elsewhere = TABLES
        .iter()
        .find(|(_, keys)| keys.iter().any(|key| key.name == name));
    match elsewhere {
        Some((table, _)) if distance > 1 => {
            if table.is_empty() {
                format!("{name} above all tables")
            } else {
                format!("{table}.{name}")
            }
        }
        _ => here.to_owned(),
    }
}
