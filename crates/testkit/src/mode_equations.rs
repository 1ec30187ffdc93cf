//! The smooth equations of one contact mode and their damped Newton iteration: [`ModeEquations`].
//!
//! Unknowns, scaled: z, y, then the impulses that the mode leaves free. Rows: z − z_free − Σ c p +
//! Σ_sliding b_k J_kᵀ s_k/σ_k = 0 with σ_k = sqrt(|s_k|² + ε²), then the velocities that the mode
//! holds at zero, then the drive. Only the sliding feet are not linear.

use nalgebra::{DMatrix, DVector, SVD};
use stickslip_dynamics::StepSolution;

use crate::scaled_problem::{Column, ScaledProblem, dot3};
use crate::vector::left;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ContactMode {
    Separate,
    Stick,
    /// Slip with this sign of s.
    Slip(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FeetMode {
    Slide,
    Pivot(usize),
    Stuck,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DriveMode {
    Commanded,
    Stalled,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mode {
    pub contacts: Vec<ContactMode>,
    pub feet: FeetMode,
    pub drive: DriveMode,
}

/// A component of a solution's impulses.
#[derive(Clone, Copy)]
enum Component {
    Normal(usize),
    Tangential(usize),
    Foot(usize, usize),
}

/// One unknown impulse: its column in Newton's law, its projection on the drive's direction, and
/// its share of each component of the solution.
struct Impulse {
    column: Column,
    drive: f64,
    components: Vec<(Component, f64)>,
}

pub(crate) struct ModeEquations<'a> {
    scaled: &'a ScaledProblem<'a>,
    impulses: Vec<Impulse>,
    sliding: Vec<usize>,
    largest_term: f64,
    linear: DMatrix<f64>,
    offset: DVector<f64>,
}

/// Index of y; impulses follow.
const YIELD: usize = 3;
/// Roundings ε of |s_k|, relative to the fastest speed, one after the other.
const ROUNDINGS: [f64; 6] = [0.3, 0.03, 1e-3, 1e-5, 1e-8, 0.0];
const ITERATIONS: usize = 40;
const HALVINGS: usize = 10;
/// The equations are solved where the largest row is below this times the largest term.
const CONVERGED: f64 = 1e-11;
const ROUNDING_ERROR: f64 = 1e-15;
/// Least divisor of a slip: the square of its inverse is still finite.
const SHORTEST: f64 = 1e-60;
/// Singular values below this count as zero: directions in which a mode determines nothing.
const RANK: f64 = 1e-11;

impl<'a> ModeEquations<'a> {
    pub fn new(scaled: &'a ScaledProblem<'a>, mode: &Mode) -> Self {
        let impulses: Vec<Impulse> = contact_impulses(scaled, mode)
            .into_iter()
            .chain(foot_impulses(scaled, mode))
            .collect();
        let zero = zero_velocities(scaled, mode);
        let n = YIELD + 1 + impulses.len();
        let mut linear = DMatrix::zeros(3 + zero.len() + 1, n);
        let mut offset = DVector::zeros(linear.nrows());
        fill_momentum(scaled, &impulses, &mut linear, &mut offset);
        for (row, (velocity, yielding, constant)) in zero.into_iter().enumerate() {
            (0..3).for_each(|axis| linear[(3 + row, axis)] = velocity[axis]);
            linear[(3 + row, YIELD)] = yielding;
            offset[3 + row] = constant;
        }
        fill_drive(scaled, mode.drive, &impulses, &mut linear, &mut offset);
        let slides = |k: &usize| scaled.bound(*k) > 0.0 && !is_stuck(mode.feet, *k);
        let largest_term = (0..3).map(|k| scaled.bound(k)).fold(1.0, f64::max);
        Self {
            scaled,
            impulses,
            sliding: (0..3).filter(slides).collect(),
            largest_term,
            linear,
            offset,
        }
    }

    /// The mode's solution reached from twist `start`, inequalities unchecked; `None` where the
    /// iteration fails.
    pub fn solve(&self, start: &Column) -> Option<StepSolution> {
        let mut x = DVector::zeros(self.linear.ncols());
        x.rows_mut(0, 3).copy_from_slice(start);
        let roundings = if self.sliding.is_empty() {
            &[0.0]
        } else {
            &ROUNDINGS[..]
        };
        for &rounding in roundings {
            self.newton(&mut x, rounding)?;
        }
        (self.rows(&x, 0.0).amax() < CONVERGED * self.largest_term).then(|| self.solution(&x))
    }

    /// Newton's iteration at a fixed rounding, until the rows no longer shrink.
    fn newton(&self, x: &mut DVector<f64>, rounding: f64) -> Option<()> {
        for _ in 0..ITERATIONS {
            let rows = self.rows(x, rounding);
            if rows.amax() < ROUNDING_ERROR * self.largest_term {
                break;
            }
            let svd =
                SVD::try_new_unordered(self.jacobian(x, rounding), true, true, f64::EPSILON, 400)?;
            let step = svd.solve(&rows, RANK).ok()?;
            let Some(next) = self.damped(x, &step, rounding, rows.norm()) else {
                break;
            };
            *x = next;
        }
        Some(())
    }

    /// The first of the halved steps that shrinks the rows.
    fn damped(
        &self,
        x: &DVector<f64>,
        step: &DVector<f64>,
        rounding: f64,
        norm: f64,
    ) -> Option<DVector<f64>> {
        let trial = |halvings: usize| x - step * 0.5_f64.powi(halvings as i32);
        (0..HALVINGS)
            .map(trial)
            .find(|next| self.rows(next, rounding).norm() < norm)
    }

    fn slip(&self, x: &DVector<f64>, k: usize, rounding: f64) -> ([Column; 2], [f64; 2], f64) {
        let rows = self.scaled.foot(k);
        let slip = rows.map(|row| dot3(&row, &[x[0], x[1], x[2]]));
        let length = libm::hypot(libm::hypot(slip[0], slip[1]), rounding);
        (rows, slip, length.max(SHORTEST))
    }

    fn rows(&self, x: &DVector<f64>, rounding: f64) -> DVector<f64> {
        let mut rows = &self.linear * x + &self.offset;
        for &k in &self.sliding {
            let (foot, slip, length) = self.slip(x, k, rounding);
            for axis in 0..3 {
                rows[axis] += self.scaled.bound(k)
                    * (foot[0][axis] * slip[0] + foot[1][axis] * slip[1])
                    / length;
            }
        }
        rows
    }

    fn jacobian(&self, x: &DVector<f64>, rounding: f64) -> DMatrix<f64> {
        let mut jacobian = self.linear.clone();
        for &k in &self.sliding {
            let (foot, slip, length) = self.slip(x, k, rounding);
            let along: [f64; 3] =
                [0, 1, 2].map(|axis| (foot[0][axis] * slip[0] + foot[1][axis] * slip[1]) / length);
            for (i, j) in (0..9).map(|cell| (cell / 3, cell % 3)) {
                let spread =
                    foot[0][i] * foot[0][j] + foot[1][i] * foot[1][j] - along[i] * along[j];
                jacobian[(i, j)] += self.scaled.bound(k) / length * spread;
            }
        }
        jacobian
    }

    fn solution(&self, x: &DVector<f64>) -> StepSolution {
        let contacts = self.scaled.problem.contacts.len();
        let mut solution = StepSolution {
            twist: self.scaled.unscale_twist(&[x[0], x[1], x[2]]),
            normal: vec![0.0; contacts],
            tangential: vec![0.0; contacts],
            pusher_yield: x[YIELD] * self.scaled.speed(),
            ..StepSolution::default()
        };
        for &k in &self.sliding {
            let (_, slip, length) = self.slip(x, k, 0.0);
            solution.feet[k] = slip.map(|s| -self.scaled.problem.feet[k].bound * s / length);
        }
        for (impulse, value) in self.impulses.iter().zip(x.iter().skip(YIELD + 1)) {
            for &(component, share) in &impulse.components {
                *component_mut(&mut solution, component) += share * value * self.scaled.impulse();
            }
        }
        solution
    }
}

fn component_mut(solution: &mut StepSolution, component: Component) -> &mut f64 {
    match component {
        Component::Normal(i) => &mut solution.normal[i],
        Component::Tangential(i) => &mut solution.tangential[i],
        Component::Foot(k, axis) => &mut solution.feet[k][axis],
    }
}

fn is_stuck(feet: FeetMode, k: usize) -> bool {
    feet == FeetMode::Stuck || feet == FeetMode::Pivot(k)
}

/// Impulses of the closed contacts: normal and tangential where one sticks, one along the friction
/// cone's edge where it slips.
fn contact_impulses(scaled: &ScaledProblem, mode: &Mode) -> Vec<Impulse> {
    let mut all = vec![];
    for (i, (contact, &contact_mode)) in scaled
        .problem
        .contacts
        .iter()
        .zip(&mode.contacts)
        .enumerate()
    {
        let mut along = |normal: f64, tangential: f64| {
            let (n, t) = (contact.normal, left(contact.normal));
            let direction = [
                normal * n[0] + tangential * t[0],
                normal * n[1] + tangential * t[1],
            ];
            all.push(Impulse {
                column: scaled.column(direction, contact.arm),
                drive: scaled.yielding(contact, direction),
                components: vec![
                    (Component::Normal(i), normal),
                    (Component::Tangential(i), tangential),
                ],
            });
        };
        match contact_mode {
            ContactMode::Separate => {}
            ContactMode::Slip(sign) => along(1.0, -contact.mu * sign),
            ContactMode::Stick => {
                along(1.0, 0.0);
                along(0.0, 1.0);
            }
        }
    }
    all
}

fn foot_impulses(scaled: &ScaledProblem, mode: &Mode) -> Vec<Impulse> {
    let stuck = (0..3).filter(|&k| is_stuck(mode.feet, k));
    let axes = stuck.flat_map(|k| (0..2).map(move |axis| (k, axis)));
    let impulse = |(k, axis)| Impulse {
        column: scaled.foot(k)[axis],
        drive: 0.0,
        components: vec![(Component::Foot(k, axis), 1.0)],
    };
    axes.map(impulse).collect()
}

/// Velocities that a mode holds at zero: coefficients of z and of y, and the constant.
fn zero_velocities(scaled: &ScaledProblem, mode: &Mode) -> Vec<(Column, f64, f64)> {
    let mut rows = vec![];
    for (c, &contact_mode) in scaled.problem.contacts.iter().zip(&mode.contacts) {
        if contact_mode != ContactMode::Separate {
            rows.push((
                scaled.normal(c),
                scaled.yielding(c, c.normal),
                scaled.gap_offset(c),
            ));
        }
        if contact_mode == ContactMode::Stick {
            rows.push((
                scaled.tangent(c),
                scaled.yielding(c, left(c.normal)),
                scaled.slip_offset(c),
            ));
        }
    }
    match mode.feet {
        FeetMode::Slide => {}
        FeetMode::Pivot(k) => rows.extend(scaled.foot(k).map(|row| (row, 0.0, 0.0))),
        FeetMode::Stuck => rows
            .extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|row| (row, 0.0, 0.0))),
    }
    rows
}

fn fill_momentum(
    scaled: &ScaledProblem,
    impulses: &[Impulse],
    linear: &mut DMatrix<f64>,
    offset: &mut DVector<f64>,
) {
    let free = scaled.free();
    for axis in 0..3 {
        linear[(axis, axis)] = 1.0;
        offset[axis] = -free[axis];
        for (j, impulse) in impulses.iter().enumerate() {
            linear[(axis, YIELD + 1 + j)] = -impulse.column[axis];
        }
    }
}

/// The last row: y = 0, or the drive's impulse at its limit.
fn fill_drive(
    scaled: &ScaledProblem,
    drive: DriveMode,
    impulses: &[Impulse],
    linear: &mut DMatrix<f64>,
    offset: &mut DVector<f64>,
) {
    let row = linear.nrows() - 1;
    match drive {
        DriveMode::Commanded => linear[(row, YIELD)] = 1.0,
        DriveMode::Stalled => {
            offset[row] = -scaled.stall_impulse().unwrap_or(0.0);
            impulses
                .iter()
                .enumerate()
                .for_each(|(j, impulse)| linear[(row, YIELD + 1 + j)] = impulse.drive);
        }
    }
}
