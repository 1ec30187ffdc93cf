//! The friction that three feet can exert together: [`LimitSurface`].
//!
//! The total friction of an object that slips in direction e, F(e) = Σ bound_k J_kᵀ u_k with u_k
//! the direction of foot k's slip J_k e, does not depend on the speed. It lies on the boundary of a
//! convex body, whose outward normal there is e (Goyal, Ruina and Papadopoulos 1991). The boundary
//! has a flat facet where the object pivots about a loaded foot, whose impulse may then be any
//! within its bound.

use crate::solver::exhaustive::scalar_ncp::ScalarFoot;
use crate::solver::vector::{Vector, add_scaled, norm};

/// Slip per unit of e up to which a foot stands.
const STANDS: f64 = 1e-12;

/// The boundary of the set of loads that three feet can exert.
pub struct LimitSurface {
    feet: [ScalarFoot; 3],
}

/// The friction that belongs to a direction of slip.
#[derive(Clone, Copy, Debug, Default)]
pub struct SlipFriction {
    /// F.
    pub total: Vector<3>,
    /// The share of each foot: bound times its direction of slip; zero where it stands.
    pub feet: [[f64; 2]; 3],
    /// Its dissipation per unit of e, F·e = Σ bound |J e|.
    pub loss: f64,
}

/// The object pivots about a foot.
#[derive(Clone, Copy, Debug)]
pub struct Pivot {
    /// The foot.
    pub foot: usize,
    /// The unit direction of slip.
    pub e: Vector<3>,
    /// The friction of the other feet.
    pub others: SlipFriction,
}

impl LimitSurface {
    /// Of these feet.
    pub fn new(feet: &[ScalarFoot; 3]) -> Self {
        Self { feet: *feet }
    }

    /// The friction that opposes slip in direction `e`, of any length.
    pub fn friction(&self, e: &Vector<3>) -> SlipFriction {
        let mut friction = SlipFriction::default();
        let stands = STANDS * norm(e);
        for (k, foot) in self.feet.iter().enumerate() {
            let s = foot.slip(e);
            let length = norm(&s);
            if length > stands {
                friction.add(k, foot, s.map(|x| foot.bound * x / length));
                friction.loss += foot.bound * length;
            }
        }
        friction
    }

    /// The change of the friction with `e`, a symmetric matrix with e in its null space; the part
    /// of feet that slip.
    pub fn change(&self, e: &Vector<3>) -> [Vector<3>; 3] {
        let mut change = [[0.0; 3]; 3];
        let stands = STANDS * norm(e);
        for foot in &self.feet {
            let s = foot.slip(e);
            let length = norm(&s);
            if length <= stands {
                continue;
            }
            // slip across its direction turns the impulse
            let across = wrench(foot, &[-s[1] / length, s[0] / length]);
            for i in 0..3 {
                for j in 0..3 {
                    change[i][j] += foot.bound / length * across[i] * across[j];
                }
            }
        }
        change
    }

    /// The pivots about each foot, in both directions.
    pub fn pivots(&self) -> [Pivot; 6] {
        std::array::from_fn(|i| {
            let foot = i / 2;
            let turn = if i % 2 == 0 { 1.0 } else { -1.0 };
            let d = [-self.feet[foot].jx, -self.feet[foot].jy, 1.0];
            let e = d.map(|x| turn * x / norm(&d));
            Pivot {
                foot,
                e,
                others: self.friction(&e),
            }
        })
    }

    /// The friction of a pivot whose foot exerts `impulse`; `None` where that exceeds its bound.
    pub fn on_facet(&self, pivot: &Pivot, impulse: [f64; 2]) -> Option<SlipFriction> {
        let foot = &self.feet[pivot.foot];
        let mut friction = pivot.others;
        friction.add(pivot.foot, foot, impulse);
        (norm(&impulse) <= foot.bound).then_some(friction)
    }
}

impl SlipFriction {
    /// A multiple of it.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            total: self.total.map(|x| factor * x),
            feet: self.feet.map(|f| f.map(|x| factor * x)),
            loss: factor * self.loss,
        }
    }

    fn add(&mut self, k: usize, foot: &ScalarFoot, impulse: [f64; 2]) {
        self.feet[k] = impulse;
        self.total = add_scaled(&self.total, 1.0, &wrench(foot, &impulse));
    }
}

/// J_kᵀ p.
fn wrench(foot: &ScalarFoot, p: &[f64; 2]) -> Vector<3> {
    [p[0], p[1], foot.jx * p[0] + foot.jy * p[1]]
}
