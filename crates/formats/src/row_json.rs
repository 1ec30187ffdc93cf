//! A row as one line of JSON: [`read_row_json`], keys named as the columns of `log.csv`.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::Value;
use stickslip::Row;
use stickslip_dynamics::Pose;

use crate::log_csv::{
    COVARIANCE, FINGERS, FORCE, OBJECT, PUSHER, TACTILE, covariance, finger_names,
};
use crate::nearest::nearest;

/// Most tactile sensors of a row.
const MOST_SENSORS: usize = 1000;

/// Reason why a line is no row.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RowJsonError {
    /// No JSON object.
    #[error(
        "the line is no JSON object: {0}. Write a row as {{\"time\": 0.033, \"object_x\": 0.1, ...}}"
    )]
    Syntax(String),
    /// A key that a row does not have.
    #[error("`{key}` is no key of a row; the nearest is `{nearest}`. Correct it, or leave it out")]
    UnknownKey {
        /// The key.
        key: String,
        /// A key that is one.
        nearest: String,
    },
    /// A key that is there twice.
    #[error("`{0}` is there twice; a row has each key once. Leave one out")]
    Twice(String),
    /// A value of another type.
    #[error(
        "`{key}` is {found}; it must be {expected}. Write null, or leave it out, where nothing was measured"
    )]
    Type {
        /// The key.
        key: String,
        /// The value.
        found: String,
        /// Expected value.
        expected: &'static str,
    },
    /// A pose or force without all of its numbers.
    #[error("`{missing}` is missing and `{given}` is there; give both or neither")]
    Partial {
        /// A key that is there.
        given: &'static str,
        /// One that is not.
        missing: &'static str,
    },
    /// No time.
    #[error("`time` is missing; every row has one. Give it in s")]
    NoTime,
}

/// Keys and values in the order of the line.
struct Entries(Vec<(String, Value)>);

/// Reads a row from a line of JSON: an object whose keys are named as the columns of `log.csv`
/// (`time`, `object_x`, ..., `tactile_1`, ..., `pusher_force_y`), `null` or left out where nothing
/// was measured; tactile values are 0, 1, `true` or `false`. Numbers keep their bits.
///
/// # Errors
/// No JSON object, an unknown key or one twice, a value of another type, a pose or force in part,
/// no time.
///
/// ```
/// let line = r#"{"time": 0.5, "pusher_x": 0.1, "pusher_y": 0, "pusher_theta": 0, "tactile_2": 1}"#;
/// let row = stickslip_formats::read_row_json(line)?;
/// assert_eq!((row.time, row.object, row.tactile), (0.5, None, vec![None, Some(true)]));
/// # Ok::<(), stickslip_formats::RowJsonError>(())
/// ```
pub fn read_row_json(line: &str) -> Result<Row, RowJsonError> {
    let Entries(entries) =
        serde_json::from_str(line).map_err(|error| RowJsonError::Syntax(error.to_string()))?;
    let mut seen: Vec<&str> = Vec::with_capacity(entries.len());
    for (key, _) in &entries {
        if seen.contains(&key.as_str()) {
            return Err(RowJsonError::Twice(key.clone()));
        }
        seen.push(key);
        check_key(key)?;
    }
    let number = |key: &str| number(&entries, key);
    let mut row = Row {
        time: number("time")?.ok_or(RowJsonError::NoTime)?,
        object: whole(OBJECT, number)?.map(pose),
        object_covariance: whole(COVARIANCE, number)?.map(covariance),
        pusher: whole(PUSHER, number)?.map(pose),
        other_fingers: finger_names(|name| seen.contains(&name))
            .iter()
            .map(|names| Ok(whole(*names, number)?.map(pose)))
            .collect::<Result<_, _>>()?,
        tactile: Vec::new(),
        force: whole(FORCE, number)?,
    };
    for (key, value) in &entries {
        let Some(sensor) = sensor(key) else { continue };
        let reading = reading(key, value)?;
        if row.tactile.len() < sensor {
            row.tactile.resize(sensor, None);
        }
        row.tactile[sensor - 1] = reading;
    }
    Ok(row)
}

fn pose([x, y, theta]: [f64; 3]) -> Pose {
    Pose::new(x, y, theta)
}

fn check_key(key: &str) -> Result<(), RowJsonError> {
    let known = || {
        ["time"]
            .into_iter()
            .chain(OBJECT)
            .chain(PUSHER)
            .chain(FINGERS.into_iter().flatten())
            .chain(FORCE)
            .chain(COVARIANCE)
    };
    if known().any(|name| name == key) || sensor(key).is_some() {
        return Ok(());
    }
    let near = nearest(key, known().chain(["tactile_1"]));
    Err(RowJsonError::UnknownKey {
        key: shortened(key),
        nearest: near.map_or("time", |(name, _)| name).to_owned(),
    })
}

