//! What a scene file does not know, and how badly: [`Uncertainty`], which contact mode allows for
//! (docs/method.md, "Contact mode").

use stickslip_dynamics::Friction;

/// What the nominal numbers of a scene leave open. Paper mode takes them as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Standard deviations of ln β, the priors of the friction parameters: 0.45 is 45 %.
    pub friction: Friction,
    /// Standard deviations of the logarithm by which friction differs from place to place.
    pub variation: Friction,
    /// Way over which that variation forgets itself (m).
    pub variation_length: f64,
    /// Random step of ln β per step of 1/30 s while the camera looks, which keeps copies of a
    /// particle apart.
    pub jitter: f64,
    /// Standard deviation of a constant offset between the camera's frame and the pusher's, on each
    /// axis (m).
    pub pusher_offset: f64,
    /// Mean time by which the camera lags more than the scene says (s).
    pub latency: f64,
    /// Gap at which object and body may touch already, as far as shapes and poses are known (m).
    pub touch_gap: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            friction: Friction {
                mu_s: 0.35,
                mu_p: 0.45,
                mu_f: 0.45,
                d_tri: 0.25,
            },
            variation: Friction {
                mu_s: 0.1,
                mu_p: 0.1,
                mu_f: 0.1,
                d_tri: 0.1,
            },
            variation_length: 5e-3,
            jitter: 0.01,
            pusher_offset: 2e-4,
            latency: 0.02,
            touch_gap: 1e-4,
        }
    }
}
