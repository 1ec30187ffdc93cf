//! Progress on standard error, only where that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar of `length` steps, counted in `unit`; `Work::Short` shows nothing.
pub fn bar(length: usize, unit: &str, work: Work) -> ProgressBar {
    let target = match work {
        Work::Short => ProgressDrawTarget::hidden(),
        Work::Long => ProgressDrawTarget::stderr(),
    };
    let style =
        ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{eta}} left"));
    let bar = ProgressBar::with_draw_target(Some(length as u64), target);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// A count of `unit` whose total is not known.
#[cfg(feature = "camera")]
pub fn spinner(unit: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    match ProgressStyle::with_template(&format!("{{spinner}} {{pos}} {unit}, {{elapsed}}")) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// A description of the work, with the time since its beginning; for work whose steps cannot be
/// counted.
pub fn stage(doing: String) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    bar.enable_steady_tick(Duration::from_millis(200));
    let bar = bar.with_message(doing);
    match ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Duration of work, as a person sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// A second or so.
    Short,
    /// Longer.
    Long,
}
