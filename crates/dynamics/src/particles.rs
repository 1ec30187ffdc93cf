//! Numbers of a particle that a step reads and writes: [`Particle`], and [`Particles`], `W` of them
//! side by side.

use stickslip_lanes::Lanes;

use crate::friction::Friction;
use crate::input::MOST_FINGERS;
use crate::se2::{Pose, Twist, Wrench};

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
    /// Vector from each finger's actual position to its pose (m), world frame: the amount by which
    /// it yielded in the step before. Zero where it stands at its pose. All fingers lag equally
    /// far.
    pub pusher_lag: [[f64; 2]; MOST_FINGERS],
    /// Impulses of the step before.
    pub warm: WarmStart,
}

/// Impulses of a step, mass-normalised, from which the solver starts the next one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmStart<T = f64> {
    /// Friction impulse of each foot (m/s).
    pub feet: [[T; 2]; 3],
    /// Speed y by which the pusher yielded (m/s).
    pub pusher_yield: T,
    /// The contacts that pressed, at most four.
    pub contacts: [ContactImpulse<T>; REMEMBERED],
}

/// The impulse of one contact, to be found again in the next step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactImpulse<T = f64> {
    /// Names the contact: body and pair of features; 0 is no contact.
    pub key: T,
    /// p_n (m/s).
    pub normal: T,
    /// p_t (m/s).
    pub tangential: T,
}

impl WarmStart {
    /// Numbers of a warm start.
    pub const LEN: usize = 7 + 3 * REMEMBERED;
}

impl<T> WarmStart<T> {
    /// Its numbers, to be stored in columns.
    #[inline(always)]
    pub fn fields(&self) -> [&T; WarmStart::LEN] {
        let [[ax, ay], [bx, by], [cx, cy]] = &self.feet;
        let [a, b, c, d] = &self.contacts;
        [
            ax,
            ay,
            bx,
            by,
            cx,
            cy,
            &self.pusher_yield,
            &a.key,
            &a.normal,
            &a.tangential,
            &b.key,
            &b.normal,
            &b.tangential,
            &c.key,
            &c.normal,
            &c.tangential,
            &d.key,
            &d.normal,
            &d.tangential,
        ]
    }

    /// Its numbers, to be written.
    #[inline(always)]
    pub fn fields_mut(&mut self) -> [&mut T; WarmStart::LEN] {
        let [[ax, ay], [bx, by], [cx, cy]] = &mut self.feet;
        let [a, b, c, d] = &mut self.contacts;
        [
            ax,
            ay,
            bx,
            by,
            cx,
            cy,
            &mut self.pusher_yield,
            &mut a.key,
            &mut a.normal,
            &mut a.tangential,
            &mut b.key,
            &mut b.normal,
            &mut b.tangential,
            &mut c.key,
            &mut c.normal,
            &mut c.tangential,
            &mut d.key,
            &mut d.normal,
            &mut d.tangential,
        ]
    }
}

/// `W` particles side by side, each with its friction parameters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Particles<const W: usize> {
    /// Pose of the object (m, m, rad).
    pub pose: Pose<Lanes<W>>,
    /// Twist of the object (m/s, m/s, rad/s).
    pub twist: Twist<Lanes<W>>,
    /// Applied impulse p_app + w_app (N s, N s, N m s).
    pub applied: Wrench<Lanes<W>>,
    /// Friction parameters; d_tri in m.
    pub friction: Friction<Lanes<W>>,
    /// Way from where each finger stands to its pose (m), world frame.
    pub pusher_lag: [[Lanes<W>; 2]; MOST_FINGERS],
    /// Impulses of the step before.
    pub warm: WarmStart<Lanes<W>>,
}

/// Writes one lane of several numbers.
fn set_lane<const W: usize, const N: usize>(to: [&mut Lanes<W>; N], lane: usize, from: [&f64; N]) {
    to.into_iter()
        .zip(from)
        .for_each(|(to, from)| to.0[lane] = *from);
}

impl Particle {
    /// Leaves each finger at most `most` (m) behind its pose: it is dragged there.
    pub fn limit_pusher_lag(&mut self, most: f64) {
        for lag in &mut self.pusher_lag {
            *lag = limited(lag.map(|x| Lanes([x])), most).map(|x| x.0[0]);
        }
    }
}

/// A vector, shortened to `most` where it is longer.
#[inline(always)]
fn limited<const W: usize>([x, y]: [Lanes<W>; 2], most: f64) -> [Lanes<W>; 2] {
    let squared = (x * x).add_mul(y, y);
    let longer = squared.gt(Lanes::splat(most * most));
    if !longer.any() {
        return [x, y];
    }
    let share = longer.select(squared.inverse_sqrt() * most, Lanes::splat(1.0));
    [x * share, y * share]
}

impl<const W: usize> Particles<W> {
    /// [`Particle::limit_pusher_lag`] in every lane.
    #[inline(always)]
    pub fn limit_pusher_lag(&mut self, most: f64) {
        for lag in &mut self.pusher_lag {
            *lag = limited(*lag, most);
        }
    }

    /// Overwrites one lane.
    pub fn set(&mut self, lane: usize, particle: &Particle, friction: &Friction) {
        set_lane(self.pose.fields_mut(), lane, particle.pose.fields());
        set_lane(self.twist.fields_mut(), lane, particle.twist.fields());
        set_lane(self.applied.fields_mut(), lane, particle.applied.fields());
        set_lane(self.friction.fields_mut(), lane, friction.fields());
        for (to, from) in self.pusher_lag.iter_mut().zip(&particle.pusher_lag) {
            set_lane(to.each_mut(), lane, from.each_ref());
        }
        set_lane(self.warm.fields_mut(), lane, particle.warm.fields());
    }

    /// One lane.
    pub fn get(&self, lane: usize) -> Particle {
        let mut warm = WarmStart::default();
        for (to, from) in warm.fields_mut().into_iter().zip(self.warm.fields()) {
            *to = from.0[lane];
        }
        Particle {
            pose: self.pose.map(|x| x.0[lane]),
            twist: self.twist.map(|x| x.0[lane]),
            applied: self.applied.map(|x| x.0[lane]),
            pusher_lag: self.pusher_lag.map(|lag| lag.map(|x| x.0[lane])),
            warm,
        }
    }
}
