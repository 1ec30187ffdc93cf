//! One particle's problem as plain numbers: [`Rows`], what the slow solvers work on.

use stickslip_lanes::Lanes;

use crate::ncp::rows::{ContactRow, Ncp};
use crate::ncp::unknowns::Impulses;

/// A vector of the scaled velocity space (x, y, ρ θ), or of (x, y, ρ θ, y) with the pusher's yield
/// speed appended.
pub type Vector<const N: usize> = [f64; N];

/// a · b.
pub fn dot<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + s b.
pub fn plus<const N: usize>(a: &Vector<N>, s: f64, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// Length of a vector.
pub fn norm<const N: usize>(a: &Vector<N>) -> f64 {
    dot(a, a).sqrt()
}

/// One contact; the fourth entry of its columns is the effect of the pusher's yield.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Column W_n and n·d.
    pub n: Vector<4>,
    /// Column W_t and t·d.
    pub t: Vector<4>,
    /// ψ/h − n·u (m/s).
    pub gap: f64,
    /// −t·u (m/s).
    pub slip: f64,
    /// Friction coefficient.
    pub mu: f64,
}

impl Contact {
    /// Whether the other contact says the same, to rounding.
    pub fn repeats(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (1.0 + a.abs());
        let columns = self
            .n
            .iter()
            .zip(&other.n)
            .chain(self.t.iter().zip(&other.t));
        columns.into_iter().all(|(a, b)| near(*a, *b))
            && near(self.gap, other.gap)
            && near(self.slip, other.slip)
            && self.mu == other.mu
    }
}

/// One foot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Foot {
    /// Slip velocity is (v_x + jx v_θ, v_y + jy v_θ).
    pub jx: f64,
    /// See `jx`.
    pub jy: f64,
    /// Largest friction impulse over m (m/s).
    pub bound: f64,
}

impl Foot {
    /// Slip velocity.
    pub fn slip<const N: usize>(&self, v: &Vector<N>) -> [f64; 2] {
        [v[0] + self.jx * v[2], v[1] + self.jy * v[2]]
    }
}

/// One particle's problem, mass-normalised as in [`Ncp`].
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// Velocity without contact and friction impulses.
    pub free: Vector<3>,
    /// The feet.
    pub feet: [Foot; 3],
    /// The contacts.
    pub contacts: Vec<Contact>,
    /// F_stall h / m (m/s).
    pub stall: f64,
    /// The largest speed that appears in the problem (m/s).
    pub speed_scale: f64,
}

impl Rows {
    /// Reads a one-lane problem; memory is reused.
    pub fn assign(&mut self, ncp: &Ncp<1>) {
        let column = |c: &[Lanes<1>; 3], d: Lanes<1>| [c[0].0[0], c[1].0[0], c[2].0[0], d.0[0]];
        self.free = ncp.free.map(|x| x.0[0]);
        self.feet = ncp.feet.map(|f| Foot {
            jx: f.jx.0[0],
            jy: f.jy.0[0],
            bound: f.bound.0[0],
        });
        self.stall = ncp.stall.0[0];
        self.speed_scale = ncp.speed_scale().0[0];
        let contact = |c: &ContactRow<1>| Contact {
            n: column(&c.n, c.nd),
            t: column(&c.t, c.td),
            gap: c.gap.0[0],
            slip: c.slip.0[0],
            mu: c.mu.0[0],
        };
        self.contacts.clear();
        self.contacts.extend(ncp.contacts.iter().map(contact));
    }
}

/// Plain-number impulses.
#[derive(Clone, Debug, Default)]
pub struct Guess {
    /// Velocity and pusher yield.
    pub v: Vector<4>,
    /// (p_n, p_t) per contact.
    pub contacts: Vec<[f64; 2]>,
    /// Per foot.
    pub feet: [[f64; 2]; 3],
}

impl Guess {
    /// Writes the impulses where the certificate reads them.
    pub fn store(&self, p: &mut Impulses<1>) {
        p.v = [0, 1, 2].map(|i| Lanes([self.v[i]]));
        p.pusher_yield = Lanes([self.v[3]]);
        p.feet = self.feet.map(|f| f.map(|x| Lanes([x])));
        for (i, [n, t]) in self.contacts.iter().enumerate() {
            p.normal[i] = Lanes([*n]);
            p.tangential[i] = Lanes([*t]);
        }
    }
}

/// Solves the dense N×N system m x = b by elimination with row pivoting; `None` where a pivot is at
/// most `singular` times the largest entry.
pub fn solve_dense<const N: usize>(
    mut m: [[f64; N]; N],
    mut b: [f64; N],
    singular: f64,
) -> Option<[f64; N]> {
    let largest = m.iter().flatten().fold(0.0f64, |a, x| a.max(x.abs()));
    for c in 0..N {
        let pivot = (c..N).fold(c, |best, r| {
            if m[r][c].abs() > m[best][c].abs() {
                r
            } else {
                best
            }
        });
        m.swap(c, pivot);
        b.swap(c, pivot);
        if m[c][c].abs() <= singular * largest || !m[c][c].is_finite() {
            return None;
        }
        for r in c + 1..N {
            let f = m[r][c] / m[c][c];
            for k in c..N {
                m[r][k] -= f * m[c][k];
            }
            b[r] -= f * b[c];
        }
    }
    for c in (0..N).rev() {
        let tail: f64 = (c + 1..N).map(|k| m[c][k] * b[k]).sum();
        b[c] = (b[c] - tail) / m[c][c];
    }
    Some(b)
}
