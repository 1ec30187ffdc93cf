//! The boundary of a union of convex parts as features that can touch: [`Outline`].
//!
//! Polygon edges are cut where another part covers them: seams, back to back with a sibling's edge,
//! and overlaps. What is left is chained, and neighbours in line are merged, so that no vertex
//! stands on a straight seam. A convex joint is a corner with the union's own normal cone; a reflex
//! one is no feature, but both its edges are known to run on inside the body.

use crate::geometry::cluster::Cluster;
use crate::geometry::feature::{Cone, Edge, Ellipse, Round};
use crate::geometry::part::Solid;
use crate::geometry::shape::Part;
use crate::geometry::vec2::{Vec2, cross, dot, length, sub};

/// Share of a shape's extent within which the joint of two collinear edges of one part is on their
/// common line.
const STRAIGHT: f64 = 1e-9;

/// Boundary features of a shape in its own frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline {
    pub edges: Vec<Edge>,
    pub rounds: Vec<Round>,
    pub ellipses: Vec<Ellipse>,
    /// Of a convex polygon with many corners several, else one of all edges and round vertices.
    pub clusters: Vec<Cluster>,
}

/// A directed piece of boundary, and the parts that its ends come from.
#[derive(Clone, Copy, Debug)]
struct Piece {
    ends: [Vec2; 2],
    parts: [usize; 2],
    next: Option<usize>,
}

impl Outline {
    /// The outline of the union of `parts`; lengths below `tolerance` (m) are rounding. Marks the
    /// exposed sides of the solids.
    pub fn new(parts: &[Part], solids: &mut [Solid], tolerance: f64) -> Self {
        let mut pieces = exposed(solids, tolerance);
        chain(&mut pieces, tolerance);
        merge(&mut pieces, tolerance);
        let mut outline = Self {
            edges: edges(&pieces, solids, tolerance),
            ..Self::default()
        };
        outline.rounds = corners(&outline.edges, &pieces);
        for (part, covered) in parts.iter().zip(covered(solids, tolerance)) {
            outline.push_smooth(part, covered);
        }
        // the corners of a convex polygon follow each other as its edges do
        outline.clusters = match parts {
            [Part::Polygon { .. }] if outline.rounds.len() == outline.edges.len() => {
                Cluster::of_polygon(&outline.edges)
            }
            _ => vec![Cluster::of_all(
                outline.edges.len().max(outline.rounds.len()),
            )],
        };
        outline
    }

    fn push_smooth(&mut self, part: &Part, covered: bool) {
        match part {
            Part::Polygon { .. } => {}
            Part::Disc { radius, centre } => self.rounds.push(Round {
                centre: *centre,
                radius: *radius,
                cone: Cone::full(),
                covered,
            }),
            Part::Ellipse {
                semi_axes,
                centre,
                angle,
            } => {
                let (sin, cos) = libm::sincos(*angle);
                self.ellipses.push(Ellipse {
                    centre: *centre,
                    axis: [cos, sin],
                    semi_axes: *semi_axes,
                    covered,
                });
            }
        }
    }
}

/// Whether a sibling may hide some of each solid: their bounding discs overlap.
fn covered(solids: &[Solid], tolerance: f64) -> Vec<bool> {
    let disc = |solid: &Solid| match solid {
        Solid::Polygon(polygon) => (polygon.centre, polygon.radius),
        Solid::Oval {
            centre,
            semi_axes: [a, b],
            ..
        } => (*centre, a.max(*b)),
    };
    let meet = |a: &Solid, b: &Solid| {
        let ((p, r), (q, s)) = (disc(a), disc(b));
        length(sub(p, q)) < r + s - tolerance
    };
    let other = |i: usize| (0..solids.len()).any(|j| j != i && meet(&solids[i], &solids[j]));
    (0..solids.len()).map(other).collect()
}

