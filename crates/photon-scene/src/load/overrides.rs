//! Override files: additions and changes to a scene file.

mod add;
mod frame;
mod medium;
mod message;

use self::add::add_light;
use self::frame::Frame;
use self::message::{Message, kinds_with};
use super::budget::{Budget, LoadOptions};
use super::light_units::LightUnits;
use super::schema::{File, Kind, Material};
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, Dispersion, MaterialDesc, PhaseDesc, PhaseKeys, Surface};
use crate::error::SceneError;
use crate::report::LoadReport;
use crate::similar;
use crate::texture::TexturesDesc;
use photon_core::shown;
use std::path::{Path, PathBuf};

/// Materials, lights, an environment, cameras and quadrilaterals that change or extend a scene, read from TOML.
///
/// A given albedo or tint replaces the texture of the base colour too, a given metallic or roughness that of both, a given
/// emission that of the emission, a given alpha that of the alpha.
///
/// The format is described in the project's `docs/scene-files.md`.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Path for messages.
    path: PathBuf,
    file: File,
}

impl Overrides {
    /// Reads an override file.
    ///
    /// # Errors
    /// A file that cannot be read, or what [`Overrides::parse`] finds.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::read_with(path, &LoadOptions::default())
    }

    /// As [`Self::read`], with options: a limit on memory.
    ///
    /// # Errors
    /// As [`Self::read`], and [`SceneError::Memory`] for a file that does not fit, before it is read.
    pub fn read_with(path: &Path, options: &LoadOptions) -> Result<Self, SceneError> {
        // The text, and the tables that are parsed from it.
        Self::parse(&super::text::text_of(path, super::read_within(path, &Budget::new(options), 16)?)?, path)
    }

    /// Parses the text of an override file; `path` is its name in messages.
    ///
    /// # Errors
    /// Text that is not TOML, an unknown or missing key, or a value of the wrong type; the error has the
    /// line number.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SceneError> {
        let path = path.to_owned();
        match toml::from_str(text) {
            Ok(file) => Ok(Self { path, file }),
            Err(error) => {
                let Message { line, what, hint } = message::of(text, &error);
                Err(SceneError::Content { path, line, what, hint })
            }
        }
    }

    /// The overrides with these units of the lights of the scene file, in place of those of the override file.
    #[must_use]
    pub fn with_light_units(mut self, units: LightUnits) -> Self {
        self.file.light_units = Some(units);
        self
    }

    /// Modifies a scene: converts the units of its lights, changes materials, then adds quadrilaterals, lights and cameras,
    /// and sets the environment and the ambient medium. The new cameras are inserted before existing ones, so that the first of them is the default.
    ///
    /// Removes report lines about materials whose surface is now given by the override file.
    ///
    /// # Errors
    /// A material that does not exist, a property that its kind does not have, a camera without or
    /// with two projections, an environment that cannot be read or is invalid; the error has the name.
    pub fn apply(&self, scene: &mut SceneBuilder, report: &mut LoadReport) -> Result<(), SceneError> {
        self.apply_within(scene, report, &Budget::unlimited())
    }

    /// As [`Self::apply`], within a limit on memory.
    pub(super) fn apply_within(
        &self,
        scene: &mut SceneBuilder,
        report: &mut LoadReport,
        budget: &Budget,
    ) -> Result<(), SceneError> {
        let frame = Frame::of(scene);
        if let Some(units) = self.file.light_units {
            units.convert(scene, report);
        }
        for (name, material) in &self.file.materials {
            self.material(name, material, scene, budget)?;
            if material.kind.is_some() || material.albedo.is_some() {
                let subject = format!("material '{name}'");
                let subject = shown(&subject);
                report.lines.retain(|line| line.subject != subject);
            }
        }
        let added = self.file.quads.iter().map(|quad| quad.material.as_str());
        let meshes =
            scene.meshes.iter().filter_map(|mesh| Some(scene.materials.get(mesh.material.0 as usize)?.name.as_str()));
        let met = added.chain(meshes);
        let is_met = |name: &String| met.clone().any(|other| other == name);
        for name in self.file.materials.keys().filter(|&name| !is_met(name)) {
            report.note(
                format!("material '{name}'"),
                "has no surface, so that what the override file says of it has no effect",
            );
        }
        for (index, quad) in self.file.quads.iter().enumerate() {
            self.quad(index, quad, frame, scene)?;
        }
        for (index, light) in self.file.lights.iter().enumerate() {
            add_light(index, light, frame, scene);
        }
        if let Some(environment) = &self.file.environment {
            if let Some(desc) = self.environment(environment, report, budget)? {
                scene.environment_from(&desc)?;
            }
            self.portals(environment, frame, scene)?;
        }
        if let Some(medium) = &self.file.medium {
            self.medium(medium, scene)?;
        }
        let mut cameras = Vec::new();
        for camera in &self.file.cameras {
            cameras.push((camera.name.clone(), self.camera(camera, frame)?));
        }
        scene.cameras.splice(0..0, cameras);
        Ok(())
    }

    fn fault(&self, what: String, hint: impl Into<String>) -> SceneError {
        SceneError::Content { path: self.path.clone(), line: None, what, hint: hint.into() }
    }

    fn material(
        &self,
        name: &str,
        with: &Material,
        scene: &mut SceneBuilder,
        budget: &Budget,
    ) -> Result<(), SceneError> {
        let known = scene.materials.iter().any(|material| material.name == name);
        if with.new {
            if known {
                let what = format!("material '{name}' is new, but the scene has one of that name");
                return Err(self.fault(what, "leave out 'new', or choose another name"));
            }
            scene.material(MaterialDesc::lambert(name, [0.5; 3]));
        } else if !known {
            return Err(self.unknown(name, &format!("there is no material '{name}'"), scene));
        }
        for material in scene.materials.iter_mut().filter(|material| material.name == name) {
            self.change(material, with, budget)?;
        }
        Ok(())
    }

    fn unknown(&self, name: &str, what: &str, scene: &SceneBuilder) -> SceneError {
        let hint = similar::did_you_mean(name, scene.materials.iter().map(|material| material.name.as_str()));
        let separator = if hint.ends_with('?') { "" } else { ";" };
        self.fault(what.to_owned(), format!("{hint}{separator} 'new = true' in its table adds one"))
    }

    /// The dispersion that a material is given, if any.
    fn dispersion(&self, name: &str, with: &Material) -> Result<Option<Dispersion>, SceneError> {
        let (abbe, cauchy) = (with.abbe.map(Dispersion::Abbe), with.cauchy.map(Dispersion::Cauchy));
        let all = [abbe, cauchy, with.sellmeier.map(Dispersion::Sellmeier)];
        let given: Vec<Dispersion> = all.into_iter().flatten().collect();
        if let [first, second, ..] = given[..] {
            let what = format!("material '{name}' has both {} and {}", first.name(), second.name());
            return Err(self.fault(what, "give one of cauchy, abbe and sellmeier"));
        }
        Ok(given.first().copied())
    }

    fn change(&self, desc: &mut MaterialDesc, with: &Material, budget: &Budget) -> Result<(), SceneError> {
        let before = kind_of(&desc.surface);
        let kind = with.kind.unwrap_or(before);
        if kind != before {
            // A texture keeps its factor, and a sheet or solid that had one too; diffuse and glossy surfaces their colour.
            let has_base = |kind: Kind| matches!(kind, Kind::Lambert | Kind::Glossy);
            let keeps = desc.textures.base_color.is_some() || has_base(kind) && has_base(before);
            let color = keeps.then(|| color_of(&desc.surface));
            desc.surface = match kind {
                Kind::Lambert => Surface::Lambert { albedo: color.unwrap_or([0.5; 3]) },
                Kind::Mirror => Surface::Mirror { reflectance: color.unwrap_or([1.0; 3]) },
                Kind::Glass => Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.0 },
                Kind::Boundary => MaterialDesc::boundary("", [0.0; 3]).surface,
                Kind::Thin => Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness: 0.0 },
                Kind::Glossy => Surface::Glossy {
                    base_color: color.unwrap_or([0.5; 3]),
                    metallic: 0.0,
                    roughness: 0.5,
                    specular: 1.0,
                    ior: 1.5,
                },
            };
        }
        let is_boundary = kind == Kind::Boundary;
        if is_boundary {
            // It changes the medium, and nothing else.
            (desc.textures, desc.dispersion) = (TexturesDesc::default(), None);
            (desc.emission, desc.emits_both_sides) = ([0.0; 3], false);
        }
        if is_boundary || kind == Kind::Glass || kind != before {
            // Another kind of surface is there everywhere, and a solid always is.
            (desc.alpha, desc.alpha_mode, desc.textures.alpha) = (1.0, AlphaMode::Opaque, None);
        }
        if let Some(alpha) = with.alpha {
            let alpha_mode = if alpha == 1.0 { AlphaMode::Opaque } else { AlphaMode::Blend };
            (desc.alpha, desc.alpha_mode, desc.textures.alpha) = (alpha, alpha_mode, None);
        }
        if with.albedo.is_some() || with.tint.is_some() {
            desc.textures.base_color = None;
        }
        if with.emission.is_some() {
            desc.textures.emission = None;
        }
        let (mut new_albedo, mut new_ior) = (with.albedo, with.ior);
        let (mut new_tint, mut new_absorption) = (with.tint, with.absorption);
        let (mut new_priority, mut new_specular_color) = (with.priority, with.specular_color);
        let (mut new_metallic, mut new_roughness, mut new_specular) = (with.metallic, with.roughness, with.specular);
        if with.metallic.is_some() || with.roughness.is_some() || kind != before {
            desc.textures.metallic_roughness = None;
        }
        if with.specular.is_some() || kind != before {
            desc.textures.specular = None;
        }
        if with.clearcoat.is_some() {
            desc.textures.clearcoat = None;
        }
        if with.clearcoat_roughness.is_some() {
            desc.textures.clearcoat_roughness = None;
        }
        if kind != before {
            (desc.clearcoat, desc.clearcoat_roughness) = (0.0, 0.0);
            (desc.textures.clearcoat, desc.textures.clearcoat_roughness) = (None, None);
            desc.textures.clearcoat_normal = None;
        }
        let (mut new_clearcoat, mut new_clearcoat_roughness) = (with.clearcoat, with.clearcoat_roughness);
        let is_glass = matches!(kind, Kind::Glass | Kind::Boundary | Kind::Thin);
        if !is_glass {
            desc.clearcoat = new_clearcoat.take().unwrap_or(desc.clearcoat);
            desc.clearcoat_roughness = new_clearcoat_roughness.take().unwrap_or(desc.clearcoat_roughness);
        }
        if with.sheen.is_some() || kind != before {
            (desc.sheen_color, desc.textures.sheen_color) = ([0.0; 3], None);
        }
        if with.sheen_roughness.is_some() || kind != before {
            (desc.sheen_roughness, desc.textures.sheen_roughness) = (0.0, None);
        }
        let (mut new_sheen, mut new_sheen_roughness) = (with.sheen, with.sheen_roughness);
        if !is_glass {
            desc.sheen_color = new_sheen.take().map_or(desc.sheen_color, |given| given.rgb());
            desc.sheen_roughness = new_sheen_roughness.take().unwrap_or(desc.sheen_roughness);
        }
        if with.diffuse_transmission.is_some() {
            desc.textures.diffuse_transmission = None;
        }
        if with.diffuse_transmission_color.is_some() {
            desc.textures.diffuse_transmission_color = None;
        }
        let (mut new_transmission, mut new_transmission_color) =
            (with.diffuse_transmission, with.diffuse_transmission_color);
        if matches!(kind, Kind::Lambert | Kind::Glossy) {
            let color = new_transmission_color.take();
            desc.diffuse_transmission = new_transmission.take().unwrap_or(desc.diffuse_transmission);
            desc.diffuse_transmission_color = color.map_or(desc.diffuse_transmission_color, |given| given.rgb());
        } else {
            (desc.diffuse_transmission, desc.diffuse_transmission_color) = (0.0, [1.0; 3]);
            (desc.textures.diffuse_transmission, desc.textures.diffuse_transmission_color) = (None, None);
        }
        if with.transmission.is_some() || kind != before {
            (desc.transmission, desc.textures.transmission) = (0.0, None);
        }
        if kind != before {
            desc.transmission_absorption = None;
            (desc.scattering, desc.phase, desc.grid) = ([0.0; 3], PhaseDesc::default(), None);
        }
        let mut new_scattering = with.scattering;
        let (mut new_phase, mut new_droplets) = (with.phase.as_deref(), with.droplet_micrometres);
        let mut new_dispersion = self.dispersion(&desc.name, with)?;
        // One that gives the refractive index itself is replaced by another index.
        let is_replaced = with.ior.is_some() && !matches!(desc.dispersion, Some(Dispersion::Abbe(_)));
        if kind != before || is_replaced {
            desc.dispersion = None;
        }
        let mut new_share = with.transmission;
        if with.anisotropy.is_some() || with.anisotropy_degrees.is_some() || kind != before {
            desc.textures.anisotropy = None;
        }
        if kind != before {
            (desc.anisotropy, desc.anisotropy_rotation) = (0.0, 0.0);
        }
        let (mut new_anisotropy, mut new_rotation) = (with.anisotropy, with.anisotropy_degrees);
        if with.specular_color.is_some() || kind != before {
            (desc.specular_color, desc.textures.specular_color) = ([1.0; 3], None);
        }
        match &mut desc.surface {
            Surface::Lambert { albedo: colour } | Surface::Mirror { reflectance: colour } => {
                *colour = new_albedo.take().map_or(*colour, |given| given.rgb());
            }
            Surface::Dielectric { ior, absorption, tint, roughness } => {
                *roughness = new_roughness.take().unwrap_or(*roughness);
                *ior = new_ior.take().unwrap_or(*ior);
                *tint = new_tint.take().map_or(*tint, |given| given.rgb());
                *absorption = new_absorption.take().map_or(*absorption, |given| given.rgb());
            }
            Surface::Boundary { absorption } => {
                *absorption = new_absorption.take().map_or(*absorption, |given| given.rgb());
            }
            Surface::Thin { ior, tint, roughness } => {
                *roughness = new_roughness.take().unwrap_or(*roughness);
                *ior = new_ior.take().unwrap_or(*ior);
                *tint = new_tint.take().map_or(*tint, |given| given.rgb());
            }
            Surface::Glossy { base_color, metallic, roughness, specular, ior } => {
                desc.specular_color = new_specular_color.take().map_or(desc.specular_color, |given| given.rgb());
                *base_color = new_albedo.take().map_or(*base_color, |given| given.rgb());
                *metallic = new_metallic.take().unwrap_or(*metallic);
                *roughness = new_roughness.take().unwrap_or(*roughness);
                *specular = new_specular.take().unwrap_or(*specular);
                *ior = new_ior.take().unwrap_or(*ior);
                desc.transmission = new_share.take().unwrap_or(desc.transmission);
                if desc.transmission > 0.0 {
                    let inside = new_absorption.take().map(|given| given.rgb());
                    desc.transmission_absorption = inside.or(desc.transmission_absorption);
                    desc.priority = new_priority.take().unwrap_or(desc.priority);
                }
                desc.anisotropy = new_anisotropy.take().unwrap_or(desc.anisotropy);
                desc.anisotropy_rotation = new_rotation.take().map_or(desc.anisotropy_rotation, f64::to_radians);
            }
        }
        if is_boundary || kind == Kind::Glass {
            desc.scattering = new_scattering.take().map_or(desc.scattering, |given| given.rgb());
            let keys = PhaseKeys {
                phase: new_phase.take(),
                anisotropy: new_anisotropy.take(),
                droplet_micrometres: new_droplets.take(),
            };
            desc.phase = self.phase(&format!("material '{}'", desc.name), desc.phase, keys)?;
            desc.priority = new_priority.take().unwrap_or(desc.priority);
            desc.grid = self.grid(&desc.name, desc.grid.as_ref(), with, budget)?;
        }
        if desc.is_solid()
            && let Some(dispersion) = new_dispersion.take()
        {
            *desc = desc.clone().with_dispersion(dispersion);
        }
        let has_medium = matches!(kind, Kind::Glass | Kind::Boundary);
        let left = [
            ("albedo", new_albedo.is_some()),
            ("ior", new_ior.is_some()),
            (new_dispersion.map_or("dispersion", Dispersion::name), new_dispersion.is_some()),
            ("tint", new_tint.is_some()),
            ("absorption", new_absorption.is_some()),
            ("scattering", new_scattering.is_some()),
            ("phase", new_phase.is_some()),
            ("droplet_micrometres", new_droplets.is_some()),
            ("grid", !has_medium && with.grid.is_some()),
            ("transform", !has_medium && with.transform.is_some()),
            ("density_scale", !has_medium && with.density_scale.is_some()),
            ("priority", new_priority.is_some()),
            ("metallic", new_metallic.is_some()),
            ("roughness", new_roughness.is_some()),
            ("specular", new_specular.is_some()),
            ("specular_color", new_specular_color.is_some()),
            ("clearcoat", new_clearcoat.is_some()),
            ("clearcoat_roughness", new_clearcoat_roughness.is_some()),
            ("anisotropy", new_anisotropy.is_some()),
            ("anisotropy_degrees", new_rotation.is_some()),
            ("diffuse_transmission", new_transmission.is_some()),
            ("diffuse_transmission_color", new_transmission_color.is_some()),
            ("transmission", new_share.is_some()),
            ("sheen", new_sheen.is_some()),
            ("sheen_roughness", new_sheen_roughness.is_some()),
            ("emission", is_boundary && with.emission.is_some()),
            ("emits_both_sides", is_boundary && with.emits_both_sides.is_some()),
        ];
        if let Some((property, _)) = left.into_iter().find(|(_, left)| *left) {
            let kind = format!("{kind:?}").to_lowercase();
            let what = format!("material '{}' is of kind {kind} and has no {property}", desc.name);
            let hint = format!("{} it; give such a kind, or leave it out", kinds_with(property));
            return Err(self.fault(what, hint));
        }
        desc.emission = with.emission.map_or(desc.emission, |given| given.rgb());
        desc.emits_both_sides = with.emits_both_sides.unwrap_or(desc.emits_both_sides);
        Ok(())
    }
}

/// The colour that a texture multiplies.
fn color_of(surface: &Surface) -> [f64; 3] {
    match *surface {
        Surface::Lambert { albedo } => albedo,
        Surface::Mirror { reflectance } => reflectance,
        Surface::Dielectric { tint, .. } | Surface::Thin { tint, .. } => tint,
        Surface::Boundary { .. } => [1.0; 3],
        Surface::Glossy { base_color, .. } => base_color,
    }
}

/// The kind of a surface.
fn kind_of(surface: &Surface) -> Kind {
    match surface {
        Surface::Boundary { .. } => Kind::Boundary,
        Surface::Lambert { .. } => Kind::Lambert,
        Surface::Mirror { .. } => Kind::Mirror,
        Surface::Dielectric { .. } => Kind::Glass,
        Surface::Thin { .. } => Kind::Thin,
        Surface::Glossy { .. } => Kind::Glossy,
    }
}
