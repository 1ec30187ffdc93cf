//! Numbers that are possible on a table top: [`Rule`], within the limits of a [`Unit`].
//!
//! Nothing on a table top is a billion metres wide or weighs a microgram. Numbers like these are
//! slips. With them arithmetic overflows or a step never ends.

use std::f64::consts::TAU;
use std::fmt;
use std::ops::Bound::{self, Excluded, Included};

/// Unit of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A plain number.
    None,
    /// m
    Metre,
    /// rad
    Radian,
    /// s
    Second,
    /// m/s
    MetrePerSecond,
    /// m/s²
    MetrePerSecond2,
    /// kg
    Kilogram,
    /// kg m²
    KilogramMetre2,
    /// N
    Newton,
}

/// Rule that a number must obey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Any number.
    Finite,
    /// Above 0.
    Positive,
    /// Above 0, infinity included.
    PositiveOrInfinite,
    /// From 0 up.
    NotNegative,
    /// In (0, 1).
    Probability,
    /// In [0, 1].
    Share,
    /// An angle in [-2π, 2π]; a larger one is in degrees.
    Turn,
}

impl Unit {
    /// Its symbol; empty for a plain number.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Metre => "m",
            Self::Radian => "rad",
            Self::Second => "s",
            Self::MetrePerSecond => "m/s",
            Self::MetrePerSecond2 => "m/s^2",
            Self::Kilogram => "kg",
            Self::KilogramMetre2 => "kg m^2",
            Self::Newton => "N",
        }
    }

    /// Smallest positive and largest plausible number. Slips by one or two factors of 1000 are
    /// within these limits, because `diagnosis` names them.
    const fn limits(self) -> [f64; 2] {
        match self {
            Self::None => [1e-6, 1e6],
            Self::Metre => [1e-9, 1e6],
            Self::Radian => [1e-9, 1e6],
            Self::Second => [1e-9, 1e4],
            Self::MetrePerSecond => [1e-9, 1e5],
            Self::MetrePerSecond2 => [1e-3, 1e5],
            Self::Kilogram => [1e-6, 1e6],
            Self::KilogramMetre2 => [1e-12, 1e9],
            Self::Newton => [1e-9, 1e9],
        }
    }
}

impl Unit {
    /// Returns the smallest positive number that is plausible.
    pub(crate) const fn least(self) -> f64 {
        self.limits()[0]
    }

    /// Returns true if a coordinate in this unit is plausible.
    pub(crate) fn holds(self, coordinate: f64) -> bool {
        coordinate.abs() <= self.limits()[1]
    }
}

impl Rule {
    /// Returns the rule that `value` breaks, in words; `None` if it breaks none.
    ///
    /// ```
    /// use stickslip::{Rule, Unit};
    /// assert_eq!(Rule::Positive.broken_by(0.5, Unit::Kilogram), None);
    /// assert_eq!(Rule::Positive.broken_by(1e30, Unit::Kilogram).unwrap(), "at most 1e6 kg, as on any table top");
    /// ```
    pub fn broken_by(self, value: f64, unit: Unit) -> Option<String> {
        if value == f64::INFINITY && self == Self::PositiveOrInfinite {
            return None;
        }
        if !value.is_finite() || !self.holds(value) {
            let rule = if value.is_finite() || self == Self::PositiveOrInfinite {
                self
            } else {
                Self::Finite
            };
            return Some(rule.words().to_owned());
        }
        let [least, most] = unit.limits();
        let limit = |bound: &str, limit: f64| {
            Some(
                format!("{bound} {limit:e} {}", unit.symbol())
                    .trim_end()
                    .to_owned()
                    + ", as on any table top",
            )
        };
        match value.abs() {
            size if size > most => limit("at most", most),
            size if size > 0.0 && size < least && self.forbids_tiny() => limit("at least", least),
            _ => None,
        }
    }

    /// Smallest and largest number that it allows in `unit`, without infinity. [`Rule::broken_by`]
    /// also refuses some sizes between 0 and the smallest one of the unit.
    ///
    /// ```
    /// use std::ops::Bound::Included;
    /// use stickslip::{Rule, Unit};
    /// assert_eq!(Rule::Positive.range(Unit::Kilogram), (Included(1e-6), Included(1e6)));
    /// ```
    pub const fn range(self, unit: Unit) -> (Bound<f64>, Bound<f64>) {
        let [least, most] = unit.limits();
        match self {
            Self::Finite => (Included(-most), Included(most)),
            Self::Positive | Self::PositiveOrInfinite => (Included(least), Included(most)),
            Self::NotNegative => (Included(0.0), Included(most)),
            Self::Probability => (Excluded(0.0), Excluded(1.0)),
            Self::Share => (Included(0.0), Included(1.0)),
            Self::Turn => (Included(-TAU), Included(TAU)),
        }
    }

    fn holds(self, value: f64) -> bool {
        match self {
            Self::Finite => true,
            Self::Positive | Self::PositiveOrInfinite => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Probability => value > 0.0 && value < 1.0,
            Self::Share => (0.0..=1.0).contains(&value),
            Self::Turn => value.abs() <= TAU,
        }
    }

    /// Returns true if numbers near 0 are refused. A coordinate or a share may be as near to 0 as
    /// it likes; a size may not.
    fn forbids_tiny(self) -> bool {
        !matches!(
            self,
            Self::Finite | Self::Share | Self::Probability | Self::Turn
        )
    }

    fn words(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Positive => "positive",
            Self::PositiveOrInfinite => "positive, or inf for a rigid drive",
            Self::NotNegative => "zero or positive",
            Self::Probability => "between 0 and 1, both excluded",
            Self::Share => "from 0 to 1",
            Self::Turn => "an angle in radians, from -2 pi to 2 pi; multiply degrees by pi / 180",
        }
    }
}

/// An impossible number in a setup.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupError {
    /// Path to it from the setup, as `scene.object.mass`.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its unit.
    pub unit: Unit,
    /// Rule that it must obey.
    pub rule: String,
}

impl std::error::Error for SetupError {}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            unit,
            rule,
        } = self;
        let found = format!("{value:?} {}", unit.symbol());
        write!(f, "{name} is {}; it must be {rule}", found.trim_end())
    }
}
