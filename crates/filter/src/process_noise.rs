//! The process noise of a constant-velocity axis by maximum likelihood.

use crate::ConstantVelocity;
use crate::innovations::log_likelihoods;
use crate::series::{Series, SeriesError};

/// The process noise that makes a series of measurements most probable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoiseFit {
    /// q \[unit²/s³\].
    pub process_noise: f64,
    /// ln p(measurements after the first | the first, q).
    pub log_likelihood: f64,
    /// Where q lies in the range searched.
    pub optimum: Optimum,
}

/// Where an optimum was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Optimum {
    /// Inside the range.
    Interior,
    /// At the lower end: the series moves at constant velocity as far as its noise tells.
    LowerEnd,
    /// At the upper end: the measurement noise is negligible beside the motion.
    UpperEnd,
}

impl ConstantVelocity {
    /// The process noise of greatest likelihood; this model's own is not used.
    ///
    /// The search is over ln q within nine decades either side of measurement_std²/h³ (h the median
    /// step), where a step's process noise equals the measurement's: a grid of decades, then
    /// Brent's method about its best point. The result depends on the arguments alone.
    ///
    /// # Errors
    /// If the model or the series is out of range or has fewer than 3 measurements.
    pub fn fit_process_noise(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<ProcessNoiseFit, SeriesError> {
        ConstantVelocity {
            process_noise: 0.0,
            ..*self
        }
        .check()?;
        let series = Series::new(times, measurements)?;
        let found = series.measured();
        if found < 3 {
            return Err(SeriesError::TooFew {
                measurements: found,
            });
        }
        let centre = libm::log(self.measurement_std * self.measurement_std)
            - 3.0 * libm::log(series.median_step());
        Ok(Search { axis: self, series }.around(centre))
    }
}

/// A value of the objective.
#[derive(Clone, Copy)]
struct Point {
    log_q: f64,
    value: f64,
}

/// Powers of ten that are tried either side of the centre.
const REACH: usize = 9;

/// The search for the best process noise of a series.
struct Search<'a> {
    axis: &'a ConstantVelocity,
    series: Series<'a>,
}

impl Search<'_> {
    fn around(&self, centre: f64) -> ProcessNoiseFit {
        let decade = |i: usize| centre + (i as f64 - REACH as f64) * std::f64::consts::LN_10;
        let grid: [Point; 2 * REACH + 1] = self.at(std::array::from_fn(decade));
        let highest = (1..grid.len()).fold(0, |best, i| {
            if grid[i].value > grid[best].value {
                i
            } else {
                best
            }
        });
        let (peak, optimum) = match highest {
            0 => (grid[0], Optimum::LowerEnd),
            i if i + 1 == grid.len() => (grid[i], Optimum::UpperEnd),
            i => (
                maximum([grid[i - 1], grid[i], grid[i + 1]], |log_q| {
                    self.at([log_q])[0]
                }),
                Optimum::Interior,
            ),
        };
        ProcessNoiseFit {
            process_noise: libm::exp(peak.log_q),
            log_likelihood: peak.value,
            optimum,
        }
    }

    fn at<const W: usize>(&self, log_q: [f64; W]) -> [Point; W] {
        let values = log_likelihoods(self.axis, log_q.map(libm::exp), &self.series);
        std::array::from_fn(|k| Point {
            log_q: log_q[k],
            value: values[k],
        })
    }
}

/// The maximum of a function with one peak between the outer two of three points, of which the
/// middle one is highest, to 1e-6: parabolas through the best three points so far, golden section
/// where they do not help (Brent 1973, chapter 5).
fn maximum([left, middle, right]: [Point; 3], at: impl Fn(f64) -> Point) -> Point {
    const TOLERANCE: f64 = 5e-7;
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let (mut low, mut high) = (left.log_q, right.log_q);
    let (mut best, mut second, mut third) = if left.value > right.value {
        (middle, left, right)
    } else {
        (middle, right, left)
    };
    let (mut step, mut step_before) = (high - low, high - low);
    while f64::max(best.log_q - low, high - best.log_q) > 2.0 * TOLERANCE {
        let parabolic = to_vertex(best, second, third);
        let useful = parabolic.abs() < 0.5 * step_before.abs()
            && low < best.log_q + parabolic
            && best.log_q + parabolic < high;
        let rest = if best.log_q - low > high - best.log_q {
            low - best.log_q
        } else {
            high - best.log_q
        };
        (step_before, step) = if useful {
            (step, parabolic)
        } else {
            (rest, GOLDEN * rest)
        };
        // points nearer to each other than this tell nothing
        let apart = step.signum() * step.abs().max(TOLERANCE);
        let inside = low < best.log_q + apart && best.log_q + apart < high;
        let new = at(best.log_q + if inside { apart } else { -apart });
        let (worse, better) = if new.value > best.value {
            (best, new)
        } else {
            (new, best)
        };
        *(if worse.log_q < better.log_q {
            &mut low
        } else {
            &mut high
        }) = worse.log_q;
        best = better;
        if worse.value >= second.value {
            (third, second) = (second, worse);
        } else if worse.value >= third.value {
            third = worse;
        }
    }
    best
}

/// From `a` to the vertex of the parabola through three points; not finite where they are on a
/// line.
fn to_vertex(a: Point, b: Point, c: Point) -> f64 {
    let (to_b, to_c) = (b.log_q - a.log_q, c.log_q - a.log_q);
    let (rise_b, rise_c) = ((b.value - a.value) * to_c, (c.value - a.value) * to_b);
    0.5 * (rise_b * to_c - rise_c * to_b) / (rise_b - rise_c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maximum_is_found_of_smooth_and_of_pointed_functions() {
        let functions: [&dyn Fn(f64) -> f64; 4] = [
            &|x| -(x - 0.3) * (x - 0.3),
            &|x| -(x + 0.7).abs(),
            &|x| (x + 2.0) * libm::exp(-2.0 * x),
            &|x| -libm::exp(-3.0 * x) - x,
        ];
        for (f, exact) in functions
            .into_iter()
            .zip([0.3, -0.7, -1.5, libm::log(3.0) / 3.0])
        {
            let at = |log_q: f64| Point {
                log_q,
                value: f(log_q),
            };
            let found = maximum([-2.0, exact + 0.2, 1.5].map(at), at);
            assert!(
                (found.log_q - exact).abs() < 1e-6,
                "{} instead of {exact}",
                found.log_q
            );
        }
    }
}
