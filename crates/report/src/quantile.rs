//! Medians and other quantiles of a few numbers.

/// The `q`-quantile, linear between order statistics: position q (n - 1) from the smallest; `None` of nothing.
#[must_use]
pub fn quantile(mut values: Vec<f64>, q: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let position = q * last as f64;
    let lower = position.floor() as usize;
    let upper = (lower + 1).min(last);
    Some(values[lower] + (position - lower as f64) * (values[upper] - values[lower]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_is_linear_between_order_statistics() {
        assert_eq!(quantile(vec![4.0, 1.0, 2.0, 3.0], 0.5), Some(2.5));
        assert_eq!(quantile((0..=10).map(f64::from).collect(), 0.9), Some(9.0));
        assert_eq!(quantile(vec![7.0], 0.9), Some(7.0));
        assert_eq!(quantile(Vec::new(), 0.5), None);
    }
}
