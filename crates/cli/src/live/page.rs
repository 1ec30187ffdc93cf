//! The live page: a server on the loopback address, for one page and its WebSocket: [`PageServer`].

use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::json;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, accept_hdr_with_config};

/// Least time between two rows that are shown: 30 a second are seen.
const PERIOD: Duration = Duration::from_millis(33);

/// Most pages that are shown rows at a time.
const MOST_VIEWERS: usize = 8;

/// Most connections that have not shown the token yet; a further one ends the oldest.
const MOST_STRANGERS: usize = 32;

/// Time that a client may take for its whole request and the answer, and a page for a row.
const PATIENCE: Duration = Duration::from_secs(5);

/// Age of a row from which on a new page is given it.
const OLD: Duration = Duration::from_secs(2);

/// Time between checks of a page to which nothing is sent: it may be gone.
const LOOK: Duration = Duration::from_secs(1);

/// Most messages that are taken from a page at a time; it has nothing to say.
const MOST_MESSAGES: usize = 64;

/// Longest message of a page (bytes).
const LONGEST_MESSAGE: usize = 4 << 10;

/// Longest head of a request (bytes).
const LONGEST_HEAD: usize = 16 << 10;

/// Serves the page until the program ends.
pub struct PageServer {
    shared: Arc<Shared>,
    address: String,
    shown: Option<Instant>,
}

/// State that the threads of the connections share.
struct Shared {
    page: String,
    /// End of the page's address.
    token: String,
    port: u16,
    viewers: AtomicUsize,
    strangers: Mutex<Strangers>,
    newest: Mutex<Newest>,
    changed: Condvar,
}

/// Connections that have not shown the token yet, by their numbers.
#[derive(Default)]
struct Strangers {
    latest: u64,
    streams: BTreeMap<u64, TcpStream>,
}

/// The newest message, its number, and when it came.
#[derive(Default)]
struct Newest {
    number: u64,
    text: Arc<str>,
    came: Option<Instant>,
}

/// A client's stream, on which everything ends at a deadline.
struct Patient {
    stream: TcpStream,
    deadline: Instant,
}

impl PageServer {
    /// Listens at a port of the loopback address, 0 for any that is free.
    pub fn start(page: String, port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let port = listener.local_addr()?.port();
        let token = token()?;
        let address = format!("http://127.0.0.1:{port}/?{token}");
        let shared = Arc::new(Shared {
            page,
            token,
            port,
            viewers: AtomicUsize::new(0),
            strangers: Mutex::new(Strangers::default()),
            newest: Mutex::new(Newest::default()),
            changed: Condvar::new(),
        });
        let served = shared.clone();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                serve_aside(&served, stream);
            }
        });
        Ok(Self {
            shared,
            address,
            shown: None,
        })
    }

    /// The page's address, token included.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Returns true if a row should be shown now: the last one was some time ago. It is shown
    /// without a page, too, so that one that is opened while the source is silent has something to
    /// show.
    pub fn wants(&self) -> bool {
        self.shown.is_none_or(|shown| shown.elapsed() >= PERIOD)
    }

    /// Shows a message to all pages that are open; those that are busy drop the one before.
    pub fn show(&mut self, text: String) {
        let mut newest = lock(&self.shared.newest);
        self.shown = Some(Instant::now());
        newest.number += 1;
        newest.text = text.into();
        newest.came = self.shown;
        self.shared.changed.notify_all();
    }
}

/// 128 random bits in hexadecimal digits.
fn token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
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
            self.serve_page(stream, number)
        }
    }

    /// Returns true if a request names this server and its token. A page elsewhere would have
    /// another host or origin.
    fn allows(&self, host: Option<&str>, query: Option<&str>) -> bool {
        let ours = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        host.is_some_and(|host| ours.iter().any(|own| own == host))
            && query == Some(self.token.as_str())
    }

    fn serve_page(&self, mut stream: Patient, number: u64) -> io::Result<()> {
        let mut lines = BufReader::new(Read::take(&mut stream, LONGEST_HEAD as u64)).lines();
        let request = lines.next().transpose()?.unwrap_or_default();
        let heads = lines
            .map_while(Result::ok)
            .take_while(|line| !line.is_empty());
        let heads: Vec<String> = heads.collect();
        let host = heads.iter().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            name.eq_ignore_ascii_case("host").then_some(value.trim())
        });
        let query = request
            .strip_prefix("GET /?")
            .and_then(|rest| rest.split(' ').next());
        let (status, body) = match self.allows(host, query) {
            true => {
                self.is_no_stranger(number);
                ("200 OK", self.page.as_str())
            }
            false => (
                "403 Forbidden",
                "The address is the one that the program printed.\n",
            ),
        };
        // in one piece, so that a client's first look shows how it went
        let answer = format!(
            "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\n\
             Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\nConnection: close\r\n\r\n{body}",
            body.len()
        );
        stream.write_all(answer.as_bytes())
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
            let (text, age) = {
                let newest = lock(&self.newest);
                let waited = self
                    .changed
                    .wait_timeout_while(newest, LOOK, |newest| newest.number == seen);
                let (newest, _) = waited.unwrap_or_else(PoisonError::into_inner);
                let is_new = newest.number != seen;
                seen = newest.number;
                let age = newest.came.map_or(Duration::ZERO, |came| came.elapsed());
                (is_new.then(|| newest.text.clone()), age)
            };
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
