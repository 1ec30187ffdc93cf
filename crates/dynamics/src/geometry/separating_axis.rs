//! Least penetration of overlapping polygons by separating axes ([`least_penetration`]), and where
//! it need not be asked for ([`separated`]).

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::part::{Polygon, Side, Solid};
use crate::geometry::transform::{Frame, Frames, dot_fixed};
use crate::geometry::vec2::{Vec2, add, dot, length, negate, scale, sub};

/// A contact in the object's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    /// Unit normal into the object.
    pub normal: Vec2,
    /// Point of the object's boundary.
    pub touch: Vec2,
    /// Gap (m), negative.
    pub gap: f64,
}

/// The deepest one of the least penetrations of all pairs of polygons that overlap; `frame` is that
/// of `theirs` seen from `mine`.
pub(crate) fn least_penetration(
    mine: &[Solid],
    theirs: &[Solid],
    frame: &Frame,
) -> Option<Overlap> {
    let inverse = frame.inverse();
    let mut deepest: Option<Overlap> = None;
    for a in mine.iter().filter_map(polygon) {
        for b in theirs.iter().filter_map(polygon) {
            let overlap = of_pair(a, b, frame, &inverse);
            if overlap.is_some_and(|new| deepest.is_none_or(|old| new.gap < old.gap)) {
                deepest = overlap;
            }
        }
    }
    deepest
}

fn polygon(solid: &Solid) -> Option<&Polygon> {
    if let Solid::Polygon(polygon) = solid {
        Some(polygon)
    } else {
        None
    }
}

fn of_pair(a: &Polygon, b: &Polygon, frame: &Frame, inverse: &Frame) -> Option<Overlap> {
    if length(sub(frame.point(b.centre), a.centre)) >= a.radius + b.radius {
        return None;
    }
    let (normal, corner, gap) = shallowest(a, b, inverse)?;
    let by_a = Overlap {
        normal: negate(normal),
        touch: add(frame.point(corner), scale(-gap, normal)),
        gap,
    };
    let (normal, corner, gap) = shallowest(b, a, frame)?;
    let by_b = Overlap {
        normal: frame.turn(normal),
        touch: corner,
        gap,
    };
    Some(if by_a.gap >= by_b.gap { by_a } else { by_b })
}

/// Among the sides of `a`, the one that `b` reaches least far behind: its normal in a's frame, b's
/// deepest corner in b's frame, and the gap. `None` where a side has all of `b` before it. Seams
/// are no way out. `frame` is that of `a` seen from `b`.
fn shallowest(a: &Polygon, b: &Polygon, frame: &Frame) -> Option<(Vec2, Vec2, f64)> {
    let mut best: Option<(Vec2, Vec2, f64)> = None;
    for (side, start) in a.sides.iter().zip(&a.corners) {
        let (normal, on_line) = (frame.turn(side.normal), frame.point(*start));
        let mut deepest = (b.corners[0], f64::INFINITY);
        for corner in &b.corners {
            let height = dot(normal, sub(*corner, on_line));
            deepest = if height < deepest.1 {
                (*corner, height)
            } else {
                deepest
            };
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
/// overlap; `frames` are those of `b` seen from `a`, and the inverse.
#[inline(always)]
pub(crate) fn least_gap<const W: usize>(
    [a, b]: [&Solid; 2],
    [in_a, in_b]: [&Frames<W>; 2],
) -> Lanes<W> {
    let mut least = Lanes::splat(f64::NEG_INFINITY);
    for (mine, theirs, frame) in [(a, b, in_a), (b, a, in_b)] {
        if let (Solid::Polygon(mine), Solid::Polygon(theirs)) = (mine, theirs) {
            for side in &mine.sides {
                least = least.max(lowest(side, &theirs.corners, frame));
            }
        }
    }
    least
}

/// Height of the lowest corner above the line of a side (m); `frame` is that of the corners seen
/// from the side's body.
#[inline(always)]
fn lowest<const W: usize>(side: &Side, corners: &[Vec2], frame: &Frames<W>) -> Lanes<W> {
    let turned = frame.turn_back_fixed(side.normal);
    let mut lowest = Lanes::splat(f64::INFINITY);
    for corner in corners {
        lowest = lowest.min(dot_fixed(&turned, *corner));
    }
    lowest + (dot_fixed(&frame.origin, side.normal) - side.offset)
}

/// The lanes of `asked` in which every pair of polygons has a side that the other one does not
/// reach deeper than `depth` (m, negative) behind; `frames` are those of `theirs` seen from `mine`,
/// and the inverse.
#[inline(always)]
pub(crate) fn separated<const W: usize>(
    mine: &[Solid],
    theirs: &[Solid],
    frames: [&Frames<W>; 2],
    asked: Mask<W>,
    depth: f64,
) -> Mask<W> {
    let [in_mine, in_theirs] = frames;
    let mut all = asked;
    for a in mine.iter().filter_map(polygon) {
        for b in theirs.iter().filter_map(polygon) {
            let mut apart = has_clear_side(a, b, in_mine, all, depth);
            if (all & !apart).any() {
                apart = apart | has_clear_side(b, a, in_theirs, all & !apart, depth);
            }
            all = all & apart;
        }
    }
    all
}

/// The lanes of `asked` in which a side of `a` has all of `b` above `depth`; `frame` is that of `b`
/// seen from `a`.
#[inline(always)]
fn has_clear_side<const W: usize>(
    a: &Polygon,
    b: &Polygon,
    frame: &Frames<W>,
    asked: Mask<W>,
    depth: f64,
) -> Mask<W> {
    let Some(lane) = asked.lanes().next() else {
        return asked;
    };
    // the side that faces the other's centre is the likely one
    let centre = frame.lane(lane).point(b.centre);
    let above = |k: usize| dot(a.sides[k].normal, centre) - a.sides[k].offset;
    let likely =
        (1..a.sides.len()).fold(0, |best, k| if above(k) > above(best) { k } else { best });
    let mut clear = Mask::splat(false);
    for k in std::iter::once(likely).chain(0..a.sides.len()) {
        clear = clear | lowest(&a.sides[k], &b.corners, frame).gt(Lanes::splat(depth));
        if !(asked & !clear).any() {
            break;
        }
    }
    asked & clear
}
