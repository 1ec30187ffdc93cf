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

/// Asserts that an answer is a refusal with these words.
#[track_caller]
fn assert_refused(answer: Result<String, String>, words: &str) {
    let told = answer.unwrap_err();
    assert!(
        told.starts_with("error: ") && told.contains(words),
        "{told}"
    );
}

#[test]
fn strangers_are_refused_in_words() {
    let (session, log) = page_of(&Experiment::copy(SLIDE, "view_page/strangers"));
    let page = session.ask("GET /?TOKEN HTTP/1.1\nHost: HOST\n\n");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains(&log));
    let question = json!({ "log": log }).to_string();
    let length = question.len();
    let asked = |head: &str| {
        session.ask(&format!(
            "POST /check{head}\nContent-Length: {length}\n\n{question}"
        ))
    };
    let own = "?TOKEN HTTP/1.1\nHost: HOST\nOrigin: http://HOST";
    assert!(asked(own).starts_with("HTTP/1.1 200"));
    let address = "not the address that the program printed";
    for (right, wrong, words) in [
        ("?TOKEN", "?0123", address),
        ("?TOKEN", "", address),
        ("Host: HOST", "Host: evil.example", address),
        (
            "http://HOST",
            "http://evil.example",
            "from http://evil.example",
        ),
        ("http://HOST", "null", "from null"),
        ("\nOrigin: http://HOST", "", "from no page"),
    ] {
        let answer = asked(&own.replace(right, wrong));
        assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
        assert!(
            answer.contains(words) && !answer.contains("findings"),
            "{answer}"
        );
    }
}

#[test]
fn too_large_files_are_refused_in_words() {
    let (session, _) = page_of(&Experiment::copy(SLIDE, "view_page/large"));
    let head = "POST /drop?TOKEN HTTP/1.1\nHost: HOST\nOrigin: http://HOST\n";
    let bytes = " ".repeat(65_000_000);
    // as it claims, as it is sent, and without a claim
    for (rest, status, words) in [
        (
            "Content-Length: 1000000000\n\n{}",
            "413",
            "these files have 1000 MB",
        ),
        (
            &format!("Content-Length: 65000000\n\n{bytes}"),
            "413",
            "takes at most 64 MB",
        ),
        (
            "Transfer-Encoding: chunked\n\n0\n\n",
            "411",
            "does not say its length",
        ),
    ] {
        let answer = session.ask(&format!("{head}{rest}"));
        assert!(
            answer[9..].starts_with(status) && answer.contains(words),
            "{answer}"
        );
    }
}

#[test]
fn names_lead_out_of_no_list_and_wrong_files_are_told() {
    let (session, log) = page_of(&Experiment::copy(SLIDE, "view_page/names"));
    for name in [
        "../../../../etc",
        "/etc/passwd",
        &format!("{log}/../names"),
        "",
    ] {
        for what in ["check", "open", "run", "scene"] {
            let answer = session.post(what, &json!({ "log": name }));
            assert_refused(answer, "no log of this page has that name");
        }
    }
    for (names, words) in [
        (
            ["../scene.toml", "log.csv"],
            "`../scene.toml`: a path and no file name",
        ),
        (
            ["log.csv", "other.csv"],
            "log.csv, other.csv: not a scene and a log",
        ),
        (["scene.toml", "log.csv"], "scene.toml"),
    ] {
        let files = names.map(|name| json!({"name": name, "text": "time"}));
        assert_refused(session.post("drop", &json!({ "files": files })), words);
    }
    let far = json!({"log": log, "changed": {"particles": 1e9}});
    assert_refused(session.post("run", &far), "help: choose from 50 to 5000");
    let early = json!({"log": log, "changed": {"off_from": 1.5, "off_to": 1.0}});
    let words = "the camera is off from 1.5 s, and on again before, at 1 s";
    assert_refused(session.post("run", &early), words);
    let refused = stickslip().args(["view", "nowhere"]).output().unwrap();
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(
        told.starts_with("error: nowhere: there is no such folder\nhelp: "),
        "{told}"
    );
}

