//! A web server for one page that changes: GET alone, one request for each connection, everything limited.
//!
//! One thread serves all connections without waiting for any, so that a client that stalls delays nobody.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::args::ServeAddress;

/// What clients may take.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Connections at once; a further one takes the place of the oldest.
    connections: usize,
    /// Bytes of a request.
    bytes: usize,
    /// Time for sending a request.
    request: Duration,
    /// Time for reading the answer.
    answer: Duration,
    /// Time for closing.
    closing: Duration,
}

impl Limits {
    /// Those of a page that a few people look at, some of them over a slow line.
    pub(super) const USUAL: Self = Self {
        connections: 32,
        bytes: 8 << 10,
        request: Duration::from_secs(5),
        answer: Duration::from_secs(60),
        closing: Duration::from_secs(1),
    };
}

/// Pause with connections.
const BUSY: Duration = Duration::from_millis(2);
/// Pause without.
const IDLE: Duration = Duration::from_millis(20);

/// The answer to a request.
pub(super) struct Answer {
    status: &'static str,
    kind: &'static str,
    body: Arc<[u8]>,
}

impl Answer {
    pub(super) fn ok(kind: &'static str, body: Arc<[u8]>) -> Self {
        Self { status: "200 OK", kind, body }
    }

    fn refusal(status: &'static str, why: &str) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", body: format!("{why}\n").into_bytes().into() }
    }
}

/// The content for a path, if there is any.
pub(super) trait Content: Fn(&str) -> Option<Answer> + Send + 'static {}
impl<F: Fn(&str) -> Option<Answer> + Send + 'static> Content for F {}

/// A running server; it ends when this is dropped, and answers that are under way are cut off.
pub(super) struct Server {
    address: SocketAddr,
    /// When it ends, if it is to end.
    end: Arc<Mutex<Option<Instant>>>,
    thread: JoinHandle<()>,
}

impl Server {
    pub(super) fn start(address: &ServeAddress, limits: Limits, content: impl Content) -> io::Result<Self> {
        let listener = TcpListener::bind((address.host.as_str(), address.port))?;
        listener.set_nonblocking(true)?;
        let (chosen, host) = (listener.local_addr()?, address.host.clone());
        let end = Arc::new(Mutex::new(None));
        let theirs = Arc::clone(&end);
        let thread = thread::Builder::new().spawn(move || serve(&listener, limits, &host, &content, &theirs))?;
        Ok(Self { address: chosen, end, thread })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Accepts nobody any more, and waits for answers that are under way, until `deadline` at the latest.
    pub(super) fn close(&self, deadline: Instant) {
        self.end_at(deadline);
        while !self.thread.is_finished() && Instant::now() < deadline {
            thread::sleep(BUSY);
        }
    }

    fn end_at(&self, deadline: Instant) {
        self.end.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(deadline);
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end_at(Instant::now());
    }
}

fn serve(listener: &TcpListener, limits: Limits, host: &str, content: &impl Content, end: &Mutex<Option<Instant>>) {
    let mut connections: Vec<Connection> = Vec::new();
    loop {
        let now = Instant::now();
        let end = *end.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(end) = end {
            connections.retain(|connection| !matches!(connection.phase, Phase::Request(_)));
            if connections.is_empty() || now >= end {
                return;
            }
        } else {
            // Errors, such as too few descriptors, pass when other connections end.
            while let Ok((stream, _)) = listener.accept() {
                if connections.len() >= limits.connections {
                    connections.remove(0);
                }
                connections.extend(Connection::new(stream, limits, now).ok());
            }
        }
        connections.retain_mut(|connection| match connection.advance(host, content, now) {
            Err(why) if !matches!(why.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => false,
            _ => now < connection.deadline,
        });
        thread::sleep(if connections.is_empty() { IDLE } else { BUSY });
    }
}

enum Phase {
    /// The request so far.
    Request(Vec<u8>),
    /// Head and body, and how much of both was sent.
    Answer { head: Vec<u8>, body: Arc<[u8]>, sent: usize },
    /// Ended by us; what still comes is discarded, since closing at once would cut off the answer.
    Closing,
}

struct Connection {
    stream: TcpStream,
    limits: Limits,
    phase: Phase,
    deadline: Instant,
}

impl Connection {
    fn new(stream: TcpStream, limits: Limits, now: Instant) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream, limits, phase: Phase::Request(Vec::new()), deadline: now + limits.request })
    }

    /// Goes on as far as is possible without waiting. An error other than [`ErrorKind::WouldBlock`] is its end.
    fn advance(&mut self, host: &str, content: &impl Content, now: Instant) -> io::Result<()> {
        let mut bytes = [0; 1024];
        if let Phase::Request(request) = &mut self.phase {
            let answer = loop {
                match self.stream.read(&mut bytes)? {
                    0 => return Err(ErrorKind::UnexpectedEof.into()),
                    count => request.extend_from_slice(&bytes[..count]),
                }
                if let Some(answer) = answer(request, self.limits.bytes, host, content) {
                    break answer;
                }
            };
            let head = format!(
                "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
                 X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
                answer.status,
                answer.kind,
                answer.body.len()
            );
            self.phase = Phase::Answer { head: head.into_bytes(), body: answer.body, sent: 0 };
            self.deadline = now + self.limits.answer;
        }
        if let Phase::Answer { head, body, sent } = &mut self.phase {
            while *sent < head.len() + body.len() {
                let rest = head.get(*sent..).filter(|rest| !rest.is_empty());
                match self.stream.write(rest.unwrap_or_else(|| &body[*sent - head.len()..]))? {
                    0 => return Err(ErrorKind::WriteZero.into()),
                    count => *sent += count,
                }
            }
            self.stream.shutdown(Shutdown::Write)?;
            self.phase = Phase::Closing;
            self.deadline = now + self.limits.closing;
        }
        match self.stream.read(&mut bytes)? {
            0 => Err(ErrorKind::UnexpectedEof.into()),
            _ => Ok(()),
        }
    }
}

