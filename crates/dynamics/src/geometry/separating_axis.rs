//! Least penetration of overlapping polygons by separating axes ([`least_penetration`]), and where
//! it need not be asked for ([`separated`]).

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::Gap;
use crate::geometry::convex_part::ConvexPart;
use crate::geometry::polygon::{Polygon, Side};
use crate::geometry::transform::Transform;
use crate::geometry::vec2::{Vec2, add, dot, length, negate, scale, sub};

/// The deepest one of the least penetrations of all pairs of polygons that overlap, in the object's
/// frame; `other_in_object` places the other body there.
pub(crate) fn least_penetration(
    [object, other]: [&[ConvexPart]; 2],
    other_in_object: &Transform,
) -> Option<Gap> {
    let object_in_other = other_in_object.inverse();
    let mut deepest: Option<Gap> = None;
    for a in object.iter().filter_map(ConvexPart::polygon) {
        for b in other.iter().filter_map(ConvexPart::polygon) {
            let overlap = of_polygons([a, b], other_in_object, &object_in_other);
            if overlap.is_some_and(|new| deepest.is_none_or(|old| new.gap < old.gap)) {
                deepest = overlap;
            }
        }
    }
    deepest
}

/// The least penetration of two polygons, in the frame of `a`.
fn of_polygons([a, b]: [&Polygon; 2], b_in_a: &Transform, a_in_b: &Transform) -> Option<Gap> {
    if length(sub(b_in_a.transform_point(b.centre), a.centre)) >= a.radius + b.radius {
        return None;
    }
    let (normal, corner, gap) = shallowest(a, b, a_in_b)?;
    let by_a = Gap {
        normal: negate(normal),
        arm: add(b_in_a.transform_point(corner), scale(-gap, normal)),
        gap,
    };
    let (normal, corner, gap) = shallowest(b, a, b_in_a)?;
    let by_b = Gap {
        normal: b_in_a.rotate(normal),
        arm: corner,
        gap,
    };
    Some(if by_a.gap >= by_b.gap { by_a } else { by_b })
}

/// Among the sides of `a`, the one that `b` reaches least far behind: its normal in a's frame, b's
/// deepest corner in b's frame, and the gap. `None` where a side has all of `b` in front. Seams are
/// no way out.
fn shallowest(a: &Polygon, b: &Polygon, a_in_b: &Transform) -> Option<(Vec2, Vec2, f64)> {
    let mut best: Option<(Vec2, Vec2, f64)> = None;
    for (side, start) in a.sides.iter().zip(&a.vertices) {
        let normal = a_in_b.rotate(side.normal);
        let on_line = a_in_b.transform_point(*start);
        let mut deepest = (b.vertices[0], f64::INFINITY);
        for corner in &b.vertices {
            let height = dot(normal, sub(*corner, on_line));
            if height < deepest.1 {
                deepest = (*corner, height);
            }
        }
        if deepest.1 >= 0.0 {
            return None;
        }
        if side.exposed && best.is_none_or(|(_, _, gap)| deepest.1 > gap) {
            best = Some((side.normal, deepest.0, deepest.1));
        }
    }
    best
}

/// The gap of [`least_penetration`] of two convex polygons (m), not negative where they do not
/// overlap; `transforms` place `b` in the frame of `a`, and `a` in that of `b`.
#[inline(always)]
pub(crate) fn least_gap<const W: usize>(
    [a, b]: [&ConvexPart; 2],
    [b_in_a, a_in_b]: [&Transform<Lanes<W>>; 2],
) -> Lanes<W> {
    let mut least = Lanes::splat(f64::NEG_INFINITY);
    for (a, b, b_in_a) in [(a, b, b_in_a), (b, a, a_in_b)] {
        if let (ConvexPart::Polygon(a), ConvexPart::Polygon(b)) = (a, b) {
            for side in &a.sides {
                least = least.max(lowest(side, &b.vertices, b_in_a));
            }
        }
    }
    least
}

/// Height of the lowest corner above the line of a side (m); `transform` places the corners in the
/// side's frame.
#[inline(always)]
fn lowest<const W: usize>(
    side: &Side,
    corners: &[Vec2],
    transform: &Transform<Lanes<W>>,
) -> Lanes<W> {
    let normal = transform.inv_rotate(side.normal);
    let mut lowest = Lanes::splat(f64::INFINITY);
    for corner in corners {
        lowest = lowest.min(dot(normal, *corner));
    }
    lowest + (dot(transform.origin, side.normal) - side.offset)
}

/// The lanes of `asked` in which every pair of polygons has a side that the other one does not
/// reach deeper than `depth` (m, negative) behind; `transforms` as in [`least_gap`].
#[inline(always)]
pub(crate) fn separated<const W: usize>(
    [object, other]: [&[ConvexPart]; 2],
    [other_in_object, object_in_other]: [&Transform<Lanes<W>>; 2],
    asked: Mask<W>,
    depth: f64,
) -> Mask<W> {
    let mut all = asked;
    for a in object.iter().filter_map(ConvexPart::polygon) {
        for b in other.iter().filter_map(ConvexPart::polygon) {
            let mut apart = has_clear_side(a, b, other_in_object, all, depth);
            if (all & !apart).any() {
                apart = apart | has_clear_side(b, a, object_in_other, all & !apart, depth);
            }
            all = all & apart;
        }
    }
    all
}

/// The lanes of `asked` in which a side of `a` has all of `b` above `depth`.
#[inline(always)]
fn has_clear_side<const W: usize>(
    a: &Polygon,
    b: &Polygon,
    b_in_a: &Transform<Lanes<W>>,
    asked: Mask<W>,
    depth: f64,
) -> Mask<W> {
    let Some(lane) = asked.lanes().next() else {
        return asked;
    };
    // the side that faces the other's centre is the likely one
    let centre = b_in_a.lane(lane).transform_point(b.centre);
    let above = |k: usize| dot(a.sides[k].normal, centre) - a.sides[k].offset;
    let likely =
        (1..a.sides.len()).fold(0, |best, k| if above(k) > above(best) { k } else { best });
    let mut clear = Mask::splat(false);
    for k in std::iter::once(likely).chain(0..a.sides.len()) {
        clear = clear | lowest(&a.sides[k], &b.vertices, b_in_a).gt(Lanes::splat(depth));
        if !(asked & !clear).any() {
            break;
        }
    }
    asked & clear
}
