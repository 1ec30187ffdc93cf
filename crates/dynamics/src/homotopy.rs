//! The second solver: a smoothing Newton method with line search, cold-started, for what the fast one leaves open.
//!
//! Complementarity pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993), friction becomes
//! bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the primal–dual form of Andersen, Christiansen, Conn &
//! Overton 2000). ε is driven to zero; every step halves until the smoothed residual falls.

use crate::rows::{Contact, Foot, Guess, Rows, Vector, dot, plus, solve_dense};

/// Largest stiffness a smoothed row may reach.
const STIFFEST: f64 = 1.0e9;

/// Linear model of one contact: d(p_n, p_t) = r − K (dγ, ds).
#[derive(Clone, Copy, Debug)]
struct ContactStep {
    r: [f64; 2],
    nn: f64,
    tn: f64,
    tt: f64,
}

/// Linear model of one foot: dp = r − K ds.
#[derive(Clone, Copy, Debug)]
struct FootStep {
    r: [f64; 2],
    k: [[f64; 2]; 2],
}

/// Follows ε from the problem's speed scale down to 1e-8 of it; the result is meant to be polished by the fast solver.
///
/// `start` seeds the path. Returns the end point, or the last point reached where a step found no decrease.
pub fn follow(rows: &Rows, start: Guess) -> Guess {
    let scale = rows.speed_scale();
    let mut guess = start;
    let v = rows.velocity(&guess);
    guess.v[..3].copy_from_slice(&v);
    let mut epsilon = scale;
    let mut merit = smoothed_residual(rows, &guess, epsilon);
    for _ in 0..80 {
        let Some((next, next_merit)) = damped_step(rows, &guess, epsilon, merit) else { break };
        guess = next;
        merit = next_merit;
        if merit < 0.3 * epsilon {
            if epsilon < 1e-8 * scale {
                break;
            }
            epsilon *= if merit < 0.03 * epsilon { 0.05 } else { 0.3 };
            merit = smoothed_residual(rows, &guess, epsilon);
        }
    }
    guess
}

/// A Newton step, halved until the smoothed residual falls; `None` where ten halvings do not help.
fn damped_step(rows: &Rows, guess: &Guess, epsilon: f64, merit: f64) -> Option<(Guess, f64)> {
    let full = newton_step(rows, guess, epsilon)?;
    let mut share = 1.0;
    for _ in 0..12 {
        let next = blend(rows, guess, &full, share);
        let next_merit = smoothed_residual(rows, &next, epsilon);
        if next_merit < merit * (1.0 - 0.1 * share) {
            return Some((next, next_merit));
        }
        share *= 0.5;
    }
    None
}

