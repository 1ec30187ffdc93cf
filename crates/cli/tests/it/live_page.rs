//! `stickslip live --page`: access to it, and the messages over its socket.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread::{self, sleep};
use std::time::Duration;

use crate::common::page_session::Session;
use crate::common::{Experiment, SLIDE};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use serde_json::Value;
use tungstenite::client::IntoClientRequest;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, connect};

/// The first row that a socket shows, if it opens for an origin and a token.
fn socket(session: &Session, origin: &str, token: &str) -> Result<Value, String> {
    messages(session, origin, token, 1).map(|mut messages| messages.remove(0))
}

/// The first messages of a socket.
fn messages(
    session: &Session,
    origin: &str,
    token: &str,
    count: usize,
) -> Result<Vec<Value>, String> {
    let url = format!("ws://{}/socket?{token}", session.host);
    let mut request = url.into_client_request().unwrap();
    request
        .headers_mut()
        .insert("Origin", origin.parse().unwrap());
    let (mut socket, _) = connect(request).map_err(|error| error.to_string())?;
    if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
        let limit = Some(Duration::from_secs(20));
        stream.set_read_timeout(limit).unwrap();
    }
    let mut messages = Vec::new();
    while messages.len() < count {
        if let Message::Text(text) = socket.read().map_err(|error| error.to_string())? {
            messages.push(serde_json::from_str(&text).unwrap());
        }
    }
    Ok(messages)
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

#[test]
fn page_that_is_opened_while_the_source_is_silent_shows_what_came_before() {
    let case = Experiment::copy(SLIDE, "live_page/silent");
    let mut session = Session::start(&case);
    let row = r#"{"time": 0, "object_x": 0.01, "object_y": 0, "object_theta": 0}"#;
    writeln!(session.input.as_mut().unwrap(), "{row}").unwrap();
    // long enough for the row to be old before the page is opened
    sleep(Duration::from_millis(2500));
    let own = format!("http://{}", session.host);
    let shown = messages(&session, &own, &session.token, 2).unwrap();
    assert_eq!(shown[0]["object"], serde_json::json!([0.01, 0.0, 0.0]));
    assert!(shown[1]["silent"].as_f64() > Some(2.0), "{}", shown[1]);
    assert_eq!(session.end(), Some(0));
}

/// Begins connections that do not say all, more than the server keeps.
fn strangers(session: &Session) -> Vec<TcpStream> {
    let stranger = |k: usize| {
        let mut stream = TcpStream::connect(&session.host).unwrap();
        let part = ["GET /socket?aaaa", "GET /?aaaa HTTP/1.1\r\n", "G"][k % 3];
        stream.write_all(part.as_bytes()).unwrap();
        stream
    };
    (0..100).map(stranger).collect()
}

#[test]
fn clients_without_a_token_keep_no_owner_out_and_are_ended() {
    let case = Experiment::copy(SLIDE, "live_page/slow");
    let session = Session::start(&case);
    let mut slow = strangers(&session);
    let page = session.ask("GET /?TOKEN HTTP/1.1\nHost: HOST\n\n");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    // those that are left are ended, however often they say a byte
    let mut left = slow.split_off(90);
    for _ in 0..100 {
        left.retain_mut(|stream| stream.write_all(b"a").is_ok());
        if left.is_empty() {
            break;
        }
        sleep(Duration::from_millis(200));
    }
    assert_eq!(left.len(), 0);
    assert_eq!(session.end(), Some(0));
}

/// The first thing that the server says to a request, if it says something before this side hangs
/// up.
fn first_answer(session: &Session, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(&session.host).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_millis(300)))
        .unwrap();
    let _ = stream.write_all(request);
    let mut answer = [0; 1 << 10];
    let length = stream.read(&mut answer).unwrap_or(0);
    String::from_utf8_lossy(&answer[..length]).into_owned()
}

#[test]
fn damaged_handshakes_open_nothing_and_end_no_session() {
    let case = Experiment::copy(SLIDE, "live_page/damaged");
    let session = Session::start(&case);
    let (host, token) = (&session.host, &session.token);
    let good = format!(
        "GET /socket?{token} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\n\
         Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    assert!(first_answer(&session, good.as_bytes()).starts_with("HTTP/1.1 101"));
    let damage = (
        any::<prop::sample::Index>(),
        0..9_usize,
        prop::collection::vec(any::<u8>(), 0..9),
    );
    let config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(100)
    };
    let tried = TestRunner::new(config).run(&damage, |(at, cut, insert)| {
        let start = at.index(good.len());
        let end = (start + cut).min(good.len());
        let request = [&good.as_bytes()[..start], &insert, &good.as_bytes()[end..]].concat();
        let answer = first_answer(&session, &request);
        prop_assert!(
            answer.is_empty() || answer.starts_with("HTTP/1.1 "),
            "{answer}"
        );
        // who is let in named the token, and this host twice
        let text = String::from_utf8_lossy(&request);
        let named = text.contains(token) && text.matches(host.as_str()).count() == 2;
        prop_assert!(named || !answer.starts_with("HTTP/1.1 101"), "{text}");
        Ok(())
    });
    tried.unwrap();
    // pages that go away give up their places, also while there is nothing to show
    for _ in 0..8 {
        first_answer(&session, good.as_bytes());
    }
    // a request in part keeps its place for some seconds; then others are served again
    let page = format!("GET /?{token} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    let mut answers = (0..300).map(|_| {
        sleep(Duration::from_millis(100));
        first_answer(&session, page.as_bytes())
    });
    assert!(answers.any(|answer| answer.starts_with("HTTP/1.1 200")));
    assert_eq!(session.end(), Some(0));
}
