//! The live page in a real browser: rows that come over its socket are drawn, and it fits a phone.
//!
//! `cargo test --workspace --test it -- --ignored browser::`; the browser is `chromium`, or the
//! program that `STICKSLIP_CHROMIUM` names.

#[path = "../../../report/tests/it/browser/chromium.rs"]
mod chromium;
mod tab;
mod view;

use std::io::Write;
use std::process::ChildStdin;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::thread::{self, JoinHandle, sleep};
use std::time::Duration;

use crate::common::page_session::Session;
use crate::common::{Experiment, SLIDE, empty_folder};
use chromium::chromium;
use serde_json::{Value, json};
use tab::Tab;

/// Pose of the object (m, m, rad): 20 mm, -10 mm, a quarter of a turn.
const POSE: [f64; 3] = [0.02, -0.01, std::f64::consts::FRAC_PI_2];

/// A session to which rows come, 25 a second: the object at rest, and, once the camera is off, no
/// object.
struct Source {
    session: Session,
    address: String,
    dark: Arc<AtomicBool>,
    ended: Arc<AtomicBool>,
    feeder: JoinHandle<ChildStdin>,
}

impl Source {
    fn start(name: &str) -> Self {
        let mut session = Session::start(&Experiment::copy(SLIDE, name));
        let address = format!("http://{}/?{}", session.host, session.token);
        let mut input = session.input.take().unwrap();
        let [dark, ended] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
        let (is_dark, has_ended) = (dark.clone(), ended.clone());
        let feeder = thread::spawn(move || {
            let mut row = 0.0;
            while !has_ended.load(Relaxed) {
                let [x, y, theta] = POSE.map(|number| (!is_dark.load(Relaxed)).then_some(number));
                let line = json!({"time": 0.04 * row, "object_x": x, "object_y": y, "object_theta": theta});
                writeln!(input, "{line}").unwrap();
                sleep(Duration::from_millis(40));
                row += 1.0;
            }
            input
        });
        Self {
            session,
            address,
            dark,
            ended,
            feeder,
        }
    }

    fn end(mut self) {
        self.ended.store(true, Relaxed);
        self.session.input = Some(self.feeder.join().unwrap());
        assert_eq!(self.session.end(), Some(0));
    }
}

/// State of the page once it says `state`.
#[track_caller]
fn shown(tab: &mut Tab, state: &str) -> Value {
    let shown = tab.evaluate(&include_str!("browser/shown.js").replace("STATE", state));
    assert_eq!(shown["state"], state, "{shown:#}");
    shown
}

/// Asserts that a body is drawn where the object lies, within 2 mm and 5 degrees.
#[track_caller]
fn assert_at_the_object(place: &Value) {
    let place: [f64; 3] = serde_json::from_value(place.clone()).unwrap();
    let aside = [place[0] - 20.0, place[1] + 10.0, 0.4 * (place[2] - 90.0)];
    assert!(aside.iter().all(|aside| aside.abs() < 2.0), "{place:?}");
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn rows_are_drawn() {
    let source = Source::start("live_browser/rows");
    let mut tab = Tab::open(&empty_folder("live_browser/profile"), &source.address, 1280);
    let seen = shown(&mut tab, "camera on");
    for body in ["truth", "ghost"] {
        assert_at_the_object(&seen[body]);
    }
    assert_eq!(
        (&seen["particles"], &seen["truthHidden"]),
        (&json!(60), &json!(false))
    );
    let names = [
        "x",
        "y",
        "θ",
        "mu_s",
        "mu_p",
        "mu_f",
        "spread",
        "particles",
        "they are in",
        "collapses",
        "answer took",
    ];
    assert_eq!(seen["names"], json!(names));
    let cells: Vec<String> = serde_json::from_value(seen["cells"].clone()).unwrap();
    assert_eq!((cells.len(), cells[14].as_str()), (22, "64"), "{cells:?}");
    assert!(cells[15].ends_with(" effective"), "{cells:?}");
    assert_eq!(cells[18], "0");
    assert!(
        !cells
            .iter()
            .any(|cell| cell.contains("NaN") || cell.contains("undefined")),
        "{cells:?}"
    );

    // the same page goes on: nothing pushes, so while the camera is off the object stays where it
    // was
    source.dark.store(true, Relaxed);
    let unseen = shown(&mut tab, "camera off");
    assert_at_the_object(&unseen["ghost"]);
    assert_eq!(unseen["truthHidden"], true);

    // the source says nothing any more, and the camera is neither on nor off
    source.ended.store(true, Relaxed);
    shown(&mut tab, "no rows");
    let badge = tab.evaluate("document.querySelector('.badge').textContent");
    let badge = badge.as_str().unwrap();
    assert!(
        badge.starts_with("no rows for ") && badge.ends_with(" s"),
        "{badge}"
    );
    // also on a page that is opened later, which shows the last row
    let mut later = Tab::open(&empty_folder("live_browser/later"), &source.address, 1280);
    assert_at_the_object(&shown(&mut later, "no rows")["ghost"]);
    drop((tab, later));
    source.end();
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn the_live_page_fits_a_phone() {
    let source = Source::start("live_browser/phone");
    let mut tab = Tab::open(
        &empty_folder("live_browser/phone_profile"),
        &source.address,
        390,
    );
    // a scroll bar at the side takes room of the page
    let overflow = shown(&mut tab, "camera on")["overflow"].as_i64();
    assert!(overflow.is_some_and(|pixels| pixels <= 0), "{overflow:?}");
    drop(tab);
    source.end();
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn screenshots_are_made() {
    let folder = empty_folder("live_browser/pictures");
    let source = Source::start("live_browser/shown");
    for (width, scheme) in [
        (1280, "light"),
        (1280, "dark"),
        (390, "light"),
        (390, "dark"),
    ] {
        let picture = folder.join(format!("live-{width}-{scheme}.png"));
        let screenshot = format!("--screenshot={}", picture.display());
        let mut what = vec![screenshot.as_str()];
        if scheme == "dark" {
            what.push("--blink-settings=preferredColorScheme=0");
        }
        chromium(
            &folder.join("profile"),
            &source.address,
            (width, 10_000),
            &what,
        );
        // a blank page takes a fifth of this
        assert!(
            std::fs::metadata(&picture).unwrap().len() > 30_000,
            "{}",
            picture.display()
        );
    }
    source.end();
}
