use super::*;

const BODY: usize = 4 << 20;

/// A server with a small page at `/` and a large one at `/large`.
fn start(limits: Limits) -> Server {
    let address = "127.0.0.1:0".parse().unwrap();
    let content = |path: &str| match path {
        "/" => Some(Answer::ok("text/plain", (*b"hello").into())),
        "/large" => Some(Answer::ok("text/plain", vec![7; BODY].into())),
        _ => None,
    };
    Server::start(&address, limits, content).unwrap()
}

fn connect(server: &Server) -> TcpStream {
    let stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream
}

/// Everything that comes after a request, until the connection ends.
fn ask(server: &Server, request: &[u8]) -> String {
    let mut stream = connect(server);
    stream.write_all(request).unwrap();
    rest(stream)
}

fn rest(mut stream: TcpStream) -> String {
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    text
}

const GET: &[u8] = b"GET / HTTP/1.1\r\nHost: localhost:80\r\n\r\n";
const LARGE: &[u8] = b"GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n";

#[test]
fn requests_are_answered_or_refused_by_a_status() {
    let server = start(Limits::USUAL);
    let long = [b"GET / HTTP/1.1\r\nHost: a\r\nX: ", &[b'x'; 9000][..]].concat();
    let many = [b"GET / HTTP/1.1\r\n".as_slice(), &b"a: b\r\n".repeat(2000)].concat();
    let cases: &[(&[u8], &str)] = &[
        (GET, "200 OK"),
        (b"GET / HTTP/1.0\r\nhost: 192.168.0.7\r\ncontent-length: 0\r\n\r\n", "200 OK"),
        (b"GET /../a HTTP/1.1\r\nHost: localhost\r\n\r\n", "404"),
        (b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n", "405"),
        (b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello", "413"),
        (b"GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n", "413"),
        (b"GET / HTTP/1.1\r\nHost: rebound.example\r\n\r\n", "403"),
        (b"GET / HTTP/1.1\r\n\r\n", "400"),
        (b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: rebound.example\r\n\r\n", "400"),
        (b"GET / HTTP/2\r\nHost: localhost\r\n\r\n", "400"),
        (b"\xff\0\r\n\r\n", "400"),
        (&long, "431"),
        (&many, "431"),
    ];
    for (request, status) in cases {
        let found = ask(&server, request);
        let shown = String::from_utf8_lossy(&request[..request.len().min(60)]);
        assert!(found.starts_with(&format!("HTTP/1.1 {status}")), "{shown:?}: {found}");
    }
    assert!(ask(&server, GET).ends_with("Connection: close\r\n\r\nhello"));
}

#[test]
fn names_are_ours_if_no_web_site_can_have_them() {
    for ours in ["localhost", "LocalHost:8080", "127.0.0.1", "10.0.0.1:80", "[::1]", "[::1]:8080", "box:1", "Box"] {
        assert!(is_ours(ours, "box"), "{ours}");
    }
    for theirs in ["", "a", "localhost.example", "box.example:80", "127.0.0.1.example", "[a]:1", ":80"] {
        assert!(!is_ours(theirs, "box"), "{theirs}");
    }
}

/// Clients that stall in a request or in an answer, and more of them than there may be connections.
#[test]
fn nobody_is_delayed_by_others_and_stalled_clients_leave() {
    let limits = Limits { connections: 4, request: Duration::from_millis(300), ..Limits::USUAL };
    let server = start(limits);
    let idle = connect(&server);
    assert!(ask(&server, GET).ends_with("hello"));
    let stalled: Vec<TcpStream> = (0..10)
        .map(|_| {
            let mut stream = connect(&server);
            stream.write_all(LARGE).unwrap();
            stream
        })
        .collect();
    assert!(ask(&server, GET).ends_with("hello"), "all places were taken");
    assert_eq!(rest(idle), "", "it never asked");
    drop(stalled);
    assert_eq!(ask(&server, LARGE).matches('\u{7}').count(), BODY);
}

#[test]
fn closing_waits_for_readers_but_not_for_ever() {
    let large = || {
        let server = start(Limits::USUAL);
        let mut stream = connect(&server);
        stream.write_all(LARGE).unwrap();
        // The answer is under way.
        stream.read_exact(&mut [0]).unwrap();
        (server, stream)
    };
    let (server, stream) = large();
    let reader = thread::spawn(move || rest(stream));
    let begun = Instant::now();
    server.close(begun + Duration::from_secs(20));
    assert!(begun.elapsed() < Duration::from_secs(10), "the reader has left");
    assert!(reader.join().unwrap().ends_with("\u{7}\u{7}"));

    let (server, _stalled) = large();
    let begun = Instant::now();
    server.close(begun + Duration::from_millis(100));
    drop(server);
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
}
