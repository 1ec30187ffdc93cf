//! Folder of the recorded experiments: [`data_root`].
//!
//! Tests that need it have `recorded` in their name and
//! `#[ignore = "needs recorded experiments"]`, so that they are reported as ignored where it is
//! absent. `cargo test --workspace --tests -- --ignored recorded` runs them.

use std::path::{Path, PathBuf};

/// The folder of recorded experiments that `STICKSLIP_DATA` names, by default `../shared/data` next
/// to the workspace; `None` where there is none.
#[must_use]
pub fn data_root() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("STICKSLIP_DATA").map_or_else(beside, PathBuf::from);
    root.is_dir().then_some(root)
}
