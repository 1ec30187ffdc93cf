//! Curves of many rows, drawn with as few points as the eye can tell apart: [`thinned`].

/// Columns per pixel within which points are taken together.
const COLUMNS: f64 = 2.0;

/// Points of a curve (px) without those that cannot be seen.
///
/// Points left or right of the `frame` go, but for the next one on either side. Of the points of
/// one column the first, the lowest, the highest and the last stay, so that peaks of any length
/// stay visible. Points that are not finite stay: they break the curve.
pub(crate) fn thinned(points: &[[f64; 2]], frame: [f64; 2]) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for run in within(points, frame).chunk_by(|a, b| column(*a) == column(*b)) {
        let height = |k: &usize| run[*k][1];
        let by_height = |a: &usize, b: &usize| height(a).total_cmp(&height(b));
        let ends = [0, run.len() - 1].into_iter();
        let lowest = (0..run.len()).min_by(by_height);
        let highest = (0..run.len()).max_by(by_height);
        let mut shown: Vec<usize> = ends.chain(lowest).chain(highest).collect();
        shown.sort_unstable();
        shown.dedup();
        kept.extend(shown.into_iter().map(|k| run[k]));
    }
    kept
}

/// Points from the last one left of the frame to the first one right of it.
fn within(points: &[[f64; 2]], [left, right]: [f64; 2]) -> &[[f64; 2]] {
    let from = points.iter().rposition(|[x, _]| *x < left).unwrap_or(0);
    let to = points.iter().position(|[x, _]| *x > right);
    &points[from..to.map_or(points.len(), |to| to + 1).max(from)]
}

/// Column of a point; `None` for points that are not finite.
fn column([x, y]: [f64; 2]) -> Option<i64> {
    (x.is_finite() && y.is_finite()).then(|| (COLUMNS * x).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [f64; 2] = [0.0, 100.0];

    #[test]
    fn thinned_peak_of_one_row_stays() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [1e-3 * f64::from(k), 5.0]).collect();
        points[70_123][1] = 90.0;
        points[70_124][1] = -3.0;
        let kept = thinned(&points, FRAME);
        assert!(kept.len() <= 4 * 201, "{}", kept.len());
        for point in [points[0], points[70_123], points[70_124], points[99_999]] {
            assert!(kept.contains(&point), "{point:?}");
        }
    }

    #[test]
    fn thinned_gap_stays_and_few_points_stay_as_they_are() {
        let points = [[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 1.0]];
        let kept = thinned(&points, FRAME);
        assert_eq!(format!("{kept:?}"), format!("{points:?}"));
        assert!(thinned(&[], FRAME).is_empty());
    }

    #[test]
    fn thinned_points_outside_the_frame_go_but_the_next_ones() {
        let points: Vec<[f64; 2]> = (-50..150).map(|k| [f64::from(k), 0.0]).collect();
        let kept = thinned(&points, FRAME);
        assert_eq!((kept[0][0], kept[kept.len() - 1][0]), (-1.0, 101.0));
    }
}
