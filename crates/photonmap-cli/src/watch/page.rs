//! The picture so far on a web page. The page fetches linear radiance, so that layers and exposure are its own choice.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use photon_core::{Film, Layer};
use serde_json::json;
use tiny_http::{Header, Method, Request, Response, Server};

use super::Sink;
use crate::fault::Fault;

/// The page: one file, without anything from elsewhere.
const PAGE: &str = include_str!("page.html");

/// A web server in a thread of its own.
pub(super) struct Page {
    server: Arc<Server>,
    state: Arc<Mutex<State>>,
    begun: Instant,
    thread: Option<JoinHandle<()>>,
}

/// What the page shows.
#[derive(Default)]
struct State {
    title: String,
    width: u32,
    height: u32,
    passes: u32,
    seconds: f64,
    /// Name, and RGB of all pixels from the top left as little-endian f32.
    layers: Vec<(&'static str, Arc<[u8]>)>,
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Page {
    pub(super) fn serve(address: SocketAddr, title: &str) -> Result<Self, Fault> {
        let server = Server::http(address)
            .map_err(|why| Fault::input(format!("--serve {address}: {why}; port 0 takes any free port")))?;
        let chosen = server.server_addr().to_ip().unwrap_or(address);
        say!("watch at http://{chosen}/");
        let server = Arc::new(server);
        let state = Arc::new(Mutex::new(State { title: title.to_owned(), ..State::default() }));
        let (theirs, shared) = (Arc::clone(&server), Arc::clone(&state));
        let thread = thread::spawn(move || {
            for request in theirs.incoming_requests() {
                // A reader that leaves early is not an error.
                let _ = answer(request, &shared);
            }
        });
        Ok(Self { server, state, begun: Instant::now(), thread: Some(thread) })
    }

    #[cfg(test)]
    fn address(&self) -> SocketAddr {
        self.server.server_addr().to_ip().unwrap()
    }
}

impl Sink for Page {
    fn show(&mut self, film: &Film) -> Result<Option<String>, String> {
        let mut layers = vec![("picture", bytes(&film.beauty()))];
        layers.extend(Layer::ALL.map(|layer| (layer.name(), bytes(&film.layer(layer)))));
        layers.push(("albedo", bytes(&film.albedo())));
        let error: Vec<[f32; 3]> = film.standard_error().into_iter().map(|error| [error; 3]).collect();
        layers.push(("error", bytes(&error)));
        if let Some(intervals) = film.confidence_intervals() {
            let claimed: Vec<[f32; 3]> = intervals.iter().map(|interval| [interval.half_width as f32; 3]).collect();
            layers.push(("claimed", bytes(&claimed)));
        }
        let mut state = lock(&self.state);
        (state.width, state.height, state.passes) = (film.width, film.height, film.passes);
        state.seconds = self.begun.elapsed().as_secs_f64();
        state.layers = layers;
        Ok(None)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.server.unblock();
        if let Some(thread) = self.thread.take() {
            // It cannot panic, and there is no use for it if it did.
            let _ = thread.join();
        }
    }
}

fn bytes(values: &[[f32; 3]]) -> Arc<[u8]> {
    values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
}

/// Answers `/`, `/status` and `/layer/NAME`.
fn answer(request: Request, state: &Mutex<State>) -> std::io::Result<()> {
    if *request.method() != Method::Get {
        return request.respond(Response::from_string("only GET\n").with_status_code(405));
    }
    let (body, kind): (Vec<u8>, &str) = match request.url() {
        "/" => (PAGE.into(), "text/html; charset=utf-8"),
        "/status" => (status(&lock(state)).into(), "application/json"),
        path => {
            let layers = &lock(state).layers;
            let wanted = path.strip_prefix("/layer/");
            match layers.iter().find(|(name, _)| Some(*name) == wanted) {
                Some((_, values)) => (values.to_vec(), "application/octet-stream"),
                None => (Vec::new(), ""),
            }
        }
    };
    if kind.is_empty() {
        return request.respond(Response::from_string("there is no such page\n").with_status_code(404));
    }
    let header = |name: &str, value: &str| Header::from_bytes(name, value).ok();
    let headers = [header("Content-Type", kind), header("Cache-Control", "no-store")];
    let response = headers.into_iter().flatten().fold(Response::from_data(body), Response::with_header);
    request.respond(response)
}

fn status(state: &State) -> String {
    let names: Vec<&str> = state.layers.iter().map(|(name, _)| *name).collect();
    let status = json!({
        "title": state.title,
        "width": state.width,
        "height": state.height,
        "passes": state.passes,
        "seconds": state.seconds,
        "layers": names,
    });
    status.to_string()
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpStream;

    use super::*;

    /// The status line and the body of an answer.
    fn request(page: &Page, line: &str) -> (String, Vec<u8>) {
        let mut stream = TcpStream::connect(page.address()).unwrap();
        write!(stream, "{line} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        (head.lines().next().unwrap().to_owned(), bytes[end + 4..].to_vec())
    }

    #[test]
    fn the_page_its_status_and_its_layers_are_served() {
        let mut page = Page::serve("127.0.0.1:0".parse().unwrap(), "cornell").unwrap();
        let status =
            |page: &Page| -> serde_json::Value { serde_json::from_slice(&request(page, "GET /status").1).unwrap() };
        assert_eq!(status(&page)["passes"], 0);
        assert!(request(&page, "GET /layer/picture").0.contains("404"), "there is no picture yet");

        let mut film = Film::new(2, 1, photon_core::Units::default()).unwrap();
        film.passes = 1;
        film.pixels[1].layers[2] = [0.5, 1.0, 2.0];
        page.show(&film).unwrap();
        let found = status(&page);
        assert_eq!((&found["width"], &found["height"], &found["passes"]), (&2.into(), &1.into(), &1.into()));
        assert_eq!(found["title"], "cornell");
        let layers = found["layers"].as_array().unwrap();
        assert!(layers.contains(&"caustic".into()) && layers.contains(&"error".into()));
        let expected: Vec<u8> =
            [0.0f32, 0.0, 0.0, 0.5, 1.0, 2.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        for layer in ["picture", "caustic"] {
            assert_eq!(request(&page, &format!("GET /layer/{layer}")).1, expected);
        }
        assert_eq!(request(&page, "GET /").1, PAGE.as_bytes());
        for wrong in ["GET /layer/none", "GET /etc/passwd", "GET /layer/../status"] {
            assert!(request(&page, wrong).0.contains("404"), "{wrong}");
        }
        assert!(request(&page, "POST /status").0.contains("405"));
    }

    #[test]
    fn an_address_in_use_is_an_error_with_a_hint() {
        let page = Page::serve("127.0.0.1:0".parse().unwrap(), "a").unwrap();
        let fault = Page::serve(page.address(), "b").err().unwrap().to_string();
        assert!(fault.contains("--serve 127.0.0.1:") && fault.contains("port 0"), "{fault}");
    }
}
