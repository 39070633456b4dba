//! Validation of scene views: indices, kinds and numbers.

use super::SceneView;
use crate::error::{Error, Result};
use crate::parallel;
use crate::scene::boundaries::Boundaries;
use crate::scene::grid::{Grid, GridTables};
use crate::scene::light::Light;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::media::MediumStack;
use crate::scene::medium::Medium;
use crate::scene::portal::Portal;
use crate::scene::units::Units;
use crate::shading::phase::Phase;
use crate::shading::spectrum::{Spectrum, Wavelength};

/// Tolerance of the squared length of unit vectors.
const UNIT: f32 = 1e-4;
/// Tolerance of positions as a share of [`SceneView::radius`], for callers that compute the radius in
/// `f32`.
const ROUNDING: f32 = 1e-5;
/// Largest valid radius: beyond it, rounding errors of rays exceed the offsets that allow for them.
const MAX_RADIUS: f32 = 16.0;

impl SceneView<'_> {
    /// Checks everything that a renderer relies on, in linear time: lengths of the tables, indices, kinds
    /// of materials and lights, and that numbers are finite and within their ranges.
    ///
    /// [`crate::Pipeline`] and every backend's [`crate::TransportBackend::prepare`] call it. Functions that
    /// take a view and return no error, such as [`crate::explain`], may panic on a view that
    /// fails here. Not checked: whether normals are those of their triangles, and whether triangles have an
    /// area above 0.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] names the first invalid element, by its kind and its index;
    /// [`Error::InvalidScene`] names what is wrong with the view as a whole.
    pub fn validate(&self) -> Result<()> {
        whole(self)?;
        each("position", self.positions, |&position| check_position(position, self.radius))?;
        each("triangle", self.triangles, |&corners| check_indices(corners, self.positions.len()))?;
        each("primitive", self.primitives, |primitive| {
            require(is_unit(primitive.normal), || format!("its normal {:?} is not a unit vector", primitive.normal))?;
            index("material", primitive.material, self.materials.len())
        })?;
        each("medium", self.media, check_medium)?;
        each("grid", self.grids.grids, |grid| check_grid(grid, &self.grids))?;
        each("density", self.grids.densities, |density| {
            require((0.0..=1.0).contains(density), || format!("it is {density}; it must be from 0 to 1"))
        })?;
        each("brick", self.grids.bricks, |&brick| check_brick(brick, self.grids.densities.len()))?;
        each("vertex of a boundary", self.boundaries.positions, |&position| {
            require(position.iter().all(|c| c.abs() <= MAX_RADIUS), || {
                format!("{position:?} must be finite, within ±16")
            })
        })?;
        each("triangle of a boundary", self.boundaries.triangles, |&corners| {
            check_indices(corners, self.boundaries.positions.len())
        })?;
        each("medium of a boundary", self.boundaries.media, |&medium| {
            index("medium", medium, self.media.len())?;
            require(self.media[medium as usize].is_matched(), || format!("medium {medium} is not Medium::MATCHED"))
        })?;
        each("material", self.materials, |material| check_material(material, self.media))?;
        each("light", self.lights, |light| check_light(light, self.triangles.len(), self.radius))?;
        each("portal", self.portals, |portal| check_portal(portal, self.radius))?;
        check_order(self.lights)?;
        check_starts(self.light_cdf)?;
        shading::check(self)
    }
}

/// What is wrong with an element, if anything.
type Check = std::result::Result<(), String>;

/// Elements that a thread checks at a time.
const PART: usize = 1 << 16;

fn each<T: Sync>(what: &'static str, elements: &[T], check: impl Fn(&T) -> Check + Sync) -> Result<()> {
    let first = |part: &[T]| (0..).zip(part).find_map(|(at, element)| check(element).err().map(|why| (at, why)));
    let found = parallel::map(parallel::threads(), elements.chunks(PART), |_, part| first(part));
    match (0..).zip(found).find_map(|(part, found)| found.map(|(at, why)| (part * PART as u64 + at, why))) {
        Some((index, why)) => Err(Error::InvalidInput { what, index, why }),
        None => Ok(()),
    }
}

fn require(holds: bool, why: impl FnOnce() -> String) -> Check {
    if holds { Ok(()) } else { Err(why()) }
}

