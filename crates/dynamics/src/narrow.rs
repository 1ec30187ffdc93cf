//! Contacts between two placed shapes: gap, normal and contact point ([`narrow_phase`]).
//!
//! Normals point INTO the object; a positive gap means apart. Pairs of features that can touch are an edge with a round one
//! (corner, disc, ellipse), either way round, and two round ones. A round feature faces an edge where its own normal cone, a
//! little widened, holds the edge's opposite normal: so faces that meet, slightly tilted, give two points.

use crate::outline::{Edge, Round, RoundKind};
use crate::separation::widest;
use crate::{Pose, Shape};

/// Sine of the angle by which a corner's normal cone is widened when it meets an edge.
const TILT: f64 = 0.1;

/// Slack of borders between features, as a share of length or a sine, so that one of two neighbours always answers.
const BORDER: f64 = 1e-9;

/// A contact of the object with another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Unit normal into the object, world frame.
    pub normal: [f64; 2],
    /// Contact point on the object's boundary minus the object's origin, world frame (m).
    pub arm: [f64; 2],
    /// Gap (m); negative is overlap.
    pub gap: f64,
}

/// A shape at a pose, with the pose's sine and cosine.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    shape: &'a Shape,
    frame: Frame,
}

/// A rigid motion: p ↦ origin + R p.
#[derive(Clone, Copy, Debug)]
struct Frame {
    origin: [f64; 2],
    cos: f64,
    sin: f64,
}

impl<'a> Placed<'a> {
    /// Places a shape.
    pub fn new(shape: &'a Shape, pose: Pose) -> Self {
        let (sin, cos) = libm::sincos(pose.theta);
        Self { shape, frame: Frame { origin: [pose.x, pose.y], cos, sin } }
    }
}

impl Frame {
    #[inline(always)]
    fn rotate(&self, v: [f64; 2]) -> [f64; 2] {
        [self.cos * v[0] - self.sin * v[1], self.sin * v[0] + self.cos * v[1]]
    }

    #[inline(always)]
    fn point(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.rotate(p);
        [self.origin[0] + x, self.origin[1] + y]
    }

    /// This frame as seen from `base`.
    fn relative_to(&self, base: &Frame) -> Frame {
        let d = [self.origin[0] - base.origin[0], self.origin[1] - base.origin[1]];
        Frame {
            origin: [base.cos * d[0] + base.sin * d[1], base.cos * d[1] - base.sin * d[0]],
            cos: base.cos * self.cos + base.sin * self.sin,
            sin: base.cos * self.sin - base.sin * self.cos,
        }
    }

    fn inverse(&self) -> Frame {
        let [x, y] = self.origin;
        Frame { origin: [-self.cos * x - self.sin * y, self.sin * x - self.cos * y], cos: self.cos, sin: -self.sin }
    }

    fn round(&self, round: &Round) -> Round {
        let kind = match round.kind {
            RoundKind::Corner { from, to } => RoundKind::Corner { from: self.rotate(from), to: self.rotate(to) },
            RoundKind::Disc { radius } => RoundKind::Disc { radius },
            RoundKind::Ellipse { semi_axes, axis } => RoundKind::Ellipse { semi_axes, axis: self.rotate(axis) },
        };
        Round { centre: self.point(round.centre), kind }
    }
}

