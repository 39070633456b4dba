//! The picture of a running render as a screen shows it, compared with the film after the same pass.

use std::ops::ControlFlow;

use photon_core::{
    Blocks, Budget, Display, DisplayImage, Estimator, Event, Film, Observer, Paper, Pipeline, Settings, ToneMap, View,
    render, render_blocks,
};
use photon_scene::EnvironmentDesc;

use crate::harness::TestBackend;

/// What an observer sees that wants both after each pass.
struct Watcher {
    display: Display,
    stops: bool,
    images: Vec<DisplayImage>,
    films: Vec<Film>,
}

impl Watcher {
    fn new(display: Display) -> Self {
        Self { display, stops: false, images: Vec::new(), films: Vec::new() }
    }

    /// Largest difference of a byte between the pictures and those of the films.
    fn furthest(&self, display: &Display) -> u8 {
        assert_eq!(self.images.len(), self.films.len());
        let pairs = self.images.iter().zip(&self.films).flat_map(|(image, film)| {
            let expected = film.display(display);
            assert_eq!((image.width, image.height, image.passes), (expected.width, expected.height, film.passes));
            let differences: Vec<u8> = image
                .pixels
                .iter()
                .flatten()
                .zip(expected.pixels.iter().flatten())
                .map(|(a, b)| a.abs_diff(*b))
                .collect();
            differences
        });
        pairs.max().unwrap()
    }
}

impl Observer for Watcher {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Display(image) => {
                assert_eq!(self.images.len(), self.films.len(), "the picture comes first");
                self.images.push((*image).clone());
                if self.stops { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            }
            Event::Film(film) => {
                self.films.push((*film).clone());
                ControlFlow::Continue(())
            }
            _ => ControlFlow::Continue(()),
        }
    }

    fn wants_film(&mut self, _passes: u32) -> bool {
        true
    }

    fn wants_display(&mut self, _passes: u32) -> Option<Display> {
        Some(self.display)
    }
}

/// Pictures while rendering are those of the films, up to 1 of 255: with colours that are clamped first, and with a transparent
/// background; in blocks too. Another exposure is seen, and an observer may stop at a picture.
pub fn pictures_while_rendering_are_those_of_the_film<T: TestBackend>() {
    let mut builder = photon_scene::builtin("gloss").unwrap();
    builder.environment_from(&EnvironmentDesc::constant([0.2; 3])).unwrap();
    let scene = builder.build().unwrap();
    let view = View { camera: scene.camera(None, 24, 24).unwrap(), width: 24, height: 24 };
    let plain = Settings { photons: 3000, ..Settings::default() };
    let clamped = Settings { estimator: Estimator::Paper(Paper { clamp: true, ..Paper::default() }), ..plain.clone() };
    let transparent = Settings { transparent_background: true, ..plain.clone() };
    let looks = [
        ("plain", plain.clone(), Display { exposure: 1.0, tone_map: ToneMap::Agx, transparent: false }),
        ("clamped", clamped, Display { exposure: -1.0, tone_map: ToneMap::None, transparent: false }),
        ("transparent", transparent, Display { exposure: 0.5, tone_map: ToneMap::Neutral, transparent: true }),
    ];
    for (name, settings, display) in looks {
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
        let mut watcher = Watcher::new(display);
        render(&mut renderer, Budget::passes(3), &mut watcher).unwrap();
        assert_eq!(watcher.images.len(), 3, "{name}");
        assert!(watcher.furthest(&display) <= 1, "{name}");
        assert!(watcher.furthest(&Display { exposure: display.exposure + 0.5, ..display }) > 1, "{name}");
    }
    let display = Display::default();
    let renderer = || Pipeline::new(T::make(2), &scene.view(), view, plain.clone()).unwrap();
    let mut watcher = Watcher::new(display);
    let blocks = Blocks::new(0..4, 2).unwrap();
    render_blocks(&mut renderer(), &blocks, &mut None, &mut watcher, &mut |_| Ok(())).unwrap();
    assert!(watcher.images.len() == 2 && watcher.furthest(&display) == 0);
    let mut watcher = Watcher { stops: true, ..Watcher::new(display) };
    let outcome = render(&mut renderer(), Budget::passes(3), &mut watcher).unwrap();
    assert!(outcome.cancelled && outcome.passes == 1 && watcher.films.is_empty());
}
