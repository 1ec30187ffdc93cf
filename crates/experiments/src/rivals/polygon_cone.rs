//! Support friction in inscribed polygons (paper §II-B): [`PolygonCone`], whose time step is a
//! linear complementarity problem (Stewart & Trinkle 1996) that Lemke's method solves.
//!
//! It differs from docs/method.md (3) to (9), (12) only in (8). Each foot's disc of radius b is a
//! regular polygon with its corners b e_j on the circle. Impulses f_j ≥ 0 act along the e_j, and λ
//! is the largest slip against one of them. In mass-normalised units (15):
//!
//! ```text
//! 0 ≤ f_j ⟂ e_j · s + λ ≥ 0,        0 ≤ λ ⟂ b − Σ f_j ≥ 0              each foot
//! 0 ≤ p_n ⟂ γ ≥ 0                                                      each contact
//! 0 ≤ p_± ⟂ ±s + λ ≥ 0,             0 ≤ λ ⟂ μ p_n − p_+ − p_− ≥ 0
//! 0 ≤ y   ⟂ F_stall h − F ≥ 0                                          the pusher
//! ```

use std::f64::consts::TAU;

use stickslip_dynamics::{StepProblem, TOLERANCE, Twist};

use super::lemke::{Lcp, LemkeEnd};

/// Compliances of a step without a rigid solution, the stiffest first, docs/method.md (14).
const COMPLIANCES: [f64; 3] = [1e-6, 1e-4, 1e-2];

/// A regular polygon in the place of each foot's friction disc, fixed to the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonCone {
    /// Number of sides.
    pub sides: usize,
    /// Turn of the first corner from +x, as a share of the angle of a side.
    pub turn: f64,
}

/// A step with polygons.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonStep {
    /// Twist at its end: that of the rigid problem where Lemke's method solves it, else of the
    /// first compliant one, else none.
    pub twist: Twist,
    /// Speed by which the pusher falls short of its command (m/s).
    pub pusher_yield: f64,
    /// Unknowns of the problem.
    pub unknowns: usize,
    /// End of Lemke's method on the rigid problem.
    pub rigid: LemkeEnd,
    /// True if no problem was solved, so that the object rests.
    pub rests: bool,
}

impl PolygonCone {
    /// Solves a step.
    #[must_use]
    pub fn step(&self, problem: &StepProblem) -> PolygonStep {
        let rho = (problem.inertia / problem.mass).sqrt();
        let columns = self.columns(problem, rho);
        let applied = &problem.applied;
        let free = [
            problem.twist.vx + applied.fx / problem.mass,
            problem.twist.vy + applied.fy / problem.mass,
            (problem.twist.omega + applied.torque / problem.inertia) * rho,
        ];
        let mut lcp = self.complementarity(problem, &columns, &free);
        let rigid = lcp.lemke(TOLERANCE);
        let compliant = |compliance| {
            for k in 0..problem.contacts.len() {
                *lcp.entry(4 * k, 4 * k) += compliance;
            }
            lcp.lemke(TOLERANCE).solution().cloned()
        };
        let solved = rigid.solution().cloned();
        let solved = solved.or_else(|| COMPLIANCES.into_iter().find_map(compliant));

        // v⁺ = v + Σ W p; less than the solver's tolerance is rest
        let rests = solved.is_none();
        let z = solved.unwrap_or_else(|| vec![0.0; columns.len()]);
        let v = [0, 1, 2].map(|axis| {
            let impulses = columns.iter().zip(&z).map(|(column, p)| column[axis] * p);
            free[axis] + impulses.sum::<f64>()
        });
        let still = rests || v.iter().all(|speed| speed.abs() <= TOLERANCE);
        let [vx, vy, scaled] = if still { [0.0; 3] } else { v };
        let omega = scaled / rho;
        PolygonStep {
            twist: Twist { vx, vy, omega },
            pusher_yield: problem.stall.map_or(0.0, |_| z[z.len() - 1]),
            unknowns: z.len(),
            rigid,
            rests,
        }
    }

