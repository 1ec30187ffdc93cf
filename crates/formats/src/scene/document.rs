//! A TOML document whose every value has its place in the text: [`Source`], [`Table`], [`Node`].
//!
//! A derived reader would lose the place of a number in nested lists, and could not name the
//! quantity that is missing.

use std::ops::Range;

use stickslip::{Rule, Unit};
use stickslip_dynamics::Pose;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{SceneError, SceneProblem};
use super::keys::{Key, instead_of, key, names_of, nearest_key};

type Result<T> = std::result::Result<T, SceneError>;

/// The text of a scene file with its name.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) name: &'a str,
    pub(super) text: &'a str,
}

/// A table of the format.
pub(super) struct Table<'a> {
    source: Source<'a>,
    /// Its name in the format, as `fixel`.
    name: &'static str,
    /// The way to it in the file, as `fixel[1]`.
    path: String,
    span: Range<usize>,
    entries: &'a DeTable<'a>,
}

/// A value, or a part of one, with its key and the way to it.
pub(super) struct Node<'a> {
    source: Source<'a>,
    key: &'static Key,
    path: String,
    value: &'a Spanned<DeValue<'a>>,
}

impl Source<'_> {
    /// The line that a byte is on, without blanks around it.
    pub(super) fn line_at(&self, byte: usize) -> &str {
        let before = self.text.get(..byte).unwrap_or(self.text);
        self.text
            .lines()
            .nth(before.matches('\n').count())
            .unwrap_or("")
            .trim()
    }

    /// An error at a byte of the text.
    pub(super) fn error(&self, byte: usize, problem: SceneProblem) -> SceneError {
        let end = (0..=byte.min(self.text.len()))
            .rev()
            .find(|end| self.text.is_char_boundary(*end))
            .unwrap_or(0);
        let before = &self.text[..end];
        let line = 1 + before.matches('\n').count();
        let column = 1 + before
            .rsplit('\n')
            .next()
            .unwrap_or("")
            .chars()
            .filter(|c| *c != '\u{feff}')
            .count();
        SceneError {
            file: self.name.to_owned(),
            line,
            column,
            problem: Box::new(problem),
        }
    }
}

impl<'a> Table<'a> {
    /// The whole document.
    pub(super) fn root(source: Source<'a>, document: &'a Spanned<DeTable<'a>>) -> Result<Self> {
        let table = Self {
            source,
            name: "",
            path: String::new(),
            span: 0..0,
            entries: document.get_ref(),
        };
        table.check_keys()?;
        Ok(table)
    }

    /// The value of a key, if it is there.
    pub(super) fn optional(&self, name: &str) -> Option<Node<'a>> {
        let key = key(self.name, name);
        let value = self.entries.get(name)?;
        Some(Node {
            source: self.source,
            key,
            path: self.path_to(name),
            value,
        })
    }

    /// The value of a key that must be there.
    pub(super) fn required(&self, name: &str) -> Result<Node<'a>> {
        self.optional(name).ok_or_else(|| {
            let problem = SceneProblem::Missing {
                key: self.path_to(name),
                what: key(self.name, name).order(),
            };
            self.source.error(self.span.start, problem)
        })
    }

    /// A table that must be there.
    pub(super) fn section(&self, name: &str) -> Result<Table<'a>> {
        self.required(name)?.table()
    }

    /// A table, if it is there.
    pub(super) fn section_if(&self, name: &str) -> Result<Option<Table<'a>>> {
        self.optional(name).map(|node| node.table()).transpose()
    }

    /// A number that must be there.
    pub(super) fn number(&self, name: &str) -> Result<f64> {
        self.required(name)?.number()
    }

    /// A number, or the default where it is not there.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64> {
        self.optional(name)
            .map_or(Ok(default), |node| node.number())
    }

    /// The first key, in the order of the file, that is not known is an error.
    fn check_keys(&self) -> Result<()> {
        let known = names_of(self.name);
        let unknown = self
            .entries
            .iter()
            .filter(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        let Some((key, _)) = unknown.min_by_key(|(key, _)| key.span().start) else {
            return Ok(());
        };
        let path = self.path_to(key.get_ref());
        let problem = match instead_of(&path) {
            Some(instead) => SceneProblem::RemovedKey { key: path, instead },
            None => SceneProblem::UnknownKey {
                nearest: nearest_key(key.get_ref(), self.name),
                key: path,
            },
        };
        Err(self.source.error(key.span().start, problem))
    }

    fn path_to(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }
}

