//! The table of keys against all that speaks of them: the reader, the new scene, the guide.

use serde_json::Value;
use stickslip_formats::{NEW_SCENE, read_scene};
use toml::Value as Toml;

use crate::scene_schema::{Key, item_schema, keys, limits, schema};
use crate::scene_text::lines::{FEET, Line, TRIPOD, all_keys, lines};

/// The setup of a document as text, or the reader's error.
fn read(document: &Toml) -> Result<String, String> {
    let text = toml::to_string(document).unwrap();
    let setup = read_scene(&text, "scene.toml");
    setup
        .map(|setup| format!("{setup:?}"))
        .map_err(|error| error.to_string())
}

/// The new scene with all keys but those in `without`.
fn document(without: [&str; 2]) -> Toml {
    toml::from_str(&all_keys(NEW_SCENE, without)).unwrap()
}

/// The table of a document, the first one of a list of tables.
fn table<'a>(document: &'a mut Toml, name: &str) -> &'a mut toml::Table {
    let table = if name.is_empty() {
        document
    } else {
        &mut document[name]
    };
    let table = match table {
        Toml::Array(tables) => &mut tables[0],
        table => table,
    };
    table.as_table_mut().unwrap()
}

#[test]
fn new_scene_has_every_key_with_its_unit_and_default() {
    let lines = lines(NEW_SCENE);
    let keys = keys();
    for key in &keys {
        let place = format!("{}.{}", key.table, key.name);
        let head = |line: &&Line<'_>| line.table == key.name && line.key.is_empty();
        let own = |line: &&Line<'_>| line.table == key.table && line.key == key.name;
        let line = match key.is_table() {
            true => lines.iter().find(head),
            false => lines.iter().find(own),
        };
        let line = line.unwrap_or_else(|| panic!("{place} is not in the new scene"));
        if key.is_table() {
            continue;
        }
        let table_is_off = lines
            .iter()
            .any(|head| head.table == key.table && head.key.is_empty() && head.is_off);
        assert_eq!(line.is_off, !key.is_required || table_is_off, "{place}");
        if key.name != "shape" && !line.comment.starts_with("as for") {
            let words: Vec<&str> = line.comment.split([' ', ',', ';', ':', '.']).collect();
            let is_said = |unit: &String| {
                words.contains(&unit.as_str()) || line.comment.starts_with(unit.as_str())
            };
            assert!(
                key.units().iter().all(is_said),
                "{place}: {:?}",
                key.units()
            );
        }
        match key.schema.get("default") {
            Some(default) => {
                let value: toml::Table = toml::from_str(&format!("x = {}", line.value)).unwrap();
                let value = serde_json::to_value(&value["x"]).unwrap();
                assert_eq!(&value, default, "{place}");
            }
            None if key.is_required => {}
            None => assert!(line.comment.contains("Default: "), "{place}"),
        }
    }
    let known = |line: &Line<'_>| {
        let own = |key: &Key| key.table == line.table && key.name == line.key;
        line.key.is_empty() || keys.iter().any(own)
    };
    let unknown: Vec<_> = lines.iter().filter(|line| !known(line)).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn a_stated_default_is_the_one_of_a_missing_key() {
    let mut tried = 0;
    let mut base = document(FEET);
    for key in TRIPOD {
        table(&mut base, "support").remove(key);
    }
    for key in keys() {
        let Some(default) = key.schema.get("default") else {
            continue;
        };
        let default: Toml = serde_json::from_value(default.clone()).unwrap();
        let (mut with, mut without) = (base.clone(), base.clone());
        table(&mut with, &key.table).insert(key.name.clone(), default);
        table(&mut without, &key.table).remove(&key.name);
        let place = format!("{}.{}", key.table, key.name);
        assert!(read(&with) == read(&without), "{place}");
        assert!(read(&with).is_ok(), "{place}");
        tried += 1;
    }
    assert!(tried > 30, "{tried}");
}

/// Function that is called with the path of a number, its schema, and a setter of it in a document.
type Found<'a> = &'a mut dyn FnMut(&str, &Value, &dyn Fn(f64) -> Toml);

/// Every number of a schema at the place of `template` in the document that `whole` makes.
fn numbers(
    path: &str,
    schema: &Value,
    template: &Toml,
    whole: &dyn Fn(Toml) -> Toml,
    found: Found<'_>,
) {
    if let Some(kinds) = schema["anyOf"].as_array() {
        let knots = Toml::try_from([[0.0, 0.1]]).unwrap();
        numbers(path, &kinds[0], &Toml::Float(0.1), whole, found);
        numbers(path, &kinds[1], &knots, whole, found);
    } else if let Some(kinds) = schema["oneOf"].as_array() {
        for (kind, part) in kinds.iter().zip([
            "polygon = [[0, 0], [1, 0], [0, 1]]",
            "disc = { radius = 0.03, centre = [0, 0] }",
            "ellipse = { semi_axes = [0.03, 0.03], centre = [0, 0], angle = 0 }",
        ]) {
            numbers(path, kind, &toml::from_str(part).unwrap(), whole, found);
        }
    } else if let Some(properties) = schema["properties"].as_object() {
        for (key, own) in properties {
            let Some(old) = template.get(key) else {
                continue;
            };
            let whole = |value| {
                let mut table = template.clone();
                table[key] = value;
                whole(table)
            };
            numbers(&format!("{path}.{key}"), own, old, &whole, found);
        }
    } else if schema["additionalProperties"].is_object() {
        let (name, old) = template.as_table().unwrap().iter().next().unwrap();
        let whole = |value| whole(Toml::Table([(name.clone(), value)].into_iter().collect()));
        numbers(path, &schema["additionalProperties"], old, &whole, found);
    } else if let Some(items) = template.as_array() {
        let one_for_all = schema["items"].is_object();
        for (index, item) in items
            .iter()
            .enumerate()
            .take(if one_for_all { 1 } else { 9 })
        {
            let whole = |value: Toml| {
                let mut list = items.clone();
                match one_for_all {
                    true => list = filled(path, &value, items.len()),
                    false => list[index] = value,
                }
                whole(Toml::Array(list))
            };
            numbers(path, item_schema(schema, index), item, &whole, found);
        }
    } else {
        found(path, schema, &|number| whole(Toml::Float(number)));
    }
}

