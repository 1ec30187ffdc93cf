//! A straight edge between dark and bright, fitted to pixels: [`Edge`].
//!
//! A pixel at distance d outside the edge and s along it has the level
//!
//! ```text
//! dark + (bright + fade s - dark) Φ(d / blur)
//! ```
//!
//! with Φ the normal distribution function. That is a step seen through lens, defocus, the pixel's
//! own area and motion, in light that changes along it. Its six numbers (offset, turn, dark,
//! bright, blur, fade) are fitted to all pixels in a band by least squares. Pixels have independent
//! noise, so that the residuals give the covariance.

use nalgebra::{Matrix2, RowVector2, SMatrix, SVector, Vector2};

use crate::levenberg_marquardt::{LeastSquares, Minimum, Rules, Step, minimise};

/// Numbers of an edge.
const NUMBERS: usize = 6;
/// Fewest pixels that an edge is fitted to.
const FEWEST: usize = 4 * NUMBERS;
/// A fit ends where its step moves the edge by less than this (px).
const NEGLIGIBLE: f64 = 1e-5;
const RULES: Rules = Rules {
    damping: 1e-3,
    most_damping: f64::INFINITY,
    least_decrease: 0.0,
    iterations: 30,
};
/// Half width of the band that is fitted, as a share of a cell, and at least (px).
pub(crate) const WIDEST_BAND: f64 = 0.6;
pub(crate) const LEAST_BAND: f64 = 2.0;
/// Distance between the band and other edges, in units of the blur.
const CLEAR: f64 = 2.5;
/// Blur at first (px).
const FIRST_BLUR: f64 = 0.8;
/// Least blur: that of a pixel's own area is 0.29 (px).
const LEAST_BLUR: f64 = 0.2;

/// A pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Place (px).
    pub(crate) at: Vector2<f64>,
    /// Grey level.
    pub(crate) level: f64,
}

/// A straight edge: the points p with n · (p - middle) = offset + turn · (t · (p - middle)), for
/// unit vectors t along it and n outwards.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edge {
    middle: Vector2<f64>,
    along: Vector2<f64>,
    offset: f64,
    turn: f64,
    blur: f64,
    /// Covariance of (offset, turn).
    pub(crate) covariance: Matrix2<f64>,
}

/// Grey levels across an edge.
#[derive(Clone, Copy, Debug)]
struct Profile {
    dark: f64,
    bright: f64,
    blur: f64,
    fade: f64,
}

/// An edge and its profile, to be fitted to samples.
struct EdgeFit<'a> {
    edge: Edge,
    profile: Profile,
    samples: &'a [Sample],
    /// Half the length of the band (px).
    half_length: f64,
}

/// Normal equations at one guess.
pub(crate) struct Equations {
    matrix: SMatrix<f64, NUMBERS, NUMBERS>,
    gradient: SVector<f64, NUMBERS>,
    squares: f64,
}

impl Edge {
    /// Fits an edge to the samples near a rough one, which runs from corner to corner with its dark
    /// side on the left in the image. Pixels more than `cell` (px) from it or beyond its ends
    /// belong to other cells of the tag. `None` where there is no such edge.
    pub(crate) fn fit(samples: &[Sample], rough: [Vector2<f64>; 2], cell: f64) -> Option<Self> {
        let side = rough[1] - rough[0];
        let edge = Self {
            middle: (rough[0] + rough[1]) / 2.0,
            along: side / side.norm(),
            blur: FIRST_BLUR,
            ..Self::default()
        };
        // a second fit, in the band that is free of other edges by the first one's blur
        let first = edge.fit_in_band(samples, side.norm() / 2.0, cell)?;
        let found = first.fit_in_band(samples, side.norm() / 2.0, cell)?;
        (found.offset.abs() <= cell && found.turn.abs() < 0.2).then_some(found)
    }

    /// The edge's line as a row: (a, b) with a · p = b.
    pub(crate) fn row(&self) -> (Vector2<f64>, f64) {
        let normal = self.outward() - self.along * self.turn;
        (normal, self.offset + normal.dot(&self.middle))
    }

    /// Change of the right-hand side of [`row`](Self::row) with (offset, turn) at a point of the
    /// edge.
    pub(crate) fn shift_at(&self, point: Vector2<f64>) -> RowVector2<f64> {
        RowVector2::new(1.0, self.along.dot(&(point - self.middle)))
    }

