//! The JSON schema of `scene.toml`, by which editors complete and check it: [`scene_schema`].

use serde_json::{Map, Value, json};

use super::keys::{TABLES, keys_of};

/// Keys of a table that must be there.
const REQUIRED: [(&str, &[&str]); 6] = [
    ("", &["gravity", "object", "support", "pusher", "fixels"]),
    ("object", &["mass", "shape"]),
    ("support", &["friction"]),
    ("pusher", &["shape", "friction"]),
    ("fixels", &["friction"]),
    ("fixel", &["position", "shape"]),
];

/// The JSON schema of `scene.toml`, pretty, with a newline at its end. Its keys are those that the
/// reader knows; ranges, shapes that cannot be and what excludes what, the reader alone checks.
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(&stickslip_formats::scene_schema())?;
/// assert_eq!(schema["properties"]["object"]["required"][0], "mass");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[must_use]
pub fn scene_schema() -> String {
    let mut schema = table("");
    schema["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    schema["title"] = "scene.toml of stickslip".into();
    format!("{schema:#}\n")
}

/// The schema of a table, its tables within it.
fn table(name: &str) -> Value {
    let properties = keys_of(name).iter().map(|key| {
        let of_table = name.is_empty() && TABLES.iter().any(|(table, _)| table == key);
        let value = match *key {
            "fixel" => json!({ "type": "array", "items": table(key) }),
            key if of_table => table(key),
            key => value(name, key),
        };
        ((*key).to_owned(), value)
    });
    let required = REQUIRED.iter().find(|(table, _)| *table == name);
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties.collect::<Map<_, _>>(),
        "required": required.map_or(&[][..], |(_, keys)| keys),
    })
}

/// The schema of a value that is no table of the format: a number, but for these.
fn value(table: &str, key: &str) -> Value {
    match (table, key) {
        (_, "shape") => json!({ "type": "array", "minItems": 1, "items": part() }),
        (_, "tags") => json!({ "type": "object", "additionalProperties": numbers(3) }),
        ("support", "feet") => {
            json!({ "type": "array", "items": numbers(2), "minItems": 3, "maxItems": 3 })
        }
        ("support", "foot_loads") | ("start", "object" | "pusher") => numbers(3),
        ("fixel", "position") | ("filter", "mu_s" | "mu_p" | "mu_f" | "d_tri") => numbers(2),
        ("start", "speed") => {
            json!({ "anyOf": [number(), { "type": "array", "items": numbers(2) }] })
        }
        _ => number(),
    }
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn numbers(count: usize) -> Value {
    json!({ "type": "array", "items": number(), "minItems": count, "maxItems": count })
}

/// A part of a shape: exactly one of the three kinds.
fn part() -> Value {
    let kind = |name: &str, value: Value| json!({ "type": "object", "additionalProperties": false, "properties": { name: value }, "required": [name] });
    let body = |properties: Value, required: &str| json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": [required] });
    let vertices = json!({ "type": "array", "items": numbers(2), "minItems": 3 });
    let disc = json!({ "radius": number(), "centre": numbers(2) });
    let ellipse = json!({ "semi_axes": numbers(2), "centre": numbers(2), "angle": number() });
    json!({ "oneOf": [
        kind("polygon", vertices),
        kind("disc", body(disc, "radius")),
        kind("ellipse", body(ellipse, "semi_axes")),
    ] })
}