/// A list of `value`, or the nearest to it that can be: loads sum to 1, a polygon has an inside.
fn filled(path: &str, value: &Toml, count: usize) -> Vec<Toml> {
    let number = |value: &Toml| value.as_float().unwrap();
    if path.ends_with("foot_loads") {
        let rest = 0.5 * (1.0 - number(value));
        return [number(value), rest, rest].map(Toml::Float).into();
    }
    if let Some(x) = value.get(0).filter(|_| path.ends_with("polygon")) {
        let corners = [[0.0, 0.0], [number(x), 0.0], [0.0, number(x)]];
        return corners.map(|corner| Toml::try_from(corner).unwrap()).into();
    }
    vec![value.clone(); count]
}

#[test]
fn bounds_of_the_schema_are_the_readers() {
    let mut tried = std::collections::BTreeSet::new();
    for without in [FEET, TRIPOD] {
        let document = document(without);
        let mut try_number = |path: &str, number: &Value, with: &dyn Fn(f64) -> Toml| {
            let limits = limits(number);
            assert_eq!(limits.len(), 2, "{path}");
            for limit in limits {
                let (inside, outside) = (limit.inside(), limit.outside());
                let answer = read(&with(inside));
                assert!(answer.is_ok(), "{path} = {inside:e}: {answer:?}");
                assert!(read(&with(outside)).is_err(), "{path} = {outside:e}");
            }
            tried.insert(path.to_owned());
        };
        numbers(
            "scene",
            &schema(),
            &document,
            &|whole| whole,
            &mut try_number,
        );
    }
    let missing: Vec<String> = keys()
        .iter()
        .filter(|key| !key.is_table())
        .map(|key| format!("scene.{}.{}", key.table, key.name).replace("..", "."))
        .filter(|path| !tried.iter().any(|tried| tried.starts_with(path.as_str())))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The rows of the guide's tables of keys: the table, the key and the cells after it.
fn rows_of_the_guide() -> Vec<(&'static str, &'static str, Vec<&'static str>)> {
    let guide = include_str!("../../../../docs/guide/formats.md");
    let mut section = "";
    let mut rows = Vec::new();
    for line in guide.lines() {
        if let Some(heading) = line.strip_prefix("### ") {
            section = heading.strip_prefix("The table ").unwrap_or(heading).trim();
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if let [key, cells @ ..] = cells.as_slice()
            && let Some(key) = key.strip_prefix('`').and_then(|key| key.strip_suffix('`'))
        {
            let (table, key) = key.split_once('.').unwrap_or((section, key));
            rows.push((table, key, cells.to_vec()));
        }
    }
    rows
}

/// The range of a number in the guide's words.
fn range_words(number: &Value) -> &'static str {
    let at = |word: &str| number[word].as_f64();
    match (at("minimum"), at("maximum"), at("exclusiveMinimum")) {
        (_, _, Some(_)) => "(0, 1)",
        (Some(0.0), Some(1.0), _) => "[0, 1]",
        (Some(0.0), ..) => "≥ 0",
        (Some(least), ..) if least > 0.0 => "> 0",
        _ => "finite",
    }
}

#[test]
fn guide_has_every_key_with_its_unit_default_and_range() {
    let rows = rows_of_the_guide();
    for key in keys().iter().filter(|key| !key.is_table()) {
        let place = format!("{}.{}", key.table, key.name);
        let section = match key.table.as_str() {
            "" => "Above all tables",
            table => table,
        };
        let own = |row: &&(&str, &str, Vec<&str>)| row.0 == section && row.1 == key.name;
        let (_, _, cells) = rows.iter().find(own).unwrap_or_else(|| {
            panic!(
                "docs/guide/formats.md has no row `{}` under {section}",
                key.name
            )
        });
        let [unit, default, range, ..] = cells.as_slice() else {
            panic!("{place}: {cells:?}")
        };
        let units = key.units().join(", ").replace("^2", "²");
        assert!(units.is_empty() || *unit == units, "{place}: unit {unit}");
        let stated = default.split(';').next().unwrap();
        match key.schema.get("default") {
            Some(Value::Number(number)) => {
                let stated = stated.parse().unwrap_or(std::f64::consts::FRAC_PI_3);
                assert_eq!(number.as_f64(), Some(stated), "{place}: default {default}");
            }
            Some(list) => {
                let stated: Value = serde_json::from_str(stated).unwrap();
                assert_eq!(list, &stated, "{place}: default {default}");
            }
            None => assert_eq!(
                *default == "required",
                key.is_required,
                "{place}: {default}"
            ),
        }
        let mut number = &key.schema;
        while number["items"].is_object() {
            number = &number["items"];
        }
        if number["type"] == "number" {
            let words = range_words(number);
            assert!(range.contains(words), "{place}: range {range}, not {words}");
        }
    }
}
