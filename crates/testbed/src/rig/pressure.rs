//! Distribution of the object's weight over the table: [`PressureDistribution`], [`SupportPoint`].

use stickslip_dynamics::{Part, Shape};

use super::random_field::RandomField;
use super::random_stream::RandomStream;
use crate::trial::TrialError;

/// A point of the object that stands on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPoint {
    /// Position in the object frame (m).
    pub position: [f64; 2],
    /// Its share of the weight; all shares sum to 1.
    pub load: f64,
}

/// Points at which the object bears on the table, each with its share of the weight.
#[derive(Clone, Debug, PartialEq)]
pub enum PressureDistribution {
    /// Its whole face: points spread evenly over the shape, loaded unevenly, with the resultant at
    /// the centre of mass.
    Face {
        /// Number of points.
        points: usize,
        /// Standard deviation of the logarithm of the pressure; 0 is uniform pressure, as far as
        /// statics allows.
        unevenness: f64,
    },
    /// These points.
    Points(Vec<SupportPoint>),
}

impl Default for PressureDistribution {
    fn default() -> Self {
        Self::Face {
            points: 256,
            unevenness: 0.4,
        }
    }
}

impl PressureDistribution {
    /// The points of an object of this shape.
    pub(super) fn points(&self, shape: &Shape, seed: u64) -> Result<Vec<SupportPoint>, TrialError> {
        match self {
            Self::Points(points) => Ok(points.clone()),
            Self::Face { points, unevenness } => {
                let positions = spread(shape, *points, seed);
                let loads = uneven(&positions, *unevenness, shape.bounding_radius(), seed);
                balanced(positions, loads)
            }
        }
    }
}

/// `count` points spread evenly over a shape: those of a Kronecker sequence with a random beginning
/// (Roberts 2018) that are inside.
fn spread(shape: &Shape, count: usize, seed: u64) -> Vec<[f64; 2]> {
    /// 1/g and 1/g², g³ = g + 1.
    const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
    let (radius, draw) = (shape.bounding_radius(), RandomStream::Points.draw(seed));
    let first = [draw.uniform(0, 0), draw.uniform(0, 1)];
    let coordinate = |k: usize, axis: usize| {
        let share = first[axis] + k as f64 * STEP[axis];
        radius * (2.0 * (share - share.floor()) - 1.0)
    };
    let all = (1..).map(|k| [coordinate(k, 0), coordinate(k, 1)]);
    all.filter(|point| shape.parts().iter().any(|part| contains(part, *point)))
        .take(count)
        .collect()
}

