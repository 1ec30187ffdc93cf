//! Folder of the recorded experiments: [`data_root`].
//!
//! `STICKSLIP_DATA` names the folder; without it, `../shared/data` next to the workspace counts.
//! The build script `build_data_cfg.rs` applies the same rule at compile time, so that tests
//! without data are reported as ignored.

use std::path::{Path, PathBuf};

/// The folder of recorded experiments, or `None` where there is none.
///
/// # Panics
/// Where there is none and `STICKSLIP_REQUIRE_DATA=1`: continuous integration must not pass for
/// want of data.
#[must_use]
pub fn data_root() -> Option<PathBuf> {
    let root = std::env::var_os("STICKSLIP_DATA").map_or_else(default_root, PathBuf::from);
    let required = std::env::var_os("STICKSLIP_REQUIRE_DATA").is_some_and(|value| value == "1");
    present(
        root,
        if required {
            Absent::Panic
        } else {
            Absent::Skip
        },
    )
}

/// Reaction to an absent folder.
#[derive(Clone, Copy)]
enum Absent {
    Skip,
    Panic,
}

fn default_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data")
}

fn present(root: PathBuf, absent: Absent) -> Option<PathBuf> {
    match (root.is_dir(), absent) {
        (true, _) => Some(root),
        (false, Absent::Skip) => None,
        (false, Absent::Panic) => panic!(
            "STICKSLIP_REQUIRE_DATA=1, but {} is no folder; unpack the recorded experiments there or point STICKSLIP_DATA at them",
            root.display()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn present_absent_folder_is_none() {
        assert_eq!(
            present(PathBuf::from("/nonexistent/data"), Absent::Skip),
            None
        );
    }

    #[test]
    #[should_panic(expected = "point STICKSLIP_DATA at them")]
    fn present_absent_folder_panics_where_data_is_required() {
        let _ = present(PathBuf::from("/nonexistent/data"), Absent::Panic);
    }

    #[test]
    #[cfg_attr(not(stickslip_data), ignore = "no recorded data: set STICKSLIP_DATA")]
    fn data_root_holds_at_least_one_entry() {
        let root = data_root().expect("the build script found the folder");
        assert!(
            root.read_dir().expect("readable").next().is_some(),
            "{} is empty",
            root.display()
        );
    }
}