    /// Unit vector to the right of `along` (y pointing down). Corners go round anti-clockwise as
    /// printed, so this is the outside.
    fn outward(&self) -> Vector2<f64> {
        Vector2::new(-self.along.y, self.along.x)
    }

    /// Position along the edge and distance outside it (px).
    fn coordinates(&self, at: Vector2<f64>) -> [f64; 2] {
        let from = at - self.middle;
        let along = self.along.dot(&from);
        [
            along,
            self.outward().dot(&from) - self.offset - self.turn * along,
        ]
    }

    fn fit_in_band(&self, samples: &[Sample], half_length: f64, cell: f64) -> Option<Self> {
        let band = (cell - CLEAR * self.blur)
            .clamp(LEAST_BAND, WIDEST_BAND * cell.max(LEAST_BAND / WIDEST_BAND));
        let half_length = half_length - band.max(CLEAR * self.blur);
        let inside = |sample: &&Sample| {
            let [along, outside] = self.coordinates(sample.at);
            along.abs() <= half_length && outside.abs() <= band
        };
        let chosen: Vec<Sample> = samples.iter().filter(inside).copied().collect();
        if chosen.len() < FEWEST {
            return None;
        }
        let start = EdgeFit {
            edge: *self,
            profile: self.first_profile(&chosen, band)?,
            samples: &chosen,
            half_length,
        };
        let Minimum {
            at: EdgeFit { edge, profile, .. },
            equations,
            converged,
        } = minimise(start, &RULES)?;
        let found = converged && profile.bright > profile.dark && profile.blur < cell;
        let inverse = equations.matrix.try_inverse().filter(|_| found)?;
        let variance = equations.squares / (chosen.len() - NUMBERS) as f64;
        Some(Self {
            covariance: inverse.fixed_view::<2, 2>(0, 0) * variance,
            blur: profile.blur,
            ..edge
        })
    }

    /// Levels far from the edge on either side; `None` where one side has no pixels.
    fn first_profile(&self, samples: &[Sample], band: f64) -> Option<Profile> {
        let mean = |side: f64| {
            let far = samples
                .iter()
                .filter(|sample| self.coordinates(sample.at)[1] * side > band / 2.0);
            let (sum, count) = far.fold((0.0, 0), |(sum, count), sample| {
                (sum + sample.level, count + 1)
            });
            (count > 0).then(|| sum / f64::from(count))
        };
        Some(Profile {
            dark: mean(-1.0)?,
            bright: mean(1.0)?,
            blur: self.blur,
            fade: 0.0,
        })
    }

    fn moved(&self, by: &SVector<f64, NUMBERS>) -> Self {
        Self {
            offset: self.offset + by[0],
            turn: self.turn + by[1],
            ..*self
        }
    }
}

impl LeastSquares for EdgeFit<'_> {
    type Equations = Equations;

    fn equations(&self) -> Option<Equations> {
        let Profile {
            dark,
            bright,
            blur,
            fade,
        } = self.profile;
        let mut sum = Equations {
            matrix: SMatrix::zeros(),
            gradient: SVector::zeros(),
            squares: 0.0,
        };
        for sample in self.samples {
            let [along, outside] = self.edge.coordinates(sample.at);
            let (share, density) = normal(outside / blur);
            let height = bright + fade * along - dark;
            let slope = height * density / blur;
            let residual = sample.level - dark - height * share;
            let row = SVector::from([
                -slope,
                -slope * along,
                1.0 - share,
                share,
                -slope * outside / blur,
                share * along,
            ]);
            sum.matrix += row * row.transpose();
            sum.gradient += row * residual;
            sum.squares += residual * residual;
        }
        Some(sum)
    }

    fn squares(equations: &Equations) -> f64 {
        equations.squares
    }

    fn step(&self, equations: &Equations, damping: f64) -> Option<Step<Self>> {
        let Equations {
            matrix, gradient, ..
        } = equations;
        let diagonal =
            SMatrix::<f64, NUMBERS, NUMBERS>::from_diagonal(&(matrix.diagonal() * damping));
        let by = (matrix + diagonal).cholesky()?.solve(gradient);
        if by[0].abs() + by[1].abs() * self.half_length < NEGLIGIBLE {
            return Some(Step::Negligible);
        }
        Some(Step::To(Self {
            edge: self.edge.moved(&by),
            profile: self.profile.moved(&by),
            ..*self
        }))
    }
}