fn contains(part: &Part, [x, y]: [f64; 2]) -> bool {
    match part {
        Part::Polygon { vertices } => {
            let next = vertices.iter().cycle().skip(1);
            vertices
                .iter()
                .zip(next)
                .all(|([ax, ay], [bx, by])| (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0)
        }
        Part::Disc { radius, centre } => {
            let (u, v) = ((x - centre[0]) / radius, (y - centre[1]) / radius);
            u * u + v * v <= 1.0
        }
    }
}

/// Loads that vary over the face and from point to point, in equal parts of the variance.
fn uneven(positions: &[[f64; 2]], unevenness: f64, wavelength: f64, seed: u64) -> Vec<f64> {
    let field = RandomField::new(wavelength, RandomStream::Pressure.draw(seed));
    let roughness = RandomStream::Roughness.draw(seed);
    let share = unevenness * 0.5f64.sqrt();
    let load = |(k, point): (usize, &[f64; 2])| {
        libm::exp(share * (field.at(*point) + roughness.normal(k as u32, 0)))
    };
    positions.iter().enumerate().map(load).collect()
}

/// Tilts the loads, load ← load exp(a·x), until their resultant lies in the centre of mass, and
/// scales them to sum 1.
///
/// This a minimises the convex function ln Σ load exp(a·x), and Newton's method with step halving
/// finds it. Lengths are scaled by the largest coordinate.
fn balanced(positions: Vec<[f64; 2]>, loads: Vec<f64>) -> Result<Vec<SupportPoint>, TrialError> {
    let size = positions
        .iter()
        .flatten()
        .fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
    let points: Vec<([f64; 2], f64)> = positions
        .iter()
        .map(|p| p.map(|x| x / size))
        .zip(loads)
        .collect();
    let mut tilt = [0.0; 2];
    for _ in 0..100 {
        let [total, x, y, xx, xy, yy] = moments(&points, tilt);
        let (x, y) = (x / total, y / total);
        if x.abs().max(y.abs()) < 1e-13 {
            let load =
                |(p, w): &([f64; 2], f64)| w * libm::exp(tilt[0] * p[0] + tilt[1] * p[1]) / total;
            let loads = points.iter().map(load);
            return Ok(positions
                .iter()
                .zip(loads)
                .map(|(position, load)| SupportPoint {
                    position: *position,
                    load,
                })
                .collect());
        }
        // Newton step: the Hessian is the covariance of the points under their loads
        let (a, b, c) = (xx / total - x * x, xy / total - x * y, yy / total - y * y);
        let det = a * c - b * b;
        let step = [(b * y - c * x) / det, (b * x - a * y) / det];

        // halved until the function does not grow
        let value = libm::log(total);
        let at = |s: f64| [tilt[0] + s * step[0], tilt[1] + s * step[1]];
        let lower = |s: &f64| libm::log(moments(&points, at(*s))[0]) <= value + 1e-15;
        let Some(s) = (0..40).map(|k| libm::ldexp(1.0, -k)).find(lower) else {
            return Err(TrialError::Tips);
        };
        tilt = at(s);
    }
    Err(TrialError::Tips)
}

/// Σ w, Σ w x, Σ w y, Σ w x², Σ w x y, Σ w y² with w = load exp(tilt·x).
fn moments(points: &[([f64; 2], f64)], tilt: [f64; 2]) -> [f64; 6] {
    points.iter().fold([0.0; 6], |m, ([x, y], load)| {
        let w = load * libm::exp(tilt[0] * x + tilt[1] * y);
        [
            m[0] + w,
            m[1] + w * x,
            m[2] + w * y,
            m[3] + w * x * x,
            m[4] + w * x * y,
            m[5] + w * y * y,
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(parts: Vec<Part>) -> Shape {
        Shape::new(parts).expect("a shape")
    }

    fn square(corner: [f64; 2]) -> Part {
        let [x, y] = corner;
        Part::Polygon {
            vertices: vec![[x, y], [x + 0.05, y], [x + 0.05, y + 0.05], [x, y + 0.05]],
        }
    }

    fn resultant(points: &[SupportPoint]) -> [f64; 3] {
        let moment = |axis: usize| {
            points
                .iter()
                .map(|p| p.load * p.position[axis])
                .fold(0.0, |sum, m| sum + m)
        };
        [
            points.iter().map(|p| p.load).fold(0.0, |sum, w| sum + w),
            moment(0),
            moment(1),
        ]
    }

    #[test]
    fn face_carries_the_weight_in_the_centre_of_mass() {
        let ell = vec![
            Part::Polygon {
                vertices: vec![
                    [-0.0236, -0.0236],
                    [0.0364, -0.0236],
                    [0.0364, 0.0014],
                    [-0.0236, 0.0014],
                ],
            },
            Part::Polygon {
                vertices: vec![
                    [-0.0236, 0.0014],
                    [0.0014, 0.0014],
                    [0.0014, 0.0364],
                    [-0.0236, 0.0364],
                ],
            },
        ];
        // the second one has its centre of mass well off the middle of its face
        for parts in [ell, vec![square([-0.01, -0.04])]] {
            for seed in 0..10 {
                let points = PressureDistribution::default()
                    .points(&shape(parts.clone()), seed)
                    .expect("points");
                assert!(points.len() == 256 && points.iter().all(|p| p.load > 0.0));
                assert!(
                    points
                        .iter()
                        .all(|p| parts.iter().any(|part| contains(part, p.position)))
                );
                let [weight, x, y] = resultant(&points);
                assert!(
                    (weight - 1.0).abs() < 1e-12 && x.abs() < 1e-12 && y.abs() < 1e-12,
                    "{weight} {x} {y}"
                );
            }
        }
    }

    #[test]
    fn face_is_uneven_and_differs_by_seed() {
        let load = |seed: u64| {
            PressureDistribution::default()
                .points(&shape(vec![square([-0.025, -0.025])]), seed)
                .expect("points")
        };
        let loads: Vec<f64> = load(3).iter().map(|p| p.load * 256.0).collect();
        let variance = loads
            .iter()
            .map(|w| (w - 1.0) * (w - 1.0))
            .fold(0.0, |sum, v| sum + v)
            / 256.0;
        assert!((0.1..0.4).contains(&variance), "{variance}");
        assert_ne!(load(3), load(4));
    }

    #[test]
    fn even_pressure_on_a_disc_has_the_mean_radius_of_a_disc() {
        let disc = shape(vec![Part::Disc {
            radius: 0.03,
            centre: [0.0; 2],
        }]);
        let points = PressureDistribution::Face {
            points: 2000,
            unevenness: 0.0,
        }
        .points(&disc, 1)
        .expect("points");
        let mean = points
            .iter()
            .map(|p| p.load * p.position[0].hypot(p.position[1]))
            .fold(0.0, |sum, r| sum + r);
        assert!((mean / 0.02 - 1.0).abs() < 2e-3, "{mean}");
    }

    #[test]
    fn ellipses_are_filled_in_their_own_axes() {
        let ellipse = shape(vec![Part::ellipse([0.04, 0.01], [0.0; 2], 0.5)]);
        let points = PressureDistribution::Face {
            points: 2000,
            unevenness: 0.0,
        }
        .points(&ellipse, 1)
        .expect("points");
        let (sin, cos) = libm::sincos(0.5);
        let second = |pick: fn([f64; 2], f64, f64) -> f64| {
            points
                .iter()
                .map(|p| p.load * pick(p.position, sin, cos) * pick(p.position, sin, cos))
                .fold(0.0, |sum, m| sum + m)
        };
        // second moments of a uniform ellipse: a²/4, b²/4
        assert!((second(|[x, y], s, c| c * x + s * y) / 4e-4 - 1.0).abs() < 0.01);
        assert!((second(|[x, y], s, c| c * y - s * x) / 2.5e-5 - 1.0).abs() < 0.01);
    }

    #[test]
    fn object_that_would_tip_is_refused() {
        let off = shape(vec![square([0.001, 0.0])]);
        assert_eq!(
            PressureDistribution::default().points(&off, 0),
            Err(TrialError::Tips)
        );
    }
}
