//! Belief of the extended Kalman filter: [`Belief`], a normal distribution of the object's pose and
//! twist, its friction and the force that disturbs it (docs/method.md (46)).

use nalgebra::{SMatrix, SVector};
use stickslip_dynamics::{Friction, Particle, Pose, Twist, Wrench};
use stickslip_filter::Gaussian;

use crate::estimate::{CrossCovariance, EstimateRow, Spread};
use crate::setup::{Limits, Setup};
use crate::tuning::JITTER;

/// Numbers of a state: x, y, θ (m, m, rad), v_x, v_y, ω (m/s, m/s, rad/s), ln β/β_nominal of the
/// four friction parameters, and w_app in units of its standard deviations.
pub(super) const STATES: usize = 13;

/// Index of the first number of the twist.
pub(super) const TWIST: usize = 3;
/// Index of the first number of friction. A step changes only the numbers before it.
pub(super) const FRICTION: usize = 6;
/// Index of the first number of the force.
const FORCE: usize = 10;

/// A state.
pub(super) type State = SVector<f64, STATES>;
/// A covariance of states, or a root of one.
pub(super) type StateMatrix = SMatrix<f64, STATES, STATES>;

/// Log-normal priors of the friction parameters (docs/model.md (33)).
#[derive(Clone, Debug)]
pub(super) struct FrictionPrior {
    nominal: Friction,
    /// Standard deviations of ln β; 0 where a parameter is known.
    stds: [f64; 4],
    limits: Friction<Limits>,
}

/// Mean and covariance of the state, with the priors that friction goes back to.
#[derive(Clone, Debug)]
pub(super) struct Belief {
    pub normal: Gaussian<STATES>,
    prior: FrictionPrior,
}

impl FrictionPrior {
    fn new(setup: &Setup) -> Self {
        let nominal = setup.scene.nominal;
        let mut stds = setup.uncertainty.friction.fields().map(|std| *std);
        for (std, nominal) in stds.iter_mut().zip(nominal.fields()) {
            // a parameter of 0 stays 0
            if *nominal <= 0.0 {
                *std = 0.0;
            }
        }
        if !setup.has_tripod() {
            stds[3] = 0.0;
        }
        Self {
            nominal,
            stds,
            limits: setup.filter.limits,
        }
    }

    /// β of a state, within the physical limits.
    fn of(&self, state: &State) -> Friction {
        let mut friction = self.nominal;
        let limits = self.limits.fields();
        for (k, value) in friction.fields_mut().into_iter().enumerate() {
            if self.stds[k] > 0.0 {
                let drawn = *value * libm::exp(state[FRICTION + k]);
                *value = drawn.clamp(limits[k].min, limits[k].max);
            }
        }
        friction
    }
}

impl Belief {
    /// The belief before anything has moved: at rest at a measured `pose` with its covariance,
    /// friction by its prior.
    pub fn at_rest(setup: &Setup, pose: Pose, covariance: &SMatrix<f64, 3, 3>) -> Self {
        let prior = FrictionPrior::new(setup);
        let mut normal = Gaussian {
            mean: State::zeros(),
            covariance: StateMatrix::zeros(),
        };
        for (k, std) in prior.stds.iter().enumerate() {
            normal.covariance[(FRICTION + k, FRICTION + k)] = std * std;
        }
        let mut belief = Self { normal, prior };
        belief.begin_anew(&[pose.x, pose.y, pose.theta].into(), covariance);
        belief
    }

    /// Restarts with the object at rest at a measured `pose` with its covariance. Only friction is
    /// kept.
    pub fn begin_anew(&mut self, pose: &SVector<f64, 3>, covariance: &SMatrix<f64, 3, 3>) {
        let Gaussian {
            mean,
            covariance: all,
        } = &mut self.normal;
        for k in 0..FRICTION {
            mean[k] = 0.0;
            all.row_mut(k).fill(0.0);
            all.column_mut(k).fill(0.0);
        }
        mean.fixed_rows_mut::<3>(0).copy_from(pose);
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(covariance);
    }

