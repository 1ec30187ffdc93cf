//! The boundary of a union of parts as features that can touch: [`Features`].
//!
//! Polygon edges that parts share are seams, not boundary; what is left is chained, and neighbours in line are merged, so that no
//! vertex stands on a straight seam. A convex corner keeps the normal cone of the union; a reflex corner is no feature.

use crate::shape::{Part, edges};

/// Boundary features of a shape in its own frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Features {
    pub edges: Vec<Edge>,
    pub rounds: Vec<Round>,
}

/// A straight piece of boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub start: [f64; 2],
    /// Unit direction, the body on its left.
    pub along: [f64; 2],
    /// Unit outward normal.
    pub normal: [f64; 2],
    pub length: f64,
}

/// A convex corner, a disc or an ellipse: a centre with a support function and a cone of outward normals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    pub centre: [f64; 2],
    pub kind: RoundKind,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum RoundKind {
    /// A polygon's corner with the outward normals of the edges that end and begin there, counter-clockwise in this order.
    Corner { from: [f64; 2], to: [f64; 2] },
    Disc { radius: f64 },
    /// Semi-axes and the unit vector of the first one.
    Ellipse { semi_axes: [f64; 2], axis: [f64; 2] },
}

/// A directed piece of a polygon's edge.
#[derive(Clone, Copy, Debug)]
struct Piece {
    a: [f64; 2],
    b: [f64; 2],
}

/// The features of a union; points nearer than `tolerance` (m) are one.
pub(crate) fn features(parts: &[Part], tolerance: f64) -> Features {
    let mut features = Features::default();
    for part in parts {
        match part {
            Part::Polygon { .. } => {}
            Part::Disc { radius, centre } => features.rounds.push(Round { centre: *centre, kind: RoundKind::Disc { radius: *radius } }),
            Part::Ellipse { semi_axes, centre, angle } => {
                let (sin, cos) = libm::sincos(*angle);
                let kind = RoundKind::Ellipse { semi_axes: *semi_axes, axis: [cos, sin] };
                features.rounds.push(Round { centre: *centre, kind });
            }
        }
    }
    let pieces = merged(boundary_pieces(parts, tolerance), tolerance);
    for piece in &pieces {
        features.edges.extend(edge(piece));
    }
    features.rounds.extend(pieces.iter().filter_map(|piece| corner_at_end(piece, &pieces, tolerance)));
    features
}

/// All polygon edges without the stretches that lie on another polygon's edge, back to back.
fn boundary_pieces(parts: &[Part], tolerance: f64) -> Vec<Piece> {
    let polygons: Vec<&Vec<[f64; 2]>> = parts.iter().filter_map(|p| if let Part::Polygon { vertices } = p { Some(vertices) } else { None }).collect();
    let mut pieces = Vec::new();
    for (i, polygon) in polygons.iter().enumerate() {
        let others = polygons.iter().enumerate().filter(|(j, _)| *j != i).flat_map(|(_, other)| edges(other));
        let others: Vec<Piece> = others.map(|(a, b)| Piece { a, b }).collect();
        for (a, b) in edges(polygon) {
            pieces.extend(without_seams(Piece { a, b }, &others, tolerance));
        }
    }
    pieces
}

fn without_seams(piece: Piece, others: &[Piece], tolerance: f64) -> Vec<Piece> {
    let Some(line) = edge(&piece) else { return Vec::new() };
    let mut open = vec![(0.0f64, line.length)];
    for other in others {
        let (s0, d0) = line.coordinates(other.b);
        let (s1, d1) = line.coordinates(other.a);
        if d0.abs() <= tolerance && d1.abs() <= tolerance && s0 < s1 {
            open = open.into_iter().flat_map(|(low, high)| [(low, high.min(s0)), (low.max(s1), high)]).filter(|(l, h)| h - l > tolerance).collect();
        }
    }
    open.into_iter().map(|(low, high)| Piece { a: line.snapped(low, &piece, tolerance), b: line.snapped(high, &piece, tolerance) }).collect()
}

/// Joins neighbours whose common point lies on the line between their far ends.
fn merged(mut pieces: Vec<Piece>, tolerance: f64) -> Vec<Piece> {
    let joint = |pieces: &[Piece]| {
        (0..pieces.len()).find_map(|i| {
            let j = successor(&pieces[i], pieces, tolerance)?;
            let chord = edge(&Piece { a: pieces[i].a, b: pieces[j].b })?;
            let (s, d) = chord.coordinates(pieces[i].b);
            (i != j && d.abs() <= tolerance && s > 0.0 && s < chord.length).then_some((i, j))
        })
    };
    while let Some((i, j)) = joint(&pieces) {
        pieces[i].b = pieces[j].b;
        pieces.remove(j);
    }
    pieces
}

