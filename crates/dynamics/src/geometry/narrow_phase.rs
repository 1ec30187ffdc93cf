//! Contacts between two placed shapes, `W` pairs of poses side by side: gap, normal and contact
//! point ([`narrow_phase`]).
//!
//! Signs: the normal points INTO the object; the gap is positive where the bodies are apart. With
//! the twists v of the object and v' of the other body, the rate of the gap is (n, r × n)·v − n·u,
//! r the contact's arm and u the other surface's velocity there.
//!
//! Pairs that can touch: an edge with a round vertex (corner or disc) or an ellipse, either way
//! round, and two of the latter.
//! - A corner meets every edge that it stands over and faces, its normal cone widened a little:
//!   faces that meet give two points.
//! - Two corners meet along the line of their centres where it lies in both cones; the borders of a
//!   cone are those of the edges beside it, so that a corner that is passed is always answered for
//!   by one of them.
//! - A centre inside the other body meets only the edge of least penetration (and those in a reflex
//!   corner with it); edges whose back it sees from outside are not met.
//! - A point of a disc or an ellipse that lies inside a sibling part touches only where an overlap
//!   would have no contact else.
//! - Where polygons overlap with no corner of one in the other, their parts' least penetration (by
//!   separating axes) is a contact; of two convex polygons no gap is deeper than that, and one is
//!   as deep.

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::{Contact, Contacts, Gap};
use crate::geometry::edge_search::Stand;
use crate::geometry::pair::Pair;
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Frame, Frames, Vec2s, dot};
use crate::se2::Pose;

/// A shape at a pose, with the pose's sine and cosine.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    shape: &'a Shape,
    frame: Frame,
}

impl<'a> Placed<'a> {
    /// Places a shape.
    pub fn new(shape: &'a Shape, pose: Pose) -> Self {
        Self {
            shape,
            frame: Frame::new(pose),
        }
    }
}

/// Appends every contact of `object` with `other` whose gap is below `reach` (m).
///
/// The order of contacts is fixed by the shapes' features.
///
/// ```
/// # use stickslip_dynamics::{Part, Placed, Pose, Shape, narrow_phase};
/// let disc = |radius| Shape::new(vec![Part::Disc { radius, centre: [0.0, 0.0] }]);
/// let (object, pusher) = (disc(0.03)?, disc(0.005)?);
/// let mut gaps = Vec::new();
/// let pose = Pose::new(-0.036, 0.0, 0.0);
/// narrow_phase(&Placed::new(&object, Pose::default()), &Placed::new(&pusher, pose), 0.002, &mut gaps);
/// assert_eq!((gaps[0].normal, gaps[0].arm), ([1.0, 0.0], [-0.03, 0.0]));
/// assert!((gaps[0].gap - 0.001).abs() < 1e-15);
/// # Ok::<(), stickslip_dynamics::ShapeError>(())
/// ```
pub fn narrow_phase(object: &Placed<'_>, other: &Placed<'_>, reach: f64, out: &mut Vec<Gap>) {
    let mut work = NarrowWork::<1>::default();
    let frames = Frames1 {
        object: object.frame.splat(),
        other: other.frame.splat(),
    };
    let (shapes, reach) = ([object.shape, other.shape], Lanes([reach]));
    let near = near(shapes, &frames.object.origin, &frames.other.origin, reach);
    if !near.any() {
        return;
    }
    work.meet(shapes, &frames, reach, near);
    out.extend(
        work.contacts()
            .filter(|contact| contact.present.lane(0))
            .map(|contact| contact.lane(0)),
    );
}

type Frames1 = PairFrames<1>;

/// Where the two bodies of a pair are.
pub(crate) struct PairFrames<const W: usize> {
    pub object: Frames<W>,
    pub other: Frames<W>,
}

/// Where two bodies come so near to each other, by their bounding discs, that a gap may be below
/// `reach` (m).
#[inline(always)]
pub(crate) fn near<const W: usize>(
    [object, other]: [&Shape; 2],
    at: &Vec2s<W>,
    other_at: &Vec2s<W>,
    reach: Lanes<W>,
) -> Mask<W> {
    let apart = [at[0] - other_at[0], at[1] - other_at[1]];
    let limit = reach + (object.bounding_radius() + other.bounding_radius());
    limit.gt(Lanes::ZERO) & dot(&apart, &apart).lt(limit * limit)
}

/// Working memory of the narrow phase, and the contacts that it found.
#[derive(Clone, Debug)]
pub(crate) struct NarrowWork<const W: usize> {
    pub found: Contacts<W>,
    pub near: Vec<Stand<W>>,
    pub ellipses: Vec<(Gap, bool)>,
}

impl<const W: usize> Default for NarrowWork<W> {
    fn default() -> Self {
        Self {
            found: Contacts::default(),
            near: Vec::new(),
            ellipses: Vec::new(),
        }
    }
}

impl<const W: usize> NarrowWork<W> {
    /// Finds the contacts of two shapes whose gap is below `reach` (m), in the lanes of [`near`],
    /// of which there is one.
    #[inline(always)]
    pub fn meet(
        &mut self,
        [object, other]: [&Shape; 2],
        frames: &PairFrames<W>,
        reach: Lanes<W>,
        near: Mask<W>,
    ) {
        self.found.clear(object.bounding_radius());
        Pair::new([object, other], frames, reach, near, self).meet();
        self.found.sort();
    }

    /// The contacts found last; those without a lane are none.
    #[inline(always)]
    pub fn contacts(&self) -> impl Iterator<Item = &Contact<W>> {
        self.found.iter()
    }
}
