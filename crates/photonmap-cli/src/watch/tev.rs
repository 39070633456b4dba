//! The picture so far in the viewer tev, by its protocol over TCP.

use std::io::ErrorKind;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use photon_core::{Film, Layer};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::Sink;
use crate::fault::Fault;

/// Time for connecting, and for a viewer that does not read.
const TIMEOUT: Duration = Duration::from_secs(3);

/// The port on which tev listens.
const PORT: u16 = 14158;

const SLOW: &str = "the viewer reads too slowly";

/// A connection to the viewer. Pictures are sent by a thread of its own, the latest one only, so that a slow viewer does not
/// delay the render.
pub(super) struct Tev {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    picture: Option<Channels>,
    /// Whether a picture is being sent.
    sending: bool,
    closed: bool,
    failure: Option<String>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Channels of a picture, one after the other.
struct Channels {
    width: u32,
    height: u32,
    names: Vec<String>,
    data: Vec<f32>,
}

impl Channels {
    /// The picture, its layers and the standard error.
    fn new(film: &Film) -> Self {
        let mut channels = Self { width: film.width, height: film.height, names: Vec::new(), data: Vec::new() };
        channels.add("", &film.beauty());
        for layer in Layer::ALL {
            channels.add(&format!("{}.", layer.name()), &film.layer(layer));
        }
        channels.names.push("error.Y".to_owned());
        channels.data.extend(film.standard_error());
        channels
    }

    fn add(&mut self, prefix: &str, values: &[[f32; 3]]) {
        for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
            self.names.push(format!("{prefix}{name}"));
            self.data.extend(values.iter().map(|value| value[axis]));
        }
    }
}

impl Tev {
    pub(super) fn connect(host: &str, title: &str) -> Result<Self, Fault> {
        let with_port = if host.contains(':') { host.to_owned() } else { format!("{host}:{PORT}") };
        let fault = |why: std::io::Error| {
            Fault::input(format!("--tev={host}: {why}; start tev there before the render, or leave the option out"))
        };
        let none = || std::io::Error::other("this name has no address");
        let address = with_port.to_socket_addrs().map_err(fault)?.next().ok_or_else(none).map_err(fault)?;
        let socket = TcpStream::connect_timeout(&address, TIMEOUT).map_err(fault)?;
        socket.set_write_timeout(Some(TIMEOUT)).map_err(fault)?;
        let shared = Arc::new(Shared::default());
        let (theirs, title) = (Arc::clone(&shared), title.to_owned());
        // It ends with the connection, which a viewer may hold up: nobody waits for it beyond a deadline.
        thread::spawn(move || send_all(&theirs, TevClient::wrap(socket), &title));
        Ok(Self { shared })
    }
}

impl Sink for Tev {
    fn show(&mut self, film: &Film) -> Result<Option<String>, String> {
        let picture = Channels::new(film);
        let mut state = self.shared.lock();
        if let Some(why) = state.failure.take() {
            return Err(format!("tev: {why}"));
        }
        state.picture = Some(picture);
        self.shared.changed.notify_all();
        Ok(None)
    }

    /// Waits until the last picture is sent.
    fn close(&mut self, deadline: Instant) -> Result<(), String> {
        let left = deadline.saturating_duration_since(Instant::now());
        let is_busy = |state: &mut State| (state.picture.is_some() || state.sending) && state.failure.is_none();
        let (mut state, waited) = self
            .shared
            .changed
            .wait_timeout_while(self.shared.lock(), left, is_busy)
            .unwrap_or_else(PoisonError::into_inner);
        match state.failure.take() {
            Some(why) => Err(format!("tev: {why}")),
            None if waited.timed_out() => Err(format!("tev: {SLOW}")),
            None => Ok(()),
        }
    }
}

impl Drop for Tev {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.changed.notify_all();
    }
}

/// Sends pictures until the connection is closed or fails.
fn send_all(shared: &Shared, mut viewer: TevClient, title: &str) {
    let mut created = false;
    loop {
        let waits = |state: &mut State| state.picture.is_none() && !state.closed;
        let mut state = shared.changed.wait_while(shared.lock(), waits).unwrap_or_else(PoisonError::into_inner);
        let Some(picture) = state.picture.take() else { return };
        state.sending = true;
        drop(state);
        let sent = send(&mut viewer, &picture, title, !created);
        let mut state = shared.lock();
        (state.sending, state.failure) = (false, sent.as_ref().err().map(reason));
        shared.changed.notify_all();
        if sent.is_err() {
            return;
        }
        created = true;
    }
}

/// The reason why a picture was not sent.
fn reason(why: &std::io::Error) -> String {
    match why.kind() {
        // The write timeout of the connection.
        ErrorKind::WouldBlock | ErrorKind::TimedOut => SLOW.to_owned(),
        _ => why.to_string(),
    }
}

