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
use super::schema::{File, Material};
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, Dispersion, MaterialDesc, PhaseDesc, PhaseKeys, Surface};
use crate::error::SceneError;
use crate::parameter::{Kind, Layer, PARAMETERS, Parameter, Value};
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
        let dispersion = self.dispersion(&desc.name, with)?;
        let before = Kind::of(&desc.surface);
        let kind = with.kind.unwrap_or(before);
        if kind != before {
            become_kind(desc, kind, before);
        }
        let is_boundary = kind == Kind::Boundary;
        if is_boundary || kind == Kind::Glass || kind != before {
            // Another kind of surface is there everywhere, and a solid always is.
            (desc.alpha, desc.alpha_mode, desc.textures.alpha) = (1.0, AlphaMode::Opaque, None);
        }
        if let Some(alpha) = with.alpha {
            let alpha_mode = if alpha == 1.0 { AlphaMode::Opaque } else { AlphaMode::Blend };
            (desc.alpha, desc.alpha_mode, desc.textures.alpha) = (alpha, alpha_mode, None);
        }
        let is_filled = matches!(kind, Kind::Glass | Kind::Boundary);
        // Keys that the kind does not have.
        let mut left = Vec::new();
        for parameter in PARAMETERS {
            let Some(value) = with.value(parameter.key) else { continue };
            match parameter.key {
                // Of the phase function.
                "anisotropy" if is_filled => continue,
                // Of the share that is glass.
                "absorption" if kind == Kind::Glossy => continue,
                _ => {}
            }
            if let Some(texture) = parameter.texture() {
                *texture.of_mut(&mut desc.textures) = None;
            }
            if !parameter.set(desc, parameter.in_radians(value)) {
                left.push(parameter.key);
            }
        }
        let is_partly_glass = kind == Kind::Glossy && desc.transmission > 0.0;
        if is_partly_glass {
            let inside = with.absorption.map(|given| given.rgb());
            desc.transmission_absorption = inside.or(desc.transmission_absorption);
        }
        if is_filled || is_partly_glass {
            desc.priority = with.priority.unwrap_or(desc.priority);
        }
        if is_filled {
            let keys = PhaseKeys {
                phase: with.phase.as_deref(),
                anisotropy: with.anisotropy,
                droplet_micrometres: with.droplet_micrometres,
            };
            desc.phase = self.phase(&format!("material '{}'", desc.name), desc.phase, keys)?;
            desc.grid = self.grid(&desc.name, desc.grid.as_ref(), with, budget)?;
        }
        // A formula that gives the refractive index itself is replaced by another index.
        if with.ior.is_some() && !matches!(desc.dispersion, Some(Dispersion::Abbe(_))) {
            desc.dispersion = None;
        }
        if let Some(dispersion) = dispersion {
            if desc.is_solid() {
                *desc = desc.clone().with_dispersion(dispersion);
            } else {
                left.push(dispersion.name());
            }
        }
        let others = [
            ("absorption", kind == Kind::Glossy && !is_partly_glass && with.absorption.is_some()),
            ("priority", !is_filled && !is_partly_glass && with.priority.is_some()),
            ("phase", !is_filled && with.phase.is_some()),
            ("droplet_micrometres", !is_filled && with.droplet_micrometres.is_some()),
            ("grid", !is_filled && with.grid.is_some()),
            ("transform", !is_filled && with.transform.is_some()),
            ("density_scale", !is_filled && with.density_scale.is_some()),
            ("emission", is_boundary && with.emission.is_some()),
            ("emits_both_sides", is_boundary && with.emits_both_sides.is_some()),
        ];
        left.extend(others.into_iter().filter_map(|(key, is_left)| is_left.then_some(key)));
        if let Some(property) = left.first() {
            let what = format!("material '{}' is of kind {} and has no {property}", desc.name, kind.name());
            let hint = format!("{} it; give such a kind, or leave it out", kinds_with(property));
            return Err(self.fault(what, hint));
        }
        if let Some(emission) = with.emission {
            (desc.emission, desc.textures.emission) = (emission.rgb(), None);
        }
        desc.emits_both_sides = with.emits_both_sides.unwrap_or(desc.emits_both_sides);
        Ok(())
    }
}

/// Gives a material a surface of another kind. Emission, the colour of a base and its diffuse transmission stay; other layers
/// and media do not.
fn become_kind(desc: &mut MaterialDesc, kind: Kind, before: Kind) {
    // A texture keeps its factor, and a sheet or solid that had one too; diffuse and glossy surfaces their colour.
    let has_base = |kind: Kind| matches!(kind, Kind::Lambert | Kind::Glossy);
    let keeps = desc.textures.base_color.is_some() || has_base(kind) && has_base(before);
    let color = keeps.then(|| color_of(&desc.surface));
    desc.surface = kind.surface();
    if let (Some(color), Some(albedo)) = (color, Parameter::find("albedo")) {
        albedo.set(desc, Value::Color(color));
    }
    let has_leaf = has_base(kind);
    let is_kept = |layer: &Layer| layer.leader == "diffuse_transmission" && has_leaf;
    for parameter in PARAMETERS.iter().filter(|parameter| !parameter.layer.as_ref().is_some_and(is_kept)) {
        parameter.remove(desc);
    }
    let textures = &mut desc.textures;
    (textures.metallic_roughness, textures.specular) = (None, None);
    (textures.clearcoat_normal, textures.clearcoat_normal_scale) = (None, 1.0);
    (desc.transmission_absorption, desc.dispersion) = (None, None);
    (desc.phase, desc.grid) = (PhaseDesc::default(), None);
    if kind == Kind::Boundary {
        // It changes the medium, and nothing else.
        desc.textures = TexturesDesc::default();
        (desc.emission, desc.emits_both_sides) = ([0.0; 3], false);
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
