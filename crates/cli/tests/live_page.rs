//! `stickslip live --page`: who may see it, and what comes over the socket.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::io::Write;
use std::net::TcpStream;
use std::thread::{self, sleep};
use std::time::Duration;

use common::page_session::Session;
use common::{Experiment, SLIDE};
use serde_json::Value;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, connect};

/// Whether a socket opens for an origin and a token.
fn socket(session: &Session, origin: &str, token: &str) -> Result<Value, String> {
    let url = format!("ws://{}/socket?{token}", session.host);
    let mut request = url.into_client_request().unwrap();
    request
        .headers_mut()
        .insert("Origin", origin.parse().unwrap());
    let (mut socket, _) = connect(request).map_err(|error| error.to_string())?;
    loop {
        if let Message::Text(text) = socket.read().map_err(|error| error.to_string())? {
            return Ok(serde_json::from_str(&text).unwrap());
        }
    }
}

#[test]
fn page_is_for_those_who_know_its_address() {
    let case = Experiment::copy(SLIDE, "live_page/address");
    let session = Session::start(&case);
    let page = session.ask("GET /?TOKEN HTTP/1.1\nHost: HOST\n\n");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("class=\"player live\""));
    for refused in [
        "GET / HTTP/1.1\nHost: HOST\n\n",
        "GET /?0123 HTTP/1.1\nHost: HOST\n\n",
        "GET /?TOKEN HTTP/1.1\nHost: evil.example\n\n",
        "GET /?TOKEN HTTP/1.1\n\n\n",
        "POST /?TOKEN HTTP/1.1\nHost: HOST\n\n",
    ] {
        let answer = session.ask(refused);
        assert!(
            answer.starts_with("HTTP/1.1 403") && !answer.contains("player"),
            "{refused}"
        );
    }
    let own = format!("http://{}", session.host);
    assert!(socket(&session, "http://evil.example", &session.token).is_err());
    assert!(socket(&session, &own, "0123").is_err());
    assert_eq!(session.end(), Some(0));
}

#[test]
fn socket_shows_rows_and_the_session_survives_those_who_leave() {
    let case = Experiment::copy(SLIDE, "live_page/socket");
    let mut session = Session::start(&case);
    let own = format!("http://{}", session.host);
    // garbage, and half a request
    let _ = session.ask("\u{1}\u{2}\u{3}garbage that is no request\n\n");
    let silent = TcpStream::connect(&session.host).unwrap();
    let (host, token) = (session.host.clone(), session.token.clone());
    let mut input = session.input.take().unwrap();
    let feeder = thread::spawn(move || {
        for row in 0..100 {
            let time = 0.03 * f64::from(row);
            writeln!(
                input,
                "{{\"time\": {time}, \"object_x\": 0.01, \"object_y\": 0, \"object_theta\": 0}}"
            )
            .unwrap();
            sleep(Duration::from_millis(40));
        }
        input
    });
    // two, one after the other, who both leave
    for _ in 0..2 {
        let row = socket(&session, &own, &token).unwrap();
        assert_eq!(row["object"], serde_json::json!([0.01, 0.0, 0.0]));
        let x = row["estimate"]["x"].as_f64().unwrap();
        assert!((x - 0.01).abs() < 1e-3, "{row}");
        assert_eq!(
            (row["particles"].as_array().unwrap().len(), &row["count"]),
            (60, &64.into())
        );
    }
    assert!(host.starts_with("127.0.0.1"));
    drop(silent);
    session.input = Some(feeder.join().unwrap());
    assert_eq!(session.end(), Some(0));
}
