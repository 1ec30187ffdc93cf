//! `stickslip view` in a real browser: from an empty page to a saved scene.

use std::fs::File;

use serde_json::Value;

use super::tab::Tab;
use crate::common::page_session::Session;
use crate::common::{Experiment, SLIDE, empty_folder};

/// Waits until an expression is true in the page.
#[track_caller]
fn wait(tab: &mut Tab, expression: &str) {
    let look = format!(
        "new Promise((resolve) => {{ const begin = Date.now(); const look = () => {{ const is = {expression};
         if (is || Date.now() - begin > 120000) resolve(Boolean(is)); else setTimeout(look, 50); }}; look(); }})"
    );
    let state = "document.querySelector('main').innerText";
    assert_eq!(
        tab.evaluate(&look),
        true,
        "{expression}: {}",
        tab.evaluate(state)
    );
}

/// Moves a slider.
fn slide(tab: &mut Tab, name: &str, value: f64) {
    tab.evaluate(&format!(
        "{{ const slider = document.querySelector('[name=\"{name}\"]'); slider.value = {value};
           slider.dispatchEvent(new Event('input')); }}"
    ));
}

fn from_an_empty_page_to_a_saved_scene(width: u32) {
    let case = Experiment::copy(SLIDE, &format!("view_browser/{width}"));
    let session = Session::view(&[]);
    let address = format!("http://{}/?{}", session.host, session.token);
    let profile = empty_folder(&format!("view_browser/profile_{width}"));
    let mut tab = Tab::open(&profile, &address, width);
    wait(
        &mut tab,
        "document.querySelector('.failed')?.textContent.startsWith('No log is listed')",
    );

    // a gigabyte is refused before it is read
    let large = case.folder.join("large.csv");
    File::create(&large).unwrap().set_len(1 << 30).unwrap();
    tab.choose_files(&[&case.scene(), &large.display().to_string()]);
    wait(
        &mut tab,
        "document.querySelector('.failed').textContent.includes('1074 MB; the page takes at most 64 MB')",
    );

    // the log is drawn and checked before any run
    tab.choose_files(&[&case.scene(), &case.log()]);
    wait(
        &mut tab,
        "document.querySelector('.logs span')?.textContent === '0 problems, 0 warnings'",
    );
    assert_eq!(
        tab.evaluate("document.querySelectorAll('.stage .foot').length"),
        3
    );
    assert_eq!(
        tab.evaluate("document.querySelectorAll('.readout tbody tr').length"),
        0
    );

    // a run, replaced at once by one with fewer particles, and another one over that
    let rows = |count: u32| {
        let rows = "document.querySelectorAll('.readout tbody tr').length";
        format!("{rows} === {count} && document.querySelector('.said').textContent === 'done'")
    };
    tab.evaluate("document.querySelector('.run').click()");
    slide(&mut tab, "particles", 50.0);
    wait(&mut tab, &rows(1));
    assert_eq!(tab.evaluate("document.querySelector('progress').value"), 1);
    tab.evaluate("players[0].seek(3)");
    slide(&mut tab, "support.friction", 0.4);
    wait(&mut tab, &rows(2));
    assert_eq!(tab.evaluate("players[0].time"), 3);
    let names: Vec<Value> = serde_json::from_value(tab.evaluate(
        "[...document.querySelectorAll('.readout tbody label')].map((label) => label.textContent)",
    ))
    .unwrap();
    assert_eq!(names, ["particle filter", "previous run"]);

    // what was changed is saved, with the scene's own comments
    let save = "new Promise((resolve) => { const old = URL.createObjectURL;
        URL.createObjectURL = (blob) => { blob.text().then(resolve); return old(blob); };
        document.querySelector('.keep').click(); })";
    let saved = tab.evaluate(save);
    let saved = saved.as_str().unwrap();
    let kept = [
        "# support.friction = 0.4: set in",
        "\nfriction = 0.4\n",
        "# Nominal values;",
    ];
    assert!(kept.iter().all(|part| saved.contains(part)), "{saved}");

    let overflow = tab.evaluate("document.documentElement.scrollWidth - innerWidth");
    assert!(
        overflow.as_i64().is_some_and(|pixels| pixels <= 0),
        "{overflow}"
    );
    let unnamed = tab.evaluate("[...document.querySelectorAll('.view input')].filter((input) => !input.labels?.length && !input.ariaLabel).length");
    assert_eq!((unnamed, &tab.console), (0.into(), &Vec::new()));
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn a_newcomer_gets_from_an_empty_page_to_a_saved_scene() {
    from_an_empty_page_to_a_saved_scene(1280);
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn and_on_a_phone() {
    from_an_empty_page_to_a_saved_scene(390);
}
