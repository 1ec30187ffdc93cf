//! The second solver: a smoothing Newton method with line search, cold-started, for what the fast one leaves open.
//!
//! Complementarity pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993), friction becomes
//! bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the primal–dual form of Andersen, Christiansen, Conn &
//! Overton 2000). ε is driven to zero; every step halves until the smoothed residual falls.

use crate::condensed::{ContactStep, FootStep, Linearised, StallStep};
use crate::rows::{Contact, Foot, Guess, Rows, Vector, plus};

/// Largest stiffness a smoothed row may reach.
const STIFFEST: f64 = 1.0e13;

/// Follows ε from the problem's speed scale down to 1e-11 of it; the result is meant to be polished by the fast solver.
///
/// `start` seeds the path. Where a reduction of ε is too bold to recover from, a milder one is tried from the last good point.
pub fn follow(rows: &Rows, start: Guess) -> Guess {
    let scale = rows.speed_scale();
    let mut guess = start;
    let v = rows.velocity(&guess);
    guess.v[..3].copy_from_slice(&v);
    let mut epsilon = scale;
    let mut reduction = 0.1;
    for _ in 0..60 {
        match settle(rows, &guess, epsilon) {
            Some(settled) => {
                guess = settled;
                if epsilon < 1e-11 * scale {
                    break;
                }
                reduction = f64::max(reduction * reduction, 0.03);
                epsilon *= reduction;
            }
            None if reduction < 0.9 => {
                epsilon /= reduction;
                reduction = reduction.sqrt();
                epsilon *= reduction;
            }
            None => break,
        }
    }
    guess
}

/// Newton steps at one ε until the smoothed residual is well below it; `None` where they do not get there.
fn settle(rows: &Rows, start: &Guess, epsilon: f64) -> Option<Guess> {
    let mut guess = start.clone();
    let mut merit = smoothed_residual(rows, &guess, epsilon);
    for _ in 0..12 {
        if merit < 0.1 * epsilon {
            return Some(guess);
        }
        (guess, merit) = damped_step(rows, &guess, epsilon, merit)?;
    }
    None
}

/// A Newton step, halved until the smoothed residual falls; `None` where ten halvings do not help.
fn damped_step(rows: &Rows, guess: &Guess, epsilon: f64, merit: f64) -> Option<(Guess, f64)> {
    let full = linearise(rows, guess, epsilon).step(rows, guess)?;
    let mut share = 1.0;
    for _ in 0..6 {
        let next = blend(guess, &full, share);
        let next_merit = smoothed_residual(rows, &next, epsilon);
        if next_merit < merit * (1.0 - 0.1 * share) {
            return Some((next, next_merit));
        }
        share *= 0.5;
    }
    None
}