/// Checks of the view as a whole, not of single elements.
fn whole(view: &SceneView<'_>) -> Result<()> {
    let invalid = |what, value: String, hint| Err(Error::InvalidScene { what, value, hint });
    let (triangles, primitives) = (view.triangles.len(), view.primitives.len());
    if primitives != triangles {
        let value = format!("{primitives} for {triangles} triangles");
        return invalid("the number of primitives", value, "every triangle needs one");
    }
    let Boundaries { triangles, media, scale, .. } = view.boundaries;
    if media.len() != triangles.len() {
        let value = format!("{} for {} triangles", media.len(), triangles.len());
        return invalid("the number of media of boundaries", value, "every triangle needs one");
    }
    if !(scale.is_normal() && scale >= 1.0 && scale.to_bits() & 0x007F_FFFF == 0) {
        return invalid("the scale of boundaries", scale.to_string(), "it must be a power of two, at least 1");
    }
    let (lights, starts) = (view.lights.len(), view.light_cdf.len());
    if starts != lights {
        let value = format!("{starts} for {lights} lights");
        return invalid("the length of light_cdf", value, "fill it in with photon_core::light_cdf");
    }
    let media = view.media.len();
    let is_ambient = |first: &Medium| first.ior == 1.0 && first.priority == 0 && first.dispersion == 0;
    if !view.media.first().is_some_and(is_ambient) || media > MediumStack::MAX_MEDIA + 1 {
        let value = format!("a table of {media}");
        let hint =
            "it must begin with the space around solids, of index 1 and priority 0, followed by at most 255 others";
        return invalid("media", value, hint);
    }
    let grids = view.grids.grids.len();
    if grids != 0 && grids != media {
        let value = format!("{grids} for {media} media");
        return invalid("the number of grids", value, "every medium needs one, or none has any");
    }
    if !(0.0..=MAX_RADIUS).contains(&view.radius) {
        let hint = "it must be a number from 0 to 16: scale the scene to a unit box centred at the origin";
        return invalid("the radius", view.radius.to_string(), hint);
    }
    let skies = view.lights.iter().filter(|light| light.kind == Light::ENVIRONMENT).count();
    let expected = usize::from(view.environment.is_some());
    if skies != expected {
        let value = format!("{skies} lights of kind Light::ENVIRONMENT");
        return invalid("environment", value, "with an environment map there must be one, otherwise none");
    }
    let suns = view.lights.iter().filter(|light| light.is_sun()).count();
    if suns > 1 {
        let value = format!("{suns} directional lights with a disc");
        return invalid("lights", value, "cameras see one of them: set the versine_outer of the others to 0");
    }
    let portals = view.portals.len();
    if portals > Portal::MAX {
        let hint = "each photon is tested against all: at most 64; use a pair for each opening";
        return invalid("the number of portals", portals.to_string(), hint);
    }
    let Units { center, scale, power } = view.units;
    if !center.iter().all(|c| c.is_finite()) {
        return invalid("units.center", format!("{center:?}"), "each coordinate must be a finite number");
    }
    for (what, value) in [("units.scale", scale), ("units.power", power)] {
        if !(value.is_finite() && value > 0.0) {
            return invalid(what, value.to_string(), "it must be a finite number above 0");
        }
    }
    Ok(())
}

fn check_position(position: [f32; 3], radius: f32) -> Check {
    // In f64, so that the square of a finite number is finite too; NaN fails.
    let squared: f64 = position.iter().map(|&c| f64::from(c) * f64::from(c)).sum();
    let limit = f64::from(radius) * f64::from(1.0 + ROUNDING);
    require(squared <= limit * limit, || {
        format!("{position:?} must be finite and within the scene's radius, {radius}, of the origin")
    })
}

fn check_indices(corners: [u32; 3], vertices: usize) -> Check {
    require(corners.iter().all(|&vertex| (vertex as usize) < vertices), || {
        format!("{corners:?} has an index that is not among the {vertices} vertices")
    })
}

fn index(what: &str, index: u32, count: usize) -> Check {
    require((index as usize) < count, || format!("{what} {index} is out of range, {count} exist"))
}

fn is_unit(vector: [f32; 3]) -> bool {
    let squared: f32 = vector.iter().map(|c| c * c).sum();
    (squared - 1.0).abs() <= UNIT
}

fn not_negative(name: &str, numbers: &[f32]) -> Check {
    require(numbers.iter().all(|n| n.is_finite() && *n >= 0.0), || {
        format!("its {name} {numbers:?} must be finite and at least 0")
    })
}

