//! One particle's problem as plain numbers: [`ScalarNcp`], the form on which the search over
//! contact modes works.

use stickslip_lanes::Lanes;

use crate::ncp::rows::{ContactRow, FootRow, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::solver::vector::{Vector, norm};

/// One contact; the fourth entry of its columns is the effect of the pusher's yield.
#[derive(Clone, Copy, Debug)]
pub struct ScalarContact {
    /// Column W_n and n·d.
    pub n: Vector<4>,
    /// Column W_t and t·d.
    pub t: Vector<4>,
    /// ψ/h − n·u (m/s).
    pub gap_offset: f64,
    /// −t·u (m/s).
    pub slip_offset: f64,
    /// Friction coefficient.
    pub mu: f64,
}

impl ScalarContact {
    fn new(row: &ContactRow<1>) -> Self {
        let column = |c: &[Lanes<1>; 3], d: Lanes<1>| [c[0].0[0], c[1].0[0], c[2].0[0], d.0[0]];
        Self {
            n: column(&row.n, row.nd),
            t: column(&row.t, row.td),
            gap_offset: row.gap_offset.0[0],
            slip_offset: row.slip_offset.0[0],
            mu: row.mu.0[0],
        }
    }

    /// Returns true if the other contact is equal to this one, to rounding.
    pub fn repeats(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (1.0 + a.abs());
        let all_near = |a: &Vector<4>, b: &Vector<4>| a.iter().zip(b).all(|(a, b)| near(*a, *b));
        all_near(&self.n, &other.n)
            && all_near(&self.t, &other.t)
            && near(self.gap_offset, other.gap_offset)
            && near(self.slip_offset, other.slip_offset)
            && self.mu == other.mu
    }
}

/// One foot, as in [`FootRow`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ScalarFoot {
    /// −r_y / ρ.
    pub jx: f64,
    /// r_x / ρ.
    pub jy: f64,
    /// Largest friction impulse over m (m/s).
    pub bound: f64,
}

impl ScalarFoot {
    fn new(row: &FootRow<1>) -> Self {
        Self {
            jx: row.jx.0[0],
            jy: row.jy.0[0],
            bound: row.bound.0[0],
        }
    }

    /// Slip velocity.
    pub fn slip<const N: usize>(&self, v: &Vector<N>) -> [f64; 2] {
        [v[0] + self.jx * v[2], v[1] + self.jy * v[2]]
    }

    /// Its impulse where it slides with V; none where it stands.
    pub fn sliding(&self, v: &Vector<4>) -> [f64; 2] {
        let slip = self.slip(v);
        let length = norm(&slip);
        if length > 1e-12 {
            slip.map(|s| -self.bound * s / length)
        } else {
            [0.0; 2]
        }
    }
}

/// One particle's problem, mass-normalised as in [`Ncp`].
#[derive(Clone, Debug, Default)]
pub struct ScalarNcp {
    /// Velocity without contact and friction impulses.
    pub free: Vector<3>,
    /// The feet.
    pub feet: [ScalarFoot; 3],
    /// The contacts.
    pub contacts: Vec<ScalarContact>,
    /// F_stall h / m (m/s).
    pub stall: f64,
    /// The largest speed that appears in the problem (m/s).
    pub speed_scale: f64,
    /// The largest speed of a solution (m/s).
    pub speed_limit: f64,
}

impl ScalarNcp {
    /// Reads a one-lane problem; memory is reused.
    pub fn assign(&mut self, ncp: &Ncp<1>) {
        self.free = ncp.free.map(|x| x.0[0]);
        self.feet = ncp.feet.each_ref().map(ScalarFoot::new);
        self.stall = ncp.stall.0[0];
        self.speed_scale = ncp.speed_scale().0[0];
        self.speed_limit = ncp.speed_limit().0[0];
        self.contacts.clear();
        self.contacts
            .extend(ncp.contacts.iter().map(ScalarContact::new));
    }

    /// The impulses of feet that slide with V; none where one stands.
    pub fn sliding_feet(&self, v: &Vector<4>) -> [[f64; 2]; 3] {
        self.feet.map(|foot| foot.sliding(v))
    }
}

/// A point that may be near a solution.
#[derive(Clone, Debug, Default)]
pub struct Candidate {
    /// Velocity and pusher yield.
    pub v: Vector<4>,
    /// (p_n, p_t) per contact.
    pub contacts: Vec<[f64; 2]>,
    /// Per foot.
    pub feet: [[f64; 2]; 3],
}

impl Candidate {
    /// Writes the point where the certificate reads it.
    pub fn store(&self, z: &mut Unknowns<1>) {
        z.v = [0, 1, 2].map(|i| Lanes([self.v[i]]));
        z.pusher_yield = Lanes([self.v[3]]);
        z.feet = self.feet.map(|f| f.map(|x| Lanes([x])));
        for (i, [n, t]) in self.contacts.iter().enumerate() {
            z.normal[i] = Lanes([*n]);
            z.tangential[i] = Lanes([*t]);
        }
    }
}
