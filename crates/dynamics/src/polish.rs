//! Newton's method with the modes of a guess held fixed: [`polish`].
//!
//! The homotopy ends where every contact's and foot's mode shows plainly (an impulse well inside its bound sticks, one on it
//! slides), also at speeds so small that the natural map of the fast solver, which weighs impulses against speeds, cannot tell.

use crate::condensed::{ContactStep, FootStep, Linearised, StallStep};
use crate::rows::{Contact, Foot, Guess, Rows, Vector};

/// Stiffness of held rows; their impulses are kept from one iteration to the next.
const STIFFNESS: f64 = 1.0e6;

/// Relative change of the velocity at which the iteration ends.
const CONVERGED: f64 = 1e-14;

/// What a contact does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Open,
    Stick,
    /// p_t = ratio p_n.
    Slide {
        ratio: f64,
    },
}

/// Newton's method in fixed modes, with its working memory.
#[derive(Clone, Debug, Default)]
pub struct Polish {
    linearised: Linearised,
    modes: Vec<Mode>,
    best: Guess,
    next: Guess,
}

impl Polish {
    /// At most `limit` Newton steps from `guess` in its own modes; returns where they end.
    ///
    /// An impulse above the share `sliding` of its bound counts as sliding.
    pub fn polish(&mut self, rows: &Rows, guess: &Guess, sliding: f64, limit: u32) -> &Guess {
        self.modes.clear();
        self.modes.extend(rows.contacts.iter().zip(&guess.contacts).map(|(c, p)| contact_mode(rows, c, *p, &guess.v, sliding)));
        let slides: [bool; 3] = std::array::from_fn(|k| guess.feet[k][0].hypot(guess.feet[k][1]) > sliding * rows.feet[k].bound);
        let yields = rows.stall.is_finite() && guess.v[3] > rows.stall - rows.resistance(guess);
        self.best.clone_from(guess);
        for _ in 0..limit {
            let best = &self.best;
            let contacts = rows.contacts.iter().zip(&best.contacts).zip(&self.modes);
            self.linearised.contacts.clear();
            self.linearised.contacts.extend(contacts.map(|((c, p), mode)| contact(rows, c, *p, &best.v, *mode)));
            self.linearised.feet = std::array::from_fn(|k| foot(&rows.feet[k], best.feet[k], &best.v, slides[k]));
            self.linearised.stall = stall(rows, best, yields);
            if !self.linearised.step(rows, best, &mut self.next) {
                break;
            }
            std::mem::swap(&mut self.best, &mut self.next);
            // the step that led here, relative to the speed reached
            let moved = self.best.v.iter().zip(&self.next.v).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            if moved <= CONVERGED * self.best.v.iter().fold(0.0f64, |most, v| most.max(v.abs())) {
                break;
            }
        }
        &self.best
    }
}

fn contact_mode(rows: &Rows, c: &Contact, p: [f64; 2], v: &Vector<4>, sliding: f64) -> Mode {
    let (gamma, _) = rows.contact_velocity(c, v, p[0]);
    if p[0] <= gamma {
        Mode::Open
    } else if p[1].abs() > sliding * c.mu * p[0] {
        Mode::Slide { ratio: c.mu.copysign(p[1]) }
    } else {
        Mode::Stick
    }
}

fn contact(rows: &Rows, c: &Contact, p: [f64; 2], v: &Vector<4>, mode: Mode) -> ContactStep {
    let (gamma, s) = rows.contact_velocity(c, v, p[0]);
    let k = 1.0 / (1.0 / STIFFNESS + rows.compliance);
    let normal = -k * gamma;
    match mode {
        Mode::Open => ContactStep { r: [-p[0], -p[1]], nn: 0.0, tn: 0.0, tt: 0.0 },
        Mode::Stick => ContactStep { r: [normal, -STIFFNESS * s], nn: k, tn: 0.0, tt: STIFFNESS },
        Mode::Slide { ratio } => ContactStep { r: [normal, ratio * (p[0] + normal) - p[1]], nn: k, tn: ratio * k, tt: 0.0 },
    }
}

fn foot(foot: &Foot, p: [f64; 2], v: &Vector<4>, slides: bool) -> FootStep {
    let s = foot.slip(v);
    let speed = s[0].hypot(s[1]);
    if !slides || speed == 0.0 {
        return FootStep { r: s.map(|s| -STIFFNESS * s), k: [[STIFFNESS, 0.0], [0.0, STIFFNESS]] };
    }
    let unit = [s[0] / speed, s[1] / speed];
    // primal–dual: the impulse turns with the slip's new direction, p kept inside its disc
    let size = p[0].hypot(p[1]);
    let shrink = if size > foot.bound { foot.bound / size } else { 1.0 };
    let entry = |i: usize, j: usize| ((if i == j { foot.bound } else { 0.0 }) + shrink * p[i] * unit[j]) / speed;
    FootStep {
        r: [-foot.bound * unit[0] - p[0], -foot.bound * unit[1] - p[1]],
        k: [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]],
    }
}

fn stall(rows: &Rows, guess: &Guess, yields: bool) -> StallStep {
    if yields {
        StallStep { slack: 1.0, pusher: 0.0, rhs: rows.resistance(guess) - rows.stall }
    } else {
        StallStep { slack: 0.0, pusher: 1.0, rhs: -guess.v[3] }
    }
}
