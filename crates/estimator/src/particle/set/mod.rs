//! The particle set: layout of its columns, access to them, and past poses.

pub(crate) mod chunk;
pub(crate) mod columns;
pub(crate) mod history;
pub(crate) mod observer;
pub(crate) mod view;
