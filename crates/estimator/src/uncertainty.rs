//! Uncertainty of a scene file's numbers: [`Uncertainty`], which the robust model allows for
//! (docs/model.md).

use crate::tuning::{BETWEEN_HALVES, LATENCY_SPREAD, LATEST};
use stickslip_dynamics::{Friction, Lanes};

/// `[uncertainty]` of a scene file: priors of what its other numbers leave open. The paper's model
/// takes those numbers as exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Standard deviations of ln β, the priors of the friction parameters: 0.45 is 45 %.
    pub friction: Friction,
    /// Standard deviation of the centre of friction about that of the scene's feet, on each axis,
    /// as a share of the radius of gyration. The centre of a tripod is the centre of mass.
    pub centre_of_friction: f64,
    /// Standard deviation of the angle by which the feet are turned about that centre (rad).
    pub tripod_angle: f64,
    /// Standard deviation of the two numbers of ln of the stretch of the feet's triangle: its
    /// factor along one axis, and the inverse across it.
    pub foot_stretch: f64,
    /// Disturbing force per step of 1/30 s, as a share of μ_s m g on each axis, times the radius of
    /// gyration for rotation.
    pub force_std: f64,
    /// Standard deviation of a constant offset between the camera's frame and the pusher's, on each
    /// axis (m).
    pub pusher_offset: f64,
    /// Distance by which a jam holds a pusher back behind its logged pose before it stops, in terms
    /// of its Rayleigh scale, where the drive is soft (m). On the smoother half of rigs it is
    /// `well_measured` times as long.
    pub pusher_lag: f64,
    /// Standard deviation of the error of each fixel's position, on each axis (m).
    pub fixel_position: f64,
    /// Standard deviation of the logarithm of a factor of these offsets: rigs differ.
    pub roughness: f64,
    /// Factor of `fixel_position` and `pusher_lag` on the smoother half of rigs. Its square root is
    /// that of `force_std` while the camera is off. A value below 1 means that some rigs are
    /// measured much better than others.
    pub well_measured: f64,
    /// Standard deviation of the logarithm by which the camera's noise differs from its nominal
    /// value.
    pub camera_noise: f64,
    /// Median of the time by which the camera lags more than the scene says (s); its logarithm is
    /// normal.
    pub latency: f64,
    /// Gap at which object and body may already touch, in addition to the errors of their poses and
    /// shapes (m).
    pub touch_gap: f64,
}

/// Standard deviation of the angle of a tripod that may stand at any angle (rad). A third of a turn
/// changes nothing.
const ANY_ANGLE: f64 = std::f64::consts::FRAC_PI_3;

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            friction: Friction {
                mu_s: 0.35,
                mu_p: 0.45,
                mu_f: 0.45,
                d_tri: 0.25,
            },
            centre_of_friction: 0.15,
            tripod_angle: ANY_ANGLE,
            foot_stretch: 0.3,
            force_std: 0.25,
            pusher_offset: 3e-4,
            pusher_lag: 3e-3,
            fixel_position: 3e-4,
            roughness: 0.5,
            well_measured: 0.1,
            camera_noise: 0.3,
            latency: 0.01,
            touch_gap: 2.5e-4,
        }
    }
}

impl Uncertainty {
    /// Returns the uncertainty with feet that are known to stand as the scene says.
    #[must_use]
    pub fn with_known_feet(self) -> Self {
        Self {
            centre_of_friction: 0.0,
            tripod_angle: 0.0,
            foot_stretch: 0.0,
            ..self
        }
    }

    /// b of docs/model.md (36), the factor of `fixel_position` and `pusher_lag`. The logarithm of
    /// the rig's roughness is `roughness`, whose own factor is not included. b is `well_measured`
    /// on the smoother half of rigs, 1 on the others.
    #[inline(always)]
    pub(crate) fn well_measured_at<const W: usize>(&self, roughness: Lanes<W>) -> Lanes<W> {
        let one = Lanes::splat(1.0);
        if self.roughness == 0.0 {
            return one;
        }
        let smooth = one / (one + (roughness * (BETWEEN_HALVES * self.roughness)).exp());
        one - smooth * (1.0 - self.well_measured)
    }

    /// Time by which the camera lags more than the scene says (s), of a standard normal number.
    #[inline(always)]
    pub(crate) fn latency_at<const W: usize>(&self, normal: Lanes<W>) -> Lanes<W> {
        let latency = (normal * LATENCY_SPREAD).exp() * self.latency;
        latency.min(Lanes::splat(self.most_latency()))
    }

    /// Standard deviation of the time by which the camera lags more than the scene says (s).
    #[must_use]
    pub fn latency_std(&self) -> f64 {
        let square = LATENCY_SPREAD * LATENCY_SPREAD;
        self.latency * libm::exp(0.5 * square) * (libm::exp(square) - 1.0).sqrt()
    }

    /// Longest time by which the camera may lag more than the scene says (s).
    pub(crate) fn most_latency(&self) -> f64 {
        LATEST * self.latency
    }
}