    /// Mass-normalised twist that each unknown adds: p_n, p_+, p_−, λ of each contact, the f_j and
    /// λ of each foot, then y if the pusher can stall.
    fn columns(&self, problem: &StepProblem, rho: f64) -> Vec<[f64; 3]> {
        let column = |[x, y]: [f64; 2], [rx, ry]: [f64; 2]| [x, y, (rx * y - ry * x) / rho];
        let mut columns = Vec::new();
        for contact in &problem.contacts {
            let [x, y] = contact.normal;
            columns.extend([[x, y], [-y, x], [y, -x]].map(|e| column(e, contact.arm)));
            columns.push([0.0; 3]);
        }
        for foot in &problem.feet {
            columns.extend((0..self.sides).map(|j| {
                let (sin, cos) = libm::sincos(TAU / self.sides as f64 * (self.turn + j as f64));
                column([cos, sin], foot.arm)
            }));
            columns.push([0.0; 3]);
        }
        columns.extend(problem.stall.map(|_| [0.0; 3]));
        columns
    }

    /// The problem of these unknowns.
    fn complementarity(&self, problem: &StepProblem, columns: &[[f64; 3]], free: &[f64; 3]) -> Lcp {
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut lcp = Lcp::zeros(columns.len());
        for (i, column) in columns.iter().enumerate() {
            for (j, other) in columns.iter().enumerate() {
                *lcp.entry(i, j) = dot(column, other);
            }
            lcp.offset[i] = dot(column, free);
        }
        let last = columns.len() - 1;
        for (k, contact) in problem.contacts.iter().enumerate() {
            let ([x, y], [ux, uy]) = (contact.normal, contact.surface_velocity);
            let (i, slip) = (4 * k, ux * -y + uy * x);
            lcp.offset[i] += contact.gap / problem.h - (x * ux + y * uy);
            lcp.offset[i + 1] -= slip;
            lcp.offset[i + 2] += slip;
            *lcp.entry(i + 3, i) = contact.mu;
            lcp.couple(i + 1, i + 3, 1.0);
            lcp.couple(i + 2, i + 3, 1.0);
            if let Some([dx, dy]) = contact.yields.filter(|_| problem.stall.is_some()) {
                lcp.couple(i, last, x * dx + y * dy);
                lcp.couple(i + 1, last, x * dy - y * dx);
                lcp.couple(i + 2, last, y * dx - x * dy);
            }
        }
        for (k, foot) in problem.feet.iter().enumerate() {
            let first = 4 * problem.contacts.len() + k * (self.sides + 1);
            let slip = first + self.sides;
            (first..slip).for_each(|j| lcp.couple(j, slip, 1.0));
            lcp.offset[slip] = foot.bound / problem.mass;
        }
        if let Some(impulse) = problem.stall {
            lcp.offset[last] = impulse / problem.mass;
        }
        lcp
    }
}

impl Lcp {
    /// Lets unknown `j` add to row i, and unknown `i` take as much from row j.
    fn couple(&mut self, i: usize, j: usize, by: f64) {
        *self.entry(i, j) = by;
        *self.entry(j, i) = -by;
    }
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::{Outcome, StepSolution, solve};
    use stickslip_testkit::{Corpus, residual_si};

    use super::*;

    /// On a frictionless support, where polygon and disc are the same, a solution is one of the
    /// nonlinear problem, by a residual that shares no code with either. Lemke's method finds one
    /// nearly always where the search over contact modes does.
    #[test]
    fn contacts_and_stall_are_those_of_the_nonlinear_problem() {
        let corpus = Corpus { seed: 3 };
        let cone = PolygonCone {
            sides: 4,
            turn: 0.0,
        };
        let (mut solved, mut missed, mut stalled) = (0, 0, 0);
        for index in 0..600 {
            let mut problem = corpus.problem(index);
            problem.feet.iter_mut().for_each(|foot| foot.bound = 0.0);
            let step = cone.step(&problem);
            let Some(z) = step.rigid.solution() else {
                let (_, report) = solve(&problem);
                missed += usize::from(report.outcome == Outcome::Solved);
                continue;
            };
            let impulse = |k: usize| problem.mass * z[k];
            let contacts = 0..problem.contacts.len();
            let solution = StepSolution {
                twist: step.twist,
                normal: contacts.clone().map(|k| impulse(4 * k)).collect(),
                tangential: contacts
                    .map(|k| impulse(4 * k + 1) - impulse(4 * k + 2))
                    .collect(),
                feet: [[0.0; 2]; 3],
                pusher_yield: step.pusher_yield,
            };
            let residual = residual_si(&problem, &solution);
            assert!(residual < 1e-8, "{index}: {residual}");
            solved += 1;
            stalled += usize::from(step.pusher_yield > 1e-6);
        }
        assert!(
            solved > 400 && stalled > 20,
            "{solved} solved, {stalled} stalled"
        );
        assert!(missed < 10, "{missed} missed");
    }
}
