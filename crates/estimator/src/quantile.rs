//! Quantiles of numbers: [`quantile`].

/// Returns the `q`-quantile of some numbers, with `q` in \[0, 1\]. It is linear between order
/// statistics, at position q (n − 1) from the smallest. Returns `None` if there is no number.
///
/// ```
/// # use stickslip::quantile;
/// assert_eq!(quantile(&[4.0, 1.0, 2.0, 3.0], 0.5), Some(2.5));
/// assert_eq!(quantile(&[], 0.5), None);
/// ```
#[must_use]
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let position = q * last as f64;
    let lower = position.floor() as usize;
    let upper = (lower + 1).min(last);
    Some(values[lower] + (position - lower as f64) * (values[upper] - values[lower]))
}