/// The number of a tactile key, from 1.
fn sensor(key: &str) -> Option<usize> {
    let digits = key.strip_prefix(TACTILE)?;
    let k: usize = digits.parse().ok()?;
    ((1..=MOST_SENSORS).contains(&k) && k.to_string() == digits).then_some(k)
}

fn number(entries: &[(String, Value)], key: &str) -> Result<Option<f64>, RowJsonError> {
    match entries.iter().find(|(name, _)| name == key) {
        None | Some((_, Value::Null)) => Ok(None),
        Some((_, value)) => match value.as_f64() {
            Some(number) => Ok(Some(number)),
            None => Err(wrong(key, value, "a number or null")),
        },
    }
}

fn reading(key: &str, value: &Value) -> Result<Option<bool>, RowJsonError> {
    match value {
        Value::Null => Ok(None),
        Value::Bool(on) => Ok(Some(*on)),
        Value::Number(number) if number.as_f64() == Some(0.0) => Ok(Some(false)),
        Value::Number(number) if number.as_f64() == Some(1.0) => Ok(Some(true)),
        _ => Err(wrong(key, value, "0, 1, true, false or null")),
    }
}

/// All numbers, or none of them.
fn whole<const N: usize>(
    keys: [&'static str; N],
    number: impl Fn(&str) -> Result<Option<f64>, RowJsonError>,
) -> Result<Option<[f64; N]>, RowJsonError> {
    let mut numbers = [0.0; N];
    let (mut given, mut missing) = (None, None);
    for (slot, key) in numbers.iter_mut().zip(keys) {
        match number(key)? {
            Some(number) => (*slot, given) = (number, Some(key)),
            None => missing = Some(key),
        }
    }
    match (given, missing) {
        (Some(given), Some(missing)) => Err(RowJsonError::Partial { given, missing }),
        (None, _) => Ok(None),
        _ => Ok(Some(numbers)),
    }
}

fn wrong(key: &str, value: &Value, expected: &'static str) -> RowJsonError {
    RowJsonError::Type {
        key: key.to_owned(),
        found: shortened(&value.to_string()),
        expected,
    }
}

/// The beginning of a text that may be long.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_are_refused_with_value_rule_and_next_step() {
        for (line, words) in [
            ("", "the line is no JSON object: EOF"),
            ("[1]", "the line is no JSON object: invalid type: sequence"),
            (
                "{\"time\": 1} {}",
                "the line is no JSON object: trailing characters",
            ),
            ("{\"time\": NaN}", "the line is no JSON object: "),
            (
                "{\"time\": 1e999}",
                "the line is no JSON object: number out of range",
            ),
            ("{}", "`time` is missing"),
            ("{\"time\": null}", "`time` is missing"),
            (
                "{\"time\": \"0\"}",
                "`time` is \"0\"; it must be a number or null",
            ),
            (
                "{\"time\": 0, \"object_theat\": 1}",
                "`object_theat` is no key of a row; the nearest is `object_theta`",
            ),
            ("{\"time\": 0, \"time\": 1}", "`time` is there twice"),
            (
                "{\"time\": 0, \"pusher_x\": 1}",
                "`pusher_theta` is missing and `pusher_x` is there",
            ),
            (
                "{\"time\": 0, \"tactile_1\": 0.5}",
                "`tactile_1` is 0.5; it must be 0, 1, true",
            ),
            (
                "{\"time\": 0, \"tactile_01\": 1}",
                "`tactile_01` is no key of a row; the nearest is `tactile_1`",
            ),
            (
                "{\"time\": 0, \"tactile_1001\": 1}",
                "`tactile_1001` is no key",
            ),
        ] {
            let message = read_row_json(line).expect_err(line).to_string();
            assert!(message.starts_with(words), "{message}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_a_row_or_refused(text in "\\PC*") {
            let _ = read_row_json(&text);
        }

        #[test]
        fn numbers_keep_their_bits(bits in any::<[u64; 4]>()) {
            let [time, x, y, theta] = bits.map(f64::from_bits);
            prop_assume!([time, x, y, theta].iter().all(|number| number.is_finite()));
            let line = format!("{{\"time\": {time:e}, \"object_x\": {x:e}, \"object_y\": {y}, \"object_theta\": {theta:e}}}");
            let row = read_row_json(&line).unwrap();
            let pose = row.object.unwrap();
            prop_assert_eq!([row.time, pose.x, pose.y, pose.theta].map(f64::to_bits), bits);
        }
    }
}
