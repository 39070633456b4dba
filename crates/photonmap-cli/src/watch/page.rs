//! The picture so far on a web page. The page fetches linear radiance, so that layers and exposure are its own choice.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use photon_core::{Film, Layer};
use photon_image::exposure::{Exposure, measured};
use serde_json::json;

use super::Sink;
use super::server::{Answer, Limits, Server};
use crate::args::ServeAddress;
use crate::fault::Fault;

/// The page: one file, without anything from elsewhere.
const PAGE: &str = include_str!("page.html");

/// The page on a web server.
pub(super) struct Page {
    server: Server,
    state: Arc<Mutex<State>>,
    begun: Instant,
}

/// What the page shows.
#[derive(Default)]
struct State {
    title: String,
    width: u32,
    height: u32,
    passes: u32,
    seconds: f64,
    /// Automatic exposure of the picture, in stops.
    exposure: f32,
    /// Name, and RGB of all pixels from the top left as little-endian f32.
    layers: Vec<(&'static str, Arc<[u8]>)>,
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Page {
    pub(super) fn serve(address: &ServeAddress, title: &str) -> Result<Self, Fault> {
        let state = Arc::new(Mutex::new(State { title: title.to_owned(), ..State::default() }));
        let shared = Arc::clone(&state);
        let server =
            Server::start(address, Limits::USUAL, move |path: &str| answer(path, &lock(&shared))).map_err(|why| {
                Fault::input(format!(
                    "--serve {address}: {why}; give an address of this machine, and a free port, or port 0 for any free one"
                ))
            })?;
        say!("watch at http://{}/", server.address());
        Ok(Self { server, state, begun: Instant::now() })
    }
}

impl Sink for Page {
    fn show(&mut self, film: &Film) -> Result<Option<String>, String> {
        let picture = film.beauty();
        let exposure = Exposure::Auto.stops(&measured(&picture, &film.alpha()));
        let mut layers = vec![("picture", bytes(&picture))];
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
        (state.exposure, state.layers) = (exposure, layers);
        Ok(None)
    }

    fn close(&mut self, deadline: Instant) -> Result<(), String> {
        self.server.close(deadline);
        Ok(())
    }
}

fn bytes(values: &[[f32; 3]]) -> Arc<[u8]> {
    values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
}

/// Answers `/`, `/status` and `/layer/NAME`.
fn answer(path: &str, state: &State) -> Option<Answer> {
    match path {
        "/" => Some(Answer::ok("text/html; charset=utf-8", PAGE.as_bytes().into())),
        "/status" => Some(Answer::ok("application/json", status(state).into_bytes().into())),
        path => {
            let wanted = path.strip_prefix("/layer/")?;
            let (_, values) = state.layers.iter().find(|(name, _)| *name == wanted)?;
            Some(Answer::ok("application/octet-stream", Arc::clone(values)))
        }
    }
}

fn status(state: &State) -> String {
    let names: Vec<&str> = state.layers.iter().map(|(name, _)| *name).collect();
    let status = json!({
        "title": state.title,
        "width": state.width,
        "height": state.height,
        "passes": state.passes,
        "seconds": state.seconds,
        "exposure": state.exposure,
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
        let mut stream = TcpStream::connect(page.server.address()).unwrap();
        write!(stream, "{line} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        (head.lines().next().unwrap().to_owned(), bytes[end + 4..].to_vec())
    }

    #[test]
    fn the_page_its_status_and_its_layers_are_served() {
        let mut page = Page::serve(&"127.0.0.1:0".parse().unwrap(), "cornell").unwrap();
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
        // log2(0.18 / L), with the luminance of the only pixel that is lit.
        let expected = (0.18_f64 / (0.2126 * 0.5 + 0.7152 + 0.0722 * 2.0)).log2();
        assert!((found["exposure"].as_f64().unwrap() - expected).abs() < 1e-6, "{found}");
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
        let page = Page::serve(&"127.0.0.1:0".parse().unwrap(), "a").unwrap();
        let fault = Page::serve(&page.server.address().to_string().parse().unwrap(), "b").err().unwrap().to_string();
        assert!(fault.contains("--serve 127.0.0.1:") && fault.contains("port 0"), "{fault}");
    }
}
