//! Planar rigid-body quantities [`Pose`], [`Twist`] and [`Wrench`], in the world frame, SI units.
//!
//! Each is generic over its number: `f64` for one body, [`Lanes`](stickslip_lanes::Lanes) for
//! several particles side by side. The methods `map`, `fields` and `fields_mut` visit the numbers
//! in the order in which they are declared, so that no caller has to know that order.

use std::ops::{Add, Mul};

/// Pose of a body: position of its frame's origin (m) and angle of its x axis, counter-clockwise
/// (rad), not wrapped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose<T = f64> {
    /// x of the origin (m).
    pub x: T,
    /// y of the origin (m).
    pub y: T,
    /// Angle, counter-clockwise (rad).
    pub theta: T,
}

/// Planar twist: velocity of the body's origin in the world frame (m/s) and angular velocity
/// (rad/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist<T = f64> {
    /// x velocity (m/s).
    pub vx: T,
    /// y velocity (m/s).
    pub vy: T,
    /// Angular velocity (rad/s).
    pub omega: T,
}

/// Planar wrench, or the impulse of one: force (N) or impulse (N s), and torque about the origin (N
/// m) or (N m s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench<T = f64> {
    /// x component (N) or (N s).
    pub fx: T,
    /// y component (N) or (N s).
    pub fy: T,
    /// Torque (N m) or (N m s).
    pub torque: T,
}

/// Visits the numbers of a struct in the order of its declaration.
macro_rules! fields {
    ($name:ident, $n:literal: $($field:ident),*) => {
        impl<T> $name<T> {
            /// Replaces every number by a function of it.
            #[inline(always)]
            pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> $name<U> {
                $name { $($field: f(self.$field)),* }
            }

            /// Its numbers, in the order of the declaration.
            #[inline(always)]
            pub fn fields(&self) -> [&T; $n] {
                [$(&self.$field),*]
            }

            /// Its numbers, to be written.
            #[inline(always)]
            pub fn fields_mut(&mut self) -> [&mut T; $n] {
                [$(&mut self.$field),*]
            }
        }
    };
}
pub(crate) use fields;

fields!(Pose, 3: x, y, theta);
fields!(Twist, 3: vx, vy, omega);
fields!(Wrench, 3: fx, fy, torque);

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> Pose<T> {
    /// The pose after moving with `twist` for `h` seconds: q + h v (docs/method.md (10); paper eq.
    /// 6).
    #[inline(always)]
    pub fn advance(&self, twist: Twist<T>, h: f64) -> Self {
        Self {
            x: self.x + twist.vx * h,
            y: self.y + twist.vy * h,
            theta: self.theta + twist.omega * h,
        }
    }
}

impl Pose {
    /// A pose from position (m) and angle (rad).
    pub fn new(x: f64, y: f64, theta: f64) -> Self {
        Self { x, y, theta }
    }

    /// Maps a point of the body frame to the world frame (m).
    ///
    /// ```
    /// # use stickslip_dynamics::Pose;
    /// let [x, y] = Pose::new(1.0, 2.0, std::f64::consts::FRAC_PI_2).transform([3.0, 0.0]);
    /// assert!((x - 1.0).abs() < 1e-15 && (y - 5.0).abs() < 1e-15);
    /// ```
    pub fn transform(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.rotate(point);
        [self.x + x, self.y + y]
    }

    /// Turns a vector of the body frame into the world frame.
    pub fn rotate(&self, vector: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.theta);
        [
            cos * vector[0] - sin * vector[1],
            sin * vector[0] + cos * vector[1],
        ]
    }

    /// The mean twist that leads from `self` to `next` within `h` seconds.
    pub fn twist_to(&self, next: Pose, h: f64) -> Twist {
        Twist {
            vx: (next.x - self.x) / h,
            vy: (next.y - self.y) / h,
            omega: (next.theta - self.theta) / h,
        }
    }

    /// The pose at fraction `s` in [0, 1] of the straight way to `next`; angles are interpolated as
    /// they stand.
    pub fn interpolate(&self, next: Pose, s: f64) -> Self {
        Self::new(
            self.x + s * (next.x - self.x),
            self.y + s * (next.y - self.y),
            self.theta + s * (next.theta - self.theta),
        )
    }

    /// True where all three numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.theta.is_finite()
    }
}

impl Twist {
    /// Velocity (m/s) of the body point that is displaced by `arm` (m) from the origin.
    pub fn at(&self, arm: [f64; 2]) -> [f64; 2] {
        [self.vx - self.omega * arm[1], self.vy + self.omega * arm[0]]
    }
}
