//! Friction that the nominal values miss: [`true_friction`].

use stickslip_dynamics::Friction;
use stickslip_filter::Streams;

/// Step of the random streams that nothing else in a testbed uses.
const STEP: u64 = 1 << 20;

/// A true friction for a nominal one: every value is uniform within ±`share` (0 to 1) of its
/// nominal value.
///
/// ```
/// # use stickslip_dynamics::Friction;
/// # use stickslip_testbed::true_friction;
/// let nominal = Friction { mu_s: 0.3, mu_p: 0.3, mu_f: 0.3, d_tri: 0.02 };
/// let truth = true_friction(nominal, 0.4, 7);
/// assert!((truth.mu_s / 0.3 - 1.0).abs() <= 0.4 && truth.mu_s != truth.mu_p);
/// assert_eq!(true_friction(nominal, 0.0, 7), nominal);
/// ```
pub fn true_friction(nominal: Friction, share: f64, seed: u64) -> Friction {
    let factor = |k: u32| 1.0 + share * (2.0 * Streams::new(seed).uniform(STEP, k, 0) - 1.0);
    Friction {
        mu_s: nominal.mu_s * factor(0),
        mu_p: nominal.mu_p * factor(1),
        mu_f: nominal.mu_f * factor(2),
        d_tri: nominal.d_tri * factor(3),
    }
}