/// The answer to a request of at most so many bytes; `None` while it is incomplete.
fn answer(request: &[u8], most: usize, host: &str, content: &impl Content) -> Option<Answer> {
    let refusal = |status, why| Some(Answer::refusal(status, why));
    let Some(end) = request.windows(4).position(|four| four == b"\r\n\r\n") else {
        let is_long = request.len() > most;
        return if is_long { refusal("431 Request Header Fields Too Large", "the request is too long") } else { None };
    };
    let head = String::from_utf8_lossy(&request[..end]);
    let mut lines = head.split("\r\n");
    let mut words = lines.next().unwrap_or_default().split(' ');
    let (Some(method), Some(path), Some("HTTP/1.0" | "HTTP/1.1"), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return refusal("400 Bad Request", "this is no request of HTTP/1.1");
    };
    let fields: Vec<(&str, &str)> = lines.filter_map(|line| line.split_once(':')).collect();
    let values = |wanted: &str| {
        let is_wanted = move |(name, _): &&(&str, &str)| name.eq_ignore_ascii_case(wanted);
        fields.iter().filter(is_wanted).map(|(_, value)| value.trim()).collect::<Vec<_>>()
    };
    match values("Host")[..] {
        [name] if is_ours(name, host) => {}
        [_] => {
            return refusal(
                "403 Forbidden",
                "open this page by localhost, an IP address, or the name given to --serve",
            );
        }
        _ => return refusal("400 Bad Request", "a request has one host"),
    }
    if !values("Transfer-Encoding").is_empty() || values("Content-Length").iter().any(|&length| length != "0") {
        return refusal("413 Content Too Large", "requests have no content here");
    }
    if method != "GET" {
        return refusal("405 Method Not Allowed", "only GET");
    }
    content(path).or_else(|| refusal("404 Not Found", "there is no such page"))
}

/// Whether a request to this host, with or without a port, may be answered. A web site can direct a name of its own to this
/// server and read pictures through its visitor's browser (DNS rebinding); it cannot do that with an address.
fn is_ours(requested: &str, given: &str) -> bool {
    let name = match requested.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => requested.split(':').next().unwrap_or_default(),
    };
    name.parse::<IpAddr>().is_ok() || ["localhost", given].iter().any(|ours| name.eq_ignore_ascii_case(ours))
}

#[cfg(test)]
mod tests;
