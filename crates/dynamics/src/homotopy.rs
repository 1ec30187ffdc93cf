//! The second solver: a smoothing Newton method with line search, cold-started, for what the fast one leaves open.
//!
//! Complementarity pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993), friction becomes
//! bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the primal–dual form of Andersen, Christiansen, Conn &
//! Overton 2000). ε is driven to zero; every step halves until the smoothed residual falls.

use crate::condensed::{ContactStep, FootStep, Linearised, StallStep};
use crate::rows::{Contact, Foot, Guess, Rows, Vector, plus};

/// Largest stiffness a smoothed row may reach.
const STIFFEST: f64 = 1.0e13;

/// Full steps without decrease that are allowed at one ε.
const BOLD_STEPS: u32 = 3;

/// The smoothing homotopy with its working memory.
#[derive(Clone, Debug, Default)]
pub struct Homotopy {
    linearised: Linearised,
    guess: Guess,
    full: Guess,
    trial: Guess,
    settled: Guess,
}

impl Homotopy {
    /// Follows ε from `first` times the problem's speed scale down to 1e-11 of it; the end is meant to be polished.
    ///
    /// `start` seeds the path; returns its end, or the last point reached. Each reduction of ε begins with a step along the
    /// path's tangent; where it was too bold to recover from, a milder one is tried from the last good point.
    pub fn follow(&mut self, rows: &Rows, start: &Guess, first: f64) -> &Guess {
        let scale = rows.speed_scale();
        let (mut settled_at, mut epsilon) = (first * scale, first * scale);
        let mut reduction = 0.1;
        self.settled.clone_from(start);
        for _ in 0..40 {
            self.guess.clone_from(&self.settled);
            if self.settle(rows, settled_at, epsilon) {
                std::mem::swap(&mut self.settled, &mut self.guess);
                if epsilon < 1e-11 * scale {
                    break;
                }
                settled_at = epsilon;
                reduction = f64::max(reduction * reduction, 0.01);
            } else if reduction < 0.9 {
                reduction = reduction.sqrt();
            } else {
                break;
            }
            epsilon = settled_at * reduction;
        }
        &self.settled
    }

    /// Where the last path ended.
    pub fn end(&self) -> &Guess {
        &self.settled
    }

    /// From a point settled at `from`, Newton steps to `epsilon`; false where they do not get there.
    fn settle(&mut self, rows: &Rows, from: f64, epsilon: f64) -> bool {
        if from > epsilon {
            self.linearised.linearise(rows, &self.guess, from, epsilon);
            if self.linearised.step(rows, &self.guess, &mut self.full) {
                self.guess.clone_from(&self.full);
            }
        }
        let mut merit = smoothed_residual(rows, &self.guess, epsilon);
        let mut bold = BOLD_STEPS;
        for _ in 0..10 {
            if merit < 0.1 * epsilon {
                return true;
            }
            merit = match self.damped_step(rows, epsilon, merit) {
                Some(next) => next,
                None if bold > 0 => {
                    // near a kink the residual must rise before it can fall
                    bold -= 1;
                    std::mem::swap(&mut self.guess, &mut self.full);
                    smoothed_residual(rows, &self.guess, epsilon)
                }
                None => return false,
            };
        }
        merit < 0.1 * epsilon
    }

