//! Numbers of a scene file replaced, all else kept: [`SceneEdit`].

use stickslip_dynamics::{Part, Shape};
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::error::SceneError;
use super::{Source, read_scene, syntax};

/// Significant digits of a written number: measured values have no more.
const DIGITS: i32 = 6;

/// A scene file whose numbers can be replaced; its comments, order and layout stay.
///
/// ```
/// # use stickslip_formats::SceneEdit;
/// # let text = std::fs::read_to_string("../testkit/experiments/slide-ell-disc-110/scene.toml")?;
/// let mut edit = SceneEdit::new(&text, "scene.toml")?;
/// edit.set(&["support", "friction"], 0.312);
/// edit.set(&["uncertainty", "mu_s"], 0.1);
/// let setup = stickslip_formats::read_scene(&edit.text(), "scene.toml")?;
/// assert_eq!((setup.scene.nominal.mu_s, setup.uncertainty.friction.mu_s), (0.312, 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SceneEdit {
    document: DocumentMut,
    heading: String,
}

/// A way of keys at which a scene has no value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{way}` names no value of a scene; write a key, or a table and its key as pusher.friction"
)]
pub struct SceneWayError {
    /// The way.
    pub way: String,
}

impl SceneEdit {
    /// # Errors
    /// Those of [`read_scene`].
    pub fn new(text: &str, name: &str) -> Result<Self, SceneError> {
        read_scene(text, name)?;
        let document = text.parse().map_err(|error: toml_edit::TomlError| {
            let place = error.span().map_or(0, |span| span.start);
            syntax(Source { name, text }, place, error.message())
        })?;
        Ok(Self {
            document,
            heading: String::new(),
        })
    }

    /// Puts a comment line on top of the file.
    pub fn comment(&mut self, line: &str) {
        self.heading += &format!("# {line}\n");
    }

    /// Writes a number, rounded to six digits, at the end of a way of keys; tables that are missing
    /// are made.
    ///
    /// # Panics
    /// If the way is empty or leads through something that is no table.
    pub fn set(&mut self, way: &[&str], number: f64) {
        let (key, tables) = way.split_last().expect("a way has a key");
        let table = self.table(tables);
        let mut value = Value::from(rounded(number));
        if let Some(old) = table.get(key).and_then(Item::as_value) {
            // spaces and comments around it
            *value.decor_mut() = old.decor().clone();
        }
        table.insert(key, Item::Value(value));
    }

    /// Writes a value of any type, or removes it, at the end of a way of one or two keys, as
    /// `gravity` or `pusher.friction`. A missing table is made. A table or a list of tables gets
    /// headings. Whether the result is a scene is for [`read_scene`] to say.
    ///
    /// ```
    /// # use stickslip_formats::SceneEdit;
    /// let mut edit = SceneEdit::default();
    /// edit.put("gravity", Some(9.81.into()))?;
    /// edit.put("pusher.friction", Some(0.25.into()))?;
    /// assert_eq!(edit.text(), "gravity = 9.81\n\n[pusher]\nfriction = 0.25\n");
    /// # Ok::<(), stickslip_formats::SceneWayError>(())
    /// ```
    ///
    /// # Errors
    /// The way has more keys, an empty one, or leads through a value that is no table.
    pub fn put(&mut self, way: &str, value: Option<Value>) -> Result<(), SceneWayError> {
        let error = || SceneWayError {
            way: way.to_owned(),
        };
        let keys: Vec<&str> = way.split('.').collect();
        let (table, key) = match keys.as_slice() {
            ["", ..] | [.., ""] => return Err(error()),
            [key] => (self.document.as_table_mut() as &mut dyn TableLike, *key),
            [table, key] => {
                let root = self.document.as_table_mut();
                if value.is_none() && !root.contains_key(table) {
                    return Ok(());
                }
                let item = root.entry(table).or_insert(Item::Table(Table::new()));
                (item.as_table_like_mut().ok_or_else(error)?, *key)
            }
            _ => return Err(error()),
        };
        let Some(mut value) = value else {
            table.remove(key);
            return Ok(());
        };
        if let Some(old) = table.get(key).and_then(Item::as_value) {
            *value.decor_mut() = old.decor().clone();
        }
        let item = Item::Value(value);
        let item = match keys.len() {
            1 => match item.into_table() {
                Ok(table) => Item::Table(table),
                Err(item) => item
                    .into_array_of_tables()
                    .map_or_else(|item| item, Item::ArrayOfTables),
            },
            _ => item,
        };
        table.insert(key, item);
        Ok(())
    }

    /// Writes the outline of a body, `object` or `pusher`, one part a line; the names of its parts
    /// stay, text between them does not.
    ///
    /// # Panics
    /// If the scene has no such body.
    pub fn set_shape(&mut self, body: &str, shape: &Shape) {
        let mut parts = Array::new();
        for part in shape.parts() {
            let mut table = InlineTable::new();
            match part {
                Part::Polygon { vertices } => {
                    table.insert("polygon", points(vertices));
                }
                Part::Disc { radius, centre } => {
                    let mut disc = InlineTable::new();
                    disc.insert("radius", rounded(*radius).into());
                    disc.insert("centre", point(*centre));
                    table.insert("disc", disc.into());
                }
            }
            let mut part = Value::from(table);
            part.decor_mut().set_prefix("\n  ");
            parts.push_formatted(part);
        }
        parts.set_trailing("\n");
        parts.set_trailing_comma(true);
        self.table(&[body])
            .insert("shape", Item::Value(parts.into()));
    }

    /// Writes three feet (m) and their shares of the weight in the tripod's place.
    ///
    /// # Panics
    /// If the scene has no support.
    pub fn set_feet(&mut self, positions: [[f64; 2]; 3], loads: [f64; 3]) {
        let support = self.table(&["support"]);
        for key in ["tripod_radius", "tripod_angle"] {
            support.remove(key);
        }
        support.insert("feet", Item::Value(points(&positions)));
        // a third has no six digits that sum to 1
        let loads: Array = loads.into_iter().collect();
        support.insert("foot_loads", Item::Value(loads.into()));
    }

    /// The table at the end of a way of keys; those that are missing are made.
    fn table(&mut self, way: &[&str]) -> &mut dyn TableLike {
        let mut table: &mut dyn TableLike = self.document.as_table_mut();
        for name in way {
            let item = table.entry(name).or_insert(Item::Table(Table::new()));
            table = item
                .as_table_like_mut()
                .expect("the way leads through tables");
        }
        table
    }

    /// The file.
    #[must_use]
    pub fn text(&self) -> String {
        format!("{}{}", self.heading, self.document)
    }
}

fn point(at: [f64; 2]) -> Value {
    at.map(rounded).into_iter().collect::<Array>().into()
}

fn points(of: &[[f64; 2]]) -> Value {
    of.iter().map(|at| point(*at)).collect::<Array>().into()
}

/// A number with [`DIGITS`] significant digits.
fn rounded(number: f64) -> f64 {
    let digits = DIGITS as usize - 1;
    format!("{number:.digits$e}").parse().unwrap_or(number)
}
