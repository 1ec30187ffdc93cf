//! The boundary of a union of convex parts as features that can touch: [`Outline`].
//!
//! Polygon edges are cut where another part covers them: at seams, where two parts share an edge,
//! and at overlaps. What is left is chained, and collinear neighbours are merged, so that a
//! straight seam has no vertex. A convex joint is a corner whose normal cone is that of the union;
//! a reflex one is no feature, but both its edges know that their lines run on inside the body.

use crate::geometry::cluster::Cluster;
use crate::geometry::convex_part::ConvexPart;
use crate::geometry::edge::Edge;
use crate::geometry::normal_cone::NormalCone;
use crate::geometry::part::Part;
use crate::geometry::piece::Piece;
use crate::geometry::rounded_vertex::RoundedVertex;
use crate::geometry::vec2::{cross, length, sub};

/// Boundary features of a shape in its own frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline {
    pub edges: Vec<Edge>,
    pub vertices: Vec<RoundedVertex>,
    /// Several for a convex polygon with many corners, else one of all edges and vertices.
    pub clusters: Vec<Cluster>,
}

impl Outline {
    /// The outline of the union of `parts`, which are `convex` too; lengths below `tolerance` (m)
    /// are rounding. Marks the sides of the polygons as exposed or seams.
    pub fn new(parts: &[Part], convex: &mut [ConvexPart], tolerance: f64) -> Self {
        let pieces = Piece::boundary(convex, tolerance);
        let edges = edges(&pieces, convex, tolerance);
        let mut outline = Self {
            vertices: corners(&edges, &pieces),
            edges,
            ..Self::default()
        };
        for (i, part) in parts.iter().enumerate() {
            if let Part::Disc { radius, centre } = part {
                outline.vertices.push(RoundedVertex {
                    centre: *centre,
                    radius: *radius,
                    cone: NormalCone::full(),
                    covered: is_covered(i, convex, tolerance),
                });
            }
        }
        // the corners of a convex polygon follow each other as its edges do
        let (edges, vertices) = (outline.edges.len(), outline.vertices.len());
        outline.clusters = match parts {
            [Part::Polygon { .. }] if vertices == edges => Cluster::of_polygon(&outline.edges),
            _ => vec![Cluster::of_all(edges.max(vertices))],
        };
        outline
    }
}

/// Returns true if a sibling may hide some of part `i`: their bounding discs overlap.
fn is_covered(i: usize, parts: &[ConvexPart], tolerance: f64) -> bool {
    let (p, r) = parts[i].bounding_disc();
    parts.iter().enumerate().any(|(j, sibling)| {
        let (q, s) = sibling.bounding_disc();
        j != i && length(sub(p, q)) < r + s - tolerance
    })
}

/// The edges of chained pieces, with their reflex neighbours and how far their lines run on inside
/// the body.
fn edges(pieces: &[Piece], parts: &[ConvexPart], tolerance: f64) -> Vec<Edge> {
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
            if turns[end].is_none_or(|turn| turn <= 0.0) {
                edges[i].buried[end] = buried(&edges[i], end, parts, tolerance);
                edges[i].reflex[end] = neighbours[end].map(|j| j as u32);
            }
        }
    }
    edges
}

/// Sine of the angle between two edges: positive at a convex corner.
fn turn(before: &Edge, after: &Edge) -> f64 {
    cross(before.along, after.along)
}

/// Length by which the edge's line runs on inside the body (m, up to the edge's own length): beyond
/// its start (end 0) or its end (1).
fn buried(edge: &Edge, end: usize, parts: &[ConvexPart], tolerance: f64) -> f64 {
    const STEPS: u32 = 32;
    let inside = |share: f64| {
        let s = if end == 0 {
            -share * edge.length
        } else {
            (1.0 + share) * edge.length
        };
        parts
            .iter()
            .any(|part| part.depth_at(edge.at(s)) > -tolerance)
    };
    let steps = (1..=STEPS)
        .take_while(|k| inside(f64::from(*k) / f64::from(STEPS)))
        .count();
    edge.length * steps as f64 / f64::from(STEPS)
}

/// The convex corners, each at the end of its edge.
fn corners(edges: &[Edge], pieces: &[Piece]) -> Vec<RoundedVertex> {
    let corner = |(i, piece): (usize, &Piece)| {
        let next = &edges[piece.next?];
        (turn(&edges[i], next) > 0.0).then(|| RoundedVertex {
            centre: piece.ends[1],
            radius: 0.0,
            cone: NormalCone::of_corner(edges[i].along, next.along),
            covered: false,
        })
    };
    pieces.iter().enumerate().filter_map(corner).collect()
}