/// The piece that begins where this one ends.
fn successor(piece: &Piece, pieces: &[Piece], tolerance: f64) -> Option<usize> {
    pieces.iter().position(|next| (next.a[0] - piece.b[0]).hypot(next.a[1] - piece.b[1]) <= 2.0 * tolerance)
}

fn corner_at_end(piece: &Piece, pieces: &[Piece], tolerance: f64) -> Option<Round> {
    let next = &pieces[successor(piece, pieces, tolerance)?];
    let (before, after) = (edge(piece)?, edge(next)?);
    let turn = before.along[0] * after.along[1] - before.along[1] * after.along[0];
    (turn > 0.0).then_some(Round { centre: piece.b, kind: RoundKind::Corner { from: before.normal, to: after.normal } })
}

fn edge(piece: &Piece) -> Option<Edge> {
    let d = [piece.b[0] - piece.a[0], piece.b[1] - piece.a[1]];
    let length = d[0].hypot(d[1]);
    let along = [d[0] / length, d[1] / length];
    (length > 0.0).then_some(Edge { start: piece.a, along, normal: [along[1], -along[0]], length })
}

impl Edge {
    /// (distance along the edge from its start, signed distance outward).
    #[inline(always)]
    pub fn coordinates(&self, point: [f64; 2]) -> (f64, f64) {
        let d = [point[0] - self.start[0], point[1] - self.start[1]];
        (d[0] * self.along[0] + d[1] * self.along[1], d[0] * self.normal[0] + d[1] * self.normal[1])
    }

    /// The point at distance `s`, which is the piece's own end point where it is near one.
    fn snapped(&self, s: f64, piece: &Piece, tolerance: f64) -> [f64; 2] {
        if s <= tolerance {
            piece.a
        } else if s >= self.length - tolerance {
            piece.b
        } else {
            [self.start[0] + s * self.along[0], self.start[1] + s * self.along[1]]
        }
    }
}

impl Round {
    /// Distance from the centre to the tangent line with outward normal `n`.
    #[inline(always)]
    pub fn support(&self, n: [f64; 2]) -> f64 {
        match self.kind {
            RoundKind::Corner { .. } => 0.0,
            RoundKind::Disc { radius } => radius,
            RoundKind::Ellipse { semi_axes: [a, b], axis } => {
                let (c, s) = (n[0] * axis[0] + n[1] * axis[1], n[1] * axis[0] - n[0] * axis[1]);
                (a * a * c * c + b * b * s * s).sqrt()
            }
        }
    }

    /// The boundary point with outward normal `n`, from the centre.
    #[inline(always)]
    pub fn support_point(&self, n: [f64; 2]) -> [f64; 2] {
        match self.kind {
            RoundKind::Corner { .. } => [0.0; 2],
            RoundKind::Disc { radius } => [radius * n[0], radius * n[1]],
            RoundKind::Ellipse { semi_axes: [a, b], axis } => {
                let (c, s) = (n[0] * axis[0] + n[1] * axis[1], n[1] * axis[0] - n[0] * axis[1]);
                let h = (a * a * c * c + b * b * s * s).sqrt();
                let (x, y) = (a * a * c / h, b * b * s / h);
                [x * axis[0] - y * axis[1], x * axis[1] + y * axis[0]]
            }
        }
    }

    /// Largest support.
    pub fn radius(&self) -> f64 {
        match self.kind {
            RoundKind::Corner { .. } => 0.0,
            RoundKind::Disc { radius } => radius,
            RoundKind::Ellipse { semi_axes: [a, b], .. } => a.max(b),
        }
    }

    /// Whether `n` lies in the cone of outward normals, widened by an angle of sine `slack`.
    #[inline(always)]
    pub fn faces(&self, n: [f64; 2], slack: f64) -> bool {
        match self.kind {
            RoundKind::Corner { from, to } => {
                let after = from[0] * n[1] - from[1] * n[0];
                let before = n[0] * to[1] - n[1] * to[0];
                // the cone is narrower than a half turn: inside it both crosses are positive
                after >= -slack && before >= -slack && n[0] * (from[0] + to[0]) + n[1] * (from[1] + to[1]) > 0.0
            }
            _ => true,
        }
    }
}
