//! Scenes: a builder that the Python class replays its calls on, and the built scene.

use std::path::Path;
use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use photonmap::scene::{
    AmbientMedium, CameraDesc, Dispersion, EnvironmentDesc, EnvironmentName, GridDesc, LightDesc, LoadOptions,
    LoadReport, MaterialDesc, MaterialId, Overrides, PhaseDesc, PhaseKeys, Projection, ReportKind, Scene, SceneBuilder,
    Sun, TextureDesc, TextureId, ThinLens, VertexAttributes, builtin, builtin_names, did_you_mean, load_builder_with,
    summed_up,
};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::texture::{self, TextureUses};
use crate::tree::vectors;

/// A scene under construction.
#[pyclass(module = "photonmap._photonmap")]
pub(crate) struct RawBuilder {
    builder: SceneBuilder,
    report: LoadReport,
    materials: Vec<MaterialId>,
    textures: Vec<TextureId>,
}

/// Names and one-line descriptions of the built-in scenes.
#[pyfunction]
pub(crate) fn builtin_scenes() -> Vec<(&'static str, &'static str)> {
    builtin_names().to_vec()
}

/// The meaning of the text of an environment: "file", "gradient", "constant" with a radiance, or "sky" with elevation
/// and turbidity.
#[pyfunction]
pub(crate) fn environment_text(text: &str) -> PyResult<(&'static str, Vec<f64>)> {
    let name = text.parse::<EnvironmentName>();
    Ok(match name.map_err(|why| Failure::input(format!("environment {text:?}: {why}")))? {
        EnvironmentName::File(_) => ("file", Vec::new()),
        EnvironmentName::Gradient => ("gradient", Vec::new()),
        EnvironmentName::Constant(radiance) => ("constant", radiance.to_vec()),
        EnvironmentName::Sky(elevation, turbidity) => ("sky", vec![elevation, turbidity]),
    })
}

/// A phase function: its kind, mean cosine, and diameter of droplets.
type PhaseArguments = (String, f64, Option<f64>);

/// The phase function with these arguments; a mean cosine of 0 is the default, which all kinds have.
fn phase((name, anisotropy, droplet_micrometres): &PhaseArguments) -> PyResult<PhaseDesc> {
    let anisotropy = (*anisotropy != 0.0).then_some(*anisotropy);
    let keys = PhaseKeys { phase: Some(name), anisotropy, droplet_micrometres: *droplet_micrometres };
    Ok(PhaseDesc::default().with_keys(keys).map_err(Failure::from)?)
}

#[pymethods]
impl RawBuilder {
    #[new]
    fn new() -> Self {
        Self {
            builder: SceneBuilder::new(),
            report: LoadReport::default(),
            materials: Vec::new(),
            textures: Vec::new(),
        }
    }

    /// A built-in scene.
    #[staticmethod]
    fn builtin(name: &str) -> PyResult<Self> {
        let builder = builtin(name).ok_or_else(|| {
            let names: Vec<&str> = builtin_names().iter().map(|(name, _)| *name).collect();
            let near = did_you_mean(name, names);
            Failure::input(format!("{name:?} is neither a built-in scene nor a file with a known extension: {near}"))
        })?;
        Ok(Self { builder, report: LoadReport::default(), materials: Vec::new(), textures: Vec::new() })
    }

    /// A scene file, changed by an override file. `memory` limits the bytes that reading holds.
    #[staticmethod]
    fn load(py: Python<'_>, path: &str, overrides: Option<&str>, memory: Option<u64>) -> PyResult<Self> {
        let options = LoadOptions::default().with_memory(memory);
        let load = || {
            let overrides = overrides.map(|path| Overrides::read_with(Path::new(path), &options)).transpose()?;
            load_builder_with(Path::new(path), overrides.as_ref(), &options)
        };
        let (builder, report) = py.detach(|| load().map_err(Failure::from))?;
        Ok(Self { builder, report, materials: Vec::new(), textures: Vec::new() })
    }

