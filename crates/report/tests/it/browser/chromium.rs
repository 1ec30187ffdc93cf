//! Chromium without a window: the state of pages once their scripts have run.

use std::path::Path;
use std::process::Command;

/// Chromium's print of the page at `address`, or the screenshot that it makes, at a window's
/// `width` (px) and after `budget` (ms) of the browser's own time; its profile lies in `folder`.
pub fn chromium(
    folder: &Path,
    address: &str,
    (width, budget): (u32, u32),
    what: &[&str],
) -> String {
    let program = std::env::var("STICKSLIP_CHROMIUM").unwrap_or_else(|_| "chromium".to_owned());
    let fixed = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
    ];
    let run = Command::new("timeout")
        .args(["120", &program])
        .args(fixed)
        .arg(format!("--virtual-time-budget={budget}"))
        .arg(format!("--window-size={width},1600"))
        .arg(format!("--user-data-dir={}", folder.display()))
        .args(what)
        .arg(address)
        .output();
    let run = run.unwrap_or_else(|error| {
        panic!("{program} cannot be run: {error}; install it, or name it in STICKSLIP_CHROMIUM")
    });
    assert!(
        run.status.success(),
        "{program}: {}\n{}",
        run.status,
        String::from_utf8_lossy(&run.stderr)
    );
    String::from_utf8_lossy(&run.stdout).into_owned()
}
