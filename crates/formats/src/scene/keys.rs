//! The keys that a scene file may have: [`keys_of`], [`nearest_key`].

use crate::nearest::nearest;

/// The keys of each table of the format; the first one is the document itself.
pub(super) const TABLES: [(&str, &[&str]); 11] = [
    (
        "",
        &[
            "gravity",
            "object",
            "support",
            "pusher",
            "fixels",
            "fixel",
            "camera",
            "tactile",
            "filter",
            "uncertainty",
            "start",
        ],
    ),
    ("object", &["mass", "inertia", "shape", "tags"]),
    (
        "support",
        &[
            "friction",
            "tripod_radius",
            "tripod_angle",
            "feet",
            "foot_loads",
        ],
    ),
    ("pusher", &["shape", "friction", "stall_force", "tags"]),
    ("fixels", &["friction"]),
    ("fixel", &["position", "angle", "shape"]),
    (
        "camera",
        &[
            "position_std",
            "orientation_std",
            "latency",
            "pusher_position_std",
            "pusher_orientation_std",
        ],
    ),
    (
        "tactile",
        &["false_positive", "false_negative", "touch_force"],
    ),
    (
        "filter",
        &[
            "force_std",
            "parameter_std",
            "resample_below",
            "likelihood_scale",
            "mu_s",
            "mu_p",
            "mu_f",
            "d_tri",
        ],
    ),
    (
        "uncertainty",
        &[
            "mu_s",
            "mu_p",
            "mu_f",
            "d_tri",
            "centre_of_friction",
            "tripod_angle",
            "drift",
            "variation",
            "variation_length",
            "force_std",
            "force_spread",
            "creep",
            "pusher_offset",
            "pusher_lag",
            "fixel_position",
            "outline",
            "roughness",
            "well_measured",
            "camera_noise",
            "latency",
            "touch_gap",
        ],
    ),
    (
        "start",
        &["object", "pusher", "direction", "speed", "duration"],
    ),
];

/// The keys that a table of the format may have; `""` is the document itself.
pub(super) fn keys_of(table: &str) -> &'static [&'static str] {
    TABLES
        .iter()
        .find(|(name, _)| *name == table)
        .map_or(&[], |(_, keys)| keys)
}

/// The known key that was probably meant: a near miss at this place, else the same key in the table
/// it belongs to.
pub(super) fn nearest_key(key: &str, known: &[&str]) -> String {
    let (here, distance) = nearest(key, known.iter().copied()).unwrap_or_default();
    let elsewhere = TABLES.iter().find(|(_, keys)| keys.contains(&key));
    match elsewhere {
        Some((table, _)) if distance > 1 => {
            if table.is_empty() {
                format!("{key} above all tables")
            } else {
                format!("{table}.{key}")
            }
        }
        _ => here.to_owned(),
    }
}
