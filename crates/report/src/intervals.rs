//! Stretches over which flags are set: [`row_ranges`], [`intervals`] and [`times`].

/// Every stretch of set flags: its first row and the row after its last one.
pub(crate) fn row_ranges(flags: impl IntoIterator<Item = bool>) -> Vec<[usize; 2]> {
    let mut ranges: Vec<[usize; 2]> = Vec::new();
    for (row, _) in flags.into_iter().enumerate().filter(|(_, set)| *set) {
        match ranges.last_mut() {
            Some([_, end]) if *end == row => *end = row + 1,
            _ => ranges.push([row, row + 1]),
        }
    }
    ranges
}

/// The times over which flags are set; the flag of a row applies to the interval that ends at it.
pub(crate) fn intervals(time: &[f64], flags: &[bool]) -> Vec<[f64; 2]> {
    let set = flags.iter().take(time.len()).copied();
    row_ranges(set)
        .into_iter()
        .map(|rows| times(time, rows))
        .collect()
}

/// The time to which rows from..to apply; `to` is after `from` and within the times.
pub(crate) fn times(time: &[f64], [from, to]: [usize; 2]) -> [f64; 2] {
    [time[from.saturating_sub(1)], time[to - 1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_join_rows_that_follow_each_other() {
        let time = [0.0, 0.1, 0.2, 0.3, 0.4];
        assert_eq!(
            intervals(&time, &[false, true, true, false, true]),
            [[0.0, 0.2], [0.3, 0.4]]
        );
        assert_eq!(
            intervals(&time, &[true, false, false, false, false]),
            [[0.0, 0.0]]
        );
        assert!(intervals(&time, &[]).is_empty());
    }
}
