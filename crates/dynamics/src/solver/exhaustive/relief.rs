//! Impulses that cancel each other: [`relieve`] finds smaller ones.
//!
//! Bodies that squeeze an object press on it with impulses that nothing determines, and iterations
//! that raise an impulse as long as a gap is closed leave them as large as they happen to be. Of
//! all impulses at the same V, those of [`balance`] belong to at most four independent generators,
//! and so are no larger than the load and the wedge ask for.

use crate::solver::exhaustive::balance::{Balance, balance};
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::load::Load;
use crate::solver::exhaustive::scalar_ncp::{Candidate, ScalarNcp};
use crate::solver::vector::{Vector, dot, norm};

/// Speeds below this are zero, as in the certificate (m/s).
const ZERO: f64 = 1e-9;

/// Imbalance that is left to the certificate (m/s).
const BALANCED: f64 = 1e-10;

/// Candidate that moves like a solution, V = (v, y), with impulses that do not cancel each other;
/// `None` where none were found.
pub fn relieve(problem: &ScalarNcp, v: &Vector<4>) -> Option<Candidate> {
    let rigid = !problem.stall.is_finite();
    let generators: Vec<_> = Generator::all(problem)
        .into_iter()
        .filter(|generator| acts(problem, generator, v))
        .collect();
    let stands = problem.feet.map(|foot| norm(&foot.slip(v)) <= ZERO);
    let load = Load::at(problem, v, stands);
    let columns: Vec<_> = generators
        .iter()
        .map(|generator| match generator.g {
            [x, y, turn, _] if rigid => [x, y, turn, 0.0],
            g => g,
        })
        .collect();
    let (Balance::Met { alpha, directions }, _) = balance(&columns, &load, BALANCED) else {
        return None;
    };
    let mut feet = problem.sliding_feet(v);
    for k in (0..3).filter(|k| stands[*k]) {
        feet[k] = directions[k].map(|u| -problem.feet[k].bound * u);
    }
    let mut contacts = vec![[0.0; 2]; problem.contacts.len()];
    for (generator, alpha) in generators.iter().zip(alpha) {
        if let Some(i) = generator.contact {
            contacts[i][0] += alpha;
            contacts[i][1] += alpha * generator.sign * problem.contacts[i].mu;
        }
    }
    Some(Candidate {
        v: *v,
        contacts,
        feet,
    })
}

/// Returns true if a solution that moves with V may have an impulse along a generator.
fn acts(problem: &ScalarNcp, generator: &Generator, v: &Vector<4>) -> bool {
    let Some(i) = generator.contact else {
        return problem.stall.is_finite() && v[3] <= ZERO;
    };
    let c = &problem.contacts[i];
    let (gap, slip) = (dot(&c.n, v) + c.gap_offset, dot(&c.t, v) + c.slip_offset);
    gap <= ZERO && generator.sign * slip <= ZERO
}
