//! The live page: a server on the loopback address, for one page and its WebSocket: [`PageServer`].

use std::io::{self, BufRead, BufReader, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, accept_hdr_with_config};

/// Least time between two rows that are shown: 30 a second are seen.
const PERIOD: Duration = Duration::from_millis(33);

/// Most pages that are served at a time.
const MOST_VIEWERS: usize = 8;

/// Time that a client may take to say or take something.
const PATIENCE: Duration = Duration::from_secs(5);

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
    newest: Mutex<Newest>,
    changed: Condvar,
}

/// The newest message and its number.
#[derive(Default)]
struct Newest {
    number: u64,
    text: Arc<str>,
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
        newest.number += 1;
        newest.text = text.into();
        self.shown = Some(Instant::now());
        self.shared.changed.notify_all();
    }
}

/// 128 random bits in hexadecimal digits.
fn token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn lock(newest: &Mutex<Newest>) -> MutexGuard<'_, Newest> {
    newest.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Serves one connection on a thread of its own, if there are not too many.
fn serve_aside(shared: &Arc<Shared>, stream: TcpStream) {
    if shared.viewers.fetch_add(1, Ordering::Relaxed) >= MOST_VIEWERS {
        shared.viewers.fetch_sub(1, Ordering::Relaxed);
        return;
    }
    let shared = shared.clone();
    thread::spawn(move || {
        // a client that goes away, or says what is no request, is its own affair
        let _ = shared.serve(stream);
        shared.viewers.fetch_sub(1, Ordering::Relaxed);
    });
}

impl Shared {
    fn serve(&self, stream: TcpStream) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        let mut start = [0_u8; 12];
        let begin = Instant::now();
        while stream.peek(&mut start)? < start.len() {
            if begin.elapsed() > PATIENCE {
                return Ok(());
            }
            thread::sleep(Duration::from_millis(1));
        }
        if &start == b"GET /socket?" {
            self.serve_socket(stream)
        } else {
            self.serve_page(stream)
        }
    }

    /// Returns true if a request names this server and its token. A page elsewhere would have
    /// another host or origin.
    fn allows(&self, host: Option<&str>, query: Option<&str>) -> bool {
        let ours = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        host.is_some_and(|host| ours.iter().any(|own| own == host))
            && query == Some(self.token.as_str())
    }

    fn serve_page(&self, mut stream: TcpStream) -> io::Result<()> {
        let mut lines = BufReader::new(io::Read::take(&stream, LONGEST_HEAD as u64)).lines();
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
            true => ("200 OK", self.page.as_str()),
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

    fn serve_socket(&self, stream: TcpStream) -> io::Result<()> {
        #[expect(clippy::result_large_err, reason = "the library's signature")]
        let judge = |request: &Request, response: Response| {
            let head = |name: &str| request.headers().get(name)?.to_str().ok();
            let origin = head("origin").and_then(|origin| origin.strip_prefix("http://"));
            let query = request.uri().query();
            if self.allows(head("host"), query) && self.allows(origin, query) {
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
        let mut seen = 0;
        while is_open(&mut socket)? {
            let text = {
                let newest = lock(&self.newest);
                let waited = self
                    .changed
                    .wait_timeout_while(newest, LOOK, |newest| newest.number == seen);
                let (newest, _) = waited.unwrap_or_else(PoisonError::into_inner);
                let is_new = newest.number != seen;
                seen = newest.number;
                is_new.then(|| newest.text.clone())
            };
            if let Some(text) = text {
                socket
                    .send(Message::text(&*text))
                    .map_err(io::Error::other)?;
            }
        }
        Ok(())
    }
}

/// Takes a page's messages, without waiting for more; false where it has gone.
fn is_open(socket: &mut WebSocket<TcpStream>) -> io::Result<bool> {
    socket.get_ref().set_nonblocking(true)?;
    let mut said = (0..MOST_MESSAGES).map(|_| socket.read());
    let end = said.find_map(Result::err);
    socket.get_ref().set_nonblocking(false)?;
    Ok(match end {
        None => true,
        Some(tungstenite::Error::Io(error)) => error.kind() == io::ErrorKind::WouldBlock,
        Some(_) => false,
    })
}
