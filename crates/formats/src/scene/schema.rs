//! The JSON schema of `scene.toml`, by which editors complete and check it: [`scene_schema`].

use std::ops::Bound::{self, Excluded, Included};
use std::ops::RangeInclusive;

use serde_json::{Map, Value, json};
use stickslip::{Rule, Unit};

use super::keys::{Form, Key, Need, keys_of};
use super::shapes::{MOST_PARTS, MOST_VERTICES};

/// The JSON schema of `scene.toml`, pretty, with a newline at its end. Each key has its meaning,
/// unit, default and range. The reader alone checks shapes, keys that exclude each other, and
/// numbers next to 0 that are too small for their unit.
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(&stickslip_formats::scene_schema())?;
/// let object = &schema["properties"]["object"];
/// assert_eq!(object["required"][0], "mass");
/// assert_eq!(object["properties"]["mass"]["description"], "The object's mass. Unit: kg. Required.");
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
    let keys = keys_of(name).iter();
    let properties = keys.clone().map(|key| (key.name.to_owned(), property(key)));
    let required = keys.filter(|key| key.need == Need::Required);
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties.collect::<Map<_, _>>(),
        "required": required.map(|key| key.name).collect::<Vec<_>>(),
    })
}

/// The schema of a key: its value, what it means and what it is by default.
fn property(key: &Key) -> Value {
    let mut schema = value(key);
    schema["description"] = description(key).into();
    if let Need::Or(default) = key.need {
        schema["default"] = serde_json::from_str(default).expect("a default is a JSON value");
    }
    schema
}

fn description(key: &Key) -> String {
    let unit = match (key.form, key.unit) {
        (Form::Pose | Form::Poses, _) => " Unit: m, rad.".to_owned(),
        (Form::Shape, _) => " Unit: m.".to_owned(),
        (_, Unit::None) => String::new(),
        (_, unit) => format!(" Unit: {}.", unit.symbol()),
    };
    let default = match key.need {
        Need::Required => " Required.".to_owned(),
        Need::Optional => String::new(),
        Need::Or(default) | Need::Derived(default) => format!(" Default: {default}."),
    };
    let mut what = key.what.trim_end_matches(',').to_owned();
    if let Some(first) = what.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    format!("{what}.{unit}{default} {}", key.note)
        .trim_end()
        .to_owned()
}

/// The schema of a key's value.
fn value(key: &Key) -> Value {
    let number = || number(key.unit, key.rule);
    let point = || list(number(), 2..=2);
    let pose = || list(self::number(Unit::Metre, Rule::Finite), 3..=3);
    match key.form {
        Form::Number => number(),
        Form::Pair => point(),
        Form::Triple => list(number(), 3..=3),
        Form::Pose => pose(),
        Form::Poses => json!({ "type": "object", "additionalProperties": pose() }),
        Form::Feet => list(point(), 3..=3),
        Form::Points => list(point(), 3..=MOST_VERTICES),
        Form::Speed => {
            let mut knot = point();
            knot["items"] = json!([self::number(Unit::Second, Rule::NotNegative), number()]);
            json!({ "anyOf": [number(), list(knot, 1..=usize::MAX)] })
        }
        Form::Shape => list(part(), 1..=MOST_PARTS),
        Form::Table => table(key.name),
        Form::Tables => list(table(key.name), 0..=usize::MAX),
    }
}

/// A number within what a rule allows in a unit.
fn number(unit: Unit, rule: Rule) -> Value {
    let mut schema = json!({ "type": "number" });
    if rule == Rule::PositiveOrInfinite {
        // JSON has no infinity: who turns TOML into JSON makes it null
        schema["type"] = json!(["number", "null"]);
    }
    let mut limit = |limit: Bound<f64>, [included, excluded]: [&str; 2]| match limit {
        Included(limit) => schema[included] = limit.into(),
        Excluded(limit) => schema[excluded] = limit.into(),
        Bound::Unbounded => {}
    };
    let (least, most) = rule.range(unit);
    limit(least, ["minimum", "exclusiveMinimum"]);
    limit(most, ["maximum", "exclusiveMaximum"]);
    schema
}

fn list(items: Value, count: RangeInclusive<usize>) -> Value {
    let mut schema = json!({ "type": "array", "items": items });
    if *count.start() > 0 {
        schema["minItems"] = (*count.start()).into();
    }
    if *count.end() < usize::MAX {
        schema["maxItems"] = (*count.end()).into();
    }
    schema
}

/// A part of a shape: exactly one of its kinds.
fn part() -> Value {
    let kinds = keys_of("part").iter().map(|key| {
        json!({
            "type": "object",
            "additionalProperties": false,
            "properties": { key.name: property(key) },
            "required": [key.name],
        })
    });
    json!({ "oneOf": kinds.collect::<Vec<_>>() })
}