#[test]
fn a_run_with_changes_is_that_of_filter_with_the_saved_scene() {
    let case = Experiment::copy(STOP, "view_page/run");
    let (session, log) = page_of(&case);
    let answer = |what: &str, question: Value| session.post(what, &question).unwrap();
    let found: Value = serde_json::from_str(&answer("check", json!({ "log": log }))).unwrap();
    assert_eq!(found, printed(stickslip().args(["check", &log, "--json"])));
    assert!(answer("open", json!({ "log": log })).contains("Small circles: its feet"));

    let changed = json!({"support.friction": 0.21, "particles": 100, "off_from": 1.5, "off_to": 2.5, "touch": 0});
    let question = json!({"log": log, "run": 1, "changed": changed});
    let page = answer("run", question.clone());
    let again = answer("run", json!({ "log": log }));
    let previous = "\"name\":\"previous run\"";
    assert!(!page.contains(previous) && again.contains(previous));

    let scene = answer("scene", question);
    let kept = [
        "# Nominal values; the truth",
        "# support.friction = 0.21: set in",
    ];
    assert!(kept.iter().all(|line| scene.contains(line)), "{scene}");
    case.edit("scene.toml", |_| scene);
    let (_, command) = page.split_once("in a terminal: stickslip ").unwrap();
    let command = command
        .split('<')
        .next()
        .unwrap()
        .replace("--scene scene.toml", "");
    let own = printed(stickslip().args(command.split_whitespace()).arg("--json"));
    let (_, scores) = page.split_once("verdict").unwrap();
    for key in ["wmse_occluded_mm", "wmse_moving_mm", "final_error_mm"] {
        let cell = format!(">{:.3}</td>", own[key].as_f64().unwrap());
        assert!(scores.contains(&cell), "{key}: {own:#}");
    }
}

#[test]
fn what_is_lost_in_reading_is_on_the_page() {
    let case = Experiment::copy(SLIDE, "view_page/lost");
    let (session, _) = page_of(&case);
    let text = |file: &str| std::fs::read_to_string(case.folder.join(file)).unwrap();
    let lines = text("log.csv");
    let wider = lines.lines().enumerate().map(|(row, line)| {
        let more = if row == 0 { "comment" } else { "1" };
        format!("{line},{more}\n")
    });
    let files = [
        ("scene.toml", text("scene.toml")),
        ("log.csv", wider.collect()),
    ];
    let files = files.map(|(name, text)| json!({ "name": name, "text": text }));
    let name = session.post("drop", &json!({ "files": files })).unwrap();
    let name: String = serde_json::from_str(&name).unwrap();
    for what in ["check", "open"] {
        let found = session.post(what, &json!({ "log": name })).unwrap();
        let found: Value = serde_json::from_str(&found).unwrap();
        let first = &found["findings"][0];
        assert_eq!(
            (&first["severity"], &first["subject"]),
            (&json!("warning"), &json!("reading"))
        );
        assert!(
            first["found"].as_str().unwrap().contains("comment"),
            "{first}"
        );
    }
}

#[test]
fn a_run_ends_when_another_begins() {
    let (session, log) = page_of(&Experiment::copy(SLIDE, "view_page/superseded"));
    let url = format!("ws://{}/socket?{}", session.host, session.token);
    let mut request = url.into_client_request().unwrap();
    let own = format!("http://{}", session.host);
    request.headers_mut().insert("Origin", own.parse().unwrap());
    let (mut socket, _) = connect(request).unwrap();
    let run = |number: u32, particles: u32| {
        let changed = json!({ "particles": particles });
        session.post(
            "run",
            &json!({"log": log, "run": number, "changed": changed}),
        )
    };
    thread::scope(|scope| {
        let replaced = scope.spawn(|| run(1, 5000));
        // it has begun
        let told: Value = serde_json::from_str(socket.read().unwrap().to_text().unwrap()).unwrap();
        assert_eq!(told["run"], 1.0);
        run(2, 50).unwrap();
        assert_refused(replaced.join().unwrap(), "another run began");
    });
}
