//! Contacts of one pair of bodies, `W` pairs of poses side by side: [`Contact`], [`Contacts`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::transform::{Vec2s, cross, dot, lane_of, splat, sub};

/// Contacts whose lines of action are nearer than this share of the object's size, with normals
/// within about 0.1 rad, are one.
const SAME_LINE: f64 = 1e-4;

/// Cosine of the largest angle between the normals of one contact.
const SAME_NORMAL: f64 = 0.995;

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

/// A contact between two features, in the lanes that have it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact<const W: usize> {
    /// Number of the pair of features among those of the two bodies, below [`Contact::PLACES`].
    pub place: u32,
    /// The lanes that have it.
    pub present: Mask<W>,
    /// Unit normal into the object, world frame.
    pub normal: Vec2s<W>,
    /// From the object's origin to the contact point on its boundary, world frame (m).
    pub arm: Vec2s<W>,
    /// Gap (m).
    pub gap: Lanes<W>,
}

impl<const W: usize> Contact<W> {
    /// Contacts of one pair of bodies that numbers tell apart.
    pub const PLACES: u32 = 1 << 24;

    /// A contact of one lane.
    pub fn in_lane(place: u32, lane: usize, gap: &Gap) -> Self {
        let present = Mask::from_fn(|i| i == lane);
        Self {
            place,
            present,
            normal: splat(gap.normal),
            arm: splat(gap.arm),
            gap: Lanes::splat(gap.gap),
        }
    }

    /// One lane's contact.
    pub fn lane(&self, lane: usize) -> Gap {
        Gap {
            normal: lane_of(&self.normal, lane),
            arm: lane_of(&self.arm, lane),
            gap: self.gap.0[lane],
        }
    }

    /// Takes over what `from` has in the lanes of `mask`.
    #[inline(always)]
    fn take(&mut self, mask: Mask<W>, from: &Self) {
        for k in 0..2 {
            self.normal[k] = mask.select(from.normal[k], self.normal[k]);
            self.arm[k] = mask.select(from.arm[k], self.arm[k]);
        }
        self.gap = mask.select(from.gap, self.gap);
        self.present = self.present | mask;
    }
}

/// The contacts of one pair of bodies.
#[derive(Clone, Debug)]
pub(crate) struct Contacts<const W: usize> {
    list: Vec<Contact<W>>,
    /// Distance below which two lines of action are one (m).
    same_line: f64,
    /// The deepest overlap at a boundary point that a sibling part hides.
    hidden: Option<Contact<W>>,
}

impl<const W: usize> Default for Contacts<W> {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            same_line: 0.0,
            hidden: None,
        }
    }
}

impl<const W: usize> Contacts<W> {
    /// Removes all contacts; the next ones are those of an object of a given size (m).
    #[inline(always)]
    pub fn clear(&mut self, bounding_radius: f64) {
        self.list.clear();
        self.hidden = None;
        self.same_line = SAME_LINE * bounding_radius;
    }

    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = &Contact<W>> {
        self.list.iter()
    }

    /// Orders them by place, so that no lane's order depends on its neighbours.
    #[inline(always)]
    pub fn sort(&mut self) {
        if !self.list.is_sorted_by_key(|contact| contact.place) {
            self.list.sort_unstable_by_key(|contact| contact.place);
        }
    }

    /// Of two contacts with one line of action, which have one row W_n, keeps that with the smaller
    /// gap.
    #[inline(always)]
    pub fn push(&mut self, mut new: Contact<W>) {
        for old in &mut self.list {
            let same = old.present & new.present & same_line(old, &new, self.same_line);
            let closer = same & new.gap.lt(old.gap);
            old.present = old.present & !closer;
            new.present = new.present & (!same | closer);
        }
        if !new.present.any() {
            return;
        }
        match self.list.iter_mut().find(|old| old.place == new.place) {
            Some(old) => old.take(new.present, &new),
            None => self.list.push(new),
        }
    }

    /// A contact whose point a sibling part hides counts only in overlap, and only if there is no
    /// other.
    #[inline(always)]
    pub fn push_unless(&mut self, hidden: Mask<W>, contact: Contact<W>) {
        let deep = hidden & contact.present & contact.gap.lt(Lanes::ZERO);
        self.push(Contact {
            present: contact.present & !hidden,
            ..contact
        });
        if !deep.any() {
            return;
        }
        match &mut self.hidden {
            Some(old) => {
                let deeper = deep & (!old.present | contact.gap.lt(old.gap));
                old.take(deeper, &contact);
            }
            None => {
                self.hidden = Some(Contact {
                    present: deep,
                    ..contact
                })
            }
        }
    }

    /// Adds the hidden contact, as `place`, where no other overlaps.
    #[inline(always)]
    pub fn settle_hidden(&mut self, place: u32) {
        if let Some(hidden) = self.hidden.take() {
            self.push(Contact {
                place,
                present: hidden.present & !self.deeper_than(0.0),
                ..hidden
            });
        }
    }

    /// The lanes in which a contact found so far has a gap below `depth` (m).
    #[inline(always)]
    pub fn deeper_than(&self, depth: f64) -> Mask<W> {
        let deep = |contact: &Contact<W>| contact.present & contact.gap.lt(Lanes::splat(depth));
        self.list
            .iter()
            .fold(Mask::splat(false), |all, contact| all | deep(contact))
    }

    /// Drops contacts that are deeper than `least` (m), where that is an overlap, in the lanes of
    /// `asked`; those where one as deep is left.
    #[inline(always)]
    pub fn bound(&mut self, asked: Mask<W>, least: Lanes<W>, slack: f64) -> Mask<W> {
        let asked = asked & least.lt(Lanes::ZERO);
        let mut answered = Mask::splat(false);
        for contact in &mut self.list {
            let held = contact.present & asked;
            let deeper = held & contact.gap.lt(least - slack);
            contact.present = contact.present & !deeper;
            answered = answered | held & !deeper & !contact.gap.gt(least + slack);
        }
        answered
    }
}

#[inline(always)]
fn same_line<const W: usize>(old: &Contact<W>, new: &Contact<W>, distance: f64) -> Mask<W> {
    let d = sub(&old.arm, &new.arm);
    let limit = Lanes::splat(distance);
    cross(&d, &old.normal).abs().lt(limit)
        & cross(&d, &new.normal).abs().lt(limit)
        & dot(&old.normal, &new.normal).gt(Lanes::splat(SAME_NORMAL))
}
