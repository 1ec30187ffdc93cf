//! The JSON schema of scenes: its keys, its ranges, and the values that do not match it.

use serde_json::Value;
use stickslip_formats::scene_schema;

/// A bound of a number.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    pub at: f64,
    pub is_upper: bool,
    pub is_included: bool,
}

/// A key of a table of the format.
#[derive(Debug)]
pub struct Key {
    pub table: String,
    pub name: String,
    pub schema: Value,
    pub is_required: bool,
}

impl Limit {
    /// The nearest number outside.
    pub fn outside(self) -> f64 {
        match (self.is_included, self.is_upper) {
            (false, _) => self.at,
            (true, true) => self.at.next_up(),
            (true, false) => self.at.next_down(),
        }
    }

    /// The outermost number inside.
    pub fn inside(self) -> f64 {
        match (self.is_included, self.is_upper) {
            (true, _) => self.at,
            (false, true) => self.at.next_down(),
            (false, false) => self.at.next_up(),
        }
    }

    fn excludes(self, number: f64) -> bool {
        match self.is_upper {
            true => number > self.inside(),
            false => number < self.inside(),
        }
    }
}

/// The bounds in the schema of a number.
pub fn limits(number: &Value) -> Vec<Limit> {
    let of = [
        ("minimum", false, true),
        ("exclusiveMinimum", false, false),
        ("maximum", true, true),
        ("exclusiveMaximum", true, false),
    ];
    let limit = |(word, is_upper, is_included): (&str, bool, bool)| {
        number[word].as_f64().map(|at| Limit {
            at,
            is_upper,
            is_included,
        })
    };
    of.into_iter().filter_map(limit).collect()
}

impl Key {
    /// Its units, as its description names them.
    pub fn units(&self) -> Vec<String> {
        let words = self.schema["description"].as_str().unwrap();
        let units = words.split_once("Unit: ").map_or("", |(_, rest)| rest);
        let units = units.split_once('.').map_or("", |(units, _)| units);
        units
            .split(", ")
            .filter(|unit| !unit.is_empty())
            .map(str::to_owned)
            .collect()
    }

    /// True if it names a table.
    pub fn is_table(&self) -> bool {
        self.schema["properties"].is_object() || self.schema["items"]["properties"].is_object()
    }
}

pub fn schema() -> Value {
    serde_json::from_str(&scene_schema()).unwrap()
}

/// All keys but those of a shape's parts.
pub fn keys() -> Vec<Key> {
    fn add(keys: &mut Vec<Key>, table: &str, schema: &Value) {
        let required = schema["required"].as_array().unwrap();
        for (name, own) in schema["properties"].as_object().unwrap() {
            let key = Key {
                table: table.to_owned(),
                name: name.clone(),
                schema: own.clone(),
                is_required: required.iter().any(|required| required == name),
            };
            let is_list = own["items"]["properties"].is_object();
            if key.is_table() {
                add(keys, name, if is_list { &own["items"] } else { own });
            }
            keys.push(key);
        }
    }
    let mut keys = Vec::new();
    add(&mut keys, "", &schema());
    keys
}

/// Reason why a value does not match a schema of the few words that ours is written in.
pub fn mismatch(schema: &Value, value: &Value, path: &str) -> Option<String> {
    if let Some(kinds) = schema["oneOf"].as_array().or(schema["anyOf"].as_array()) {
        let fits = kinds
            .iter()
            .filter(|kind| mismatch(kind, value, path).is_none());
        return (fits.count() != 1).then(|| format!("{path} is not one of its kinds"));
    }
    let kind = &schema["type"];
    match kind.as_str().or(kind[0].as_str()).unwrap() {
        // `inf`
        "number" if kind.is_array() && value.is_null() => None,
        "number" => match value.as_f64() {
            None => Some(format!("{path} is no number")),
            Some(number) => {
                let beyond = limits(schema).iter().any(|limit| limit.excludes(number));
                beyond.then(|| format!("{path} is {number}"))
            }
        },
        "array" => {
            let Some(items) = value.as_array() else {
                return Some(format!("{path} is no array"));
            };
            let within = |key: &str, of: fn(u64, u64) -> bool| {
                schema[key]
                    .as_u64()
                    .is_none_or(|limit| of(items.len() as u64, limit))
            };
            if !within("minItems", |n, least| n >= least)
                || !within("maxItems", |n, most| n <= most)
            {
                return Some(format!("{path} has {} items", items.len()));
            }
            items
                .iter()
                .enumerate()
                .find_map(|(index, item)| mismatch(item_schema(schema, index), item, path))
        }
        _ => {
            let Some(entries) = value.as_object() else {
                return Some(format!("{path} is no table"));
            };
            let required = schema["required"].as_array().into_iter().flatten();
            for key in required.map(|key| key.as_str().unwrap()) {
                if !entries.contains_key(key) {
                    return Some(format!("{path}.{key} is missing"));
                }
            }
            entries.iter().find_map(|(key, value)| {
                let of_key = schema["properties"].get(key);
                let others =
                    Some(&schema["additionalProperties"]).filter(|others| others.is_object());
                match of_key.or(others) {
                    Some(schema) => mismatch(schema, value, &format!("{path}.{key}")),
                    None => Some(format!("{path}.{key} is no key")),
                }
            })
        }
    }
}

/// The schema of an item of a list: one for all, or one for each.
pub fn item_schema(list: &Value, index: usize) -> &Value {
    let items = &list["items"];
    items.as_array().map_or(items, |items| &items[index])
}