/// All polygon edges without what other parts cover. Where two parts share a stretch of boundary,
/// the first one keeps it.
fn exposed(solids: &mut [Solid], tolerance: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for i in 0..solids.len() {
        let Solid::Polygon(polygon) = &solids[i] else {
            continue;
        };
        let mut bare = Vec::new();
        for k in 0..polygon.corners.len() {
            let edge = Edge::between(
                polygon.corners[k],
                polygon.corners[(k + 1) % polygon.corners.len()],
            );
            let mut open = vec![[0.0, edge.length]];
            for (j, sibling) in solids.iter().enumerate().filter(|(j, _)| *j != i) {
                let cover = sibling
                    .cover(&edge, tolerance)
                    .filter(|cover| !cover.flush || j < i);
                open = cover.map_or(open.clone(), |cover| {
                    open.iter()
                        .flat_map(|gap| without(*gap, cover.near, cover.exact))
                        .collect()
                });
            }
            open.retain(|[low, high]| high - low > 2.0 * tolerance);
            bare.push((
                !open.is_empty(),
                open.iter().map(|[low, high]| high - low).sum::<f64>() < edge.length - tolerance,
            ));
            pieces.extend(open.iter().map(|&[low, high]| {
                piece(
                    polygon.corners[k],
                    &edge,
                    [low, high],
                    polygon.corners[(k + 1) % polygon.corners.len()],
                    i,
                )
            }));
        }
        if let Solid::Polygon(polygon) = &mut solids[i] {
            polygon
                .sides
                .iter_mut()
                .zip(bare)
                .for_each(|(side, bare)| (side.exposed, side.seam) = bare);
        }
    }
    pieces
}

/// What is left of an interval without a covered one: decided by the cover with tolerance, cut at
/// the exact one.
fn without(
    [low, high]: [f64; 2],
    near: [f64; 2],
    exact: [f64; 2],
) -> impl Iterator<Item = [f64; 2]> {
    let apart = near[1] <= low || near[0] >= high;
    let before = if near[0] > low {
        [low, exact[0].min(high)]
    } else {
        [low, low]
    };
    let after = if near[1] < high {
        [exact[1].max(low), high]
    } else {
        [high, high]
    };
    let pieces = if apart {
        [[low, high], [high, high]]
    } else {
        [before, after]
    };
    pieces.into_iter().filter(|[a, b]| b > a)
}

/// The stretch of an edge from corner `from` to corner `to`, whose own ends are kept bit for bit.
fn piece(from: Vec2, edge: &Edge, [low, high]: [f64; 2], to: Vec2, part: usize) -> Piece {
    let start = if low > 0.0 { edge.at(low) } else { from };
    let end = if high < edge.length {
        edge.at(high)
    } else {
        to
    };
    Piece {
        ends: [start, end],
        parts: [part; 2],
        next: None,
    }
}

/// Finds for each piece the one that goes on where it ends; where several do, the one that turns
/// most to the left.
fn chain(pieces: &mut [Piece], tolerance: f64) {
    for i in 0..pieces.len() {
        let follows = |j: &usize| {
            *j != i && length(sub(pieces[*j].ends[0], pieces[i].ends[1])) <= 4.0 * tolerance
        };
        let turn = |j: usize| {
            let (t, u) = (
                sub(pieces[i].ends[1], pieces[i].ends[0]),
                sub(pieces[j].ends[1], pieces[j].ends[0]),
            );
            libm::atan2(cross(t, u), dot(t, u))
        };
        pieces[i].next = (0..pieces.len())
            .filter(follows)
            .max_by(|a, b| turn(*a).total_cmp(&turn(*b)));
    }
    for i in 0..pieces.len() {
        if let Some(j) = pieces[i].next {
            pieces[i].ends[1] = pieces[j].ends[0];
        }
    }
}