/// Whether it is one of the constants of [`Light`].
fn is_known_light(kind: u32) -> bool {
    kind <= Light::ENVIRONMENT
}

fn check_medium(medium: &Medium) -> Check {
    not_negative("absorption", &medium.absorption)?;
    not_negative("scattering", &medium.scattering)?;
    let g = medium.anisotropy;
    require(g.abs() < 1.0, || format!("its anisotropy {g} must lie between -1 and 1"))?;
    require(medium.phase <= Medium::MIE, || {
        format!("its phase {} is unknown; use 0 or a constant of Medium", medium.phase)
    })?;
    let [draine, alpha, share] = medium.draine;
    let is_lobe = draine > 0.0 && draine < 1.0 && alpha >= 0.0 && alpha.is_finite() && (0.0..=1.0).contains(&share);
    require(medium.phase != Medium::MIE || (is_lobe && g >= 0.0), || {
        format!("its phase function {:?} must be within the ranges of phase::Mie", Phase::of(medium))
    })?;
    require(medium.ior.is_normal() && medium.ior > 0.0, || {
        format!("its ior {} must be finite and above 0", medium.ior)
    })?;
    require(medium.dispersion <= Medium::MATCHED, || {
        format!("its dispersion {} is unknown; use 0 or a constant of Medium", medium.dispersion)
    })?;
    let mut indices = (0..Spectrum::CELLS).map(|cell| medium.index(Wavelength::of_cell(cell)));
    require(medium.terms.iter().all(|term| term.is_finite()) && indices.all(f32::is_normal), || {
        format!("its terms {:?} must be finite, and so must be the refractive index of all visible light", medium.terms)
    })
}

fn check_grid(grid: &Grid, tables: &GridTables<'_>) -> Check {
    if *grid == Grid::default() {
        return Ok(());
    }
    let rows = [grid.x, grid.y, grid.z];
    require(rows.iter().flatten().all(|part| part.is_finite()), || format!("its rows {rows:?} are not finite"))?;
    let bricks = grid.cells.iter().try_fold(1_u64, |product, &cells| product.checked_mul(u64::from(cells / 8) + 1));
    let fits = bricks.is_some_and(|bricks| u64::from(grid.first) + bricks <= tables.bricks.len() as u64);
    let has_cells = grid.cells.iter().all(|&cells| (1..1 << 24).contains(&cells));
    require(fits && has_cells, || {
        format!("its {:?} cells from brick {} are not in the table of {}", grid.cells, grid.first, tables.bricks.len())
    })
}

fn check_brick(brick: u32, densities: usize) -> Check {
    require(GridTables::is_brick(brick, densities), || {
        format!("its word {brick:#x} is neither a density from 0 to 1 nor in the table of {densities} densities")
    })
}

fn check_material(material: &Material, media: &[Medium]) -> Check {
    let Some(kind) = MaterialKind::from_u32(material.kind) else {
        return Err(format!("its kind {} is unknown; use the number of a MaterialKind", material.kind));
    };
    require(material.albedo.iter().all(|part| (0.0..=1.0).contains(part)), || {
        format!("its albedo {:?} must lie between 0 and 1", material.albedo)
    })?;
    not_negative("emission", &material.emission)?;
    let (alpha, cutoff) = (material.alpha, material.alpha_cutoff);
    require((0.0..=1.0).contains(&alpha), || format!("its alpha {alpha} must lie between 0 and 1"))?;
    not_negative("alpha_cutoff", &[cutoff])?;
    require(!(material.has_alpha() && kind == MaterialKind::Dielectric), || {
        "it has Material::ALPHA, but the boundary of a solid must be closed; use MaterialKind::Thin".to_owned()
    })?;
    let ior = material.ior;
    let refracts = || require(ior.is_normal() && ior > 0.0, || format!("its ior {ior} must be finite and above 0"));
    let roughness = material.roughness;
    let is_rough =
        || require((0.0..=1.0).contains(&roughness), || format!("its roughness {roughness} must lie between 0 and 1"));
    match kind {
        MaterialKind::Lambert => Ok(()),
        MaterialKind::Mirror => require((0.0..=1.0).contains(&material.metallic), || {
            format!("its metallic {} must lie between 0 and 1", material.metallic)
        }),
        MaterialKind::Thin => refracts().and_then(|()| is_rough()),
        MaterialKind::Glossy => {
            is_rough()?;
            for (name, value) in [("metallic", material.metallic), ("specular", material.specular)] {
                require((0.0..=1.0).contains(&value), || format!("its {name} {value} must lie between 0 and 1"))?;
            }
            require(ior.is_finite() && ior >= 0.0, || format!("its ior {ior} must be finite and at least 0"))
        }
        MaterialKind::Dielectric => {
            refracts()?;
            is_rough()?;
            let inside = material.medium;
            require(inside > 0, || "it has no medium; a dielectric needs an entry of media after the first".into())?;
            index("medium", inside, media.len())?;
            let medium = &media[inside as usize];
            require(!medium.is_matched(), || format!("its medium {inside} is Medium::MATCHED, that of a boundary"))?;
            let there = medium.ior;
            require(there == ior, || format!("its ior {ior} differs from that of its medium {inside}, {there}"))
        }
    }
}

