//! Order statistics of measured times.

/// The value below which a share of `values` lies, by the nearest rank; NaN where there is none.
///
/// ```
/// assert_eq!(stickslip_bench::quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
/// ```
#[must_use]
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

/// The [`quantile`] of a half.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}