impl<'a> Node<'a> {
    /// The way to the value.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// The value as it stands in the file.
    pub(super) fn text(&self) -> &'a str {
        self.source.text.get(self.value.span()).unwrap_or("")
    }

    /// An error at this value.
    pub(super) fn error(&self, problem: SceneProblem) -> SceneError {
        self.source.error(self.value.span().start, problem)
    }

    /// The value as the table of the format that its key names.
    pub(super) fn table(&self) -> Result<Table<'a>> {
        self.table_of(self.key.name)
    }

    /// The value as a table of the format.
    pub(super) fn table_of(&self, name: &'static str) -> Result<Table<'a>> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            return Err(self.wrong_type("a table"));
        };
        let table = Table {
            source: self.source,
            name,
            path: self.path.clone(),
            span: self.value.span(),
            entries,
        };
        table.check_keys()?;
        Ok(table)
    }

    /// The entries of a table whose keys are free.
    pub(super) fn entries(&self) -> Result<Vec<(String, Node<'a>)>> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            return Err(self.wrong_type("a table"));
        };
        let node =
            |name: &Spanned<std::borrow::Cow<'a, str>>, value: &'a Spanned<DeValue<'a>>| Node {
                source: self.source,
                key: self.key,
                path: format!("{}.{}", self.path, name.get_ref()),
                value,
            };
        let named = entries
            .iter()
            .map(|(name, value)| (name.get_ref().to_string(), node(name, value)));
        Ok(named.collect())
    }

    /// Returns true if it is a list.
    pub(super) fn is_list(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Array(_))
    }

    /// The list is empty and must not be.
    pub(super) fn empty(&self) -> SceneError {
        self.wrong("an empty list".to_owned(), "a list with entries")
    }

    /// The items of a list.
    pub(super) fn items(&self) -> Result<Vec<Node<'a>>> {
        let DeValue::Array(items) = self.value.get_ref() else {
            return Err(self.wrong_type("a list"));
        };
        let node = |(index, value)| Node {
            source: self.source,
            key: self.key,
            path: format!("{}[{}]", self.path, index + 1),
            value,
        };
        Ok(items.iter().enumerate().map(node).collect())
    }

    /// A list of exactly N items.
    pub(super) fn exactly<const N: usize>(&self) -> Result<[Node<'a>; N]> {
        let items = self.items()?;
        let count = items.len();
        items
            .try_into()
            .map_err(|_| self.wrong(format!("a list of {count}"), &format!("a list of {N}")))
    }

    /// A list of two numbers under the key's rule.
    pub(super) fn pair(&self) -> Result<[f64; 2]> {
        let [first, second] = self.exactly::<2>()?;
        Ok([first.number()?, second.number()?])
    }

    /// A list of x, y (m) and theta (rad).
    pub(super) fn pose(&self) -> Result<Pose> {
        let [x, y, theta] = self.exactly::<3>()?;
        let metres = |node: &Self| node.number_in(Unit::Metre, Rule::Finite);
        let theta = theta.number_in(Unit::Radian, Rule::Finite);
        Ok(Pose::new(metres(&x)?, metres(&y)?, theta?))
    }

    /// A number, whole numbers included, under the key's rule.
    pub(super) fn number(&self) -> Result<f64> {
        self.number_in(self.key.unit, self.key.rule)
    }

    /// A number under a rule.
    pub(super) fn number_in(&self, unit: Unit, rule: Rule) -> Result<f64> {
        let value = self.float().ok_or_else(|| self.wrong_type("a number"))?;
        match rule.broken_by(value, unit) {
            None => Ok(value),
            Some(rule) => Err(self.out_of_range_in(&rule, unit)),
        }
    }

    /// The value is against a rule, put in words.
    pub(super) fn out_of_range(&self, rule: &str) -> SceneError {
        self.out_of_range_in(rule, self.key.unit)
    }

    /// An error about a value in a unit that is not the key's.
    pub(super) fn out_of_range_in(&self, rule: &str, unit: Unit) -> SceneError {
        let found = format!("{} {}", self.text(), unit.symbol())
            .trim_end()
            .to_owned();
        self.error(SceneProblem::OutOfRange {
            key: self.path.clone(),
            found,
            rule: rule.to_owned(),
            what: self.key.order(),
        })
    }

    fn float(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .ok()
                .map(|value| value as f64),
            _ => None,
        }
    }

    fn wrong_type(&self, expected: &str) -> SceneError {
        self.wrong(self.kind(), expected)
    }

    fn wrong(&self, found: String, expected: &str) -> SceneError {
        self.error(SceneProblem::WrongType {
            key: self.path.clone(),
            found,
            expected: expected.to_owned(),
            what: self.key.order(),
        })
    }

    /// The value in words: as it stands where that is short, else its type.
    fn kind(&self) -> String {
        match self.value.get_ref() {
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
            DeValue::Integer(_) if self.float().is_none() => {
                format!("the number {}, which is too large", self.text())
            }
            DeValue::String(_) => format!("the text {}", self.text()),
            DeValue::Integer(_)
            | DeValue::Boolean(_)
            | DeValue::Float(_)
            | DeValue::Datetime(_) => self.text().to_owned(),
        }
    }
}