    /// Renews the force for what follows: it is independent of all before.
    pub fn renew_force(&mut self) {
        let Gaussian { mean, covariance } = &mut self.normal;
        for k in FORCE..STATES {
            mean[k] = 0.0;
            covariance.row_mut(k).fill(0.0);
            covariance.column_mut(k).fill(0.0);
            covariance[(k, k)] = 1.0;
        }
    }

    /// Makes a random step of the friction parameters that `took_part`, over `steps` steps of 1/30
    /// s. It keeps their priors (docs/model.md (34)).
    pub fn drift(&mut self, took_part: &Friction<bool>, steps: f64) {
        let Gaussian { mean, covariance } = &mut self.normal;
        for (k, took_part) in took_part.fields().into_iter().enumerate() {
            let std = self.prior.stds[k];
            if !took_part || std <= 0.0 {
                continue;
            }
            let share = (JITTER * steps.sqrt()).min(1.0);
            let kept = (1.0 - share * share).sqrt();
            let k = FRICTION + k;
            mean[k] *= kept;
            covariance.row_mut(k).scale_mut(kept);
            covariance.column_mut(k).scale_mut(kept);
            covariance[(k, k)] += share * share * std * std;
        }
    }

    /// Limits the friction of the mean to the physical limits, as that of every state is.
    pub fn limit_friction(&mut self) {
        let friction = self.prior.of(&self.normal.mean);
        let nominal = self.prior.nominal.fields();
        for (k, value) in friction.fields().into_iter().enumerate() {
            if self.prior.stds[k] > 0.0 {
                self.normal.mean[FRICTION + k] = libm::log(value / nominal[k]);
            }
        }
    }

    /// Returns a state as Γ takes it. Its force lasts as an impulse of `share` times μ_s (N s) on
    /// an axis, times `rho` (m) about it. All that is not part of the state is that of `like`.
    pub fn particle(
        &self,
        state: &State,
        like: &Particle,
        (share, rho): (f64, f64),
    ) -> (Particle, Friction) {
        let friction = self.prior.of(state);
        let std = friction.mu_s * share;
        let particle = Particle {
            pose: Pose::new(state[0], state[1], state[2]),
            twist: twist(state),
            applied: Wrench {
                fx: state[FORCE] * std,
                fy: state[FORCE + 1] * std,
                torque: state[FORCE + 2] * std * rho,
            },
            ..*like
        };
        (particle, friction)
    }

    /// Returns means and standard deviations; those of friction are a log-normal distribution's.
    pub fn row(&self) -> EstimateRow {
        let Gaussian { mean, covariance } = &self.normal;
        let std = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        let (mut friction, mut spread) = (self.prior.nominal, Friction::default());
        let both = friction.fields_mut().into_iter().zip(spread.fields_mut());
        for (k, (value, spread)) in (FRICTION..).zip(both) {
            let variance = std(k) * std(k);
            *value *= libm::exp(mean[k] + 0.5 * variance);
            *spread = *value * libm::expm1(variance).sqrt();
        }
        EstimateRow {
            pose: Some(Pose::new(mean[0], mean[1], mean[2])),
            twist: Some(twist(mean)),
            friction: Some(friction),
            spread: Some(Spread {
                pose: Pose::new(std(0), std(1), std(2)),
                cross: Some(CrossCovariance {
                    x_y: covariance[(0, 1)],
                    x_theta: covariance[(0, 2)],
                    y_theta: covariance[(1, 2)],
                }),
                friction: Some(spread),
            }),
            ..EstimateRow::default()
        }
    }
}

fn twist(state: &State) -> Twist {
    Twist {
        vx: state[TWIST],
        vy: state[TWIST + 1],
        omega: state[TWIST + 2],
    }
}