/// Appends every contact of `object` with `other` whose gap is below `reach` (m).
///
/// Nothing is allocated but what `out` grows by.
pub fn narrow_phase(object: &Placed<'_>, other: &Placed<'_>, reach: f64, out: &mut Vec<Gap>) {
    let view = other.frame.relative_to(&object.frame);
    let apart = view.origin[0].hypot(view.origin[1]) - object.shape.bounding_radius() - other.shape.bounding_radius();
    if apart >= reach {
        return;
    }
    let back = view.inverse();
    let first = out.len();

    // the other's corners and discs against the object's edges, in the object's frame
    for round in &other.shape.features().rounds {
        let near = |centre: [f64; 2]| centre[0].hypot(centre[1]) - round.radius() < object.shape.bounding_radius() + reach;
        if near(view.point(round.centre)) {
            round_on_edges(&view.round(round), object.shape, reach, |edge, gap, touch| {
                out.push(Gap { normal: [-edge.normal[0], -edge.normal[1]], arm: [touch[0] - gap * edge.normal[0], touch[1] - gap * edge.normal[1]], gap });
            });
        }
    }
    // the object's corners and discs against the other's edges, in the other's frame
    for round in &object.shape.features().rounds {
        let centre = back.point(round.centre);
        if centre[0].hypot(centre[1]) - round.radius() < other.shape.bounding_radius() + reach {
            round_on_edges(&back.round(round), other.shape, reach, |edge, gap, touch| {
                out.push(Gap { normal: view.rotate(edge.normal), arm: view.point(touch), gap });
            });
            round_on_rounds(round, other.shape, &view, reach, out);
        }
    }
    finish(object, other, &back, first, out);
}

/// Drops contacts inside a sibling part and turns the rest into the world frame.
fn finish(object: &Placed<'_>, other: &Placed<'_>, back: &Frame, first: usize, out: &mut Vec<Gap>) {
    let mut kept = first;
    for k in first..out.len() {
        let gap = out[k];
        let on_other = [gap.arm[0] - gap.gap * gap.normal[0], gap.arm[1] - gap.gap * gap.normal[1]];
        if !object.shape.hides(gap.arm) && !other.shape.hides(back.point(on_other)) {
            out[kept] = Gap { normal: object.frame.rotate(gap.normal), arm: object.frame.rotate(gap.arm), gap: gap.gap };
            kept += 1;
        }
    }
    out.truncate(kept);
}

/// Reports (edge, gap, touching point of the round feature) for every edge of `shape` that the round feature meets.
///
/// From outside, every edge that it stands over is met. Where its centre is inside the shape, only the edge that is nearest
/// to the surface is: the way out.
#[inline(always)]
fn round_on_edges(round: &Round, shape: &Shape, reach: f64, mut report: impl FnMut(&Edge, f64, [f64; 2])) {
    let mut outside = false;
    let mut way_out: Option<(&Edge, f64, [f64; 2])> = None;
    for edge in &shape.features().edges {
        let outward = edge.normal;
        let (_, height) = edge.coordinates(round.centre);
        let gap = height - round.support(outward);
        if gap >= reach {
            continue;
        }
        let inward = [-outward[0], -outward[1]];
        let offset = round.support_point(inward);
        let touch = [round.centre[0] + offset[0], round.centre[1] + offset[1]];
        let (along, _) = edge.coordinates(touch);
        let over = along >= -BORDER * edge.length && along <= (1.0 + BORDER) * edge.length;
        if !over || !round.faces(inward, TILT) {
            continue;
        }
        if height >= 0.0 {
            outside = true;
            report(edge, gap, touch);
        } else if way_out.is_none_or(|(_, best, _)| gap > best) {
            way_out = Some((edge, gap, touch));
        }
    }
    if let Some((edge, gap, touch)) = way_out
        && !outside
        && shape.contains(round.centre)
    {
        report(edge, gap, touch);
    }
}

/// Contacts of one round feature of the object with the other's round features, in the object's frame.
fn round_on_rounds(round: &Round, other: &Shape, view: &Frame, reach: f64, out: &mut Vec<Gap>) {
    for theirs in &other.features().rounds {
        let centre = view.point(theirs.centre);
        let d = [round.centre[0] - centre[0], round.centre[1] - centre[1]];
        if d[0].hypot(d[1]) >= reach + round.radius() + theirs.radius() {
            continue;
        }
        let theirs = view.round(theirs);
        let (normal, gap) = widest(round, &theirs, d);
        let inward = [-normal[0], -normal[1]];
        if gap < reach && theirs.faces(normal, BORDER) && round.faces(inward, BORDER) {
            let offset = round.support_point(inward);
            out.push(Gap { normal, arm: [round.centre[0] + offset[0], round.centre[1] + offset[1]], gap });
        }
    }
}