/// Joins neighbours in line: exactly so within one part, within the tolerance across a seam.
fn merge(pieces: &mut Vec<Piece>, tolerance: f64) {
    while let Some((i, j)) = (0..pieces.len()).find_map(|i| straight_joint(pieces, i, tolerance)) {
        pieces[i] = Piece {
            ends: [pieces[i].ends[0], pieces[j].ends[1]],
            parts: [pieces[i].parts[0], pieces[j].parts[1]],
            next: pieces[j].next,
        };
        pieces.remove(j);
        for piece in pieces.iter_mut() {
            piece.next = piece
                .next
                .map(|k| if k == j { i } else { k })
                .map(|k| if k > j { k - 1 } else { k });
        }
    }
}

fn straight_joint(pieces: &[Piece], i: usize, tolerance: f64) -> Option<(usize, usize)> {
    let j = pieces[i].next.filter(|j| *j != i)?;
    let sole = pieces.iter().filter(|piece| piece.next == Some(j)).count() == 1;
    let (from, joint, to) = (pieces[i].ends[0], pieces[i].ends[1], pieces[j].ends[1]);
    let (s, height) = Edge::between(from, to).coordinates(joint);
    let same_part = pieces[i].parts[1] == pieces[j].parts[0];
    let limit = if same_part {
        STRAIGHT / crate::geometry::shape::TOLERANCE * tolerance
    } else {
        tolerance
    };
    // a dent of rounding is straightened like a seam: it would be a reflex corner that no convex
    // part can have
    let dent = same_part && height < 0.0 && -height <= 2.0 * tolerance;
    (sole && s > 0.0 && s < length(sub(to, from)) && (height.abs() <= limit || dent))
        .then_some((i, j))
}

/// The edges of chained pieces, with their reflex neighbours and how far their lines run on inside
/// the body.
fn edges(pieces: &[Piece], solids: &[Solid], tolerance: f64) -> Vec<Edge> {
    let mut edges: Vec<Edge> = pieces
        .iter()
        .map(|piece| Edge::between(piece.ends[0], piece.ends[1]))
        .collect();
    let before = |i: usize| pieces.iter().position(|piece| piece.next == Some(i));
    for i in 0..edges.len() {
        let neighbours = [before(i), pieces[i].next];
        let turns = [
            neighbours[0].map(|j| turn(&edges[j], &edges[i])),
            neighbours[1].map(|j| turn(&edges[i], &edges[j])),
        ];
        for end in 0..2 {
            if turns[end].is_some_and(|turn| turn > 0.0) {
                continue;
            }
            edges[i].buried[end] = buried(&edges[i], end, solids, tolerance);
            edges[i].reflex[end] = neighbours[end].map(|j| j as u32);
        }
    }
    edges
}

fn turn(before: &Edge, after: &Edge) -> f64 {
    cross(before.along, after.along)
}

/// How far (m, up to the edge's own length) its line runs on inside the body beyond its start (end
/// 0) or its end (1).
fn buried(edge: &Edge, end: usize, solids: &[Solid], tolerance: f64) -> f64 {
    const STEPS: u32 = 32;
    let inside = |share: f64| {
        let s = if end == 0 {
            -share * edge.length
        } else {
            (1.0 + share) * edge.length
        };
        solids
            .iter()
            .any(|solid| solid.depth(edge.at(s)) > -tolerance)
    };
    let steps = (1..=STEPS)
        .take_while(|k| inside(f64::from(*k) / f64::from(STEPS)))
        .count();
    edge.length * steps as f64 / f64::from(STEPS)
}

/// The convex corners, each at the end of its edge.
fn corners(edges: &[Edge], pieces: &[Piece]) -> Vec<Round> {
    let corner = |(i, piece): (usize, &Piece)| {
        let j = piece.next?;
        let cone = Cone::corner(edges[i].along, edges[j].along);
        (turn(&edges[i], &edges[j]) > 0.0).then_some(Round {
            centre: piece.ends[1],
            radius: 0.0,
            cone,
            covered: false,
        })
    };
    pieces.iter().enumerate().filter_map(corner).collect()
}