    /// A Newton step, halved until the smoothed residual falls to what is returned; `None` where halving does not help.
    fn damped_step(&mut self, rows: &Rows, epsilon: f64, merit: f64) -> Option<f64> {
        self.linearised.linearise(rows, &self.guess, epsilon, epsilon);
        if !self.linearised.step(rows, &self.guess, &mut self.full) {
            return None;
        }
        let mut share = 1.0;
        for _ in 0..6 {
            self.trial.blend(&self.guess, &self.full, share);
            let next = smoothed_residual(rows, &self.trial, epsilon);
            if next < merit * (1.0 - 0.1 * share) {
                std::mem::swap(&mut self.guess, &mut self.trial);
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }
}

impl Guess {
    /// from + share (to − from).
    fn blend(&mut self, from: &Guess, to: &Guess, share: f64) {
        let mix = |a: [f64; 2], b: [f64; 2]| [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
        self.v = plus(&from.v, share, &plus(&to.v, -1.0, &from.v));
        self.contacts.clear();
        self.contacts.extend(from.contacts.iter().zip(&to.contacts).map(|(a, b)| mix(*a, *b)));
        self.feet = std::array::from_fn(|k| mix(from.feet[k], to.feet[k]));
    }
}

/// a + b − sqrt((a − b)² + 4ε²).
fn smooth_pair(a: f64, b: f64, epsilon: f64) -> f64 {
    a + b - ((a - b) * (a - b) + 4.0 * epsilon * epsilon).sqrt()
}

/// The smoothed pair p ⟂ γ as dp = −r − k dγ at ε, aimed at `target`: (r, k).
fn pair_step(pressed: f64, gap: f64, epsilon: f64, target: f64) -> (f64, f64) {
    let root = ((pressed - gap) * (pressed - gap) + 4.0 * epsilon * epsilon).sqrt();
    let w = (pressed - gap) / root;
    // 1 − w without cancellation where the pair is closed
    let open = if w > 0.0 { 4.0 * epsilon * epsilon / (root * (root + (pressed - gap))) } else { 1.0 - w };
    let open = open.max(2.0 / STIFFEST);
    let value = smooth_pair(pressed, gap, epsilon) - 4.0 * epsilon / root * (target - epsilon);
    (value / open, (1.0 + w) / open)
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
        let off = [foot.bound * s[0] / sigma + p[0], foot.bound * s[1] / sigma + p[1]];
        worst = worst.max((off[0] * off[0] + off[1] * off[1]).sqrt());
    }
    if rows.stall.is_finite() {
        worst = worst.max(smooth_pair(rows.stall - rows.resistance(guess), guess.v[3], epsilon).abs());
    }
    if worst.is_nan() { f64::INFINITY } else { worst }
}

impl Linearised {
    /// All rows, smoothed with ε and linearised at `guess` in unknowns and ε, aimed at ε = `target`.
    fn linearise(&mut self, rows: &Rows, guess: &Guess, epsilon: f64, target: f64) {
        let aim = Aim { epsilon, target };
        self.contacts.clear();
        self.contacts.extend(rows.contacts.iter().zip(&guess.contacts).map(|(c, p)| aim.contact(rows, c, *p, &guess.v)));
        self.feet = std::array::from_fn(|k| aim.foot(&rows.feet[k], guess.feet[k], &guess.v));
        self.stall = aim.stall(rows, guess);
    }
}

/// Where a linearisation is taken and where it shall lead.
#[derive(Clone, Copy, Debug)]
struct Aim {
    epsilon: f64,
    target: f64,
}

impl Aim {
    /// (σ, σ linearised at the target over σ) for a slip speed.
    fn sigma(&self, slip: f64) -> (f64, f64) {
        let sigma = (slip * slip + self.epsilon * self.epsilon).sqrt();
        (sigma, 1.0 + self.epsilon * (self.target - self.epsilon) / (sigma * sigma))
    }

    fn contact(&self, rows: &Rows, c: &Contact, p: [f64; 2], v: &Vector<4>) -> ContactStep {
        let (gamma, s) = rows.contact_velocity(c, v, p[0]);
        let (f, k) = pair_step(p[0], gamma, self.epsilon, self.target);
        // γ itself grows by κ dp_n
        let soft = 1.0 / (1.0 + rows.compliance * k);
        let (r_n, nn) = (-f * soft, k * soft);
        let (sigma, shift) = self.sigma(s);
        let (p_n, open) = if p[0] > 0.0 { (p[0], 1.0) } else { (0.0, 0.0) };
        // the matrix uses p_t clamped to the cone, which keeps its diagonal positive
        let p_t = p[1].clamp(-c.mu * p_n, c.mu * p_n);
        let tt = ((c.mu * p_n + p_t * s / sigma) / sigma).min(STIFFEST);
        let ratio = -c.mu * s / sigma * open;
        ContactStep { r: [r_n, -(c.mu * p_n * s / sigma + p[1] * shift) + ratio * r_n], nn, tn: ratio * nn, tt }
    }

    fn foot(&self, foot: &Foot, p: [f64; 2], v: &Vector<4>) -> FootStep {
        let s = foot.slip(v);
        let (sigma, shift) = self.sigma((s[0] * s[0] + s[1] * s[1]).sqrt());
        let unit = [s[0] / sigma, s[1] / sigma];
        let size = (p[0] * p[0] + p[1] * p[1]).sqrt();
        let shrink = if size > foot.bound { foot.bound / size } else { 1.0 };
        let inside = [p[0] * shrink, p[1] * shrink];
        let entry = |i: usize, j: usize| ((if i == j { foot.bound } else { 0.0 }) + inside[i] * unit[j]) / sigma;
        FootStep {
            r: [-(foot.bound * unit[0] + p[0] * shift), -(foot.bound * unit[1] + p[1] * shift)],
            k: [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]],
        }
    }

    fn stall(&self, rows: &Rows, guess: &Guess) -> StallStep {
        if !rows.stall.is_finite() {
            return StallStep { slack: 0.0, pusher: 1.0, rhs: -guess.v[3] };
        }
        let (slack, y) = (rows.stall - rows.resistance(guess), guess.v[3]);
        let root = ((slack - y) * (slack - y) + 4.0 * self.epsilon * self.epsilon).sqrt();
        let w = (slack - y) / root;
        let value = smooth_pair(slack, y, self.epsilon) - 4.0 * self.epsilon / root * (self.target - self.epsilon);
        StallStep { slack: 1.0 - w, pusher: 1.0 + w, rhs: -value }
    }
}
