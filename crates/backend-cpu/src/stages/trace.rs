//! Photon tracing.

mod kernel;
mod medium;
mod scheduling;

use photon_core::flight::MAX_COLLISIONS;
use photon_core::glam::Vec3;
use photon_core::memory::{self, OutOfMemory};
use photon_core::photon_sample::{Arriving, GlossyLobe, PhotonSample};
use photon_core::random::{BLOCK_SURFACES, Domain, Sampler, unit_f32};
use photon_core::{
    Batch, Deposits, Fate, Features, FixedFlux, Hit, Layers, Lobe, MapKind, MediaDeposits, MediaFeatures, MediumStack,
    PerMap, Photon, PhotonFormat, PhotonRay, Ray, Requirements, Result, Scattering, Scheduling, Settings, SkipLimit,
    SurfaceInteraction, Tally, Tracer, Vertex, Wavelength, gloss_caustics, most_total_reflections, octahedral,
    shading_normal,
};

use self::kernel::{AIMED, BATCHED, NESTED, REFLECTED, REFLECTIONS, SCATTERING, SCATTERS, SHADED, kernel};
use self::medium::{Crossing, Flown, MediumWalk};
use self::scheduling::{share_dynamically, share_statically};
use crate::cpu::{Cpu, CpuBuffer};
use crate::scene::CpuScene;
use crate::stages::trace_batch;

/// Paths per block of dynamic scheduling. The result does not depend on it.
const BLOCK: usize = 2048;

/// Traces photons through the scene.
#[derive(Debug)]
pub(crate) struct CpuTracer {
    scheduling: Scheduling,
    max_bounces: u32,
    features: Features,
    nested: bool,
    aimed: bool,
    reflections: bool,
    caustic_roughness: Option<f32>,
    tally: Tally,
}

impl CpuTracer {
    pub(crate) fn new(settings: &Settings, required: &Requirements) -> Self {
        let (scheduling, max_bounces) = (settings.scheduling, settings.max_bounces);
        let nested = required.media.contains(MediaFeatures::NESTED);
        let (aimed, reflections, tally) = (false, false, Tally::default());
        let (features, caustic_roughness) = (required.features, required.caustic_roughness(settings));
        Self { scheduling, max_bounces, features, nested, aimed, reflections, caustic_roughness, tally }
    }

    /// For aimed paths, which end at the first diffuse surface.
    pub(crate) fn aimed(settings: &Settings, required: &Requirements) -> Self {
        Self { aimed: true, ..Self::new(settings, required) }
    }

    /// For [`photon_core::GlossCaustics`]: aimed or not, paths end at the first surface that is not perfectly specular.
    pub(crate) fn for_reflections(settings: &Settings, required: &Requirements) -> Self {
        Self { reflections: true, ..Self::aimed(settings, required) }
    }
}

/// The output of tracing some paths: photons for each map.
#[derive(Default)]
pub(super) struct TraceOutput {
    pub(super) photons: PerMap<PhotonList>,
    in_media: PerMap<PhotonList>,
    from_media: PhotonList,
    tally: Tally,
}

/// Photons of one map. Without memory for more, later ones are lost, and the pass fails.
#[derive(Default)]
pub(super) struct PhotonList {
    pub(super) stored: Vec<Photon>,
    refused: Option<OutOfMemory>,
}

impl PhotonList {
    #[inline(always)]
    pub(super) fn push(&mut self, photon: Photon) {
        match memory::reserve_doubling(&mut self.stored, 1, "photons under way") {
            Ok(()) => self.stored.push(photon),
            Err(refused) => self.refused = Some(refused),
        }
    }

    /// Appends these photons to a buffer, if there is one.
    fn append_to(&self, target: Option<&mut CpuBuffer<Photon>>) -> Result<()> {
        if let Some(refused) = self.refused {
            return Err(refused.into());
        }
        if let Some(target) = target {
            target.append_photons(&self.stored);
        }
        Ok(())
    }
}

