//! `stickslip view`: access to it, what it refuses, and that its runs are those of `filter`.

use std::thread;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::connect;

use crate::common::page_session::Session;
use crate::common::{Experiment, SLIDE, STOP, json as printed, stickslip};

/// A page about one log.
fn page_of(case: &Experiment) -> (Session, String) {
    let log = case.folder.display().to_string();
    (Session::view(&[&log]), log)
}

#[test]
fn strangers_are_refused_in_words() {
    let (session, log) = page_of(&Experiment::copy(SLIDE, "view_page/strangers"));
    let page = session.ask("GET /?TOKEN HTTP/1.1\nHost: HOST\n\n");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains(&log));
    let question = json!({ "log": log }).to_string();
    let length = question.len();
    let asked = |address: &str, host: &str, origin: &str| {
        session.ask(&format!(
            "POST /{address} HTTP/1.1\nHost: {host}\n{origin}Content-Length: {length}\n\n{question}"
        ))
    };
    let own = "Origin: http://HOST\n";
    assert!(asked("check?TOKEN", "HOST", own).starts_with("HTTP/1.1 200"));
    for (address, host, origin, words) in [
        (
            "check?0123",
            "HOST",
            own,
            "not the address that the program printed",
        ),
        (
            "check",
            "HOST",
            own,
            "not the address that the program printed",
        ),
        (
            "check?TOKEN",
            "evil.example",
            own,
            "not the address that the program printed",
        ),
        (
            "check?TOKEN",
            "HOST",
            "Origin: http://evil.example\n",
            "comes from http://evil.example",
        ),
        ("check?TOKEN", "HOST", "Origin: null\n", "comes from null"),
        ("check?TOKEN", "HOST", "", "comes from no page"),
    ] {
        let answer = asked(address, host, origin);
        assert!(
            answer.starts_with("HTTP/1.1 403") && answer.contains(words),
            "{answer}"
        );
        assert!(!answer.contains("findings"), "{answer}");
    }
}

#[test]
fn too_large_files_are_refused_in_words() {
    let (session, _) = page_of(&Experiment::copy(SLIDE, "view_page/large"));
    let head = "POST /drop?TOKEN HTTP/1.1\nHost: HOST\nOrigin: http://HOST\n";
    // as it claims, and as it is sent
    let claimed = session.ask(&format!("{head}Content-Length: 1000000000\n\n{{}}"));
    let sent = session.ask(&format!(
        "{head}Content-Length: 65000000\n\n{}",
        " ".repeat(65_000_000)
    ));
    for (answer, size) in [(claimed, "1000 MB"), (sent, "65 MB")] {
        assert!(answer.starts_with("HTTP/1.1 413"), "{answer}");
        assert!(answer.contains(&format!(
            "these files have {size}; the page takes at most 64 MB"
        )));
    }
    let unsaid = session.ask(&format!("{head}Transfer-Encoding: chunked\n\n0\n\n"));
    assert!(unsaid.starts_with("HTTP/1.1 411") && unsaid.contains("does not say its length"));
}

#[test]
fn names_lead_out_of_no_list_and_wrong_files_are_told() {
    let case = Experiment::copy(SLIDE, "view_page/names");
    let (session, log) = page_of(&case);
    for name in [
        "../../../../etc",
        "/etc/passwd",
        &format!("{log}/../names"),
        "",
    ] {
        for what in ["check", "open", "run", "scene"] {
            let (status, text) = session.post(what, &json!({ "log": name }));
            assert_eq!(status, 422, "{text}");
            assert!(text.contains("no log of this page has that name"), "{text}");
        }
    }
    let drop = |files: &[(&str, &str)]| {
        let files = files
            .iter()
            .map(|(name, text)| json!({"name": name, "text": text}));
        session.post("drop", &json!({ "files": files.collect::<Vec<_>>() }))
    };
    for (files, words) in [
        (
            vec![("../scene.toml", ""), ("log.csv", "")],
            "`../scene.toml`: a path and no file name",
        ),
        (vec![("log.csv", "")], "log.csv: not a scene and a log"),
        (
            vec![("scene.toml", "gravity = 9.81"), ("log.csv", "time\n")],
            "scene.toml",
        ),
    ] {
        let (status, text) = drop(&files);
        assert!(
            status == 422 && text.starts_with("error: ") && text.contains(words),
            "{text}"
        );
    }
    let (status, text) = session.post("run", &json!({"log": log, "changed": {"particles": 1e9}}));
    assert!(
        status == 422 && text.contains("help: choose from 50 to 5000"),
        "{text}"
    );
    let (status, text) = session.post("other", &json!({ "log": log }));
    assert!(status == 422 && text.contains("no such question"), "{text}");
    let refused = stickslip().args(["view", "nowhere"]).output().unwrap();
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(
        told.starts_with("error: nowhere: there is no such folder\nhelp: "),
        "{told}"
    );
}