fn check_portal(portal: &Portal, radius: f32) -> Check {
    let (corner, [first, second]) = (portal.corner, portal.edges);
    let sum = |edge: [f32; 3]| std::array::from_fn(|axis| corner[axis] + edge[axis]);
    for at in [corner, sum(first), sum(second)] {
        check_position(at, Portal::REACH * radius).map_err(|why| format!("its corner {why}"))?;
    }
    let [x, y, z] = portal.area.map(f64::from);
    let area = (x * x + y * y + z * z).sqrt();
    require(area >= f64::from(Portal::MIN_AREA) && area.is_finite(), || {
        format!("its area {area:e} must be finite and at least {:e}", Portal::MIN_AREA)
    })
}

fn check_light(light: &Light, triangles: usize, radius: f32) -> Check {
    let kind = light.kind;
    require(is_known_light(kind), || format!("its kind {kind} is unknown; use a constant of Light"))?;
    not_negative("power", &light.power)?;
    let direction =
        || require(is_unit(light.direction), || format!("its direction {:?} is not a unit vector", light.direction));
    let position = || check_position(light.position, radius).map_err(|why| format!("its position {why}"));
    match kind {
        Light::TRIANGLE => {
            index("triangle", light.primitive, triangles)?;
            require(light.area.is_finite() && light.area > 0.0, || {
                format!("its area {} must be finite and above 0", light.area)
            })
        }
        Light::POINT => position(),
        Light::SPOT => {
            position()?;
            direction()?;
            let (inner, outer) = (light.versine_inner, light.versine_outer);
            require(0.0 <= inner && inner <= outer && outer <= 2.0, || {
                format!("its versines {inner} and {outer} must lie between 0 and 2, the inner not above the outer")
            })
        }
        Light::ENVIRONMENT => require(light.radius.is_finite() && light.radius > 0.0, || {
            format!("its radius {} must be finite and above 0", light.radius)
        }),
        _ => {
            direction()?;
            let versine = light.versine_outer;
            require((0.0..=Light::MAX_SUN_VERSINE).contains(&versine), || {
                format!("the versine {versine} of its disc must lie between 0 and {}", Light::MAX_SUN_VERSINE)
            })?;
            not_negative("radius", &[light.radius])
        }
    }
}

/// Lights are found by their triangle with a binary search: [`crate::light_sampler::light_of_triangle`].
fn check_order(lights: &[Light]) -> Result<()> {
    let in_order = |pair: &[Light]| {
        pair[1].kind != Light::TRIANGLE || (pair[0].kind == Light::TRIANGLE && pair[0].primitive < pair[1].primitive)
    };
    lights.windows(2).position(|pair| !in_order(pair)).map_or(Ok(()), |before| {
        let primitive = lights[before + 1].primitive;
        let why = format!(
            "triangle {primitive} is out of order: list lights of kind Light::TRIANGLE before all others, by \
             increasing primitive, each once"
        );
        Err(Error::InvalidInput { what: "light", index: before as u64 + 1, why })
    })
}

fn check_starts(starts: &[u32]) -> Result<()> {
    let wrong = match starts.first() {
        Some(&first) if first != 0 => Some(0),
        _ => starts.windows(2).position(|pair| pair[0] >= pair[1]).map(|before| before + 1),
    };
    wrong.map_or(Ok(()), |at| {
        let why = format!(
            "{} is invalid in a list that must begin with 0 and increase strictly; fill it in with light_cdf",
            starts[at]
        );
        Err(Error::InvalidInput { what: "light_cdf entry", index: at as u64, why })
    })
}

mod shading;
#[cfg(test)]
mod tests;