impl Tracer<Cpu> for CpuTracer {
    fn trace(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        batch: &Batch,
        rays: &CpuBuffer<PhotonRay>,
        mut deposits: Deposits<'_, Cpu>,
        mut in_media: MediaDeposits<'_, Cpu>,
    ) -> Result<()> {
        let [wanted, wanted_in_media] =
            [&deposits, &in_media.inside].map(|targets| targets.each_ref().map(|target| target.is_some()));
        let wanted_from_media = in_media.onto_surfaces.is_some();
        let in_batches = scene.traces_batches();
        let follow = match (in_batches, self.reflections) {
            (true, true) => follow::<{ REFLECTIONS | BATCHED }>,
            (true, false) if self.aimed => follow::<{ SHADED | BATCHED | AIMED }>,
            (true, false) => follow::<{ SHADED | BATCHED }>,
            (false, true) => follow::<REFLECTIONS>,
            (false, false) if scene.fills_space() && self.aimed => follow::<{ SCATTERING | AIMED }>,
            (false, false) if scene.fills_space() => follow::<SCATTERING>,
            (false, false) => kernel(self.features, (self.nested, scene.disperses), self.aimed),
        };
        let all_lights = self.caustic_roughness.is_some_and(|least| least <= scene.roughest_caustic);
        let max_bounces = self.max_bounces;
        let wanted = (wanted, wanted_from_media);
        let walk = Walk { scene, batch, wanted, wanted_in_media, max_bounces, all_lights, in_batches, follow };
        let rays = rays.as_slice();
        let outputs = match self.scheduling {
            Scheduling::Static => share_statically(on, &walk, rays),
            Scheduling::Dynamic => share_dynamically(on, &walk, rays),
        };
        for output in outputs? {
            self.tally.merge(&output.tally);
            for kind in MapKind::ALL {
                output.photons[kind].append_to(deposits[kind].as_deref_mut())?;
                output.in_media[kind].append_to(in_media.inside[kind].as_deref_mut())?;
            }
            output.from_media.append_to(in_media.onto_surfaces.as_deref_mut())?;
        }
        scene.check_caster()
    }

    fn take_tally(&mut self, _on: &mut Cpu) -> Result<Tally> {
        Ok(std::mem::take(&mut self.tally))
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

type Follow = fn(&Walk<'_>, &PhotonRay, &mut TraceOutput, &mut Paused);

pub(super) struct Walk<'a> {
    pub(super) scene: &'a CpuScene,
    batch: &'a Batch,
    /// The maps on surfaces, and whether light last scattered in a medium has one of its own there.
    wanted: (PerMap<bool>, bool),
    pub(super) wanted_in_media: PerMap<bool>,
    max_bounces: u32,
    /// Whether photons for reflections are stored of all lights, with a mark: [`gloss_caustics`].
    all_lights: bool,
    in_batches: bool,
    pub(super) follow: Follow,
}

/// A path that waits for the result of its ray. Only kernels with [`BATCHED`] use it; the others follow a path to its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Paused {
    /// Before the first call, and after the end of the path, `None`.
    pub(super) path: Option<PausedPath>,
    /// What the ray of `path` hits, once that is known.
    pub(super) hit: Option<Option<Hit>>,
}

/// The state of a path at a surface that it has not met yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PausedPath {
    pub(super) ray: Ray,
    bounce: u32,
    sampler: Sampler,
    power: Vec3,
    flux: FixedFlux,
    specular_only: bool,
    media: MediumStack,
    too_deep: bool,
    wavelength: Wavelength,
    total: u32,
}

impl Walk<'_> {
    fn trace_all(&self, rays: &[PhotonRay]) -> TraceOutput {
        let mut output = TraceOutput::default();
        if self.in_batches {
            rays.chunks(BLOCK).for_each(|block| trace_batch::trace(self, block, &mut output));
            return output;
        }
        for ray in rays {
            (self.follow)(self, ray, &mut output, &mut Paused::default());
        }
        output
    }
}

