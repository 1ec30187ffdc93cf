//! A number of the scene file: its key, meaning, unit and range: [`Quantity`].

/// What a number must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    Finite,
    Positive,
    /// Positive, infinity included.
    PositiveOrInfinite,
    NotNegative,
    /// In (0, 1).
    Probability,
    /// In [0, 1].
    Share,
}

/// A key that holds a number: its name, what it means, its unit (empty for none) and its rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    pub(super) key: &'static str,
    pub(super) what: &'static str,
    pub(super) unit: &'static str,
    pub(super) rule: Rule,
}

impl Rule {
    /// What `value` must be and is not, in words; `None` where it may be as it is.
    pub(super) fn broken_by(self, value: f64) -> Option<&'static str> {
        if !value.is_finite() && self != Self::PositiveOrInfinite {
            return Some(Self::Finite.words());
        }
        (!self.holds(value)).then(|| self.words())
    }

    fn holds(self, value: f64) -> bool {
        match self {
            Self::Finite => true,
            Self::Positive | Self::PositiveOrInfinite => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Probability => value > 0.0 && value < 1.0,
            Self::Share => (0.0..=1.0).contains(&value),
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Positive => "positive",
            Self::PositiveOrInfinite => "positive, or inf for a rigid drive",
            Self::NotNegative => "zero or positive",
            Self::Probability => "between 0 and 1, both excluded",
            Self::Share => "from 0 to 1",
        }
    }
}

impl Quantity {
    pub(super) const fn new(
        key: &'static str,
        what: &'static str,
        unit: &'static str,
        rule: Rule,
    ) -> Self {
        Self {
            key,
            what,
            unit,
            rule,
        }
    }

    /// What to give, with the unit.
    pub(super) fn order(&self) -> String {
        if self.unit.is_empty() {
            self.what.to_owned()
        } else {
            format!("{} in {}", self.what, self.unit)
        }
    }
}
