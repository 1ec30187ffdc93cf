//! What a step reads and writes of a particle: [`Particle`], and [`Particles`], `W` of them side by
//! side.

use crate::lanes::Lanes;
use crate::scene::Friction;
use crate::{Pose, Twist, Wrench};

/// Contacts whose impulses a particle remembers for its next step.
pub(crate) const REMEMBERED: usize = 4;

/// State of one particle, and the impulse that is applied to it in the coming step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Particle {
    /// Pose of the object.
    pub pose: Pose,
    /// Twist of the object.
    pub twist: Twist,
    /// Applied impulse p_app + w_app (N s, N s, N m s).
    pub applied: Wrench,
    /// How far the pusher stands behind its pose, against its direction, since it gave way in the
    /// step before (m); 0 where its pose is where it stands.
    pub pusher_lag: f64,
    /// Impulses of the step before.
    pub warm: WarmStart,
}

/// Impulses of a step, mass-normalised, from which the next one starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmStart {
    /// Per foot (m/s).
    pub feet: [[f64; 2]; 3],
    /// Speed by which the pusher gave way (m/s).
    pub pusher_yield: f64,
    /// Per remembered contact: its key (body and place among the body's contacts; 0: no contact),
    /// p_n, p_t (m/s).
    pub contacts: [[f64; 3]; REMEMBERED],
}

impl WarmStart {
    /// Numbers in [`WarmStart::to_array`].
    pub const LEN: usize = 7 + 3 * REMEMBERED;

    /// As plain numbers, to be stored in columns.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        array[..6].copy_from_slice(self.feet.as_flattened());
        array[6] = self.pusher_yield;
        array[7..].copy_from_slice(self.contacts.as_flattened());
        array
    }

    /// The inverse of [`WarmStart::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let mut warm = Self {
            pusher_yield: array[6],
            ..Self::default()
        };
        warm.feet.as_flattened_mut().copy_from_slice(&array[..6]);
        warm.contacts
            .as_flattened_mut()
            .copy_from_slice(&array[7..]);
        warm
    }
}

/// `W` particles side by side.
#[derive(Clone, Copy, Debug)]
pub struct Particles<const W: usize> {
    /// x (m), y (m), θ (rad).
    pub pose: [Lanes<W>; 3],
    /// vx (m/s), vy (m/s), ω (rad/s).
    pub twist: [Lanes<W>; 3],
    /// Applied impulse p_app + w_app (N s, N s, N m s).
    pub applied: [Lanes<W>; 3],
    /// μ_s, μ_p, μ_f, d_tri (m).
    pub friction: [Lanes<W>; 4],
    /// How far the pusher stands behind its pose (m).
    pub pusher_lag: Lanes<W>,
    /// Impulses of the step before, in the order of [`WarmStart::to_array`].
    pub warm: [Lanes<W>; WarmStart::LEN],
}

impl<const W: usize> Default for Particles<W> {
    fn default() -> Self {
        let o = Lanes::ZERO;
        Self {
            pose: [o; 3],
            twist: [o; 3],
            applied: [o; 3],
            friction: [o; 4],
            pusher_lag: o,
            warm: [o; WarmStart::LEN],
        }
    }
}

/// Writes plain numbers to one lane.
fn set_lane<const W: usize, const N: usize>(to: &mut [Lanes<W>; N], lane: usize, from: [f64; N]) {
    to.iter_mut()
        .zip(from)
        .for_each(|(to, from)| to.0[lane] = from);
}

impl<const W: usize> Particles<W> {
    /// Overwrites one lane.
    pub fn set(&mut self, lane: usize, particle: &Particle, friction: &Friction) {
        let Particle {
            pose,
            twist,
            applied,
            pusher_lag,
            warm,
        } = particle;
        set_lane(&mut self.pose, lane, [pose.x, pose.y, pose.theta]);
        set_lane(&mut self.twist, lane, [twist.vx, twist.vy, twist.omega]);
        set_lane(
            &mut self.applied,
            lane,
            [applied.fx, applied.fy, applied.torque],
        );
        set_lane(
            &mut self.friction,
            lane,
            [friction.mu_s, friction.mu_p, friction.mu_f, friction.d_tri],
        );
        self.pusher_lag.0[lane] = *pusher_lag;
        set_lane(&mut self.warm, lane, warm.to_array());
    }

    /// One lane.
    pub fn get(&self, lane: usize) -> Particle {
        let [x, y, theta] = self.pose.map(|x| x.0[lane]);
        let [vx, vy, omega] = self.twist.map(|x| x.0[lane]);
        let [fx, fy, torque] = self.applied.map(|x| x.0[lane]);
        Particle {
            pose: Pose { x, y, theta },
            twist: Twist { vx, vy, omega },
            applied: Wrench { fx, fy, torque },
            pusher_lag: self.pusher_lag.0[lane],
            warm: WarmStart::from_array(&self.warm.map(|x| x.0[lane])),
        }
    }
}
