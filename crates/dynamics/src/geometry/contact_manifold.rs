//! The contacts of one pair of bodies: [`ContactManifold`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::Contact;
use crate::geometry::vec2::{cross, dot, sub};

/// Contacts whose lines of action are nearer than this share of the object's size, with normals
/// within about 0.1 rad, are one.
const SAME_LINE: f64 = 1e-4;

/// Cosine of the largest angle between the normals of one contact.
const SAME_NORMAL: f64 = 0.995;

/// Contacts of one pair of bodies, one for each line of action.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactManifold<const W: usize> {
    contacts: Vec<Contact<W>>,
    /// Distance below which two lines of action are one (m).
    same_line: f64,
    /// The deepest overlap at a boundary point that a sibling part hides.
    hidden: Option<Contact<W>>,
}

impl<const W: usize> ContactManifold<W> {
    /// Removes all contacts; the next ones are those of an object of a given size (m).
    #[inline(always)]
    pub fn clear(&mut self, bounding_radius: f64) {
        self.contacts.clear();
        self.hidden = None;
        self.same_line = SAME_LINE * bounding_radius;
    }

    /// The contacts; some may be present in no lane.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = &Contact<W>> {
        self.contacts.iter()
    }

    /// Orders them by id, so that no lane's order depends on its neighbours.
    #[inline(always)]
    pub fn sort(&mut self) {
        if !self.contacts.is_sorted_by_key(|contact| contact.id) {
            self.contacts.sort_unstable_by_key(|contact| contact.id);
        }
    }

    /// Adds a contact. Of two with one line of action, which have one row W_n, it keeps that with
    /// the smaller gap.
    #[inline(always)]
    pub fn push(&mut self, mut new: Contact<W>) {
        for old in &mut self.contacts {
            let same = old.present & new.present & same_line(old, &new, self.same_line);
            let closer = same & new.gap.lt(old.gap);
            old.present = old.present & !closer;
            new.present = new.present & (!same | closer);
        }
        if !new.present.any() {
            return;
        }
        match self.contacts.iter_mut().find(|old| old.id == new.id) {
            Some(old) => old.assign(new.present, &new),
            None => self.contacts.push(new),
        }
    }

    /// Adds a contact whose point a sibling part hides in some lanes. There it counts only in
    /// overlap, and only if there is no other.
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
                old.assign(deeper, &contact);
            }
            None => {
                self.hidden = Some(Contact {
                    present: deep,
                    ..contact
                })
            }
        }
    }

    /// Adds the hidden contact, as `id`, where no other overlaps.
    #[inline(always)]
    pub fn settle_hidden(&mut self, id: u32) {
        if let Some(hidden) = self.hidden.take() {
            self.push(Contact {
                id,
                present: hidden.present & !self.deeper_than(0.0),
                ..hidden
            });
        }
    }

    /// The lanes in which a contact found so far has a gap below `depth` (m).
    #[inline(always)]
    pub fn deeper_than(&self, depth: f64) -> Mask<W> {
        let deep = |contact: &Contact<W>| contact.present & contact.gap.lt(Lanes::splat(depth));
        self.contacts
            .iter()
            .fold(Mask::splat(false), |all, contact| all | deep(contact))
    }

    /// Drops the contacts of `lanes` that are deeper than `least` (m), if that is an overlap.
    /// Returns the lanes in which a contact of that depth is left.
    #[inline(always)]
    pub fn limit_depth(&mut self, lanes: Mask<W>, least: Lanes<W>, slack: f64) -> Mask<W> {
        let lanes = lanes & least.lt(Lanes::ZERO);
        let mut reached = Mask::splat(false);
        for contact in &mut self.contacts {
            let asked = contact.present & lanes;
            let deeper = asked & contact.gap.lt(least - slack);
            contact.present = contact.present & !deeper;
            reached = reached | asked & !deeper & !contact.gap.gt(least + slack);
        }
        reached
    }
}

#[inline(always)]
fn same_line<const W: usize>(old: &Contact<W>, new: &Contact<W>, distance: f64) -> Mask<W> {
    let d = sub(old.arm, new.arm);
    let limit = Lanes::splat(distance);
    cross(d, old.normal).abs().lt(limit)
        & cross(d, new.normal).abs().lt(limit)
        & dot(old.normal, new.normal).gt(Lanes::splat(SAME_NORMAL))
}