    /// Applies an override file.
    fn overrides(&mut self, path: &str) -> PyResult<()> {
        let overrides = Overrides::read(Path::new(path)).map_err(Failure::from)?;
        Ok(overrides.apply(&mut self.builder, &mut self.report).map_err(Failure::from)?)
    }

    /// Adds a material and returns its number. `kind`, `parameters`: as in override files; `emission`: radiance, and whether
    /// the back emits; `dispersion`: no number, or the 1, 2 or 6 of its formula; `textures`: see [`TextureUses`].
    #[expect(clippy::too_many_arguments, reason = "called by Python alone, by position")]
    fn material(
        &mut self,
        name: &str,
        kind: &str,
        parameters: Vec<(String, Vec<f64>)>,
        emission: ([f64; 3], bool),
        phase_function: PhaseArguments,
        dispersion: Vec<f64>,
        textures: TextureUses,
    ) -> PyResult<usize> {
        let parameters = parameters.iter().map(|(key, numbers)| (key.as_str(), numbers.as_slice()));
        let mut desc = MaterialDesc::with_parameters(name, kind, parameters).map_err(Failure::from)?;
        (desc.emission, desc.emits_both_sides) = emission;
        desc.phase = phase(&phase_function)?;
        let desc = match dispersion[..] {
            [] => desc,
            [abbe] => desc.with_dispersion(Dispersion::Abbe(abbe)),
            [a, b] => desc.with_dispersion(Dispersion::Cauchy([a, b])),
            [b1, b2, b3, c1, c2, c3] => desc.with_dispersion(Dispersion::Sellmeier([b1, b2, b3, c1, c2, c3])),
            _ => return Err(Failure::input("a formula of dispersion has 1, 2 or 6 numbers").into()),
        };
        let desc = texture::used(desc, textures, &self.textures)?;
        self.materials.push(self.builder.material(desc));
        Ok(self.materials.len() - 1)
    }

    /// Gives a material densities: of a file, or of an array with x fastest. Without a transform, they fill the box of the file,
    /// or the unit cube.
    fn grid(
        &mut self,
        material: usize,
        file: Option<&str>,
        densities: PyReadonlyArray1<'_, f32>,
        cells: [u32; 3],
        transform: Option<[[f64; 4]; 4]>,
        density_scale: f64,
    ) -> PyResult<()> {
        let unknown = || Failure::input(format!("no material has the number {material}"));
        let id = *self.materials.get(material).ok_or_else(unknown)?;
        let desc = match file {
            Some(file) => GridDesc::read(Path::new(file), &LoadOptions::default()).map_err(Failure::from)?,
            None => GridDesc::new(cells, densities.as_array().iter().copied().collect::<Vec<f32>>()),
        };
        let desc = transform.map_or(desc.clone(), |transform| desc.with_transform(transform));
        let desc = desc.with_density_scale(density_scale);
        self.builder.material_mut(id).ok_or_else(unknown)?.grid = Some(desc);
        Ok(())
    }

    /// Adds an image of bytes, four for each texel, and returns its number. `wraps`: 0 to repeat, 1 to mirror, 2 to clamp.
    fn texture_bytes(
        &mut self,
        name: &str,
        texels: PyReadonlyArray1<'_, u8>,
        width: u32,
        is_color: bool,
        wraps: (u8, u8),
        nearest: bool,
    ) -> PyResult<usize> {
        let desc = texture::bytes(name, &texels, width, is_color)?;
        Ok(self.add_texture(texture::placed(desc, wraps, nearest)))
    }

    /// The same for linear numbers.
    fn texture_floats(
        &mut self,
        name: &str,
        texels: PyReadonlyArray1<'_, f32>,
        width: u32,
        wraps: (u8, u8),
        nearest: bool,
    ) -> PyResult<usize> {
        let desc = texture::floats(name, &texels, width)?;
        Ok(self.add_texture(texture::placed(desc, wraps, nearest)))
    }

