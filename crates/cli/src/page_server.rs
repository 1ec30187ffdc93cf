//! A server on the loopback address, for one page, its WebSocket and what it asks: [`PageServer`].

mod head;
mod notices;

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read, Write, copy, sink};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;
use serde_json::json;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, accept_hdr_with_config};

use crate::failure::hinted;
use crate::output::{said, talk};
use head::Head;
pub use notices::{Notices, lock};

/// Most pages that are shown messages at a time.
const MOST_VIEWERS: usize = 8;

/// Most connections that have not shown the token yet; a further one ends the oldest.
const MOST_STRANGERS: usize = 32;

/// Time that a client may take for its whole request and the answer, and a page for a row.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time that a client that has shown the token may take to send files.
const PATIENCE_WITH_FILES: Duration = Duration::from_secs(60);

/// Age of a row from which on a new page is given it.
const OLD: Duration = Duration::from_secs(2);

/// Most messages that are taken from a page at a time; it has nothing to say.
const MOST_MESSAGES: usize = 64;

/// Longest message of a page (bytes).
const LONGEST_MESSAGE: usize = 4 << 10;

/// Most that a page sends at once (MB).
pub const LARGEST_BODY_MB: u64 = 64;

/// Answers what a page asks: the name of the question, its text, and where messages are shown.
pub type Answers = dyn Fn(&str, &[u8], &Notices) -> Result<String> + Send + Sync;

/// Serves the page until the program ends.
pub struct PageServer {
    shared: Arc<Shared>,
    /// The page's address, token included.
    address: String,
}

/// State that the threads of the connections share.
struct Shared {
    page: String,
    /// Absent for a page that asks nothing.
    answers: Option<Box<Answers>>,
    /// End of the page's address.
    token: String,
    port: u16,
    viewers: AtomicUsize,
    strangers: Mutex<Strangers>,
    notices: Notices,
}

/// Connections that have not shown the token yet, by their numbers.
#[derive(Default)]
struct Strangers {
    latest: u64,
    streams: BTreeMap<u64, TcpStream>,
}

/// A client's stream, on which everything ends at a deadline.
struct Patient {
    stream: TcpStream,
    deadline: Instant,
}

impl PageServer {
    /// Listens at a port of the loopback address, 0 for any that is free.
    fn start(page: String, answers: Option<Box<Answers>>, port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let port = listener.local_addr()?.port();
        let token = token()?;
        let address = format!("http://127.0.0.1:{port}/?{token}");
        let shared = Arc::new(Shared {
            page,
            answers,
            token,
            port,
            viewers: AtomicUsize::new(0),
            strangers: Mutex::new(Strangers::default()),
            notices: Notices::default(),
        });
        let served = shared.clone();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                serve_aside(&served, stream);
            }
        });
        Ok(Self { shared, address })
    }

    /// Messages to the pages that are open.
    pub fn notices(&self) -> &Notices {
        &self.shared.notices
    }
}

/// Starts a server and prints its address. Another port is named as in `example`.
pub fn serve(
    page: String,
    answers: Option<Box<Answers>>,
    (port, example): (u16, &str),
) -> Result<PageServer> {
    let server = PageServer::start(page, answers, port).map_err(|error| {
        hinted(
            format!("the page cannot be served at port {port}: {error}"),
            format!("name another port, as {example}, or none"),
        )
    })?;
    talk(format_args!("open {}", server.address));
    Ok(server)
}

/// 128 random bits in hexadecimal digits.
fn token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Serves one connection on a thread of its own.
fn serve_aside(shared: &Arc<Shared>, stream: TcpStream) {
    let Ok(number) = shared.receive(&stream) else {
        return;
    };
    let shared = shared.clone();
    thread::spawn(move || {
        // a client that goes away, or says what is no request, is its own affair
        let _ = shared.serve(stream, number);
        shared.is_no_stranger(number);
    });
}

