//! The direction in which two round features are farthest apart: [`widest`].

use crate::outline::{Round, RoundKind};

/// Directions tried before the best one is refined.
const SAMPLES: usize = 32;

/// The unit normal n (towards `ours`) that maximises the separation n·d − h_ours(−n) − h_theirs(n), and that separation;
/// `d` leads from their centre to ours.
///
/// For points and discs it is the line of centres. With an ellipse it is found by bisection of the derivative, bracketed by
/// samples of the whole turn, so that it is the least penetration where the two overlap.
pub(crate) fn widest(ours: &Round, theirs: &Round, d: [f64; 2]) -> ([f64; 2], f64) {
    let curved = |round: &Round| matches!(round.kind, RoundKind::Ellipse { .. });
    if !curved(ours) && !curved(theirs) {
        return between_centres(ours, theirs, d);
    }
    let separation = |angle: f64| {
        let n = unit(angle);
        n[0] * d[0] + n[1] * d[1] - ours.support(n) - theirs.support(n)
    };
    // d/dangle: the tangent's product with d less the support points' (a support function's gradient is its point)
    let slope = |angle: f64| {
        let (n, t) = (unit(angle), unit(angle + std::f64::consts::FRAC_PI_2));
        let (p, q) = (ours.support_point(n), theirs.support_point(n));
        t[0] * (d[0] - p[0] - q[0]) + t[1] * (d[1] - p[1] - q[1])
    };
    let step = std::f64::consts::TAU / SAMPLES as f64;
    let best = (0..SAMPLES).map(|k| step * k as f64).fold((0.0, f64::NEG_INFINITY), |best, angle| {
        let value = separation(angle);
        if value > best.1 { (angle, value) } else { best }
    });
    let angle = bisect(best.0 - step, best.0 + step, slope);
    (unit(angle), separation(angle))
}

fn between_centres(ours: &Round, theirs: &Round, d: [f64; 2]) -> ([f64; 2], f64) {
    let distance = d[0].hypot(d[1]);
    let normal = if distance > 0.0 { [d[0] / distance, d[1] / distance] } else { [1.0, 0.0] };
    (normal, distance - ours.radius() - theirs.radius())
}

fn unit(angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [cos, sin]
}

/// Root of a function that falls through zero between `low` and `high`.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
