//! The picture of a render while it is rendered: in a file, on a web page, in a viewer, in the terminal.

mod page;
mod preview;
mod server;
mod terminal;
mod tev;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photon_core::{Display, DisplayImage, Event, Film, Observer, StopCondition};

use crate::args::WatchArgs;
use crate::command::picture::Look;
use crate::fault::Fault;
use crate::stderr;

/// Interval between pictures, once passes that double the film have become rare.
const INTERVAL: Duration = Duration::from_secs(5);

/// At most this share of the time is spent on showing: one in twenty.
const SHARE: u32 = 20;

/// Time for closing everything.
const CLOSING: Duration = Duration::from_secs(2);

/// Text for the terminal.
#[derive(Clone, Copy)]
pub(crate) enum Said<'a> {
    Message(&'a str),
    /// Lines of coloured characters.
    Picture(&'a str),
}

impl Said<'_> {
    /// Writes it to standard error.
    pub(crate) fn say(self) {
        match self {
            Self::Message(text) => say!("{text}"),
            Self::Picture(text) => stderr::commands(text),
        }
    }
}

/// Shows films, or what a screen shows of them.
trait Sink: Send {
    /// How the pictures for [`Sink::show_image`] are made; `None` if a whole film is needed.
    fn display(&self) -> Option<Display> {
        None
    }

    /// Shows a film. Returns a picture for the terminal, if any.
    ///
    /// # Errors
    /// Why it cannot be shown; it is not asked again.
    fn show(&mut self, film: &Film) -> Result<Option<String>, String>;

    /// The same with a picture that was made as [`Sink::display`] says.
    ///
    /// # Errors
    /// Likewise.
    fn show_image(&mut self, _image: &DisplayImage) -> Result<Option<String>, String> {
        Ok(None)
    }

    /// Waits, until `deadline` at the latest, for those who still read what was shown.
    ///
    /// # Errors
    /// Why they do not have it.
    fn close(&mut self, _deadline: Instant) -> Result<(), String> {
        Ok(())
    }
}

/// What there is to show.
#[derive(Clone, Copy)]
enum View<'a> {
    Film(&'a Film),
    Image(&'a DisplayImage),
}

/// Shows the film of a render from time to time.
pub(crate) struct Watch {
    sinks: Vec<Box<dyn Sink>>,
    /// When the last picture was asked for, and how long it took to read and show.
    last: Option<(Instant, Duration)>,
}

impl Watch {
    /// Opens everything that the options ask for.
    ///
    /// # Errors
    /// [`Fault::Input`] naming the option that is not possible.
    pub(crate) fn start(args: &WatchArgs, look: Look, title: &str) -> Result<Self, Fault> {
        let mut sinks: Vec<Box<dyn Sink>> = Vec::new();
        if let Some(path) = &args.preview {
            sinks.push(Box::new(preview::Preview::new(path, look)?));
        }
        if let Some(address) = &args.serve {
            sinks.push(Box::new(page::Page::serve(address, title)?));
        }
        if let Some(host) = &args.tev {
            sinks.push(Box::new(tev::Tev::connect(host, title)?));
        }
        if args.show {
            sinks.push(Box::new(terminal::Terminal::new(look)?));
        }
        Ok(Self { sinks, last: None })
    }

    /// Shows a film or a picture. `say` prints to the terminal.
    fn show(&mut self, view: View<'_>, say: &mut dyn FnMut(Said<'_>)) {
        let begun = Instant::now();
        let shown = |sink: &mut Box<dyn Sink>| match view {
            View::Film(film) => sink.show(film),
            View::Image(image) => sink.show_image(image),
        };
        self.sinks.retain_mut(|sink| match shown(sink) {
            Ok(picture) => {
                if let Some(picture) = picture {
                    say(Said::Picture(&picture));
                }
                true
            }
            Err(why) => {
                say(Said::Message(&format!("warning: {why}; rendering goes on without it")));
                false
            }
        });
        // With the time for reading the film, if it was asked for.
        let asked = self.last.map_or(begun, |(asked, _)| asked);
        self.last = Some((asked, asked.elapsed()));
    }

    /// Shows the finished film and closes everything. Readers that stall are waited for no longer than [`CLOSING`] in all.
    pub(crate) fn finish(mut self, film: &Film) {
        self.show(View::Film(film), &mut |said| said.say());
        let deadline = Instant::now() + CLOSING;
        for sink in &mut self.sinks {
            if let Err(why) = sink.close(deadline) {
                say!("warning: {why}");
            }
        }
    }

    /// How to make a picture that all can show; `None` if one needs a film, or they need different pictures.
    fn display(&self) -> Option<Display> {
        let mut displays = self.sinks.iter().map(|sink| sink.display());
        let first = displays.next()??;
        displays.all(|display| display == Some(first)).then_some(first)
    }

    fn is_due(&mut self, passes: u32) -> bool {
        let due = !self.sinks.is_empty() && is_due(passes, self.last.map(|(asked, cost)| (asked.elapsed(), cost)));
        if due {
            self.last = Some((Instant::now(), Duration::ZERO));
        }
        due
    }
}

