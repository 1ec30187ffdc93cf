//! Discrepancy of a model that is only nearly right: [`Constant`].
//!
//! No tripod slides as a face under uneven pressure does, and friction differs from place to place.
//! The value that predicts best absorbs such differences. They are equal in all pushes of a rig, so
//! that more pushes do not average them out. The posterior is about the value that predicts best,
//! and does not cover them.
//!
//! Their size was learnt on random virtual rigs whose constants are known. The drift of its
//! predictions distinguishes a rig on which the model is right from one on which it is not
//! (`crates/fit/examples/rigs`, docs/guide/fit.md).

use serde::Serialize;

use crate::parameter::Parameter;
use crate::prior::Prior;

/// Factor of posterior spreads where the model is right: the tracked pusher's noise is no part of
/// it.
const OWN_FACTOR: f64 = 1.1;

/// Drift at which half of the discrepancy counts (m/m).
const HALF_DRIFT: f64 = 0.02;

/// Half the width of a 90 % interval in standard deviations: Student's t with 6 degrees of freedom,
/// since rigs differ in how far the model is off.
const NINETY_PERCENT: f64 = 1.943;

/// Largest posterior over prior standard deviation that is used as it is; beyond, the pushes say
/// nothing.
const NOTHING: f64 = 0.97;

/// The discrepancy of one parameter, of logarithms.
#[derive(Clone, Copy, Debug)]
struct Discrepancy {
    /// Factor on the spread that the pushes leave.
    growth: f64,
    /// Its standard deviation on top of that.
    std: f64,
    /// Mean excess of the value that predicts best over the constant.
    bias: f64,
}

const MU_P: Discrepancy = Discrepancy {
    growth: 1.71,
    std: 0.047,
    bias: 0.0,
};

const TRIPOD_RADIUS: Discrepancy = Discrepancy {
    growth: 4.42,
    std: 0.038,
    bias: 0.05,
};

/// The constant of a rig, estimated from fitted values of the model: friction as one would measure
/// it by itself, the radius of the tripod with the torque of the real support in pure spin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Constant {
    /// Best guess, in the parameter's unit.
    pub value: f64,
    /// Lower end of its 90 % interval.
    pub low_90: f64,
    /// Upper end.
    pub high_90: f64,
}

/// Returns true if the discrepancy of a fit of these parameters was learnt: of `mu_p` and
/// `tripod_radius`, with no others that change how an object answers a push.
pub(crate) fn is_known(parameters: &[Parameter]) -> bool {
    use Parameter::{MuF, MuP, MuS, TripodRadius};
    [MuP, TripodRadius]
        .iter()
        .all(|one| parameters.contains(one))
        && parameters
            .iter()
            .all(|one| matches!(one, MuP | TripodRadius | MuS | MuF))
}

impl Constant {
    /// The constant behind a whitened coordinate with its mean and standard deviation, where
    /// predictions drift by `drift` (m/m); `None` for a parameter whose discrepancy was never
    /// learnt.
    pub(crate) fn behind(
        parameter: Parameter,
        prior: &Prior,
        [z, std]: [f64; 2],
        drift: f64,
    ) -> Option<Self> {
        let discrepancy = match parameter {
            Parameter::MuP => MU_P,
            Parameter::TripodRadius => TRIPOD_RADIUS,
            _ => return None,
        };
        let Prior::LogNormal { relative_std, .. } = *prior else {
            return None;
        };
        let ratio = drift / HALF_DRIFT;
        let cube = ratio * ratio * ratio;
        let wrong = cube / (1.0 + cube);

        // what the pushes say, without the prior, as a normal likelihood of the constant
        let variance = std.min(NOTHING) * std.min(NOTHING);
        let centre = z / (1.0 - variance) - wrong * discrepancy.bias / relative_std;
        let factor = OWN_FACTOR * (1.0 + discrepancy.growth * wrong);
        let own = factor * factor * variance / (1.0 - variance);
        let shared = wrong * discrepancy.std / relative_std;

        // the prior once more
        let weight = 1.0 / (1.0 + own + shared * shared);
        let (mean, half) = (weight * centre, NINETY_PERCENT * (1.0 - weight).sqrt());
        Some(Self {
            value: prior.value(mean),
            low_90: prior.value(mean - half),
            high_90: prior.value(mean + half),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Constant, is_known};
    use crate::parameter::Parameter;
    use crate::prior::Prior;

    const PRIOR: Prior = Prior::LogNormal {
        median: 0.3,
        relative_std: 0.45,
    };

    fn logs(constant: &Constant) -> [f64; 3] {
        [constant.value, constant.low_90, constant.high_90].map(|x| libm::log(x / 0.3) / 0.45)
    }

    fn behind(parameter: Parameter, coordinate: [f64; 2], drift: f64) -> [f64; 3] {
        logs(&Constant::behind(parameter, &PRIOR, coordinate, drift).expect("a constant"))
    }

    /// Without drift the spread is the posterior's, up to the factor for the pusher's noise and the
    /// heavier tails.
    #[test]
    fn a_model_that_is_right_adds_little() {
        let [value, low, high] = behind(Parameter::MuP, [0.8, 0.1], 0.0);
        assert!((value - 0.8).abs() < 0.01, "{value}");
        let half = 0.5 * (high - low);
        assert!((1.645 * 0.1..1.645 * 0.1 * 1.4).contains(&half), "{half}");
    }

    #[test]
    fn the_interval_grows_with_the_drift_and_never_beyond_the_prior() {
        for parameter in [Parameter::MuP, Parameter::TripodRadius] {
            let halves = [0.0, 0.01, 0.02, 0.04, 1.0].map(|drift| {
                let [_, low, high] = behind(parameter, [0.8, 0.1], drift);
                0.5 * (high - low)
            });
            assert!(halves.is_sorted_by(|a, b| a < b), "{halves:?}");
            assert!(halves[4] < 1.943, "{halves:?}");
        }
    }

    #[test]
    fn pushes_that_say_nothing_leave_the_prior() {
        let [value, low, high] = behind(Parameter::MuP, [0.0, 1.0], 0.03);
        assert!(value.abs() < 1e-12 && high - low > 2.0 * 1.645);
    }

    #[test]
    fn only_what_was_learnt_is_told() {
        use Parameter::{CentreX, MuF, MuP, MuS, TripodRadius};
        assert!(Constant::behind(MuS, &PRIOR, [0.0, 0.1], 0.0).is_none());
        assert!(is_known(&[MuP, TripodRadius]) && is_known(&[MuS, MuP, MuF, TripodRadius]));
        assert!(!is_known(&[MuP]) && !is_known(&[MuP, TripodRadius, CentreX]));
    }
}