/// guess + share (full − guess).
fn blend(guess: &Guess, full: &Guess, share: f64) -> Guess {
    let mix = |a: [f64; 2], b: [f64; 2]| [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
    Guess {
        v: plus(&guess.v, share, &plus(&full.v, -1.0, &guess.v)),
        contacts: guess.contacts.iter().zip(&full.contacts).map(|(a, b)| mix(*a, *b)).collect(),
        feet: std::array::from_fn(|k| mix(guess.feet[k], full.feet[k])),
    }
}

/// a + b − sqrt((a − b)² + 4ε²).
fn smooth_pair(a: f64, b: f64, epsilon: f64) -> f64 {
    a + b - ((a - b) * (a - b) + 4.0 * epsilon * epsilon).sqrt()
}

/// Stiffness of a smoothed pair: db = −(F + k da)/… written as the ratio (∂F/∂a)/(∂F/∂b), and F/(∂F/∂b).
fn pair_step(pressed: f64, gap: f64, epsilon: f64) -> (f64, f64) {
    let root = ((pressed - gap) * (pressed - gap) + 4.0 * epsilon * epsilon).sqrt();
    let w = (pressed - gap) / root;
    // 1 − w without cancellation where the pair is closed
    let open = if w > 0.0 { 4.0 * epsilon * epsilon / (root * (root + (pressed - gap))) } else { 1.0 - w };
    let open = open.max(2.0 / STIFFEST);
    (smooth_pair(pressed, gap, epsilon) / open, (1.0 + w) / open)
}

/// Largest smoothed violation.
fn smoothed_residual(rows: &Rows, guess: &Guess, epsilon: f64) -> f64 {
    let mut worst = 0.0f64;
    for (c, [p_n, p_t]) in rows.contacts.iter().zip(&guess.contacts) {
        let (gamma, s) = rows.contact_velocity(c, &guess.v, *p_n);
        worst = worst.max(smooth_pair(*p_n, gamma, epsilon).abs());
        let sigma = (s * s + epsilon * epsilon).sqrt();
        worst = worst.max((c.mu * p_n.max(0.0) * s / sigma + p_t).abs());
    }
    for (foot, p) in rows.feet.iter().zip(&guess.feet) {
        let s = foot.slip(&guess.v);
        let sigma = (s[0] * s[0] + s[1] * s[1] + epsilon * epsilon).sqrt();
        worst = worst.max((foot.bound * s[0] / sigma + p[0]).hypot(foot.bound * s[1] / sigma + p[1]));
    }
    if rows.stall.is_finite() {
        worst = worst.max(smooth_pair(rows.stall - rows.resistance(guess), guess.v[3], epsilon).abs());
    }
    if worst.is_nan() { f64::INFINITY } else { worst }
}

/// All rows, smoothed with ε and linearised at `guess`.
fn linearise(rows: &Rows, guess: &Guess, epsilon: f64) -> Linearised {
    Linearised {
        contacts: rows.contacts.iter().zip(&guess.contacts).map(|(c, p)| linearise_contact(rows, c, *p, &guess.v, epsilon)).collect(),
        feet: std::array::from_fn(|k| linearise_foot(&rows.feet[k], guess.feet[k], &guess.v, epsilon)),
        stall: linearise_stall(rows, guess, epsilon),
    }
}

fn linearise_contact(rows: &Rows, c: &Contact, p: [f64; 2], v: &Vector<4>, epsilon: f64) -> ContactStep {
    let (gamma, s) = rows.contact_velocity(c, v, p[0]);
    let (f, k) = pair_step(p[0], gamma, epsilon);
    // γ itself grows by κ dp_n
    let soft = 1.0 / (1.0 + rows.compliance * k);
    let (r_n, nn) = (-f * soft, k * soft);
    let sigma = (s * s + epsilon * epsilon).sqrt();
    let (p_n, open) = if p[0] > 0.0 { (p[0], 1.0) } else { (0.0, 0.0) };
    // the matrix uses p_t clamped to the cone, which keeps its diagonal positive
    let p_t = p[1].clamp(-c.mu * p_n, c.mu * p_n);
    let tt = ((c.mu * p_n + p_t * s / sigma) / sigma).min(STIFFEST);
    let ratio = -c.mu * s / sigma * open;
    ContactStep { r: [r_n, -(c.mu * p_n * s / sigma + p[1]) + ratio * r_n], nn, tn: ratio * nn, tt }
}

fn linearise_foot(foot: &Foot, p: [f64; 2], v: &Vector<4>, epsilon: f64) -> FootStep {
    let s = foot.slip(v);
    let sigma = (s[0] * s[0] + s[1] * s[1] + epsilon * epsilon).sqrt();
    let unit = [s[0] / sigma, s[1] / sigma];
    let size = p[0].hypot(p[1]);
    let shrink = if size > foot.bound { foot.bound / size } else { 1.0 };
    let inside = [p[0] * shrink, p[1] * shrink];
    let entry = |i: usize, j: usize| ((if i == j { foot.bound } else { 0.0 }) + inside[i] * unit[j]) / sigma;
    FootStep {
        r: [-(foot.bound * unit[0] + p[0]), -(foot.bound * unit[1] + p[1])],
        k: [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]],
    }
}

fn linearise_stall(rows: &Rows, guess: &Guess, epsilon: f64) -> StallStep {
    if !rows.stall.is_finite() {
        return StallStep { slack: 0.0, pusher: 1.0, rhs: -guess.v[3] };
    }
    let (slack, y) = (rows.stall - rows.resistance(guess), guess.v[3]);
    let root = ((slack - y) * (slack - y) + 4.0 * epsilon * epsilon).sqrt();
    let w = (slack - y) / root;
    StallStep { slack: 1.0 - w, pusher: 1.0 + w, rhs: -smooth_pair(slack, y, epsilon) }
}
