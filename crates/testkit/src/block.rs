//! Closed forms of the time-stepping scheme itself, not of continuous time: [`Block`] sliding,
//! spinning and pivoting on its tripod.
//!
//! The block stands on an equal tripod of radius d with support friction bound b = μ m g h in all
//! (b/3 per foot) and has no contacts; only the loads that a function's arguments name act on it.
//! With h fixed, every step of the scheme is exact, so tests may ask for rounding accuracy.

use stickslip_dynamics::{Foot, StepProblem, StepSolution, Twist, Wrench};

/// A block on three equally loaded feet, the first one in direction +x from the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Mass m in kg.
    pub mass: f64,
    /// Moment of inertia J (kg m²).
    pub inertia: f64,
    /// Step h in s.
    pub h: f64,
    /// Support friction μ_s.
    pub mu_s: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
    /// Tripod radius d in m.
    pub d_tri: f64,
}

/// Stop of a motion that loses the same speed in every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The first step at whose end the speed is zero; 0 for a motion that never began.
    pub steps: u64,
    /// The travel until then, h Σ v_k (m or rad).
    pub travel: f64,
}

impl Block {
    /// b = μ m g h, the largest friction impulse of all feet together (N s).
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.mu_s * self.mass * self.gravity * self.h
    }

    /// The step problem of this block from `twist` under the impulse `applied`.
    #[must_use]
    pub fn problem(&self, twist: Twist, applied: Wrench) -> StepProblem {
        let bound = self.bound() / 3.0;
        let feet = self.directions().map(|e| Foot {
            arm: [self.d_tri * e[0], self.d_tri * e[1]],
            bound,
        });
        StepProblem {
            mass: self.mass,
            inertia: self.inertia,
            h: self.h,
            twist,
            applied,
            contacts: vec![],
            feet,
            stall: None,
        }
    }

    fn directions(&self) -> [[f64; 2]; 3] {
        let half_root_3 = 0.75_f64.sqrt();
        [[1.0, 0.0], [-0.5, half_root_3], [-0.5, -half_root_3]]
    }

    /// Speed lost per step in translation, μ g h (m/s).
    #[must_use]
    pub fn slide_loss(&self) -> f64 {
        self.mu_s * self.gravity * self.h
    }

    /// Angular speed lost per step in pure spin, μ m g h d / J (rad/s).
    #[must_use]
    pub fn spin_loss(&self) -> f64 {
        self.bound() * self.d_tri / self.inertia
    }

    /// Speed after step `k` of a pure translation that begins with `speed` ≥ 0 (m/s).
    #[must_use]
    pub fn slide_speed(&self, speed: f64, k: u64) -> f64 {
        remaining(speed, self.slide_loss(), k)
    }

    /// Angular speed after step `k` of a pure spin that begins with `omega` ≥ 0 (rad/s).
    #[must_use]
    pub fn spin_speed(&self, omega: f64, k: u64) -> f64 {
        remaining(omega, self.spin_loss(), k)
    }

    /// Place and time at which a pure translation of initial `speed` (m/s) stops; the friction must
    /// not be zero.
    #[must_use]
    pub fn slide_stop(&self, speed: f64) -> Stop {
        stop(speed, self.slide_loss(), self.h)
    }

    /// At which angle and when a pure spin of initial `omega` (rad/s) stops; friction and tripod
    /// radius must not be zero.
    #[must_use]
    pub fn spin_stop(&self, omega: f64) -> Stop {
        stop(omega, self.spin_loss(), self.h)
    }

    /// One step of pure translation along the unit vector `direction`: problem and solution.
    #[must_use]
    pub fn slide_step(&self, speed: f64, direction: [f64; 2]) -> (StepProblem, StepSolution) {
        let along = |s: f64| Twist {
            vx: s * direction[0],
            vy: s * direction[1],
            omega: 0.0,
        };
        let after = self.slide_speed(speed, 1);
        let friction = direction.map(|d| -self.mass * (speed - after) / 3.0 * d);
        let solution = StepSolution {
            twist: along(after),
            feet: [friction; 3],
            ..StepSolution::default()
        };
        (self.problem(along(speed), Wrench::default()), solution)
    }

    /// One step of pure counter-clockwise spin: problem and solution.
    #[must_use]
    pub fn spin_step(&self, omega: f64) -> (StepProblem, StepSolution) {
        let after = self.spin_speed(omega, 1);
        let size = if self.d_tri > 0.0 {
            self.inertia * (omega - after) / (3.0 * self.d_tri)
        } else {
            0.0
        };
        let feet = self.directions().map(|e| [size * e[1], -size * e[0]]);
        let spin = |omega| Twist {
            omega,
            ..Twist::default()
        };
        (
            self.problem(spin(omega), Wrench::default()),
            StepSolution {
                twist: spin(after),
                feet,
                ..StepSolution::default()
            },
        )
    }

    /// One step from rest in which an impulse turns the block counter-clockwise about its first
    /// foot, which sticks.
    ///
    /// The impulse is (`fx`, `fy`) at the centre of mass and the torque `torque` about it. Feet 2
    /// and 3 slide: they are √3 d from the pivot, their friction adds up to (0, b/√3) and to the
    /// torque −2 b d/√3 about the pivot. Angular momentum about the pivot (the centre of mass is at
    /// (−d, 0) from it) and Newton's law then give
    ///
    /// ```text
    /// (J + m d²) ω⁺ = torque − d fy − 2 b d/√3,    v⁺ = (0, −d ω⁺)
    /// p_1 = (−fx, −m d ω⁺ − fy − b/√3)             must lie in the disc of radius b/3
    /// ```
    ///
    /// Returns `None` where the load does not make the block pivot like this. The solution is
    /// unique, as without contacts the step is a strictly convex minimisation.
    #[must_use]
    pub fn pivot_step(&self, applied: Wrench) -> Option<(StepProblem, StepSolution)> {
        let (b, d, root_3) = (self.bound(), self.d_tri, 3.0_f64.sqrt());
        let omega = (applied.torque - d * applied.fy - 2.0 * b * d / root_3)
            / (self.inertia + self.mass * d * d);
        let stuck = [
            -applied.fx,
            -self.mass * d * omega - applied.fy - b / root_3,
        ];
        if omega <= 0.0 || libm::hypot(stuck[0], stuck[1]) > b / 3.0 {
            return None;
        }
        let (across, along) = (b / 6.0, b * 0.75_f64.sqrt() / 3.0);
        let twist = Twist {
            vx: 0.0,
            vy: -d * omega,
            omega,
        };
        let solution = StepSolution {
            twist,
            feet: [stuck, [across, along], [-across, along]],
            ..StepSolution::default()
        };
        Some((self.problem(Twist::default(), applied), solution))
    }
}

