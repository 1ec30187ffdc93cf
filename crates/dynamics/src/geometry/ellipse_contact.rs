//! Contacts of an ellipse with one shape ([`EllipseContact`]): in closed form with an edge, by
//! Newton's method on the [`Separation`] with a rounded vertex.

use crate::geometry::contact::Gap;
use crate::geometry::convex_part::ConvexPart;
use crate::geometry::edge::Edge;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::polygon::Polygon;
use crate::geometry::rounded_vertex::RoundedVertex;
use crate::geometry::separation::{Peak, Separation};
use crate::geometry::shape::Shape;
use crate::geometry::vec2::{Vec2, add, dot, length, negate, scale, splat, sub};

/// A contact of an ellipse with a shape, and whether a sibling part hides its point.
///
/// [`EllipseContact::find`] gives it in the shape's frame, with the ellipse as the object: the
/// normal points into the ellipse, the arm is a boundary point of the ellipse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EllipseContact {
    pub contact: Gap,
    pub hidden: bool,
}

impl EllipseContact {
    /// Reports the contacts of an ellipse with a shape whose gap is below the search distance.
    pub fn find(
        ellipse: &Ellipse,
        shape: &Shape,
        [search_distance, slack]: [f64; 2],
        mut report: impl FnMut(Self),
    ) {
        if shape.parts().len() > 1 {
            with_union(ellipse, shape, [search_distance, slack], report);
        } else if let Some(contact) = with_convex(ellipse, shape, slack)
            && contact.gap < search_distance
        {
            report(Self::visible(contact));
        }
    }

    fn visible(contact: Gap) -> Self {
        Self {
            contact,
            hidden: false,
        }
    }
}

/// Returns true if a boundary point of one part of `shape` is not on the union's boundary.
pub(crate) fn hides(shape: &Shape, point: Vec2) -> bool {
    shape.hides(splat::<1>(point)).lane(0)
}

/// Two convex bodies have one contact: where the separation is largest.
fn with_convex(ellipse: &Ellipse, shape: &Shape, slack: f64) -> Option<Gap> {
    let mut best: Option<Gap> = None;
    let edges = &shape.outline().edges;
    for contact in edges
        .iter()
        .filter_map(|edge| with_edge(ellipse, edge, slack))
    {
        // apart, a local maximum is the only one
        if contact.gap >= 0.0 {
            return Some(contact);
        }
        best = wider(best, contact);
    }
    for vertex in &shape.outline().vertices {
        let d = sub(ellipse.centre, vertex.centre);
        let bound = vertex.cone.support(d) - ellipse.inner_radius() - vertex.radius;
        if best.is_none_or(|best| bound > best.gap)
            && let Some(contact) = with_vertex(ellipse, vertex, slack)
        {
            best = wider(best, contact);
        }
    }
    best
}

/// The one with the larger separation.
fn wider(best: Option<Gap>, new: Gap) -> Option<Gap> {
    Some(best.filter(|best| best.gap >= new.gap).unwrap_or(new))
}

/// A union touches with every feature that has the ellipse's centre in front; where the centre is
/// inside, with the feature of least penetration too. Where none of these explains an overlap, as
/// about a part that the ellipse holds whole, the contact is the least penetration into the parts.
fn with_union(
    ellipse: &Ellipse,
    shape: &Shape,
    [search_distance, slack]: [f64; 2],
    mut report: impl FnMut(EllipseContact),
) {
    let (mut way_out, mut explained): (Option<EllipseContact>, bool) = (None, false);
    let mut consider = |new: EllipseContact, from: Vec2| {
        let gap = new.contact.gap;
        let height = dot(new.contact.normal, sub(ellipse.centre, from));
        explained |= height >= 0.0 && gap < 0.0;
        if height >= 0.0 && gap < search_distance {
            report(new);
        } else if height < 0.0 && way_out.is_none_or(|way| gap > way.contact.gap) {
            way_out = Some(new);
        }
    };

    // every feature
    for edge in &shape.outline().edges {
        if let Some(contact) = with_edge(ellipse, edge, slack) {
            consider(EllipseContact::visible(contact), edge.start);
        }
    }
    for vertex in &shape.outline().vertices {
        let distance = length(sub(ellipse.centre, vertex.centre));
        if distance - vertex.radius - ellipse.outer_radius() < search_distance
            && let Some(contact) = with_vertex(ellipse, vertex, slack)
        {
            let point = add(vertex.centre, scale(vertex.radius, contact.normal));
            let hidden = vertex.covered && hides(shape, point);
            consider(EllipseContact { contact, hidden }, vertex.centre);
        }
    }

    // the way out from inside, or else out of the parts
    let way_out = way_out.filter(|_| shape.contains(splat::<1>(ellipse.centre)).lane(0));
    let least = if explained || way_out.is_some() {
        None
    } else {
        least_penetration(ellipse, shape.convex_parts()).map(EllipseContact::visible)
    };
    if let Some(way) = way_out.or(least)
        && way.contact.gap < search_distance
    {
        report(way);
    }
}

