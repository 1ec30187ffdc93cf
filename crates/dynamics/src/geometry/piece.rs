//! Polygon edges without the stretches that siblings cover, chained along the boundary of the
//! union: [`Piece`].

use crate::geometry::convex_part::ConvexPart;
use crate::geometry::edge::Edge;
use crate::geometry::part::TOLERANCE;
use crate::geometry::vec2::{Vec2, cross, dot, length, sub};

/// Share of a shape's extent within which the joint of two collinear edges of one part is on their
/// common line.
const STRAIGHT: f64 = 1e-9;

/// A directed piece of boundary, and the parts that its ends come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub ends: [Vec2; 2],
    parts: [usize; 2],
    /// The piece that goes on where this one ends.
    pub next: Option<usize>,
}

impl Piece {
    /// The straight boundary of a union; lengths below `tolerance` (m) are rounding. Marks the
    /// sides of its polygons as exposed or seams.
    pub fn boundary(parts: &mut [ConvexPart], tolerance: f64) -> Vec<Self> {
        let mut pieces = uncovered(parts, tolerance);
        chain(&mut pieces, tolerance);
        merge_collinear(&mut pieces, tolerance);
        pieces
    }

    /// A stretch of an edge, whose own ends are kept bit for bit.
    fn new([from, to]: [Vec2; 2], edge: &Edge, [low, high]: [f64; 2], part: usize) -> Self {
        let start = if low > 0.0 { edge.at(low) } else { from };
        let end = if high < edge.length {
            edge.at(high)
        } else {
            to
        };
        Self {
            ends: [start, end],
            parts: [part; 2],
            next: None,
        }
    }

    fn direction(&self) -> Vec2 {
        sub(self.ends[1], self.ends[0])
    }
}

/// All polygon edges without the stretches that other parts cover.
fn uncovered(parts: &mut [ConvexPart], tolerance: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for i in 0..parts.len() {
        let Some(polygon) = parts[i].polygon() else {
            continue;
        };
        let mut flags = Vec::new();
        for ends in polygon.segments() {
            let edge = Edge::between(ends[0], ends[1]);
            let open = open_stretches(&edge, i, parts, tolerance);
            let left = open.iter().map(|[low, high]| high - low).sum::<f64>();
            flags.push((!open.is_empty(), left < edge.length - tolerance));
            pieces.extend(
                open.iter()
                    .map(|stretch| Piece::new(ends, &edge, *stretch, i)),
            );
        }
        if let ConvexPart::Polygon(polygon) = &mut parts[i] {
            for (side, flags) in polygon.sides.iter_mut().zip(flags) {
                (side.exposed, side.seam) = flags;
            }
        }
    }
    pieces
}

/// The stretches of an edge of part `i` that no other part covers. Where two parts share a stretch
/// of boundary, the first one keeps it. A short stretch that a sibling leaves of an edge is
/// rounding; an edge that none of them covers is kept, however short it is.
fn open_stretches(edge: &Edge, i: usize, parts: &[ConvexPart], tolerance: f64) -> Vec<[f64; 2]> {
    let mut open = vec![[0.0, edge.length]];
    for (j, sibling) in parts.iter().enumerate().filter(|(j, _)| *j != i) {
        let cover = sibling.cover(edge, tolerance);
        if let Some(cover) = cover.filter(|cover| !cover.flush || j < i) {
            open = open
                .into_iter()
                .flat_map(|stretch| cover.subtract_from(stretch))
                .collect();
        }
    }
    let whole = [0.0, edge.length];
    open.retain(|stretch| *stretch == whole || stretch[1] - stretch[0] > 2.0 * tolerance);
    open
}

/// Finds for each piece the one that goes on where it ends: that of its own part which starts at
/// the same corner, else of those that start nearby the one that turns most to the left.
fn chain(pieces: &mut [Piece], tolerance: f64) {
    for i in 0..pieces.len() {
        let follows_exactly = |j: &usize| {
            *j != i
                && pieces[*j].parts[0] == pieces[i].parts[1]
                && pieces[*j].ends[0] == pieces[i].ends[1]
        };
        let follows = |j: &usize| {
            *j != i && length(sub(pieces[*j].ends[0], pieces[i].ends[1])) <= 4.0 * tolerance
        };
        let turn = |j: usize| {
            let (t, u) = (pieces[i].direction(), pieces[j].direction());
            libm::atan2(cross(t, u), dot(t, u))
        };
        pieces[i].next = (0..pieces.len()).find(follows_exactly).or_else(|| {
            (0..pieces.len())
                .filter(follows)
                .max_by(|a, b| turn(*a).total_cmp(&turn(*b)))
        });
    }
    for i in 0..pieces.len() {
        if let Some(j) = pieces[i].next {
            pieces[i].ends[1] = pieces[j].ends[0];
        }
    }
}

/// Joins neighbours in line: exactly so within one part, within the tolerance across a seam.
fn merge_collinear(pieces: &mut Vec<Piece>, tolerance: f64) {
    while let Some((i, j)) = (0..pieces.len()).find_map(|i| straight_joint(pieces, i, tolerance)) {
        pieces[i] = Piece {
            ends: [pieces[i].ends[0], pieces[j].ends[1]],
            parts: [pieces[i].parts[0], pieces[j].parts[1]],
            next: pieces[j].next,
        };
        pieces.remove(j);
        // what led to j leads to i, and all numbers after j move up
        for next in pieces.iter_mut().filter_map(|piece| piece.next.as_mut()) {
            if *next == j {
                *next = i;
            }
            if *next > j {
                *next -= 1;
            }
        }
    }
}

/// Piece `i` and its successor, where their joint lies on one line with their other ends.
fn straight_joint(pieces: &[Piece], i: usize, tolerance: f64) -> Option<(usize, usize)> {
    let j = pieces[i].next.filter(|j| *j != i)?;
    let sole = pieces.iter().filter(|piece| piece.next == Some(j)).count() == 1;
    let (from, joint, to) = (pieces[i].ends[0], pieces[i].ends[1], pieces[j].ends[1]);
    let (s, height) = Edge::between(from, to).coordinates(joint);
    let same_part = pieces[i].parts[1] == pieces[j].parts[0];
    let limit = if same_part {
        STRAIGHT / TOLERANCE * tolerance
    } else {
        tolerance
    };
    // a dent of rounding is straightened like a seam: it would be a reflex corner that no convex
    // part can have
    let dent = same_part && height < 0.0 && -height <= 2.0 * tolerance;
    (sole && s > 0.0 && s < length(sub(to, from)) && (height.abs() <= limit || dent))
        .then_some((i, j))
}