fn remaining(speed: f64, loss: f64, k: u64) -> f64 {
    (speed - k as f64 * loss).max(0.0)
}

fn stop(speed: f64, loss: f64, h: f64) -> Stop {
    let moving = (speed / loss).floor();
    let travel = h * (moving * speed - 0.5 * loss * moving * (moving + 1.0));
    Stop {
        steps: (speed / loss).ceil() as u64,
        travel,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residual::residual_si;

    const BLOCK: Block = Block {
        mass: 0.4,
        inertia: 3e-4,
        h: 1.0 / 30.0,
        mu_s: 0.21,
        gravity: 9.81,
        d_tri: 0.02,
    };

    #[test]
    fn slide_step_solves_the_step_moving_and_stopping() {
        for speed in [0.0, 0.01, 0.069, 0.2, 1.0] {
            let (problem, solution) = BLOCK.slide_step(speed, [0.6, -0.8]);
            assert!(residual_si(&problem, &solution) < 1e-15, "speed {speed}");
        }
    }

    #[test]
    fn spin_step_solves_the_step_moving_and_stopping() {
        for omega in [0.0, 0.5, 2.0, 10.0] {
            let (problem, solution) = BLOCK.spin_step(omega);
            assert!(residual_si(&problem, &solution) < 1e-15, "omega {omega}");
        }
    }

    #[test]
    fn slide_stop_equals_the_walked_sum() {
        let (mut speed, mut travel, mut steps) = (0.7, 0.0, 0);
        while speed > 0.0 {
            let (_, solution) = BLOCK.slide_step(speed, [1.0, 0.0]);
            speed = solution.twist.vx;
            travel += BLOCK.h * speed;
            steps += 1;
        }
        let stop = BLOCK.slide_stop(0.7);
        assert_eq!(stop.steps, steps);
        assert!((stop.travel - travel).abs() < 1e-14);
        assert!(BLOCK.slide_speed(0.7, steps - 1) > 0.0);
    }

    #[test]
    fn stop_tends_to_the_continuous_law_for_small_steps() {
        let fine = Block { h: 1e-6, ..BLOCK };
        let continuous = 0.5 * 0.3 * 0.3 / (fine.mu_s * fine.gravity);
        assert!((fine.slide_stop(0.3).travel / continuous - 1.0).abs() < 1e-5);
    }

    #[test]
    fn pivot_step_solves_the_step() {
        let b = BLOCK.bound();
        for (fx, turn) in [(0.0, 1.0), (0.25, 1.0), (-0.2, 3.0)] {
            let omega = turn * b * BLOCK.d_tri / BLOCK.inertia;
            let fy = -BLOCK.mass * BLOCK.d_tri * omega - b / 3.0_f64.sqrt() + 0.1 * b;
            let inertia = BLOCK.inertia + BLOCK.mass * BLOCK.d_tri * BLOCK.d_tri;
            let torque =
                inertia * omega + BLOCK.d_tri * fy + 2.0 * b * BLOCK.d_tri / 3.0_f64.sqrt();
            let (problem, solution) = BLOCK
                .pivot_step(Wrench {
                    fx: fx * b,
                    fy,
                    torque,
                })
                .expect("the load makes it pivot");
            assert!((solution.twist.omega / omega - 1.0).abs() < 1e-12);
            assert!(residual_si(&problem, &solution) < 1e-15);
        }
    }

    #[test]
    fn pivot_step_refuses_loads_that_slide_or_hold() {
        let b = BLOCK.bound();
        assert!(BLOCK.pivot_step(Wrench::default()).is_none());
        assert!(
            BLOCK
                .pivot_step(Wrench {
                    fx: 2.0 * b,
                    fy: 0.0,
                    torque: 1.0
                })
                .is_none()
        );
    }
}
