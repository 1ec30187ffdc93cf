//! Curves as lines: [`Flattener`].

use crate::outline::Point;

/// Most lines of one curve.
const MOST: f64 = 1000.0;

/// Draws curves as lines, none farther from them than a tolerance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flattener {
    /// The tolerance, in the drawing's unit.
    pub tolerance: f64,
}

impl Flattener {
    /// Adds a Bézier curve of degree 2 or 3 behind its first point, which is there already. A chord
    /// of a curve c over a step h of its parameter is at most h²/8 max |c″| off.
    pub(super) fn bezier<const N: usize>(&self, points: [Point; N], to: &mut Vec<Point>) {
        let degree = (N - 1) as f64;
        let bend = |[a, b, c]: &[Point; 3]| {
            libm::hypot(a[0] - 2.0 * b[0] + c[0], a[1] - 2.0 * b[1] + c[1])
        };
        let bends = points.array_windows::<3>().map(bend);
        let most = degree * (degree - 1.0) * bends.fold(0.0, f64::max);
        let steps = self.steps((most / (8.0 * self.tolerance)).sqrt());
        for step in 1..=steps {
            let t = f64::from(step) / f64::from(steps);
            to.push(at(points, t));
        }
    }

    /// Adds an arc of an ellipse behind its first point: about `centre`, with half axes `a` and `b`
    /// at right angles, over the eccentric anomalies `from` to `to_angle` (rad).
    pub(super) fn arc(
        &self,
        (centre, a, b): (Point, Point, Point),
        [from, to_angle]: [f64; 2],
        to: &mut Vec<Point>,
    ) {
        let [a_length, b_length] = [a, b].map(|[x, y]| libm::hypot(x, y));
        let radius = if a_length > b_length {
            a_length
        } else {
            b_length
        };
        // |c″| is at most the longer half axis
        let steps = (to_angle - from).abs() * (radius / (8.0 * self.tolerance)).sqrt();
        let steps = self.steps(steps);
        for step in 1..=steps {
            let angle = from + (to_angle - from) * f64::from(step) / f64::from(steps);
            let (sin, cos) = libm::sincos(angle);
            to.push([
                centre[0] + a[0] * cos + b[0] * sin,
                centre[1] + a[1] * cos + b[1] * sin,
            ]);
        }
    }

    /// Adds an arc of a circle from the last point to another one, whose bulge is the tangent of a
    /// quarter of its angle, counter-clockwise where it is positive.
    pub(super) fn bulge(&self, end: Point, bulge: f64, to: &mut Vec<Point>) {
        let Some(start) = to.last().copied().filter(|_| bulge != 0.0) else {
            to.push(end);
            return;
        };
        let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
        // from the chord's middle to the centre, to its left
        let away = (1.0 - bulge * bulge) / (4.0 * bulge);
        let centre = [
            0.5 * (start[0] + end[0]) - away * dy,
            0.5 * (start[1] + end[1]) + away * dx,
        ];
        let a = [start[0] - centre[0], start[1] - centre[1]];
        self.arc(
            (centre, a, [-a[1], a[0]]),
            [0.0, 4.0 * libm::atan(bulge)],
            to,
        );
        if let Some(last) = to.last_mut() {
            *last = end;
        }
    }

    fn steps(&self, steps: f64) -> u32 {
        // not a number where a coordinate is none
        if steps > 1.0 {
            steps.ceil().min(MOST) as u32
        } else {
            1
        }
    }
}

/// The point of a Bézier curve (de Casteljau).
fn at<const N: usize>(mut points: [Point; N], t: f64) -> Point {
    for last in (1..N).rev() {
        for k in 0..last {
            let [p, q] = [points[k], points[k + 1]];
            points[k] = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
        }
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

    use super::*;

    const FLAT: Flattener = Flattener { tolerance: 1e-3 };

    /// Largest and smallest distance of points on the lines from the origin.
    fn distances(points: &[Point]) -> [f64; 2] {
        let middles = points
            .array_windows()
            .map(|[p, q]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
        let all = points
            .iter()
            .copied()
            .chain(middles)
            .map(|[x, y]| libm::hypot(x, y));
        all.fold([f64::MAX, 0.0], |[low, high], r| [low.min(r), high.max(r)])
    }

    #[test]
    fn arcs_are_lines_within_the_tolerance() {
        let mut points = vec![[2.0, 0.0]];
        FLAT.arc(
            ([0.0; 2], [2.0, 0.0], [0.0, 2.0]),
            [0.0, 1.5 * PI],
            &mut points,
        );
        let [low, high] = distances(&points);
        assert!(
            low > 2.0 - 1e-3 && low < 2.0 - 1e-4 && high < 2.0 + 1e-12,
            "{low} {high}"
        );
        let end = points[points.len() - 1];
        assert!(
            end[0].abs() < 1e-12 && (end[1] + 2.0).abs() < 1e-12,
            "{end:?}"
        );
    }

    /// A quarter of a circle as a cubic curve is off by 2.7e-4 of its radius itself.
    #[test]
    fn bezier_curves_are_lines_within_the_tolerance() {
        let k = 4.0 / 3.0 * (SQRT_2 - 1.0);
        let mut points = vec![[1.0, 0.0]];
        FLAT.bezier([[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]], &mut points);
        let [low, high] = distances(&points);
        assert!(
            low > 1.0 - 1e-3 && high < 1.0 + 3e-4 && points.len() > 4,
            "{low} {high}"
        );
        // x = t, y = t²
        let mut points = vec![[0.0, 0.0]];
        FLAT.bezier([[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]], &mut points);
        for [p, q] in points.array_windows() {
            assert!((q[1] - q[0] * q[0]).abs() < 1e-12);
            let (x, y) = (0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]));
            assert!(y - x * x < 1e-3);
        }
    }

    #[test]
    fn a_bulge_is_an_arc() {
        for (bulge, side) in [(1.0, -1.0), (-1.0, 1.0)] {
            let mut points = vec![[-1.0, 0.0]];
            FLAT.bulge([1.0, 0.0], bulge, &mut points);
            let [low, high] = distances(&points);
            assert!(low > 1.0 - 1e-3 && high < 1.0 + 1e-12, "{low} {high}");
            let middle = points[points.len() / 2];
            assert!(middle[1] * side > 0.9, "{middle:?}");
        }
        // a quarter of a circle about (1, 0), clockwise
        let mut points = vec![[0.0, 0.0]];
        FLAT.bulge([1.0, 1.0], -libm::tan(FRAC_PI_2 / 4.0), &mut points);
        for [x, y] in points {
            assert!((libm::hypot(x - 1.0, y) - 1.0).abs() < 1e-12);
        }
    }
}