impl Patient {
    /// Ends the next operation at the deadline.
    fn limit(&self) -> io::Result<()> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.set_write_timeout(Some(left))
    }
}

impl Read for Patient {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.limit()?;
        self.stream.read(buffer)
    }
}

impl Write for Patient {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.limit()?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

impl Shared {
    /// Accepts a stranger, and ends the oldest one if there are too many; returns its number.
    /// Clients without the token thus never keep its owner out.
    fn receive(&self, stream: &TcpStream) -> io::Result<u64> {
        let mut strangers = lock(&self.strangers);
        if strangers.streams.len() >= MOST_STRANGERS
            && let Some((_, oldest)) = strangers.streams.pop_first()
        {
            let _ = oldest.shutdown(Shutdown::Both);
        }
        strangers.latest += 1;
        let number = strangers.latest;
        strangers.streams.insert(number, stream.try_clone()?);
        Ok(number)
    }

    /// Forgets a stranger: it has shown the token, or has gone.
    fn is_no_stranger(&self, number: u64) {
        lock(&self.strangers).streams.remove(&number);
    }

    fn serve(&self, stream: TcpStream, number: u64) -> io::Result<()> {
        stream.set_nodelay(true)?;
        let deadline = Instant::now() + PATIENCE;
        let stream = Patient { stream, deadline };
        let mut start = [0_u8; 12];
        loop {
            stream.limit()?;
            match stream.stream.peek(&mut start)? {
                0 => return Ok(()),
                all if all == start.len() => break,
                _ => thread::sleep(Duration::from_millis(1)),
            }
        }
        if &start == b"GET /socket?" {
            self.serve_socket(stream, number)
        } else {
            self.serve_request(stream, number)
        }
    }

    /// Returns true if a request names this server and its token. A page elsewhere would have
    /// another host or origin.
    fn allows(&self, host: Option<&str>, query: Option<&str>) -> bool {
        let ours = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        host.is_some_and(|host| ours.iter().any(|own| own == host))
            && query == Some(self.token.as_str())
    }

    fn serve_request(&self, stream: Patient, number: u64) -> io::Result<()> {
        let mut reader = BufReader::new(stream);
        let head = Head::read(&mut reader);
        let known = self.allows(head.field("host"), head.query());
        if known {
            self.is_no_stranger(number);
            reader.get_mut().deadline = Instant::now() + PATIENCE_WITH_FILES;
        }
        let (status, body) = match (head.method(), &self.answers) {
            _ if !known => (
                "403 Forbidden",
                "This is not the address that the program printed. Open that one.\n".to_owned(),
            ),
            ("GET", _) if head.path() == "" => ("200 OK", self.page.clone()),
            ("POST", Some(answers)) => self.answer(&head, &mut reader, answers.as_ref())?,
            _ => ("403 Forbidden", "This page asks nothing.\n".to_owned()),
        };
        // in one piece, so that a client's first look shows how it went
        let kind = if head.method() == "GET" {
            "html"
        } else {
            "plain"
        };
        let answer = format!(
            "HTTP/1.1 {status}\r\nContent-Type: text/{kind}; charset=utf-8\r\nContent-Length: {}\r\n\
             Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\n\
             X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n{body}",
            body.len()
        );
        if known {
            reader.get_mut().deadline = Instant::now() + PATIENCE;
        }
        reader.get_mut().write_all(answer.as_bytes())?;
        // a client that still sends would not read the answer; what it sends is not kept
        reader.get_ref().stream.shutdown(Shutdown::Write)?;
        copy(&mut reader, &mut sink()).map(drop)
    }

