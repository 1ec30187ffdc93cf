//! Largest separation of two smooth convex features over the direction: [`Separation`].
//!
//! g(n) = n·d − h₁(n) − h₂(n) − r for unit n, d from the centre of one feature to that of the
//! other, h the support functions of the ellipses among them and r the sum of the radii of the
//! round vertices. Apart, the only local maximum with g > 0 is their distance; in overlap, the
//! largest local maximum is minus the least penetration. n points from the first feature to the
//! second. Scaled to any length, g is concave, which is why a positive local maximum is the only
//! one.

use crate::geometry::ellipse::Ellipse;
use crate::geometry::normal_cone::NormalCone;
use crate::geometry::vec2::{Vec2, add, cross, dot, left, scale, unit};

/// Newton steps with bisection as its guard; twice what bisection alone needs from a quarter turn.
const STEPS: u32 = 100;

/// Slack of a cone's borders (rad).
const ANGLE: f64 = 1e-9;

/// Cosine and sine of 0.1 rad, the stride in which a bracket is sought uphill.
const STRIDE: Vec2 = [0.995_004_165_278_025_8, 0.099_833_416_646_828_15];

/// g(n) of one pair of features.
pub(crate) struct Separation<'a> {
    /// From the first centre to the second one (m).
    pub d: Vec2,
    pub ellipses: [Option<&'a Ellipse>; 2],
    /// Sum of the radii of the round vertices (m).
    pub radius: f64,
}

/// A local maximum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peak {
    pub normal: Vec2,
    pub gap: f64,
}

impl Separation<'_> {
    /// The largest local maximum in the cone, of the first feature's normals; `None` where g only
    /// falls from the cone's borders.
    pub fn widest(&self, cone: &NormalCone, slack: f64) -> Option<Peak> {
        let start = unit(self.d);
        if self.gap(start) > 0.0 {
            let peak = self.climb(start);
            if cone.contains(peak.normal, ANGLE) {
                return Some(peak);
            }
        }
        self.best_sampled(cone, slack)
    }

    /// Brackets every local maximum between neighbouring samples of the cone and refines it. The
    /// slope at a border of the cone is the distance by which the ellipse's lowest point misses the
    /// edge there, so it has the same slack as the border.
    fn best_sampled(&self, cone: &NormalCone, slack: f64) -> Option<Peak> {
        let mut best: Option<Peak> = None;
        let (mut low, mut slope) = (cone.first, self.slope(cone.first));
        for _ in 0..cone.steps {
            let high = turned(low, cone.step);
            let next = self.slope(high);
            if slope >= -slack && next <= slack {
                let peak = self.refine(low, high);
                if best.is_none_or(|best| peak.gap > best.gap) {
                    best = Some(peak);
                }
            }
            (low, slope) = (high, next);
        }
        best
    }

    /// The local maximum uphill of a direction.
    fn climb(&self, start: Vec2) -> Peak {
        let slope = self.slope(start);
        let stride = if slope > 0.0 {
            STRIDE
        } else {
            [STRIDE[0], -STRIDE[1]]
        };
        let mut from = start;
        for _ in 0..63 {
            let to = turned(from, stride);
            if self.slope(to) * slope <= 0.0 {
                return if slope > 0.0 {
                    self.refine(from, to)
                } else {
                    self.refine(to, from)
                };
            }
            from = to;
        }
        Peak {
            normal: start,
            gap: self.gap(start),
        }
    }

    /// Newton's method on g' = 0 between `low`, where g rises, and `high`, where it falls
    /// (counter-clockwise from low).
    fn refine(&self, mut low: Vec2, mut high: Vec2) -> Peak {
        let mut n = unit(add(low, high));
        for _ in 0..STEPS {
            let (slope, curvature) = self.derivatives(n);
            let step = -slope / curvature;
            if step.abs() < 1e-16 {
                break;
            }
            if slope > 0.0 {
                low = n
            } else {
                high = n
            }
            let newton = unit(add(n, scale(step, left(n))));
            let inside = curvature < 0.0 && cross(low, newton) > 0.0 && cross(newton, high) > 0.0;
            let next = if inside { newton } else { unit(add(low, high)) };
            if next == n {
                break;
            }
            n = next;
        }
        Peak {
            normal: n,
            gap: self.gap(n),
        }
    }

    fn gap(&self, n: Vec2) -> f64 {
        self.ellipses
            .iter()
            .flatten()
            .fold(dot(n, self.d) - self.radius, |g, e| g - e.support(n))
    }

    fn slope(&self, n: Vec2) -> f64 {
        self.derivatives(n).0
    }

    /// (g', g'') by the angle of n.
    fn derivatives(&self, n: Vec2) -> (f64, f64) {
        let mut g = (cross(n, self.d), -dot(n, self.d));
        for ellipse in self.ellipses.iter().flatten() {
            let [a, b] = ellipse.semi_axes;
            let (c, s) = (dot(ellipse.axis, n), cross(ellipse.axis, n));
            let h = ellipse.support(n);
            let excess = (b - a) * (b + a);
            let slope = excess * c * s / h;
            g.0 -= slope;
            g.1 -= (excess * (c * c - s * s) - slope * slope) / h;
        }
        g
    }
}

fn turned(n: Vec2, [cos, sin]: Vec2) -> Vec2 {
    [cos * n[0] - sin * n[1], cos * n[1] + sin * n[0]]
}
