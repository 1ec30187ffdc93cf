//! A TOML document whose every value has its place in the text: [`Source`], [`Table`], [`Node`].
//!
//! A derived reader would lose the place of a number in nested lists, and could not name the
//! quantity that is missing.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{SceneError, SceneProblem};
use super::keys::{keys_of, nearest_key};
use super::quantity::Quantity;

type Result<T> = std::result::Result<T, SceneError>;

/// The text of a scene file with its name.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) name: &'a str,
    pub(super) text: &'a str,
}

/// A table with the keys it may have.
pub(super) struct Table<'a> {
    source: Source<'a>,
    path: String,
    span: Range<usize>,
    entries: &'a DeTable<'a>,
}

/// A value with the way to it.
pub(super) struct Node<'a> {
    source: Source<'a>,
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
            path: String::new(),
            span: 0..0,
            entries: document.get_ref(),
        };
        table.check_keys(keys_of(""))?;
        Ok(table)
    }

    /// The value of a key, if it is there.
    pub(super) fn optional(&self, key: &str) -> Option<Node<'a>> {
        let value = self.entries.get(key)?;
        Some(Node {
            source: self.source,
            path: self.path_to(key),
            value,
        })
    }

    /// The value of a key that must be there; `what` completes "Give ...".
    pub(super) fn required(&self, key: &str, what: &str) -> Result<Node<'a>> {
        self.optional(key).ok_or_else(|| {
            let problem = SceneProblem::Missing {
                key: self.path_to(key),
                what: what.to_owned(),
            };
            self.source.error(self.span.start, problem)
        })
    }

    /// A table of the format that must be there.
    pub(super) fn section(&self, key: &str) -> Result<Table<'a>> {
        let what = format!(
            "the table [{key}] with keys among {}",
            keys_of(key).join(", ")
        );
        self.required(key, &what)?.table(keys_of(key), &what)
    }

    /// A table of the format, if it is there.
    pub(super) fn section_if(&self, key: &str) -> Result<Option<Table<'a>>> {
        self.optional(key)
            .map(|node| node.table(keys_of(key), &format!("it as the table [{key}]")))
            .transpose()
    }

    /// A number that must be there.
    pub(super) fn number(&self, quantity: &Quantity) -> Result<f64> {
        self.required(quantity.key, &quantity.order())?
            .number(quantity)
    }

    /// A number, if it is there.
    pub(super) fn number_if(&self, quantity: &Quantity) -> Result<Option<f64>> {
        self.optional(quantity.key)
            .map(|node| node.number(quantity))
            .transpose()
    }

    /// A number, or the default where it is not there.
    pub(super) fn number_or(&self, quantity: &Quantity, default: f64) -> Result<f64> {
        Ok(self.number_if(quantity)?.unwrap_or(default))
    }

    /// The first key, in the order of the file, that is not known is an error.
    fn check_keys(&self, known: &[&str]) -> Result<()> {
        let unknown = self
            .entries
            .iter()
            .filter(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        let Some((key, _)) = unknown.min_by_key(|(key, _)| key.span().start) else {
            return Ok(());
        };
        let nearest = nearest_key(key.get_ref(), known);
        let problem = SceneProblem::UnknownKey {
            key: self.path_to(key.get_ref()),
            nearest,
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

    /// The value as a table that has no other keys than `known`; `what` completes "Give ...".
    pub(super) fn table(&self, known: &[&str], what: &str) -> Result<Table<'a>> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            return Err(self.wrong_type("a table", what));
        };
        let table = Table {
            source: self.source,
            path: self.path.clone(),
            span: self.value.span(),
            entries,
        };
        table.check_keys(known)?;
        Ok(table)
    }

    /// The entries of a table whose keys are free; `what` completes "Give ...".
    pub(super) fn entries(&self, what: &str) -> Result<Vec<(String, Node<'a>)>> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            return Err(self.wrong_type("a table", what));
        };
        let node =
            |key: &Spanned<std::borrow::Cow<'a, str>>, value: &'a Spanned<DeValue<'a>>| Node {
                source: self.source,
                path: format!("{}.{}", self.path, key.get_ref()),
                value,
            };
        let named = entries
            .iter()
            .map(|(key, value)| (key.get_ref().to_string(), node(key, value)));
        Ok(named.collect())
    }

    /// Returns true if it is a list.
    pub(super) fn is_list(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Array(_))
    }

    /// The list is empty and must not be; `what` completes "Give ...".
    pub(super) fn empty(&self, what: &str) -> SceneError {
        self.wrong("an empty list".to_owned(), "a list with entries", what)
    }

    /// The items of a list; `what` completes "Give ...".
    pub(super) fn items(&self, what: &str) -> Result<Vec<Node<'a>>> {
        let DeValue::Array(items) = self.value.get_ref() else {
            return Err(self.wrong_type("a list", what));
        };
        let node = |(index, value)| Node {
            source: self.source,
            path: format!("{}[{}]", self.path, index + 1),
            value,
        };
        Ok(items.iter().enumerate().map(node).collect())
    }

    /// A list of exactly N items.
    pub(super) fn exactly<const N: usize>(&self, what: &str) -> Result<[Node<'a>; N]> {
        let items = self.items(what)?;
        let count = items.len();
        items.try_into().map_err(|_| {
            self.wrong(
                format!("a list of {count}"),
                &format!("a list of {N}"),
                what,
            )
        })
    }

    /// A list of two numbers under one rule.
    pub(super) fn pair(&self, quantity: &Quantity) -> Result<[f64; 2]> {
        let [first, second] = self.exactly::<2>(&quantity.order())?;
        Ok([first.number(quantity)?, second.number(quantity)?])
    }

    /// A number, whole numbers included, under the quantity's rule.
    pub(super) fn number(&self, quantity: &Quantity) -> Result<f64> {
        let value = self
            .float()
            .ok_or_else(|| self.wrong_type("a number", &quantity.order()))?;
        match quantity.rule.broken_by(value, quantity.unit) {
            None => Ok(value),
            Some(rule) => Err(self.out_of_range(&rule, quantity)),
        }
    }

    /// The value is against a rule, put in words.
    pub(super) fn out_of_range(&self, rule: &str, quantity: &Quantity) -> SceneError {
        let found = format!("{} {}", self.text(), quantity.unit.symbol())
            .trim_end()
            .to_owned();
        self.error(SceneProblem::OutOfRange {
            key: self.path.clone(),
            found,
            rule: rule.to_owned(),
            what: quantity.order(),
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

    fn wrong_type(&self, expected: &str, what: &str) -> SceneError {
        self.wrong(self.kind(), expected, what)
    }

    fn wrong(&self, found: String, expected: &str, what: &str) -> SceneError {
        self.error(SceneProblem::WrongType {
            key: self.path.clone(),
            found,
            expected: expected.to_owned(),
            what: what.to_owned(),
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
