//! Impulses that belong to a given twist: [`impulses_for_twist`], a convex feasibility problem.
//!
//! Once v⁺ and y are known, every contact is open or closed and every slip velocity zero or not,
//! and the remaining problem is linear: Newton–Euler, friction on the cone's edge where something
//! slips, friction inside the cone where it sticks. Where several sets of impulses do (a face that
//! sticks, an object wedged at rest) the one of least norm is returned.

use stickslip_dynamics::{ContactPoint, StepProblem, StepSolution, Twist};

use crate::conic_program::{Affine, ConicProgram, Optimum};
use crate::residual::residual_si;
use crate::scaled_problem::{Column, ScaledProblem, dot3};
use crate::vector::left;

/// Relative to the problem's fastest speed: slower than this is not moving.
const STILL: f64 = 1e-9;

/// Worst accepted residual, relative to the same.
const ACCURACY: f64 = 1e-8;

/// Condition of the twist on a direction.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Still,
    Moving(f64),
}

/// A solution with the given `twist` and pusher yield; `None` where no impulses go with it to 1e-8
/// of the problem's fastest speed.
#[must_use]
pub fn impulses_for_twist(
    problem: &StepProblem,
    twist: Twist,
    pusher_yield: f64,
) -> Option<StepSolution> {
    let scaled = ScaledProblem::new(problem);
    let known = KnownTwist {
        z: scaled.scale_twist(twist),
        y: pusher_yield / scaled.speed(),
        scaled,
    };
    let solves =
        |solution: &StepSolution| residual_si(problem, solution) < ACCURACY * known.scaled.speed();
    known
        .program()?
        .attempts()
        .map(|optimum| known.solution(&optimum, twist, pusher_yield))
        .find(solves)
}

/// A step whose motion is known.
struct KnownTwist<'a> {
    scaled: ScaledProblem<'a>,
    z: Column,
    y: f64,
}

