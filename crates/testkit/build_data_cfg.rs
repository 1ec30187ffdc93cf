//! Build script: sets the cfg `stickslip_data` where the recorded experiments are present.
//!
//! A Rust test cannot be skipped while it runs, only when it is compiled. A crate whose tests need
//! recorded data names this file in its `Cargo.toml`, `build = "../testkit/build_data_cfg.rs"`, and
//! marks those tests
//!
//! ```text
//! #[test]
//! #[cfg_attr(not(stickslip_data), ignore = "no recorded data: set STICKSLIP_DATA")]
//! ```
//!
//! so that they are reported as ignored, never as passed. `STICKSLIP_DATA` names the folder;
//! without it, `../shared/data` next to the workspace counts. `STICKSLIP_REQUIRE_DATA=1` sets the
//! cfg in any case: the tests then run, and fail where there is no data. The rule is the one of
//! `stickslip_testkit::data_root`. An absent folder is not watched (Cargo would rebuild each time):
//! after unpacking data into the default place, touch this file.

use std::path::PathBuf;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(stickslip_data)");
    println!("cargo::rerun-if-env-changed=STICKSLIP_DATA");
    println!("cargo::rerun-if-env-changed=STICKSLIP_REQUIRE_DATA");
    let package = std::env::var("CARGO_MANIFEST_DIR").expect("Cargo sets CARGO_MANIFEST_DIR");
    let root = std::env::var("STICKSLIP_DATA").map_or_else(
        |_| PathBuf::from(package).join("../../../shared/data"),
        PathBuf::from,
    );
    let required = std::env::var("STICKSLIP_REQUIRE_DATA").is_ok_and(|value| value == "1");
    if root.is_dir() {
        println!("cargo::rerun-if-changed={}", root.display());
    }
    if required || root.is_dir() {
        println!("cargo::rustc-cfg=stickslip_data");
    }
}