/// Into the polygons of a union that an ellipse overlaps: each one's shallowest way out, the
/// deepest of these.
fn least_penetration(ellipse: &Ellipse, parts: &[ConvexPart]) -> Option<Gap> {
    parts
        .iter()
        .filter_map(ConvexPart::polygon)
        .filter(|polygon| overlaps(ellipse, polygon))
        .filter_map(|polygon| shallowest(ellipse, polygon))
        .reduce(|deepest, way| if way.gap < deepest.gap { way } else { deepest })
}

/// The side that an ellipse reaches least far behind; seams are no way out.
fn shallowest(ellipse: &Ellipse, polygon: &Polygon) -> Option<Gap> {
    let exposed = polygon.sides.iter().filter(|side| side.exposed);
    exposed.fold(None, |best, side| {
        let gap = dot(side.normal, ellipse.centre) - side.offset - ellipse.support(side.normal);
        wider(best, touching(ellipse, side.normal, gap))
    })
}

/// Returns true if an ellipse and a polygon overlap. Both are scaled so that the ellipse is the
/// unit circle, and the polygon's distance from its centre decides.
fn overlaps(ellipse: &Ellipse, polygon: &Polygon) -> bool {
    let scaled = |corner: Vec2| ellipse.normalise(sub(corner, ellipse.centre));
    let nearest = polygon
        .segments()
        .map(|[from, to]| distance_to_segment(scaled(from), scaled(to)))
        .fold(f64::INFINITY, f64::min);
    polygon.depth(splat::<1>(ellipse.centre)).0[0] > 0.0 || nearest < 1.0
}

/// Distance from the origin to a segment.
fn distance_to_segment(from: Vec2, to: Vec2) -> f64 {
    let along = sub(to, from);
    let share = (-dot(from, along) / dot(along, along)).clamp(0.0, 1.0);
    length(add(from, scale(share, along)))
}

/// Contact with an edge, in closed form: the ellipse's lowest point, if it projects onto the edge.
fn with_edge(ellipse: &Ellipse, edge: &Edge, slack: f64) -> Option<Gap> {
    let normal = edge.normal();
    let (_, height) = edge.coordinates(ellipse.centre);
    let contact = touching(ellipse, normal, height - ellipse.support(normal));
    let (s, _) = edge.coordinates(contact.arm);
    edge.spans(s, slack).then_some(contact)
}

/// Contact with a corner or a disc: the largest separation within its cone.
fn with_vertex(ellipse: &Ellipse, vertex: &RoundedVertex, slack: f64) -> Option<Gap> {
    let separation = Separation {
        d: sub(ellipse.centre, vertex.centre),
        ellipses: [Some(ellipse), None],
        radius: vertex.radius,
    };
    let Peak { normal, gap } = separation.widest(&vertex.cone, slack)?;
    Some(touching(ellipse, normal, gap))
}

/// The contact of an ellipse along a normal.
fn touching(ellipse: &Ellipse, normal: Vec2, gap: f64) -> Gap {
    Gap {
        normal,
        arm: ellipse.point(negate(normal)),
        gap,
    }
}