    /// Status and answer to a question of the page.
    fn answer(
        &self,
        head: &Head,
        reader: &mut BufReader<Patient>,
        answers: &Answers,
    ) -> io::Result<(&'static str, String)> {
        let origin = head.field("origin");
        if !self.allows(
            origin.and_then(|origin| origin.strip_prefix("http://")),
            head.query(),
        ) {
            let origin = origin.unwrap_or("no page");
            let text = format!(
                "The question comes from {origin}. Only the page of this program is answered.\n"
            );
            return Ok(("403 Forbidden", text));
        }
        let Some(length) = head
            .field("content-length")
            .and_then(|length| length.parse().ok())
        else {
            let text = "The request does not say its length. Send Content-Length.\n".to_owned();
            return Ok(("411 Length Required", text));
        };
        if length > LARGEST_BODY_MB * 1_000_000 {
            let text = too_large(length);
            return Ok(("413 Content Too Large", text));
        }
        let mut body = Vec::new();
        if reader.take(length).read_to_end(&mut body)? as u64 != length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        // a status of an error would stand in the browser's console
        let answer = match answers(head.path(), &body, &self.notices) {
            Ok(text) => json!({ "answer": text }),
            Err(error) => json!({ "error": said(&error) }),
        };
        Ok(("200 OK", answer.to_string()))
    }

    fn serve_socket(&self, stream: Patient, number: u64) -> io::Result<()> {
        #[expect(clippy::result_large_err, reason = "the library's signature")]
        let judge = |request: &Request, response: Response| {
            let head = |name: &str| request.headers().get(name)?.to_str().ok();
            let origin = head("origin").and_then(|origin| origin.strip_prefix("http://"));
            let query = request.uri().query();
            if self.allows(head("host"), query) && self.allows(origin, query) {
                self.is_no_stranger(number);
                return Ok(response);
            }
            let mut refused = ErrorResponse::new(None);
            *refused.status_mut() = StatusCode::FORBIDDEN;
            Err(refused)
        };
        let limits = WebSocketConfig::default()
            .max_message_size(Some(LONGEST_MESSAGE))
            .max_frame_size(Some(LONGEST_MESSAGE));
        let mut socket = accept_hdr_with_config(stream, judge, Some(limits))
            .map_err(|error| io::Error::other(error.to_string()))?;
        if self.viewers.fetch_add(1, Ordering::Relaxed) < MOST_VIEWERS {
            // a page that leaves is its own affair
            let _ = self.show_rows(&mut socket);
        }
        self.viewers.fetch_sub(1, Ordering::Relaxed);
        Ok(())
    }

    /// Sends a page the newest row again and again. A page that is opened while no rows come also
    /// gets the age of that row.
    fn show_rows(&self, socket: &mut WebSocket<Patient>) -> io::Result<()> {
        let mut seen = 0;
        while is_open(socket)? {
            let is_first = seen == 0;
            let (number, text, age) = self.notices.after(seen);
            let text = (number != seen).then_some(text);
            seen = number;
            socket.get_mut().deadline = Instant::now() + PATIENCE;
            if let Some(text) = text {
                let text = Message::text(&*text);
                socket.send(text).map_err(io::Error::other)?;
                if is_first && age >= OLD {
                    let silent = json!({ "silent": age.as_secs_f64() });
                    let silent = Message::text(silent.to_string());
                    socket.send(silent).map_err(io::Error::other)?;
                }
            }
        }
        Ok(())
    }
}

/// The answer to files that are too large together (bytes).
fn too_large(length: u64) -> String {
    format!(
        "error: these files have {} MB; the page takes at most {LARGEST_BODY_MB} MB\n\
         help: put them into a folder, and run `stickslip view FOLDER`",
        length / 1_000_000
    )
}

/// Takes a page's messages, without waiting for more; false where it has gone.
fn is_open(socket: &mut WebSocket<Patient>) -> io::Result<bool> {
    socket.get_mut().deadline = Instant::now() + PATIENCE;
    socket.get_ref().stream.set_nonblocking(true)?;
    let mut said = (0..MOST_MESSAGES).map(|_| socket.read());
    let end = said.find_map(Result::err);
    socket.get_ref().stream.set_nonblocking(false)?;
    Ok(match end {
        None => true,
        Some(tungstenite::Error::Io(error)) => error.kind() == io::ErrorKind::WouldBlock,
        Some(_) => false,
    })
}