    /// Adds triangles of a material. Arrays of vectors are flat.
    fn mesh(
        &mut self,
        name: &str,
        positions: PyReadonlyArray1<'_, f64>,
        triangles: PyReadonlyArray1<'_, u32>,
        material: usize,
        normals: Option<PyReadonlyArray1<'_, f64>>,
        uvs: Vec<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<()> {
        let corners: Vec<u32> = triangles.as_array().iter().copied().collect();
        let (triangles, rest) = corners.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(Failure::input("corners of triangles must come in threes").into());
        }
        let unknown = || Failure::input(format!("mesh '{name}': no material has the number {material}"));
        let material = *self.materials.get(material).ok_or_else(unknown)?;
        let mut attributes = VertexAttributes::default();
        if let Some(normals) = normals {
            attributes = attributes.with_normals(vectors(&normals)?);
        }
        if !uvs.is_empty() {
            let pairs = |flat: &PyReadonlyArray1<'_, f64>| {
                let numbers: Vec<f64> = flat.as_array().iter().copied().collect();
                numbers.as_chunks::<2>().0.to_vec()
            };
            attributes = attributes.with_uvs(uvs.iter().map(pairs).collect());
        }
        self.builder.mesh_with(name, vectors(&positions)?, triangles.to_vec(), attributes, material);
        Ok(())
    }

    fn point_light(&mut self, name: &str, position: [f64; 3], intensity: [f64; 3]) {
        self.builder.light(name, LightDesc::Point { position, intensity });
    }

    fn spot_light(
        &mut self,
        name: &str,
        position: [f64; 3],
        direction: [f64; 3],
        intensity: [f64; 3],
        angles: (f64, f64),
    ) {
        let (inner_angle, outer_angle) = angles;
        self.builder.light(name, LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle });
    }

    fn directional_light(&mut self, name: &str, direction: [f64; 3], irradiance: [f64; 3]) {
        self.builder.light(name, LightDesc::Directional { direction, irradiance });
    }

    fn sun(&mut self, direction: [f64; 3], irradiance: [f64; 3], radius_degrees: f64) {
        self.builder.sun(Sun::new(direction, irradiance).with_radius_degrees(radius_degrees));
    }

    /// Light from all around: the same from all directions.
    fn environment_constant(&mut self, radiance: [f64; 3]) -> PyResult<()> {
        self.environment(&EnvironmentDesc::constant(radiance), 0.0, 1.0)
    }

    /// Light that shows every side of a model.
    fn environment_gradient(&mut self, rotate: f64, scale: f64) -> PyResult<()> {
        self.environment(&EnvironmentDesc::gradient(), rotate, scale)
    }

    /// A clear sky with its sun.
    fn environment_sky(&mut self, elevation: f64, turbidity: f64, rotate: f64, scale: f64) -> PyResult<()> {
        self.environment(&EnvironmentDesc::sky(elevation, turbidity), rotate, scale)
    }

    /// An image file in latitude and longitude. `memory` limits the bytes that reading holds.
    fn environment_file(&mut self, path: &str, rotate: f64, scale: f64, memory: Option<u64>) -> PyResult<()> {
        let options = LoadOptions::default().with_memory(memory);
        let desc = EnvironmentDesc::read_with(Path::new(path), &mut self.report, &options).map_err(Failure::from)?;
        self.environment(&desc, rotate, scale)
    }

    /// An image, one row for each texel.
    fn environment_image(
        &mut self,
        width: usize,
        texels: PyReadonlyArray2<'_, f32>,
        rotate: f64,
        scale: f64,
    ) -> PyResult<()> {
        let flat: Vec<f32> = texels.as_array().iter().copied().collect();
        let (texels, _) = flat.as_chunks::<3>();
        self.environment(&EnvironmentDesc::image("array", width, texels), rotate, scale)
    }

    /// The medium around all solids, in a box if there is one.
    fn medium(
        &mut self,
        scattering: [f64; 3],
        absorption: [f64; 3],
        function: PhaseArguments,
        bounds: Option<[[f64; 3]; 2]>,
    ) -> PyResult<()> {
        let medium = AmbientMedium::new(scattering, absorption).with_phase(phase(&function)?);
        self.builder.medium(match bounds {
            Some([low, high]) => medium.with_bounds(low, high),
            None => medium,
        });
        Ok(())
    }

    /// The triangles of an opening, three corners each, flat.
    fn portal(&mut self, name: &str, corners: Vec<[f64; 3]>) {
        let (triangles, _) = corners.as_chunks::<3>();
        self.builder.portal(name, triangles.to_vec());
    }

    /// The triangles of a material or mesh as openings.
    fn portal_named(&mut self, name: &str) {
        self.builder.portal_named(name);
    }

    /// A camera; `view`: whether it is orthographic, and half the height or the vertical angle; `lens`: diameter and distance
    /// of focus.
    fn camera(
        &mut self,
        name: &str,
        position: [f64; 3],
        direction: [f64; 3],
        up: [f64; 3],
        view: (bool, f64),
        lens: Option<(f64, f64)>,
    ) {
        let (orthographic, size) = view;
        let projection = if orthographic {
            Projection::Orthographic { half_height: size }
        } else {
            Projection::Perspective { vertical_fov: size }
        };
        let mut camera = CameraDesc::new(position, direction, up, projection);
        if let Some((diameter, focus)) = lens {
            camera = camera.with_lens(ThinLens::new(diameter, focus));
        }
        self.builder.camera(name, camera);
    }

    /// Checks everything. A scene without a camera gets one that shows all of it, and one without a light the environment
    /// "gradient".
    fn build(&self, py: Python<'_>) -> PyResult<RawScene> {
        let mut builder = self.builder.clone();
        if !builder.has_camera() {
            let camera = builder.frame_camera();
            builder.camera("automatic", camera);
        }
        let is_dark = builder.light_if_dark().map_err(Failure::from)?;
        let scene = py.detach(|| builder.build().map_err(Failure::from))?;
        let mut warnings = scene.warnings().to_vec();
        if is_dark {
            warnings.push(
                "the scene has no light; environment=\"gradient\" is used: give a file or \"sky:30,3\" instead, or add lights"
                    .to_owned(),
            );
        }
        Ok(RawScene { scene: Arc::new(scene), warnings, report: self.report.clone() })
    }
}