/// Whether to show a film of this many passes, with the time since the last one and what that one cost.
fn is_due(passes: u32, last: Option<(Duration, Duration)>) -> bool {
    let Some((since, cost)) = last else { return true };
    (passes.is_power_of_two() || since >= INTERVAL) && since >= cost * SHARE
}

/// An observer that also shows films.
pub(crate) struct Watching<'a, F> {
    pub(crate) watch: &'a mut Watch,
    /// Receives all events, films and pictures included.
    pub(crate) inner: F,
    pub(crate) say: &'a mut dyn FnMut(Said<'_>),
    /// The flag that ends a pass at once.
    pub(crate) stop: &'static AtomicBool,
}

impl<F: FnMut(&Event<'_>) -> ControlFlow<()>> Observer for Watching<'_, F> {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        if let Event::Film(film) = event {
            self.watch.show(View::Film(film), self.say);
        }
        if let Event::Display(image) = event {
            self.watch.show(View::Image(image), self.say);
        }
        (self.inner)(event)
    }

    fn stop_condition(&self) -> Option<StopCondition> {
        let stop = self.stop;
        Some(StopCondition::new(|| stop.load(Ordering::SeqCst)))
    }

    fn wants_film(&mut self, passes: u32) -> bool {
        self.watch.display().is_none() && self.watch.is_due(passes)
    }

    fn wants_display(&mut self, passes: u32) -> Option<Display> {
        self.watch.display().filter(|_| self.watch.is_due(passes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_at_powers_of_two_then_by_time_and_never_cost_much() {
        let seconds = Duration::from_secs_f64;
        let due = |passes, since, cost| is_due(passes, Some((seconds(since), seconds(cost))));
        assert!(is_due(1, None) && is_due(3, None));
        assert!(due(4, 0.1, 0.001) && !due(5, 0.1, 0.001) && due(5, 5.0, 0.001));
        // A second for each picture: every 20 s at most.
        assert!(!due(8, 19.0, 1.0) && !due(9, 19.0, 1.0) && due(9, 20.0, 1.0));
    }

    #[test]
    fn nothing_is_shown_without_being_asked_for() {
        assert!(!Watch { sinks: Vec::new(), last: None }.is_due(1));
    }

    #[test]
    fn pictures_keep_their_commands_and_a_failure_is_a_message_said_once() {
        struct Once(bool);
        impl Sink for Once {
            fn show(&mut self, _: &Film) -> Result<Option<String>, String> {
                let is_first = std::mem::replace(&mut self.0, false);
                if is_first { Ok(Some("\u{1b}[0m".into())) } else { Err("it is gone".into()) }
            }
        }
        let mut watch = Watch { sinks: vec![Box::new(Once(true))], last: None };
        let film = Film::new(1, 1, photon_core::Units::default()).unwrap();
        let mut all = Vec::new();
        for _ in 0..3 {
            watch.show(View::Film(&film), &mut |said| {
                all.push(match said {
                    Said::Message(text) => (false, text.to_owned()),
                    Said::Picture(text) => (true, text.to_owned()),
                });
            });
        }
        let message = "warning: it is gone; rendering goes on without it";
        assert_eq!(all, [(true, "\u{1b}[0m".to_owned()), (false, message.to_owned())]);
    }

    #[test]
    fn a_picture_is_enough_where_all_show_the_same() {
        struct Shows(Option<Display>);
        impl Sink for Shows {
            fn display(&self) -> Option<Display> {
                self.0
            }
            fn show(&mut self, _film: &Film) -> Result<Option<String>, String> {
                Ok(None)
            }
        }
        let watch = |displays: &[Option<Display>]| {
            let sinks = displays.iter().map(|&display| Box::new(Shows(display)) as Box<dyn Sink>).collect();
            Watch { sinks, last: None }.display()
        };
        let (plain, bright) = (Display::default(), Display { exposure: 1.0, ..Display::default() });
        assert_eq!(watch(&[]), None);
        assert_eq!(watch(&[Some(bright), Some(bright)]), Some(bright));
        assert_eq!(watch(&[Some(bright), Some(plain)]), None);
        assert_eq!(watch(&[Some(plain), None]), None);
    }
}