/// Traces one path to its end. `F` selects the lobes that are compiled in; with [`BATCHED`], it is traced up to its next
/// ray, from where it was paused.
fn follow<const F: u64>(walk: &Walk<'_>, start: &PhotonRay, output: &mut TraceOutput, paused: &mut Paused) {
    let features = Features::from_bits_truncate(F as u32);
    let scene = walk.scene;
    let shaded = features.intersects(Features::SHADED);
    let reflections = F & REFLECTED != 0;
    let (aimed, nested) = (F & AIMED != 0, F & NESTED != 0 && (!shaded || scene.nested));
    let disperses = shaded && nested && scene.disperses;
    let scatters = F & SCATTERS != 0;
    let pass = walk.batch.pass;
    let domain = if aimed { Domain::Aimed } else { Domain::Photon };
    let mut sampler = Sampler::new(pass.random, pass.seed, pass.index, domain, start.path);
    if pass.random == photon_core::RandomKind::Lcg {
        // The sequence continues where emission stopped.
        let _ = (sampler.words(0), sampler.words(0));
    }
    let tally = &mut output.tally;
    let mut ray = Ray { origin: start.origin.into(), direction: start.direction.into(), t_max: f32::INFINITY };
    let mut power = Vec3::from(start.power);
    let mut flux = FixedFlux::new(start.power);
    let mut specular_only = true;
    let mut media = MediumStack::from_bits(start.media);
    let mut too_deep = false;
    let mut wavelength = Wavelength::NONE;
    // Number of total reflections.
    let mut total = 0;
    let mut first = 0;
    let resumed = if F & BATCHED != 0 { paused.path.take() } else { None };
    if let Some(path) = resumed {
        (ray, power, flux, first) = (path.ray, path.power, path.flux, path.bounce);
        (sampler, specular_only, media, too_deep) = (path.sampler, path.specular_only, path.media, path.too_deep);
        (wavelength, total) = (path.wavelength, path.total);
    } else {
        tally.emitted += 1;
        tally.flux_emitted.add(flux);
    }
    let most_total = most_total_reflections(walk.max_bounces);
    let mut in_medium = MediumWalk::new(pass, start, aimed);
    // Whether the light was last scattered in a medium.
    let mut from_medium = false;
    let mut bounce = first;
    while bounce < walk.max_bounces {
        // NaN fails the comparison too.
        let sane = ray.origin.is_finite() && ray.direction.is_finite() && power.abs().max_element() <= Fate::MAX_POWER;
        if !sane || power.is_nan() {
            return tally.end(Fate::Dropped, flux);
        }
        let block = BLOCK_SURFACES + bounce + in_medium.collisions;
        let found = if F & BATCHED != 0 {
            let Some(hit) = paused.hit.take() else {
                paused.path = Some(PausedPath {
                    ray,
                    bounce,
                    sampler,
                    power,
                    flux,
                    specular_only,
                    media,
                    too_deep,
                    wavelength,
                    total,
                });
                return;
            };
            Ok(hit.map(|hit| (scene.interaction(&ray, &hit), hit)))
        } else if features.intersects(Features::RANDOM_SURFACES) {
            // A copy, since a sequence must not advance twice.
            let mut layer = sampler;
            scene.hit_with::<true>(&ray, || layer.words(block)[3])
        } else {
            scene.hit_with::<false>(&ray, || 0)
        };
        let (mut surface, hit) = match found {
            Ok(Some(found)) => found,
            Ok(None) => {
                if scatters {
                    let flown = Flown { ray, end: f32::INFINITY, media, bounce, specular_only };
                    let crossing = in_medium.fly(walk, &flown, &mut power, &mut output.in_media);
                    if matches!(crossing, Crossing::Absorbed) {
                        return tally.end(Fate::Absorbed, flux);
                    }
                    carry(power, &mut flux, tally);
                    if matches!(crossing, Crossing::Thinned) {
                        return tally.end(Fate::Terminated, flux);
                    }
                    if let Crossing::Collides(next) = crossing {
                        (ray, specular_only, from_medium) = (next, false, true);
                        if in_medium.collisions > MAX_COLLISIONS {
                            break;
                        }
                        continue;
                    }
                }
                return tally.end(Fate::Escaped, flux);
            }
            Err(SkipLimit) => return tally.end(Fate::Truncated, flux),
        };
        let mut material = &scene.materials[surface.material as usize];
        let stores = material.stores_photons();
        let (evaluated, mut normal, layers) = if shaded {
            let is_matte = !features.intersects(Features::SHADED.difference(Features::MATTE));
            let found = if is_matte { scene.shade_matte(&surface, &hit) } else { scene.shade(&surface, &hit) };
            (Some(found.material), found.normal, found.layers)
        } else {
            (None, surface.normal, Layers::NONE)
        };
        if let Some(evaluated) = &evaluated {
            material = evaluated;
            if material.is_specular() {
                normal = shading_normal::bend(normal, -ray.direction);
                surface = surface.with_cosine_to(normal, ray.direction);
            }
        }
        let mut interface = scene.interface_by(&surface, media, nested);
        if scatters {
            let flown = Flown { ray, end: surface.t, media: interface.before, bounce, specular_only };
            let crossing = in_medium.fly(walk, &flown, &mut power, &mut output.in_media);
            if matches!(crossing, Crossing::Absorbed) {
                return tally.end(Fate::Absorbed, flux);
            }
            carry(power, &mut flux, tally);
            if matches!(crossing, Crossing::Thinned) {
                return tally.end(Fate::Terminated, flux);
            }
            if let Crossing::Collides(next) = crossing {
                (ray, specular_only, from_medium, media) = (next, false, true, interface.before);
                if in_medium.collisions > MAX_COLLISIONS {
                    break;
                }
                continue;
            }
        } else if features.contains(Features::ABSORPTION) && scene.may_attenuate(interface.before) {
            power *= scene.transmittance(&ray, surface.t, interface.before);
            carry(power, &mut flux, tally);
        }
        if disperses {
            scene.disperse(&mut interface, &mut wavelength, &mut power, || sampler.wavelength(0));
        }
        tally.surfaces += 1;
        let [choice, u, v, _] = sampler.words(block);
        let (choice, u, v) = (unit_f32(choice), unit_f32(u), unit_f32(v));
        // Aimed paths store no photon at the first surface: light straight from a light source is not theirs to count.
        let is_first = aimed && bounce == 0;
        let kind = MapKind::of_path(specular_only, bounce);
        let target = if is_first || !walk.wanted.0[kind] { None } else { Some(&mut output.photons[kind]) };
        let second = if scatters && from_medium && walk.wanted.1 { Some(&mut output.from_media) } else { None };
        let met = if features.intersects(Features::RANDOM_SURFACES) { Some((scene, &hit)) } else { None };
        let wo = -ray.direction;
        let store = Store { target, second, kind, surface: &surface, wo, met, mark: None };
        if reflections && material.has_reflection() {
            let light = scene.lights.get(start.light as usize);
            let is_sampled_only = light.is_some_and(gloss_caustics::is_sampled_only);
            if walk.all_lights || is_sampled_only {
                let mark = walk.all_lights.then_some(is_sampled_only);
                Store { mark, ..store }.add(power, tally);
            }
            return tally.end(Fate::Terminated, flux);
        }
        let vertex = Vertex {
            material,
            layers: &layers,
            wo,
            cosine: surface.cosine,
            interface: &interface,
            carries_light: true,
        };
        let arriving =
            Arriving { incoming: ray.direction, power, geometric: surface.normal, shading: normal, uv: [u, v] };
        let mut enter = |lobe: Lobe, tally: &mut Tally| {
            if lobe == Lobe::SpecularTransmission {
                if nested && !too_deep && interface.is_too_deep {
                    too_deep = true;
                    tally.too_deep += 1;
                }
                media = interface.transmitted;
            }
        };
        let rules = if shaded { features & scene.features } else { features };
        let left = match Scattering::at(rules, &scene.rough_glass, &vertex) {
            Scattering::Glossy(glossy) => {
                if stores {
                    store.add(power * glossy.coat().entering(surface.cosine), tally);
                }
                let chosen = GlossyLobe::choose(&glossy, choice);
                if chosen.0 != GlossyLobe::Reflection {
                    if aimed {
                        return tally.end(Fate::Terminated, flux);
                    }
                    (specular_only, from_medium) = (false, false);
                }
                PhotonSample::glossy(&glossy, chosen, &arriving)
            }
            Scattering::RoughGlass(_) if reflections => return tally.end(Fate::Terminated, flux),
            Scattering::RoughGlass(glass) => {
                let sampled = glass.sample(&scene.rough_glass, wo, normal, [choice, u, v]);
                enter(sampled.lobe, tally);
                if sampled.lobe == Lobe::SpecularReflection {
                    media = interface.before;
                }
                PhotonSample::rough_glass(&sampled, &arriving)
            }
            Scattering::Simple(bsdf) => {
                let lobe = bsdf.choose(choice);
                enter(lobe, tally);
                total += u32::from(bsdf.is_total());
                if lobe == Lobe::Diffuse {
                    if stores && !reflections {
                        store.add(power, tally);
                    }
                    if aimed {
                        return tally.end(Fate::Terminated, flux);
                    }
                    (specular_only, from_medium) = (false, false);
                }
                if shaded {
                    PhotonSample::shaded(&bsdf, lobe, choice, &arriving)
                } else {
                    PhotonSample::flat(&bsdf, lobe, choice, &arriving)
                }
            }
        };
        let Some(left) = left else {
            return tally.end(Fate::Absorbed, flux);
        };
        power = left.power;
        ray = surface.spawn(left.lobe, left.direction);
        carry(power, &mut flux, tally);
        if total > most_total {
            break;
        }
        bounce += 1;
    }
    tally.end(Fate::Truncated, flux);
}