impl KnownTwist<'_> {
    fn contacts(&self) -> &[ContactPoint] {
        &self.scaled.problem.contacts
    }

    /// Two impulses per contact, two per foot.
    fn unknowns(&self) -> usize {
        2 * self.contacts().len() + 6
    }

    fn combination(&self, terms: &[(usize, f64)], constant: f64) -> Affine {
        let mut row = vec![0.0; self.unknowns()];
        terms.iter().for_each(|(j, value)| row[*j] += value);
        (row, constant)
    }

    fn program(&self) -> Option<ConicProgram> {
        let mut conic = ConicProgram::new(self.unknowns());
        conic.weight.fill(1.0);
        self.momentum_rows()
            .into_iter()
            .for_each(|row| conic.equal(row));
        for (i, contact) in self.contacts().iter().enumerate() {
            self.contact_rows(&mut conic, i, contact)?;
        }
        (0..3).for_each(|k| self.foot_rows(&mut conic, k));
        self.stall_rows(&mut conic)?;
        Some(conic)
    }

    fn columns(&self) -> Vec<Column> {
        let contacts = self
            .contacts()
            .iter()
            .flat_map(|c| [self.scaled.normal(c), self.scaled.tangent(c)]);
        contacts
            .chain((0..3).flat_map(|k| self.scaled.foot(k)))
            .collect()
    }

    fn momentum_rows(&self) -> [Affine; 3] {
        let (columns, free) = (self.columns(), self.scaled.free());
        [0, 1, 2].map(|axis| {
            (
                columns.iter().map(|c| c[axis]).collect(),
                free[axis] - self.z[axis],
            )
        })
    }

    fn contact_rows(
        &self,
        conic: &mut ConicProgram,
        i: usize,
        contact: &ContactPoint,
    ) -> Option<()> {
        let (normal, tangential) = (2 * i, 2 * i + 1);
        match self.gap_motion(contact) {
            Motion::Moving(speed) if speed < 0.0 => return None,
            Motion::Moving(_) => {
                conic.equal(self.combination(&[(normal, 1.0)], 0.0));
                conic.equal(self.combination(&[(tangential, 1.0)], 0.0));
            }
            Motion::Still => {
                conic.at_least(self.combination(&[(normal, 1.0)], 0.0));
                self.friction_rows(conic, i, contact);
            }
        }
        Some(())
    }

    fn friction_rows(&self, conic: &mut ConicProgram, i: usize, contact: &ContactPoint) {
        let (normal, tangential) = (2 * i, 2 * i + 1);
        match self.slip_motion(contact) {
            Motion::Moving(slip) => {
                conic.equal(self.combination(
                    &[(tangential, 1.0), (normal, contact.mu * slip.signum())],
                    0.0,
                ));
            }
            Motion::Still => {
                conic.at_least(self.combination(&[(normal, contact.mu), (tangential, 1.0)], 0.0));
                conic.at_least(self.combination(&[(normal, contact.mu), (tangential, -1.0)], 0.0));
            }
        }
    }

    fn foot_rows(&self, conic: &mut ConicProgram, k: usize) {
        let (x, bound) = (2 * self.contacts().len() + 2 * k, self.scaled.bound(k));
        let slip = self.scaled.foot(k).map(|row| dot3(&row, &self.z));
        let length = libm::hypot(slip[0], slip[1]);
        if length > STILL {
            (0..2).for_each(|axis| {
                conic.equal(self.combination(&[(x + axis, 1.0)], bound * slip[axis] / length))
            });
        } else {
            let parts = [x, x + 1].map(|j| self.combination(&[(j, 1.0)], 0.0));
            conic.cone(self.combination(&[], bound), parts);
        }
    }

    fn stall_rows(&self, conic: &mut ConicProgram) -> Option<()> {
        let limit = self.scaled.stall_impulse();
        match (limit, motion(self.y)) {
            (None, Motion::Still) => {}
            (None, Motion::Moving(_)) => return None,
            (Some(_), Motion::Moving(y)) if y < 0.0 => return None,
            (Some(limit), Motion::Moving(_)) => conic.equal(self.reserve(limit)),
            (Some(limit), Motion::Still) => conic.at_least(self.reserve(limit)),
        }
        Some(())
    }

    /// F_stall h − F.
    fn reserve(&self, limit: f64) -> Affine {
        let terms = |(i, c): (usize, &ContactPoint)| {
            let tangent = left(c.normal);
            [
                (2 * i, -self.scaled.yielding(c, c.normal)),
                (2 * i + 1, -self.scaled.yielding(c, tangent)),
            ]
        };
        let terms: Vec<_> = self.contacts().iter().enumerate().flat_map(terms).collect();
        self.combination(&terms, limit)
    }

    fn gap_motion(&self, c: &ContactPoint) -> Motion {
        let yielded = self.y * self.scaled.yielding(c, c.normal);
        motion(dot3(&self.scaled.normal(c), &self.z) + self.scaled.gap_offset(c) + yielded)
    }

    fn slip_motion(&self, c: &ContactPoint) -> Motion {
        let yielded = self.y * self.scaled.yielding(c, left(c.normal));
        motion(dot3(&self.scaled.tangent(c), &self.z) + self.scaled.slip_offset(c) + yielded)
    }

    fn solution(&self, optimum: &Optimum, twist: Twist, pusher_yield: f64) -> StepSolution {
        let impulse = |j: usize| optimum.x[j] * self.scaled.impulse();
        let contacts = self.contacts().len();
        let foot = |k: usize| [impulse(2 * (contacts + k)), impulse(2 * (contacts + k) + 1)];
        StepSolution {
            twist,
            normal: (0..contacts).map(|i| impulse(2 * i)).collect(),
            tangential: (0..contacts).map(|i| impulse(2 * i + 1)).collect(),
            feet: [foot(0), foot(1), foot(2)],
            pusher_yield,
        }
    }
}

fn motion(speed: f64) -> Motion {
    if speed.abs() > STILL {
        Motion::Moving(speed)
    } else {
        Motion::Still
    }
}