impl Profile {
    fn moved(&self, by: &SVector<f64, NUMBERS>) -> Self {
        let blur = (self.blur + by[4]).max(LEAST_BLUR);
        Self {
            dark: self.dark + by[2],
            bright: self.bright + by[3],
            blur,
            fade: self.fade + by[5],
        }
    }
}

/// Distribution function and density of the standard normal distribution.
fn normal(z: f64) -> (f64, f64) {
    use std::f64::consts::{FRAC_1_SQRT_2, PI};
    (
        0.5 * (1.0 + libm::erf(z * FRAC_1_SQRT_2)),
        libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt(),
    )
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    const CORNERS: [Vector2<f64>; 2] = [Vector2::new(10.0, 20.0), Vector2::new(58.0, 26.0)];
    const CELL: f64 = 6.0;

    /// Pixels about the corners' line, moved outwards by `offset` and turned by `turn`, seen with a
    /// blur, fading light and noise.
    fn samples(offset: f64, turn: f64, blur: f64, noise: f64, draw: u64) -> Vec<Sample> {
        let side = CORNERS[1] - CORNERS[0];
        let edge = Edge {
            middle: (CORNERS[0] + CORNERS[1]) / 2.0,
            along: side.normalize(),
            offset,
            turn,
            ..Edge::default()
        };
        let pixel = |index: u32| {
            let at = Vector2::new(f64::from(index % 70), f64::from(index / 70));
            let [along, outside] = edge.coordinates(at);
            let level = 30.0 + (150.0 + 0.2 * along) * normal(outside / blur).0;
            Sample {
                at,
                level: level + noise * Streams::new(3).normal(draw, index, 0),
            }
        };
        (0..70 * 48).map(pixel).collect()
    }

    #[test]
    fn fit_of_an_exact_edge_is_exact() {
        for (offset, turn, blur) in [(0.0, 0.0, 0.6), (0.8, -0.02, 0.9), (-0.5, 0.01, 1.6)] {
            let edge = Edge::fit(&samples(offset, turn, blur, 0.0, 0), CORNERS, CELL).unwrap();
            assert!(
                (edge.offset - offset).abs() < 1e-5 && (edge.turn - turn).abs() < 1e-6,
                "{edge:?}"
            );
            assert!((edge.blur - blur).abs() < 1e-3, "{edge:?}");
        }
    }

    /// Squared errors in units of the predicted covariance have mean 2, those of the offset and of
    /// the turn mean 0.
    #[test]
    fn fit_has_the_covariance_of_its_errors() {
        const DRAWS: u64 = 400;
        let (mut whitened, mut mean) = (0.0, Vector2::zeros());
        for draw in 0..DRAWS {
            let edge = Edge::fit(&samples(0.3, 0.01, 0.8, 2.0, draw), CORNERS, CELL).unwrap();
            let error = Vector2::new(edge.offset - 0.3, edge.turn - 0.01);
            whitened += (error.transpose() * edge.covariance.try_inverse().unwrap() * error).x
                / DRAWS as f64;
            let std = Vector2::new(
                edge.covariance[(0, 0)].sqrt(),
                edge.covariance[(1, 1)].sqrt(),
            );
            mean += error.component_div(&std) / DRAWS as f64;
        }
        // five standard errors
        assert!(
            (whitened - 2.0).abs() < 5.0 * (4.0 / DRAWS as f64).sqrt(),
            "{whitened}"
        );
        assert!(mean.amax() < 5.0 / (DRAWS as f64).sqrt(), "{mean}");
    }

    #[test]
    fn fit_of_no_edge_is_none() {
        let flat: Vec<Sample> = samples(0.0, 0.0, 0.8, 0.0, 0)
            .iter()
            .map(|s| Sample { level: 80.0, ..*s })
            .collect();
        assert!(Edge::fit(&flat, CORNERS, CELL).is_none());
        let inverted: Vec<Sample> = samples(0.0, 0.0, 0.8, 0.0, 0)
            .iter()
            .map(|s| Sample {
                level: 255.0 - s.level,
                ..*s
            })
            .collect();
        assert!(Edge::fit(&inverted, CORNERS, CELL).is_none());
        assert!(Edge::fit(&[], CORNERS, CELL).is_none());
    }
}