impl RawBuilder {
    fn add_texture(&mut self, desc: TextureDesc) -> usize {
        self.textures.push(self.builder.texture(desc));
        self.textures.len() - 1
    }

    fn environment(&mut self, desc: &EnvironmentDesc, rotate: f64, scale: f64) -> PyResult<()> {
        let desc = desc.clone().rotated(rotate).scaled(scale);
        Ok(self.builder.environment_from(&desc).map_err(Failure::from)?)
    }
}

/// A scene that can be rendered.
#[pyclass(frozen, module = "photonmap._photonmap")]
pub(crate) struct RawScene {
    pub(crate) scene: Arc<Scene>,
    warnings: Vec<String>,
    report: LoadReport,
}

#[pymethods]
impl RawScene {
    /// Digest of all that passes depend on, cameras excluded.
    fn digest(&self) -> String {
        format!("{:032x}", self.scene.digest())
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The lines of the loader's report.
    fn report(&self) -> Vec<String> {
        self.report.lines.iter().map(ToString::to_string).collect()
    }

    /// Lines of which the user is warned: all but the notes of the loader, and of many warnings of a kind the first.
    fn user_warnings(&self) -> Vec<String> {
        let lost = self.report.lines.iter().filter(|line| line.kind != ReportKind::Note).map(ToString::to_string);
        summed_up(&lost.chain(self.warnings.iter().cloned()).collect::<Vec<_>>())
    }

    fn cameras(&self) -> Vec<String> {
        self.scene.camera_names().map(str::to_owned).collect()
    }

    fn triangles(&self) -> usize {
        self.scene.view().triangles.len()
    }
}
