//! Friction of the table: [`TableFriction`], how it varies over the table and with speed.

use super::random_field::RandomField;
use super::random_stream::RandomStream;

/// Variation of the table's friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableFriction {
    /// Standard deviation over the table, as a share of μ_s.
    pub unevenness: f64,
    /// Wavelength of the shortest variations of friction over the table (m); the longest are three
    /// times as long.
    pub wavelength: f64,
    /// Share of μ_s by which friction at high speed is above that at `speed`, and friction at rest
    /// below it; negative where sliding is easier than starting.
    pub speed_effect: f64,
    /// Speed at which friction is μ_s (m/s).
    pub speed: f64,
}

impl Default for TableFriction {
    fn default() -> Self {
        Self {
            unevenness: 0.05,
            wavelength: 0.05,
            speed_effect: -0.04,
            speed: 0.01,
        }
    }
}

/// Friction at every place of one table.
#[derive(Clone, Debug)]
pub(super) struct FrictionField {
    law: TableFriction,
    mu_s: f64,
    deviation: RandomField,
}

impl TableFriction {
    /// A table of mean friction `mu_s`.
    pub(super) fn field(&self, mu_s: f64, seed: u64) -> FrictionField {
        FrictionField {
            law: *self,
            mu_s,
            deviation: RandomField::new(self.wavelength, RandomStream::Table.draw(seed)),
        }
    }
}

impl FrictionField {
    /// The mean friction coefficient.
    pub(super) fn mean(&self) -> f64 {
        self.mu_s
    }

    /// The factor on friction at a slip speed whose square (m²/s²) is given: 1 + e (s² − s₀²) / (s²
    /// + s₀²).
    #[inline(always)]
    pub(super) fn speed_factor(&self, slip_squared: f64) -> f64 {
        let TableFriction {
            speed_effect,
            speed,
            ..
        } = self.law;
        1.0 + speed_effect * (slip_squared - speed * speed) / (slip_squared + speed * speed)
    }

    /// Friction coefficient at a point of the table (m) and at the table's reference speed.
    pub(super) fn at(&self, point: [f64; 2]) -> f64 {
        // one point in a hundred deviates more than that
        let deviation = self.deviation.at(point).clamp(-2.5, 2.5);
        (self.mu_s * (1.0 + self.law.unevenness * deviation)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_is_the_mean_at_the_reference_speed_and_bounded_at_all_others() {
        let field = TableFriction {
            speed_effect: -0.1,
            speed: 0.02,
            ..TableFriction::default()
        }
        .field(0.3, 1);
        assert_eq!(
            [0.0, 4e-4].map(|square| field.speed_factor(square)),
            [1.1, 1.0]
        );
        assert!((field.speed_factor(1e6) - 0.9).abs() < 1e-5);
    }

    #[test]
    fn friction_varies_over_the_table_by_its_unevenness() {
        let deviations: Vec<f64> = (0..20)
            .flat_map(|seed| {
                let field = TableFriction::default().field(0.3, seed);
                (0..50).map(move |k| field.at([0.026 * f64::from(k), 0.0]) / 0.3 - 1.0)
            })
            .collect();
        let variance =
            deviations.iter().map(|d| d * d).fold(0.0, |sum, d| sum + d) / deviations.len() as f64;
        assert!(
            (variance.sqrt() / 0.05 - 1.0).abs() < 0.15,
            "{}",
            variance.sqrt()
        );
        assert_eq!(
            TableFriction {
                unevenness: 0.0,
                ..TableFriction::default()
            }
            .field(0.3, 0)
            .at([0.1, 0.2]),
            0.3
        );
    }
}
