//! The arrays of a film file: each is one member of all pixels.

use photon_core::{ErrorPixel, Film, FilmPixel, Layer, MapKind, PhotonMoments};

/// One member of a pixel: up to three numbers of 64 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Column {
    Layer(Layer),
    Square,
    Normal,
    Albedo,
    Depth,
    Hits,
    Bias,
    BiasSquare,
    Narrow,
    NarrowSquare,
    Moments(MapKind, Moment),
}

/// A member of [`PhotonMoments`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Moment {
    Power,
    PowerSquared,
    Slope,
    Quadrupole,
    Stray,
}

const MOMENTS: [Moment; 5] = [Moment::Power, Moment::PowerSquared, Moment::Slope, Moment::Quadrupole, Moment::Stray];

impl Column {
    /// All columns of a film, with error statistics or without.
    pub(crate) fn all(errors: bool) -> Vec<Self> {
        let pixel = [Self::Square, Self::Normal, Self::Albedo, Self::Depth, Self::Hits];
        let mut all: Vec<Self> = Layer::ALL.map(Self::Layer).into_iter().chain(pixel).collect();
        if errors {
            all.extend([Self::Bias, Self::BiasSquare, Self::Narrow, Self::NarrowSquare]);
            all.extend(MapKind::ALL.iter().flat_map(|&kind| MOMENTS.map(|moment| Self::Moments(kind, moment))));
        }
        all
    }

    /// Name of the array.
    pub(crate) fn name(self) -> String {
        let moment = |moment| match moment {
            Moment::Power => "power",
            Moment::PowerSquared => "power_squared",
            Moment::Slope => "slope",
            Moment::Quadrupole => "quadrupole",
            Moment::Stray => "stray",
        };
        match self {
            Self::Layer(layer) => layer.name().to_owned(),
            Self::Square => "square".to_owned(),
            Self::Normal => "normal".to_owned(),
            Self::Albedo => "albedo".to_owned(),
            Self::Depth => "depth".to_owned(),
            Self::Hits => "hits".to_owned(),
            Self::Bias => "bias".to_owned(),
            Self::BiasSquare => "bias_square".to_owned(),
            Self::Narrow => "narrow".to_owned(),
            Self::NarrowSquare => "narrow_square".to_owned(),
            Self::Moments(kind, of) => format!("{}_{}", kind.name(), moment(of)),
        }
    }

    /// Numbers per pixel.
    pub(crate) fn width(self) -> usize {
        match self {
            Self::Layer(_) | Self::Normal | Self::Albedo => 3,
            Self::Moments(_, Moment::Slope | Moment::Quadrupole) => 2,
            _ => 1,
        }
    }

    /// Whether the numbers are `u64`; the others are `f64`.
    pub(crate) fn is_integer(self) -> bool {
        self == Self::Hits
    }

    /// Why bits cannot be a sum of that many passes.
    pub(crate) fn fault(self, bits: u64, paths: u64) -> Option<String> {
        // Directions, and differences of estimates, have both signs.
        let is_signed = matches!(
            self,
            Self::Normal | Self::Bias | Self::Narrow | Self::Moments(_, Moment::Slope | Moment::Quadrupole)
        );
        if self.is_integer() {
            return (bits > paths).then(|| format!("is {bits}, but there are {paths} camera paths"));
        }
        let value = f64::from_bits(bits);
        let is_valid = value.is_finite() && (is_signed || value >= 0.0);
        (!is_valid)
            .then(|| format!("is {value}, but must be {}", if is_signed { "finite" } else { "finite and at least 0" }))
    }

    /// The sum of two numbers, both and the result as bits.
    pub(crate) fn add(self, a: u64, b: u64) -> u64 {
        if self.is_integer() { a.saturating_add(b) } else { (f64::from_bits(a) + f64::from_bits(b)).to_bits() }
    }

    /// The bits of the numbers of a pixel; `to` has [`Column::width`] elements.
    pub(crate) fn get(self, film: &Film, index: usize, to: &mut [u64]) {
        let mut put = |from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to = from.to_bits());
        let pixel = &film.pixels[index];
        match self {
            Self::Hits => to[0] = pixel.hits,
            _ => match film.errors.as_ref() {
                Some(errors) if self.of_errors() => put(of_error(self, &mut { errors[index] })),
                _ => put(of_pixel(self, &mut { *pixel })),
            },
        }
    }

    /// Sets the numbers of a pixel.
    pub(crate) fn set(self, film: &mut Film, index: usize, from: &[u64]) {
        let put = |to: &mut [f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to = f64::from_bits(*from));
        let pixel = &mut film.pixels[index];
        match self {
            Self::Hits => pixel.hits = from[0],
            _ => match film.errors.as_mut() {
                Some(errors) if self.of_errors() => put(of_error(self, &mut errors[index])),
                _ => put(of_pixel(self, pixel)),
            },
        }
    }

    fn of_errors(self) -> bool {
        matches!(self, Self::Bias | Self::BiasSquare | Self::Narrow | Self::NarrowSquare | Self::Moments(..))
    }
}

/// The numbers of a column in a pixel; none if it is not one of them.
fn of_pixel(column: Column, pixel: &mut FilmPixel) -> &mut [f64] {
    match column {
        Column::Layer(layer) => &mut pixel.layers[layer as usize],
        Column::Square => std::slice::from_mut(&mut pixel.square),
        Column::Normal => &mut pixel.normal,
        Column::Albedo => &mut pixel.albedo,
        Column::Depth => std::slice::from_mut(&mut pixel.depth),
        _ => &mut [],
    }
}

/// The numbers of a column in the error statistics of a pixel; none if it is not one of them.
fn of_error(column: Column, errors: &mut ErrorPixel) -> &mut [f64] {
    match column {
        Column::Bias => std::slice::from_mut(&mut errors.bias),
        Column::BiasSquare => std::slice::from_mut(&mut errors.bias_square),
        Column::Narrow => std::slice::from_mut(&mut errors.narrow),
        Column::NarrowSquare => std::slice::from_mut(&mut errors.narrow_square),
        Column::Moments(kind, moment) => {
            // Every member by name: a new one is an error here until it is stored.
            let PhotonMoments { power, power_squared, slope, quadrupole, stray } = &mut errors.photon_moments[kind];
            match moment {
                Moment::Power => std::slice::from_mut(power),
                Moment::PowerSquared => std::slice::from_mut(power_squared),
                Moment::Slope => slope,
                Moment::Quadrupole => quadrupole,
                Moment::Stray => std::slice::from_mut(stray),
            }
        }
        _ => &mut [],
    }
}
