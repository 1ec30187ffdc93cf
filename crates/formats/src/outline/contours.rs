//! Lines that meet, joined into closed ones: [`closed_contours`].

use crate::outline::Point;
use crate::outline::error::OutlineProblem;

/// Joins lines whose ends are at most `near` apart into closed contours, without repeated points; a
/// line that is closed already stays as it is.
pub(super) fn closed_contours(
    lines: Vec<Vec<Point>>,
    near: f64,
) -> Result<Vec<Vec<Point>>, OutlineProblem> {
    let mut closed = Vec::new();
    let mut open: Vec<Vec<Point>> = Vec::new();
    for line in lines.into_iter().filter(|line| line.len() > 1) {
        if is_closed(&line, near) {
            closed.push(line);
        } else {
            open.push(line);
        }
    }
    while let Some(mut line) = open.pop() {
        while !is_closed(&line, near) {
            let end = line[line.len() - 1];
            let next = open.iter().position(|other| {
                apart(other[0], end) <= near || apart(other[other.len() - 1], end) <= near
            });
            let Some(next) = next else {
                let [from, to] = [line[0], end];
                return Err(OutlineProblem::Open { from, to });
            };
            let mut next = open.swap_remove(next);
            if apart(next[0], end) > near {
                next.reverse();
            }
            line.extend_from_slice(&next[1..]);
        }
        closed.push(line);
    }
    for contour in &mut closed {
        contour.dedup_by(|b, a| apart(*a, *b) <= near);
        while contour.len() > 1 && apart(contour[0], contour[contour.len() - 1]) <= near {
            contour.pop();
        }
    }
    closed.retain(|contour| contour.len() > 2);
    Ok(closed)
}

fn is_closed(line: &[Point], near: f64) -> bool {
    line.len() > 3 && apart(line[0], line[line.len() - 1]) <= near
}

fn apart(p: Point, q: Point) -> f64 {
    libm::hypot(p[0] - q[0], p[1] - q[1])
}

/// Twice the signed area, positive counter-clockwise.
pub(super) fn twice_area(contour: &[Point]) -> f64 {
    edges(contour).map(|[p, q]| p[0] * q[1] - q[0] * p[1]).sum()
}

/// The edges of a closed contour.
pub(super) fn edges(contour: &[Point]) -> impl Iterator<Item = [Point; 2]> {
    let next = contour.iter().cycle().skip(1);
    contour.iter().zip(next).map(|(p, q)| [*p, *q])
}

/// Returns true if a point is inside a contour (by the edges that a ray to the right crosses).
pub(super) fn contains(contour: &[Point], [x, y]: Point) -> bool {
    let crossed = edges(contour).filter(|[p, q]| {
        (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
    });
    crossed.count() % 2 == 1
}

/// Two edges of a contour that cross or touch, other than neighbours at their vertex.
pub(super) fn crossing(contour: &[Point]) -> Option<Point> {
    let all: Vec<[Point; 2]> = edges(contour).collect();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            let neighbours = j == i + 1 || (i == 0 && j + 1 == all.len());
            if !neighbours && meet(a, b) {
                return Some(a[0]);
            }
        }
    }
    None
}

/// Returns true if two segments have a point in common.
fn meet([p, q]: &[Point; 2], [r, s]: &[Point; 2]) -> bool {
    let side = |a: &Point, b: &Point, c: &Point| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let within = |a: &Point, b: &Point, c: &Point| {
        (0..2).all(|k| c[k] >= a[k].min(b[k]) && c[k] <= a[k].max(b[k]))
    };
    let [a, b, c, d] = [side(p, q, r), side(p, q, s), side(r, s, p), side(r, s, q)];
    ((a > 0.0) != (b > 0.0) && (c > 0.0) != (d > 0.0) && a != 0.0 && b != 0.0)
        || (a == 0.0 && within(p, q, r))
        || (b == 0.0 && within(p, q, s))
        || (c == 0.0 && within(r, s, p))
        || (d == 0.0 && within(r, s, q))
}