/// Cells of the table of scores on a page.
fn cells(html: &str) -> Vec<&str> {
    let (_, table) = html.split_once("verdict").unwrap();
    let cells = table.split("<td").skip(1);
    cells
        .map(|cell| cell.split(['>', '<']).nth(1).unwrap())
        .collect()
}

#[test]
fn a_run_with_changes_is_that_of_filter_with_the_saved_scene() {
    let case = Experiment::copy(STOP, "view_page/run");
    let (session, log) = page_of(&case);
    let (status, found) = session.post("check", &json!({ "log": log }));
    let own = printed(stickslip().args(["check", &log, "--json"]));
    assert_eq!(
        (status, serde_json::from_str::<Value>(&found).unwrap()),
        (200, own)
    );

    let (status, opened) = session.post("open", &json!({ "log": log }));
    let opened: Value = serde_json::from_str(&opened).unwrap();
    let keys: Vec<&str> = opened["sliders"]
        .as_array()
        .unwrap()
        .iter()
        .map(|slider| slider["key"].as_str().unwrap())
        .collect();
    let frictions = [
        "support.friction",
        "pusher.friction",
        "fixels.friction",
        "support.tripod_radius",
    ];
    assert_eq!((status, &keys[..4]), (200, &frictions[..]));
    assert_eq!(keys[4..], ["particles", "off_from", "off_to", "touch"]);
    assert!(
        opened["html"]
            .as_str()
            .unwrap()
            .contains("Small circles: its feet")
    );

    let changed = json!({"support.friction": 0.21, "particles": 100, "off_from": 1.5, "off_to": 2.5, "touch": false});
    let question = json!({ "log": log, "run": 1, "changed": changed });
    let (status, html) = session.post("run", &question);
    assert_eq!(status, 200, "{html}");
    assert!(!html.contains("previous run"));
    let (_, again) = session.post("run", &json!({ "log": log, "run": 2 }));
    assert!(again.contains("\"name\":\"previous run\""));

    let (_, scene) = session.post("scene", &question);
    assert!(
        scene.contains("# Nominal values; the truth")
            && scene.contains("# support.friction = 0.21: set in")
    );
    case.edit("scene.toml", |_| scene);
    let (_, command) = html.split_once("in a terminal: stickslip ").unwrap();
    let words = command
        .split('<')
        .next()
        .unwrap()
        .replace("--scene scene.toml", "");
    let own = printed(stickslip().args(words.split_whitespace()).arg("--json"));
    let [dark, last] = ["wmse_occluded_mm", "final_error_mm"]
        .map(|key| format!("{:.3}", own[key].as_f64().unwrap()));
    let cells = cells(&html);
    assert_eq!([cells[0], cells[4]], [&dark, &last], "{own:#} {cells:?}");
}

#[test]
fn a_run_ends_when_another_begins() {
    let (session, log) = page_of(&Experiment::copy(SLIDE, "view_page/superseded"));
    let url = format!("ws://{}/socket?{}", session.host, session.token);
    let mut request = url.into_client_request().unwrap();
    let own = format!("http://{}", session.host);
    request.headers_mut().insert("Origin", own.parse().unwrap());
    let (mut socket, _) = connect(request).unwrap();
    let long = json!({"log": log, "run": 1, "changed": {"particles": 5000}});
    thread::scope(|scope| {
        let replaced = scope.spawn(|| session.post("run", &long));
        // it has begun
        let told: Value = serde_json::from_str(socket.read().unwrap().to_text().unwrap()).unwrap();
        assert_eq!(told["run"], 1.0);
        let short = json!({"log": log, "run": 2, "changed": {"particles": 50}});
        assert_eq!(session.post("run", &short).0, 200);
        let (status, text) = replaced.join().unwrap();
        assert_eq!((status, text.as_str()), (422, "error: another run began"));
    });
}