fn send(viewer: &mut TevClient, picture: &Channels, title: &str, create: bool) -> std::io::Result<()> {
    let Channels { width, height, names, data } = picture;
    if create {
        viewer.send(PacketCreateImage {
            image_name: title,
            grab_focus: true,
            width: *width,
            height: *height,
            channel_names: names,
        })?;
    }
    let pixels = u64::from(*width) * u64::from(*height);
    let offsets: Vec<u64> = (0..names.len() as u64).map(|channel| channel * pixels).collect();
    viewer.send(PacketUpdateImage {
        image_name: title,
        grab_focus: false,
        channel_names: names,
        channel_offsets: &offsets,
        channel_strides: &vec![1; names.len()],
        x: 0,
        y: 0,
        width: *width,
        height: *height,
        data,
    })
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::net::TcpListener;
    use std::time::Instant;

    use super::*;

    fn film(value: f64, size: u32) -> Film {
        let mut film = Film::new(size, size, photon_core::Units::default()).unwrap();
        film.passes = 1;
        film.pixels.iter_mut().for_each(|pixel| pixel.layers[1] = [value, 2.0 * value, 3.0 * value]);
        film
    }

    /// Packets as in tev's description: the length, its own four bytes included, then the kind.
    fn packets(mut stream: impl Read) -> Vec<Vec<u8>> {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let (mut packets, mut rest) = (Vec::new(), &bytes[..]);
        while !rest.is_empty() {
            let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
            packets.push(rest[4..length].to_vec());
            rest = &rest[length..];
        }
        packets
    }

    #[test]
    fn a_viewer_gets_all_channels_of_the_last_picture() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let reader = thread::spawn(move || packets(listener.accept().unwrap().0));
        let mut tev = Tev::connect(&address, "scene").unwrap();
        for value in [1.0, 4.0] {
            tev.show(&film(value, 2)).unwrap();
        }
        tev.close(Instant::now() + TIMEOUT).unwrap();
        drop(tev);
        let packets = reader.join().unwrap();
        let (create, last) = (&packets[0], packets.last().unwrap());
        assert_eq!(create[0], 4, "CreateImage");
        // Focus, name, width, height, number of channels, first channel.
        assert_eq!(&create[1..], {
            let mut expected =
                [&[1][..], b"scene\0", &2u32.to_le_bytes(), &2u32.to_le_bytes(), &16u32.to_le_bytes()].concat();
            for name in ["", "emission.", "direct.", "caustic.", "indirect."] {
                ["R", "G", "B"].iter().for_each(|c| expected.extend(format!("{name}{c}\0").bytes()));
            }
            expected.extend(b"error.Y\0");
            expected
        });
        assert_eq!(last[0], 6, "UpdateImage, third version");
        let floats: Vec<f32> =
            last[last.len() - 16 * 16..].chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert_eq!([floats[0], floats[4], floats[8]], [4.0, 8.0, 12.0]);
        assert_eq!(&floats[6 * 4..9 * 4], &[[4.0; 4], [8.0; 4], [12.0; 4]].concat());
    }

    #[test]
    fn a_viewer_that_does_not_read_delays_nothing() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut tev = Tev::connect(&listener.local_addr().unwrap().to_string(), "scene").unwrap();
        let _stalled = listener.accept().unwrap();
        let picture = film(1.0, 512);
        let begun = Instant::now();
        let mut failure = None;
        while failure.is_none() && begun.elapsed() < 10 * TIMEOUT {
            let one = Instant::now();
            failure = tev.show(&picture).err();
            assert!(one.elapsed() < TIMEOUT, "it waited for the viewer");
            thread::sleep(Duration::from_millis(100));
        }
        assert!(failure.unwrap().starts_with("tev: "));
    }

    #[test]
    fn closing_does_not_wait_for_a_viewer_beyond_the_deadline() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut tev = Tev::connect(&listener.local_addr().unwrap().to_string(), "scene").unwrap();
        let _stalled = listener.accept().unwrap();
        tev.show(&film(1.0, 512)).unwrap();
        let begun = Instant::now();
        let why = tev.close(begun + Duration::from_millis(100)).unwrap_err();
        drop(tev);
        assert!(why.contains("too slowly"), "{why}");
        assert!(begun.elapsed() < TIMEOUT, "{:?}", begun.elapsed());
    }

    #[test]
    fn a_viewer_that_is_not_there_is_an_error_with_a_hint() {
        let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
        for host in [free.as_str(), "127.0.0.1:port", "no.such.host.invalid"] {
            let fault = Tev::connect(host, "scene").err().unwrap().to_string();
            assert!(fault.contains(&format!("--tev={host}")) && fault.contains("start tev"), "{fault}");
        }
    }
}
