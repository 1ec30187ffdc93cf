//! Help for writing `scene.toml`: the schema, the scene to begin with, values that may be left out.

use crate::scene_text::{FULL, replaced};
use serde_json::Value;
use stickslip_formats::{NEW_SCENE, SceneProblem, read_scene, scene_assumptions, scene_schema};

/// Reason why a value does not match a schema of the few words that ours is written in.
fn mismatch(schema: &Value, value: &Value, path: &str) -> Option<String> {
    if let Some(kinds) = schema["oneOf"].as_array().or(schema["anyOf"].as_array()) {
        let fits = kinds
            .iter()
            .filter(|kind| mismatch(kind, value, path).is_none());
        return (fits.count() != 1).then(|| format!("{path} is not one of its kinds"));
    }
    match schema["type"].as_str().unwrap() {
        "number" => (!value.is_number()).then(|| format!("{path} is no number")),
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
                .find_map(|item| mismatch(&schema["items"], item, path))
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

fn by_schema(text: &str) -> Option<String> {
    let schema = serde_json::from_str(&scene_schema()).unwrap();
    let document: toml::Table = toml::from_str(text).unwrap();
    mismatch(&schema, &serde_json::to_value(document).unwrap(), "scene")
}

/// The lines of a scene without the `#` that switches a key off.
fn all_keys(text: &str) -> String {
    let lines = text.lines().map(|line| {
        let key = line.strip_prefix("# ").filter(|rest| {
            let name = rest.split(" = ").next().unwrap();
            rest.starts_with('[')
                || (rest.contains(" = ") && name.chars().all(|c| c.is_lowercase() || c == '_'))
        });
        key.filter(|key| !key.starts_with("feet")).unwrap_or(line)
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn schema_takes_what_the_reader_takes() {
    for text in [FULL, NEW_SCENE, &all_keys(NEW_SCENE)] {
        read_scene(text, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(by_schema(text), None);
    }
    assert!(
        all_keys(NEW_SCENE).contains("\ninertia") && all_keys(NEW_SCENE).contains("\n[[fixel]]")
    );
}

#[test]
fn schema_and_reader_refuse_the_same() {
    let broken = [
        ("mass = 0.50", "mass = \"0.5 kg\""),
        ("mass = 0.50", "mas = 0.50"),
        ("mass = 0.50", ""),
        ("friction = 0.25", ""),
        ("position = [0.10, 0.018]", "position = [0.10, 0.018, 0.0]"),
        (
            "{ disc = { radius = 0.005 } }",
            "{ disc = { radios = 0.005 } }",
        ),
        ("mu_s = [0.06, 0.9]", "mu_s = 0.9"),
        ("object = [0.01, -0.02, 0.5]", "object = [0.01, -0.02]"),
        (
            "speed = [[0, 0], [0.5, 0.02], [8, 0.02], [8, 0]]",
            "speed = [[0, 0, 0]]",
        ),
    ];
    for (from, to) in broken {
        let text = replaced(FULL, from, to);
        assert!(
            read_scene(&text, "scene.toml").is_err() && by_schema(&text).is_some(),
            "{to}"
        );
    }
}

/// Every value of the full scene and of the new one, replaced by one of a wrong kind: a key of the
/// schema whose kind is not the reader's would show.
#[test]
fn kinds_of_the_schema_are_the_readers() {
    let mut tried = 0;
    for text in [FULL.to_owned(), all_keys(NEW_SCENE)] {
        for (number, line) in text.lines().enumerate() {
            let Some((key, value)) = line
                .split_once(" = ")
                .filter(|_| !line.starts_with(['#', ' ', '[']))
            else {
                continue;
            };
            if value.trim_end().ends_with('[') {
                continue;
            }
            for wrong in ["true", "{ x = 1 }", "[[[1]]]"] {
                let line = format!("{key} = {wrong}");
                let lines = text
                    .lines()
                    .enumerate()
                    .map(|(index, old)| if index == number { &line } else { old });
                let broken = lines.collect::<Vec<_>>().join("\n");
                assert!(read_scene(&broken, "scene.toml").is_err(), "{line}");
                assert!(by_schema(&broken).is_some(), "{line}");
                tried += 1;
            }
        }
    }
    assert!(tried > 150, "{tried}");
}

#[test]
fn inertia_and_tripod_follow_from_the_outline_and_it_is_said() {
    let scene = read_scene(NEW_SCENE, "scene.toml").unwrap().scene;
    // a square of edge a: a² / 6, and a (sqrt 2 + asinh 1) / 6
    assert!((scene.object.inertia - 0.5 * 0.05 * 0.05 / 6.0).abs() < 1e-9);
    assert!((scene.nominal.d_tri - 0.05 * 0.382_597_86).abs() < 1e-7);
    let told = scene_assumptions(NEW_SCENE, "scene.toml").unwrap();
    assert_eq!(told.len(), 2);
    assert!(
        told[0].contains("2.083e-4 kg m^2") && told[1].contains("0.0191 m"),
        "{told:?}"
    );
    assert!(scene_assumptions(FULL, "scene.toml").unwrap().is_empty());
}

#[test]
fn outline_off_the_centre_of_mass_needs_its_inertia() {
    let text = NEW_SCENE.replace(
        "[[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]]",
        "[[0, 0], [0.05, 0], [0.05, 0.05], [0, 0.05]]",
    );
    let error = read_scene(&text, "scene.toml").unwrap_err();
    assert!(matches!(*error.problem, SceneProblem::OffCentre { .. }));
    let told = error.to_string();
    assert!(
        told.contains("`object.inertia` is missing") && told.contains("(0.0250, 0.0250) m"),
        "{told}"
    );
}
