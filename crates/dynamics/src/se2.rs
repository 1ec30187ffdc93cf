//! Planar rigid-body quantities: [`Pose`], [`Twist`], [`Wrench`], all in the world frame, SI units.

/// Pose of a body: position of its frame's origin (m) and angle of its x axis, counter-clockwise
/// (rad), not wrapped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// x of the origin (m).
    pub x: f64,
    /// y of the origin (m).
    pub y: f64,
    /// Angle, counter-clockwise (rad).
    pub theta: f64,
}

/// Planar twist: velocity of the body's origin in the world frame (m/s) and angular velocity
/// (rad/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// x velocity (m/s).
    pub vx: f64,
    /// y velocity (m/s).
    pub vy: f64,
    /// Angular velocity (rad/s).
    pub omega: f64,
}

/// Planar wrench, or the impulse of one: force (N) or impulse (N s), and torque about the origin (N
/// m) or (N m s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// x component (N) or (N s).
    pub fx: f64,
    /// y component (N) or (N s).
    pub fy: f64,
    /// Torque (N m) or (N m s).
    pub torque: f64,
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

    /// The pose after moving with `twist` for `h` seconds: q + h v (eq. 6, last line).
    pub fn advance(&self, twist: Twist, h: f64) -> Self {
        Self::new(
            self.x + h * twist.vx,
            self.y + h * twist.vy,
            self.theta + h * twist.omega,
        )
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
