//! A number of the scene file: its key, meaning, unit and range: [`Quantity`].

use stickslip::{Rule, Unit};

/// A key that holds a number: its name, its meaning, its unit and its rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    pub(super) key: &'static str,
    pub(super) what: &'static str,
    pub(super) unit: Unit,
    pub(super) rule: Rule,
}

impl Quantity {
    pub(super) const fn new(key: &'static str, what: &'static str, unit: Unit, rule: Rule) -> Self {
        Self {
            key,
            what,
            unit,
            rule,
        }
    }

    /// The value to give, with the unit.
    pub(super) fn order(&self) -> String {
        match self.unit {
            Unit::None => self.what.to_owned(),
            unit => format!("{} in {}", self.what, unit.symbol()),
        }
    }
}
