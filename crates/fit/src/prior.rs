//! Prior of a parameter before any push: [`Prior`].

use serde::{Deserialize, Serialize};

/// Distribution of a parameter before any push. A whitened coordinate z is standard normal under
/// it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Prior {
    /// ln x is normal: positive numbers that are known to some per cent.
    LogNormal {
        /// Median, in the parameter's unit.
        median: f64,
        /// Standard deviation of ln x.
        relative_std: f64,
    },
    /// x is normal.
    Normal {
        /// Mean, in the parameter's unit.
        mean: f64,
        /// Standard deviation, in the parameter's unit.
        std: f64,
    },
}

impl Prior {
    /// The parameter at the whitened coordinate `z`.
    #[must_use]
    pub fn value(&self, z: f64) -> f64 {
        match *self {
            Self::LogNormal {
                median,
                relative_std,
            } => median * libm::exp(relative_std * z),
            Self::Normal { mean, std } => mean + std * z,
        }
    }

    /// The whitened coordinate of a value.
    #[must_use]
    pub fn coordinate(&self, value: f64) -> f64 {
        match *self {
            Self::LogNormal {
                median,
                relative_std,
            } => libm::log(value / median) / relative_std,
            Self::Normal { mean, std } => (value - mean) / std,
        }
    }

    /// Its centre and the number that says how wide it is.
    pub(crate) fn guess(&self) -> (f64, f64) {
        match *self {
            Self::LogNormal {
                median,
                relative_std,
            } => (median, relative_std),
            Self::Normal { mean, std } => (mean, std),
        }
    }

    /// Returns true if it leaves anything open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        match *self {
            Self::LogNormal {
                median,
                relative_std,
            } => median > 0.0 && relative_std > 0.0,
            Self::Normal { std, .. } => std > 0.0,
        }
    }

    /// Standard deviation at `value` for a standard deviation `z_std` of the whitened coordinate,
    /// to first order, in the parameter's unit.
    #[must_use]
    pub fn spread(&self, value: f64, z_std: f64) -> f64 {
        match *self {
            Self::LogNormal { relative_std, .. } => value * relative_std * z_std,
            Self::Normal { std, .. } => std * z_std,
        }
    }
}
