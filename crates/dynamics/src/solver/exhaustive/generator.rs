//! Directions along which contacts and the pusher's drive can push: [`Generator`].

use crate::solver::exhaustive::scalar_ncp::ScalarNcp;
use crate::solver::vector::{Vector, add_scaled};

/// An edge n + `sign` μ t of a contact's friction cone, or the unit vector of the stall pair
/// (`contact` is `None`).
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    /// Number of the contact.
    pub contact: Option<usize>,
    /// ±1; 0 where μ = 0.
    pub sign: f64,
    /// The direction.
    pub g: Vector<4>,
}

impl Generator {
    /// All of a problem: first the stall pair, then both edges of every contact that does not
    /// repeat an earlier one.
    pub fn all(problem: &ScalarNcp) -> Vec<Self> {
        let contacts = &problem.contacts;
        let mut all = vec![Self {
            contact: None,
            sign: 0.0,
            g: [0.0, 0.0, 0.0, 1.0],
        }];
        for (i, c) in contacts.iter().enumerate() {
            if contacts[..i].iter().any(|earlier| earlier.repeats(c)) {
                continue;
            }
            let signs: &[f64] = if c.mu > 0.0 { &[1.0, -1.0] } else { &[0.0] };
            all.extend(signs.iter().map(|&sign| Self {
                contact: Some(i),
                sign,
                g: add_scaled(&c.n, sign * c.mu, &c.t),
            }));
        }
        all
    }
}
