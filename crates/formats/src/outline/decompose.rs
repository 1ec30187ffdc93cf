//! Convex parts of a simple polygon: [`convex_parts`].

use crate::outline::Point;
use crate::outline::error::OutlineProblem;

/// Cuts a simple counter-clockwise polygon into convex ones that share edges. Ears are cut off,
/// then edges are taken out where both ends stay convex (Hertel & Mehlhorn 1983). That leaves at
/// most four times as many parts as there must be.
///
/// Ears are cut off fattest first, so that no sliver is left, and in the order of the boundary from
/// some of its vertices on; the way that leaves the fewest parts counts.
pub(super) fn convex_parts(polygon: &[Point]) -> Result<Vec<Vec<Point>>, OutlineProblem> {
    /// Vertices to begin at.
    const STARTS: usize = 6;
    let mut fewest = merged(polygon, triangles(polygon, Order::Fattest)?);
    for k in 0..STARTS.min(polygon.len()) {
        let start = Order::From(k * polygon.len() / STARTS.min(polygon.len()));
        let parts = merged(polygon, triangles(polygon, start)?);
        if parts.len() < fewest.len() {
            fewest = parts;
        }
    }
    let points = |part: &Vec<usize>| part.iter().map(|k| polygon[*k]).collect();
    Ok(fewest.iter().map(points).collect())
}

/// The order in which ears are cut off.
#[derive(Clone, Copy)]
enum Order {
    Fattest,
    /// Along the boundary from this vertex on.
    From(usize),
}

/// Parts joined until no two can be.
fn merged(polygon: &[Point], mut parts: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut merged = true;
    while merged {
        merged = false;
        let mut k = 0;
        while k < parts.len() {
            let other = (k + 1..parts.len())
                .find_map(|j| Some((j, joined(polygon, &parts[k], &parts[j])?)));
            match other {
                Some((j, part)) => {
                    parts.swap_remove(j);
                    parts[k] = part;
                    merged = true;
                }
                None => k += 1,
            }
        }
    }
    parts
}

/// Twice the area of a triangle, positive counter-clockwise.
fn turn([a, b, c]: [Point; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Triangles of vertex numbers, counter-clockwise. Where an ear is cut off, no other vertex than
/// its neighbours becomes an ear or ceases to be one (O'Rourke 1998), so that n² steps are enough.
fn triangles(polygon: &[Point], order: Order) -> Result<Vec<Vec<usize>>, OutlineProblem> {
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    if let Order::From(start) = order {
        left.rotate_left(start);
    }
    let all = |left: &[usize]| -> Vec<bool> {
        (0..left.len()).map(|k| is_ear(polygon, left, k)).collect()
    };
    let mut ears = all(&left);
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let mut found = next_ear(polygon, &left, &ears, order);
        if found.is_none() {
            // rounding may make one
            ears = all(&left);
            found = next_ear(polygon, &left, &ears, order);
        }
        let Some(ear) = found else {
            return Err(OutlineProblem::Crossing {
                at: polygon[left[0]],
            });
        };
        triangles.push(around(&left, ear).to_vec());
        left.remove(ear);
        ears.remove(ear);
        for neighbour in [(ear + left.len() - 1) % left.len(), ear % left.len()] {
            ears[neighbour] = is_ear(polygon, &left, neighbour);
        }
    }
    triangles.push(left);
    Ok(triangles)
}

/// The ear that comes next in an order.
fn next_ear(polygon: &[Point], left: &[usize], ears: &[bool], order: Order) -> Option<usize> {
    let mut ears = (0..left.len()).filter(|k| ears[*k]);
    let fat = |k: &usize| fatness(around(left, *k).map(|k| polygon[k]));
    match order {
        Order::Fattest => ears.max_by(|a, b| fat(a).total_cmp(&fat(b))),
        Order::From(_) => ears.next(),
    }
}

/// A vertex with its neighbours.
fn around(left: &[usize], k: usize) -> [usize; 3] {
    let n = left.len();
    [left[(k + n - 1) % n], left[k], left[(k + 1) % n]]
}

/// Area over the square of the longest edge.
fn fatness([a, b, c]: [Point; 3]) -> f64 {
    let square = |p: Point, q: Point| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    turn([a, b, c]) / square(a, b).max(square(b, c)).max(square(c, a))
}

/// Returns true if a vertex sticks out and no other one lies in its triangle.
fn is_ear(polygon: &[Point], left: &[usize], k: usize) -> bool {
    let corners = around(left, k);
    let [a, b, c] = corners.map(|k| polygon[k]);
    if turn([a, b, c]) <= 0.0 {
        return false;
    }
    let inside =
        |p: Point| turn([a, b, p]) >= 0.0 && turn([b, c, p]) >= 0.0 && turn([c, a, p]) >= 0.0;
    let mut others = left.iter().filter(|other| !corners.contains(other));
    !others.any(|other| inside(polygon[*other]))
}

/// Two parts as one, if they share one edge and the whole is convex.
fn joined(polygon: &[Point], a: &[usize], b: &[usize]) -> Option<Vec<usize>> {
    let next = |part: &[usize], k: usize| part[(k + 1) % part.len()];
    let (i, j) = (0..a.len()).find_map(|i| {
        let j = (0..b.len()).find(|j| b[*j] == next(a, i) && next(b, *j) == a[i])?;
        Some((i, j))
    })?;
    // a from the shared edge's end round to its start, then b without these two
    let of_a = (0..a.len()).map(|k| a[(i + 1 + k) % a.len()]);
    let of_b = (0..b.len() - 2).map(|k| b[(j + 2 + k) % b.len()]);
    let whole: Vec<usize> = of_a.chain(of_b).collect();
    let convex = (0..whole.len()).all(|k| turn(around(&whole, k).map(|k| polygon[k])) > 0.0);
    convex.then_some(whole)
}
