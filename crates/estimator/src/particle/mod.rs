//! The particle filter over contact dynamics (docs/method.md; docs/model.md). `contact_filter`
//! takes one row: it plans the step, has the particles make it, and weighs them. `model` gives the
//! filter these stages.

pub(crate) mod contact_filter;
mod estimate;
mod model;
pub(crate) mod sensor;
pub(crate) mod set;
pub(crate) mod transition;
mod unknown;