/// Books the power that a path has lost as absorbed.
#[inline(always)]
fn carry(power: Vec3, flux: &mut FixedFlux, tally: &mut Tally) {
    let left = FixedFlux::new(power.into());
    tally.flux_absorbed.add(flux.minus(left));
    *flux = left;
}

/// Where a photon that arrives at a surface is stored.
struct Store<'a> {
    /// `None`: nowhere.
    target: Option<&'a mut PhotonList>,
    /// A second one for the same photon.
    second: Option<&'a mut PhotonList>,
    kind: MapKind,
    surface: &'a SurfaceInteraction,
    wo: Vec3,
    /// Where the surface is met by a share of the photons, each of which stands for the others too: its hit.
    met: Option<(&'a CpuScene, &'a Hit)>,
    /// That of its direction, if it has one: [`gloss_caustics::with_mark`].
    mark: Option<bool>,
}

impl Store<'_> {
    #[inline(always)]
    fn add(self, power: Vec3, tally: &mut Tally) {
        if self.target.is_none() && self.second.is_none() {
            return;
        }
        let arriving = self.met.map_or(power, |(scene, hit)| power / scene.met_share(hit));
        let direction = octahedral::pack(self.wo);
        let photon = Photon {
            position: self.surface.point.into(),
            normal: octahedral::pack(self.surface.normal),
            power: arriving.into(),
            direction: self.mark.map_or(direction, |marked| gloss_caustics::with_mark(direction, marked)),
        };
        if let Some(target) = self.target {
            tally.stored[self.kind] += 1;
            target.push(photon);
        }
        if let Some(second) = self.second {
            second.push(photon);
        }
    }
}
