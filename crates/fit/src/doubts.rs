//! Reasons to doubt a fit: [`doubts`].

use stickslip::diagnosis::misread;

use crate::fitted::Fit;
use crate::push::Push;

/// Finds reasons to doubt a fit to `pushes`, in words: numbers in other units and the like in a
/// push, which is named, and chains that have not converged.
#[must_use]
pub fn doubts(pushes: &[Push], fit: &Fit) -> Vec<String> {
    let of_push = |push: &Push| {
        let findings = misread(&push.setup, &push.log).into_iter();
        let named = findings.map(|finding| format!("{}: {finding}", push.name));
        named.collect::<Vec<_>>()
    };
    let unsettled = (!fit.sampling.settled).then(|| {
        let split_rhat = fit.sampling.split_rhat;
        format!(
            "the chains have not converged (split R-hat {split_rhat:.3}, at most 1.01 is); the scene keeps its spreads"
        )
    });
    let left_out = fit
        .left_out
        .iter()
        .map(|push| format!("{push}, and is left out"));
    let of_pushes = pushes.iter().flat_map(of_push);
    of_pushes.chain(left_out).chain(unsettled).collect()
}