/// guess + share (full − guess).
fn blend(rows: &Rows, guess: &Guess, full: &Guess, share: f64) -> Guess {
    let mix = |a: [f64; 2], b: [f64; 2]| [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
    let mut next = Guess {
        v: plus(&guess.v, share, &plus(&full.v, -1.0, &guess.v)),
        contacts: guess.contacts.iter().zip(&full.contacts).map(|(a, b)| mix(*a, *b)).collect(),
        feet: std::array::from_fn(|k| mix(guess.feet[k], full.feet[k])),
    };
    let v = rows.velocity(&next);
    next.v[..3].copy_from_slice(&v);
    next
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

/// The full Newton step from `guess`; `None` where the condensed system is singular.
fn newton_step(rows: &Rows, guess: &Guess, epsilon: f64) -> Option<Guess> {
    let contacts: Vec<ContactStep> =
        rows.contacts.iter().zip(&guess.contacts).map(|(c, p)| linearise_contact(rows, c, *p, &guess.v, epsilon)).collect();
    let feet: [FootStep; 3] = std::array::from_fn(|k| linearise_foot(&rows.feet[k], guess.feet[k], &guess.v, epsilon));
    let (matrix, rhs) = condense(rows, guess, &contacts, &feet, epsilon);
    let dv = solve_dense(matrix, rhs)?;

    let mut full = guess.clone();
    for ((p, c), step) in full.contacts.iter_mut().zip(&rows.contacts).zip(&contacts) {
        let (dgamma, ds) = (dot(&c.n, &dv), dot(&c.t, &dv));
        p[0] += step.r[0] - step.nn * dgamma;
        p[1] += step.r[1] - step.tn * dgamma - step.tt * ds;
    }
    for ((p, foot), step) in full.feet.iter_mut().zip(&rows.feet).zip(&feet) {
        let ds = foot.slip(&dv);
        for i in 0..2 {
            p[i] += step.r[i] - step.k[i][0] * ds[0] - step.k[i][1] * ds[1];
        }
    }
    full.v = plus(&guess.v, 1.0, &dv);
    full.v.iter().all(|x| x.is_finite()).then_some(full)
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

/// (I + Σ WᵀKW) d(v, y) = rhs, with the stall pair as the fourth row.
fn condense(rows: &Rows, guess: &Guess, contacts: &[ContactStep], feet: &[FootStep; 3], epsilon: f64) -> ([[f64; 4]; 4], [f64; 4]) {
    let mut m = [[0.0; 4]; 4];
    let mut rhs = [0.0; 4];
    let lag = rows.velocity(guess);
    for i in 0..3 {
        m[i][i] = 1.0;
        rhs[i] = lag[i] - guess.v[i];
    }
    for (foot, step) in rows.feet.iter().zip(feet) {
        let columns = [[1.0, 0.0, foot.jx], [0.0, 1.0, foot.jy]];
        for i in 0..3 {
            for a in 0..2 {
                rhs[i] += columns[a][i] * step.r[a];
                for (j, entry) in m[i].iter_mut().enumerate().take(3) {
                    *entry += columns[a][i] * (step.k[a][0] * columns[0][j] + step.k[a][1] * columns[1][j]);
                }
            }
        }
    }
    for (c, step) in rows.contacts.iter().zip(contacts) {
        for i in 0..4 {
            rhs[i] += c.n[i] * step.r[0] + c.t[i] * step.r[1];
            for j in 0..4 {
                m[i][j] += c.n[i] * step.nn * c.n[j] + c.t[i] * (step.tn * c.n[j] + step.tt * c.t[j]);
            }
        }
    }
    close_stall_row(rows, guess, &mut m[3], &mut rhs[3], epsilon);
    (m, rhs)
}

/// The fourth row holds dF = rhs − row·d(v, y) on entry; on exit it is the linearised pair (F_stall − F) ⟂ y.
fn close_stall_row(rows: &Rows, guess: &Guess, row: &mut [f64; 4], rhs: &mut f64, epsilon: f64) {
    if !rows.stall.is_finite() {
        *row = [0.0, 0.0, 0.0, 1.0];
        *rhs = -guess.v[3];
        return;
    }
    let (slack, y) = (rows.stall - rows.resistance(guess), guess.v[3]);
    let root = ((slack - y) * (slack - y) + 4.0 * epsilon * epsilon).sqrt();
    let w = (slack - y) / root;
    // (1 − w) dslack + (1 + w) dy = −F, dslack = −dF
    for entry in row.iter_mut() {
        *entry *= 1.0 - w;
    }
    row[3] += 1.0 + w;
    *rhs = -smooth_pair(slack, y, epsilon) + (1.0 - w) * *rhs;
}

impl Rows {
    /// Velocity that follows from the impulses.
    pub fn velocity(&self, guess: &Guess) -> Vector<3> {
        let mut v = self.free;
        for (foot, p) in self.feet.iter().zip(&guess.feet) {
            v = plus(&v, 1.0, &foot.wrench(*p));
        }
        for (c, p) in self.contacts.iter().zip(&guess.contacts) {
            for i in 0..3 {
                v[i] += c.n[i] * p[0] + c.t[i] * p[1];
            }
        }
        v
    }

    /// Gap velocity (with the compliance of the row) and slip velocity.
    fn contact_velocity(&self, c: &Contact, v: &Vector<4>, p_n: f64) -> (f64, f64) {
        (dot(&c.n, v) + c.gap + self.compliance * p_n, dot(&c.t, v) + c.slip)
    }

    /// F / m.
    fn resistance(&self, guess: &Guess) -> f64 {
        self.contacts.iter().zip(&guess.contacts).map(|(c, p)| p[0] * c.n[3] + p[1] * c.t[3]).sum()
    }
}
