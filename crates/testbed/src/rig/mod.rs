//! The rig: an object on bristles, compliant contacts, a drive that lags, ripples and stalls, in
//! steps of 80 µs or less.
//!
//! Nothing here solves a complementarity problem: every force is a function of the state, and the
//! state is integrated by semi-implicit Euler steps, v ← v + h M⁻¹ f(q, v), q ← q + h v.

#[cfg(test)]
mod closed_forms;
mod contact;
mod drive;
mod pressure;
mod random_field;
mod random_stream;
mod state;
mod support_friction;
mod table_friction;

use stickslip_dynamics::{Feet, Friction, Scene};

pub use contact::ContactLaw;
pub use drive::{DriveSettings, Spindle};
pub use pressure::{PressureDistribution, SupportPoint};
use state::RigState;
pub use support_friction::Bristles;
pub use table_friction::TableFriction;

use crate::touch::TouchSensors;
use crate::trace::{Frame, Trace};
use crate::trial::{Trial, TrialError};

/// Most time steps of an experiment: some minutes of computing, and hours of an object of usual
/// inertia.
const MOST_STEPS: f64 = 2e8;

/// Friction is averaged over frames in which the object moves faster than this (m/s).
const MOVING: f64 = 1e-4;

/// The parameters of the rig: all that a user does not know.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Friction of object and table, the mean over the table.
    pub mu_s: f64,
    /// Friction of object and pusher.
    pub mu_p: f64,
    /// Friction of object and fixels.
    pub mu_f: f64,
    /// Distribution of the object's weight over the table.
    pub pressure: PressureDistribution,
    /// Variation of friction over the table.
    pub table: TableFriction,
    /// The bristles between object and table.
    pub bristles: Bristles,
    /// Contacts with pusher and fixels.
    pub contact: ContactLaw,
    /// The pusher's drive.
    pub drive: DriveSettings,
    /// The touch sensors on the fixels.
    pub touch: TouchSensors,
    /// Longest time step (s); stiff contacts shorten it.
    pub longest_step: f64,
}

impl Rig {
    /// The usual rig for a scene, with the scene's friction, and its feet and stall force where it
    /// has them.
    pub fn of(scene: &Scene) -> Self {
        let Friction {
            mu_s, mu_p, mu_f, ..
        } = scene.nominal;
        let pressure = match scene.feet {
            Feet::Tripod { .. } => PressureDistribution::default(),
            Feet::Known { positions, loads } => {
                let point = |k: usize| SupportPoint {
                    position: positions[k],
                    load: loads[k],
                };
                PressureDistribution::Points([0, 1, 2].map(point).to_vec())
            }
        };
        let default = Spindle::default();
        let spindle = Spindle {
            stall_force: scene.pusher.stall_force.unwrap_or(default.stall_force),
            ..default
        };
        Self {
            mu_s,
            mu_p,
            mu_f,
            pressure,
            table: TableFriction::default(),
            bristles: Bristles::default(),
            contact: ContactLaw::default(),
            drive: DriveSettings {
                spindle: Some(spindle),
                ..DriveSettings::default()
            },
            touch: TouchSensors::default(),
            longest_step: 8e-5,
        }
    }

    /// Runs an experiment.
    ///
    /// # Errors
    /// [`TrialError`]: the camera's rate or a friction value is none, bodies overlap at the start,
    /// the object would tip, or there are too many steps, as with an inertia that is far too small.
    pub fn run(&self, trial: &Trial<'_>) -> Result<Trace, TrialError> {
        self.run_observed(trial, &mut |_| ())
    }

    /// Runs an experiment like [`run`](Self::run); `progress` gets the number of finished frames,
    /// at every time step.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_observed(
        &self,
        trial: &Trial<'_>,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Trace, TrialError> {
        trial.check([
            ("mu_s", self.mu_s),
            ("mu_p", self.mu_p),
            ("mu_f", self.mu_f),
        ])?;
        let mut state = RigState::new(self, trial)?;
        let steps = (1.0 / (trial.rate * state.longest_step())).ceil();
        let h = 1.0 / (trial.rate * steps);
        let all = steps * trial.frames() as f64;
        if all > MOST_STEPS {
            return Err(TrialError::Steps {
                steps: all,
                length: h,
                most: MOST_STEPS,
            });
        }

        let mut frames = vec![state.frame(0.0, 1.0)];
        let mut friction = Mean::default();
        for k in 1..trial.frames() {
            for step in 0..steps as u32 {
                progress(k);
                state.step(trial.time(k - 1) + h * f64::from(step), h);
            }
            let frame = state.frame(trial.time(k), 1.0 / trial.rate);
            if moves(&frame, trial.scene) {
                friction.add(state.mean_friction());
            }
            frames.push(frame);
        }
        self.touch.write_readings(&mut frames, trial);

        let mu_s = friction.value().unwrap_or_else(|| state.mean_friction());
        let friction = Friction {
            mu_s,
            mu_p: self.mu_p,
            mu_f: self.mu_f,
            d_tri: state.tripod_radius(),
        };
        Ok(Trace {
            friction,
            frames,
            unsolved: 0,
        })
    }
}

fn moves(frame: &Frame, scene: &Scene) -> bool {
    let v = frame.twist;
    (v.vx * v.vx + v.vy * v.vy).sqrt() + scene.object.gyration_radius() * v.omega.abs() > MOVING
}

/// A mean.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1.0;
    }

    fn value(&self) -> Option<f64> {
        (self.count > 0.0).then_some(self.sum / self.count)
    }
}
