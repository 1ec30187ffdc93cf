//! The linear system of one Newton step on [`Rows`], with all impulses eliminated: [`Linearised`].

use crate::rows::{Contact, Guess, Rows, Vector, dot, plus, solve_dense};

/// Linear model of one contact: d(p_n, p_t) = r − K (dγ, ds), K = [nn 0; tn tt].
#[derive(Clone, Copy, Debug)]
pub struct ContactStep {
    /// Increment at dγ = ds = 0.
    pub r: [f64; 2],
    /// −∂p_n/∂γ.
    pub nn: f64,
    /// −∂p_t/∂γ.
    pub tn: f64,
    /// −∂p_t/∂s.
    pub tt: f64,
}

/// Linear model of one foot: dp = r − K ds.
#[derive(Clone, Copy, Debug, Default)]
pub struct FootStep {
    /// Increment at ds = 0.
    pub r: [f64; 2],
    /// −∂p/∂s.
    pub k: [[f64; 2]; 2],
}

/// The stall pair, linearised: slack·d(F_stall − F) + pusher·dy = rhs.
#[derive(Clone, Copy, Debug, Default)]
pub struct StallStep {
    /// Coefficient of the slack.
    pub slack: f64,
    /// Coefficient of y.
    pub pusher: f64,
    /// Right-hand side.
    pub rhs: f64,
}

/// All rows of a problem, linearised at a guess.
#[derive(Clone, Debug, Default)]
pub struct Linearised {
    /// One per contact.
    pub contacts: Vec<ContactStep>,
    /// One per foot.
    pub feet: [FootStep; 3],
    /// The stall pair.
    pub stall: StallStep,
}

impl Linearised {
    /// Writes the full Newton step from `guess` to `full`; false where the condensed system is singular.
    pub fn step(&self, rows: &Rows, guess: &Guess, full: &mut Guess) -> bool {
        let (matrix, rhs) = self.condense(rows, guess);
        let Some(dv) = solve_dense(matrix, rhs, 0.0) else { return false };
        full.clone_from(guess);
        for ((p, c), step) in full.contacts.iter_mut().zip(&rows.contacts).zip(&self.contacts) {
            let (dgamma, ds) = (dot(&c.n, &dv), dot(&c.t, &dv));
            p[0] += step.r[0] - step.nn * dgamma;
            p[1] += step.r[1] - step.tn * dgamma - step.tt * ds;
        }
        for ((p, foot), step) in full.feet.iter_mut().zip(&rows.feet).zip(&self.feet) {
            let ds = foot.slip(&dv);
            for i in 0..2 {
                p[i] += step.r[i] - step.k[i][0] * ds[0] - step.k[i][1] * ds[1];
            }
        }
        full.v = plus(&guess.v, 1.0, &dv);
        full.v.iter().all(|x| x.is_finite())
    }

    /// (I + Σ WᵀKW) d(v, y) = rhs, with the stall pair as the fourth row.
    fn condense(&self, rows: &Rows, guess: &Guess) -> ([[f64; 4]; 4], [f64; 4]) {
        let mut m = [[0.0; 4]; 4];
        let mut rhs = [0.0; 4];
        let lag = rows.velocity(guess);
        for i in 0..3 {
            m[i][i] = 1.0;
            rhs[i] = lag[i] - guess.v[i];
        }
        for (foot, step) in rows.feet.iter().zip(&self.feet) {
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
        for (c, step) in rows.contacts.iter().zip(&self.contacts) {
            for i in 0..4 {
                rhs[i] += c.n[i] * step.r[0] + c.t[i] * step.r[1];
                for j in 0..4 {
                    m[i][j] += c.n[i] * step.nn * c.n[j] + c.t[i] * (step.tn * c.n[j] + step.tt * c.t[j]);
                }
            }
        }
        // the fourth row holds dF = rhs − row·d(v, y); the slack changes by −dF
        m[3] = m[3].map(|entry| self.stall.slack * entry);
        m[3][3] += self.stall.pusher;
        rhs[3] = self.stall.rhs + self.stall.slack * rhs[3];
        (m, rhs)
    }
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
    pub fn contact_velocity(&self, c: &Contact, v: &Vector<4>, p_n: f64) -> (f64, f64) {
        (dot(&c.n, v) + c.gap + self.compliance * p_n, dot(&c.t, v) + c.slip)
    }

    /// F / m.
    pub fn resistance(&self, guess: &Guess) -> f64 {
        self.contacts.iter().zip(&guess.contacts).map(|(c, p)| p[0] * c.n[3] + p[1] * c.t[3]).sum()
    }
}
