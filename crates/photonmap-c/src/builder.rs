//! Scenes from arrays, and additions to scenes of files.

use std::ffi::c_char;
use std::path::Path;

use photonmap::scene::{
    AmbientMedium, CameraDesc, Dispersion, EnvironmentName, GridDesc, LightDesc, LoadOptions, LoadReport, MaterialDesc,
    MaterialId, Overrides, PhaseDesc, Projection, SceneBuilder, Surface, ThinLens, VertexAttributes, builtin,
    builtin_names, did_you_mean, load_builder_with,
};

use crate::describe::{
    PM_DISPERSION_ABBE, PM_DISPERSION_CAUCHY, PM_DISPERSION_NONE, PM_DISPERSION_SELLMEIER, PM_LIGHT_DIRECTIONAL,
    PM_LIGHT_POINT, PM_LIGHT_SPOT, PM_MATERIAL_BOUNDARY, PM_MATERIAL_DIELECTRIC, PM_MATERIAL_GLOSSY,
    PM_MATERIAL_LAMBERT, PM_MATERIAL_MIRROR, PM_MATERIAL_THIN, PM_PHASE_HENYEY_GREENSTEIN, PM_PHASE_MIE,
    PM_PHASE_RAYLEIGH, PmCamera, PmGrid, PmLight, PmMaterial, PmMedium, PmMesh,
};
use crate::error::{Fault, PmStatus, Result, call, free};
use crate::options::{self, PmLoadOptions};
use crate::pointer;
use crate::scene::PmScene;

/// A scene under construction. Values are checked by pm_builder_build().
#[derive(Debug, Default)]
pub struct PmBuilder {
    scene: SceneBuilder,
    materials: Vec<MaterialId>,
    report: LoadReport,
}

impl PmBuilder {
    pub(crate) fn from_file(file: &str, (overrides, options): (Option<&str>, LoadOptions)) -> Result<Self> {
        let overrides = overrides.map(|path| Overrides::read_with(Path::new(path), &options)).transpose()?;
        let (scene, report) = load_builder_with(Path::new(file), overrides.as_ref(), &options)?;
        Ok(Self { scene, report, ..Self::default() })
    }

    pub(crate) fn built_in(name: &str) -> Result<Self> {
        let Some(scene) = builtin(name) else {
            let names: Vec<&str> = builtin_names().iter().map(|(name, _)| *name).collect();
            let near = did_you_mean(name, names);
            return Err(Fault::argument(format!("no built-in scene is called {name:?}: {near}")));
        };
        Ok(Self { scene, ..Self::default() })
    }

    pub(crate) fn build(&self) -> Result<PmScene> {
        let (mut scene, mut report) = (self.scene.clone(), self.report.clone());
        if !scene.has_camera() {
            scene.camera("automatic", scene.frame_camera());
        }
        if scene.light_if_dark()? {
            report.note(
                "the scene",
                "has no light; the environment \"gradient\" is used; choose another with pm_builder_environment(), or add lights",
            );
        }
        Ok(PmScene::new(scene.build()?, &report))
    }
}

/// Makes an empty scene. `*builder` is to be freed with pm_builder_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_new(builder: *mut *mut PmBuilder) -> PmStatus {
    // SAFETY: the caller's pointer to a handle.
    call(|| unsafe { pointer::hand_out(builder, || Ok(PmBuilder::default())) })
}

/// Reads a scene file, as pm_scene_load(), to add to it. `*builder` is to be freed with pm_builder_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_load(
    file: *const c_char,
    overrides: *const c_char,
    builder: *mut *mut PmBuilder,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's texts, and pointer to a handle.
        unsafe {
            pointer::hand_out(builder, || {
                let overrides = pointer::text_or_null(overrides, "overrides")?;
                PmBuilder::from_file(pointer::text(file, "file")?, (overrides, LoadOptions::default()))
            })
        }
    })
}

/// As pm_builder_load(), with options, which may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_load_with(
    file: *const c_char,
    options: *const PmLoadOptions,
    builder: *mut *mut PmBuilder,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's text, struct, and pointer to a handle.
        unsafe {
            pointer::hand_out(builder, || {
                PmBuilder::from_file(pointer::text(file, "file")?, options::loading(options)?)
            })
        }
    })
}

/// Adds a material. `*id`, which may be NULL, is what meshes refer to it by.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_material(
    builder: *mut PmBuilder,
    material: *const PmMaterial,
    id: *mut u32,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, struct, and a name within it.
        let (builder, given, name) = unsafe {
            let given = pointer::read(material)?;
            (pointer::exclusive(builder, "builder")?, given, pointer::text_or_null(given.name, "name")?)
        };
        let PmMaterial { color, ior, absorption, roughness, .. } = given;
        let surface = match given.kind {
            PM_MATERIAL_LAMBERT => Surface::Lambert { albedo: color },
            PM_MATERIAL_MIRROR => Surface::Mirror { reflectance: color },
            PM_MATERIAL_DIELECTRIC => Surface::Dielectric { ior, absorption, tint: color, roughness },
            PM_MATERIAL_THIN => Surface::Thin { ior, tint: color, roughness },
            PM_MATERIAL_GLOSSY => Surface::Glossy {
                base_color: color,
                metallic: given.metallic,
                roughness,
                specular: given.specular,
                ior,
            },
            PM_MATERIAL_BOUNDARY => Surface::Boundary { absorption },
            kind => return Err(Fault::argument(format!("PmMaterial.kind is {kind}, but there are 0 to 5"))),
        };
        let mut desc = MaterialDesc::new(name.unwrap_or_default(), surface).with_priority(given.priority);
        if given.kind != PM_MATERIAL_BOUNDARY {
            desc.emission = given.emission;
            desc.emits_both_sides = given.emits_both_sides != 0;
        }
        let terms = given.dispersion_terms;
        let dispersion = match given.dispersion {
            PM_DISPERSION_NONE => None,
            PM_DISPERSION_ABBE => Some(Dispersion::Abbe(terms[0])),
            PM_DISPERSION_CAUCHY => Some(Dispersion::Cauchy([terms[0], terms[1]])),
            PM_DISPERSION_SELLMEIER => Some(Dispersion::Sellmeier(terms)),
            other => return Err(Fault::argument(format!("PmMaterial.dispersion is {other}, but there are 0 to 3"))),
        };
        // Fields that the kind does not use are ignored.
        let refracts = matches!(given.kind, PM_MATERIAL_DIELECTRIC | PM_MATERIAL_THIN);
        if let Some(dispersion) = dispersion.filter(|_| refracts) {
            desc = desc.with_dispersion(dispersion);
        }
        if matches!(given.kind, PM_MATERIAL_DIELECTRIC | PM_MATERIAL_BOUNDARY) {
            let phase = phase("PmMaterial", given.phase, given.anisotropy, given.droplet_micrometres)?;
            desc = desc.with_scattering(given.scattering, phase);
        }
        builder.materials.push(builder.scene.material(desc));
        if !id.is_null() {
            // SAFETY: not NULL; the caller's number.
            unsafe { id.write(builder.materials.len() as u32 - 1) };
        }
        Ok(())
    })
}

/// The phase function of a struct of this name.
fn phase(of: &str, kind: u32, anisotropy: f64, droplet_micrometres: f64) -> Result<PhaseDesc, Fault> {
    match kind {
        PM_PHASE_HENYEY_GREENSTEIN => Ok(PhaseDesc::HenyeyGreenstein { anisotropy }),
        PM_PHASE_RAYLEIGH => Ok(PhaseDesc::Rayleigh),
        PM_PHASE_MIE => Ok(PhaseDesc::Mie { droplet_micrometres }),
        other => Err(Fault::argument(format!("{of}.phase is {other}, but there are 0 to 2"))),
    }
}

/// Adds triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_mesh(builder: *mut PmBuilder, mesh: *const PmMesh) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, struct, and the arrays within it, which have the lengths within it.
        let (builder, name, positions, normals, triangles, material) = unsafe {
            let mesh = pointer::read(mesh)?;
            let normals = if mesh.normals.is_null() { 0 } else { mesh.vertex_count };
            let triple = |count| pointer::product(count, 3, "PmMesh");
            (
                pointer::exclusive(builder, "builder")?,
                pointer::text_or_null(mesh.name, "name")?,
                pointer::array(mesh.positions, triple(mesh.vertex_count)?, "positions")?,
                pointer::array(mesh.normals, triple(normals)?, "normals")?,
                pointer::array(mesh.triangles, triple(mesh.triangle_count)?, "triangles")?,
                mesh.material,
            )
        };
        let Some(&material) = builder.materials.get(material as usize) else {
            return Err(Fault::argument(format!(
                "PmMesh.material is {material}, but pm_builder_material() has made {}, numbered from 0",
                builder.materials.len()
            )));
        };
        let attributes = VertexAttributes::default().with_normals(normals.as_chunks::<3>().0.to_vec());
        let (positions, triangles) = (positions.as_chunks::<3>().0.to_vec(), triangles.as_chunks::<3>().0.to_vec());
        builder.scene.mesh_with(name.unwrap_or_default(), positions, triangles, attributes, material);
        Ok(())
    })
}

/// Adds a light.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_light(builder: *mut PmBuilder, light: *const PmLight) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, struct, and a name within it.
        let (builder, light, name) = unsafe {
            let light = pointer::read(light)?;
            (pointer::exclusive(builder, "builder")?, light, pointer::text_or_null(light.name, "name")?)
        };
        let PmLight { position, direction, color, inner_angle, outer_angle, .. } = light;
        let desc = match light.kind {
            PM_LIGHT_POINT => LightDesc::Point { position, intensity: color },
            PM_LIGHT_SPOT => LightDesc::Spot { position, direction, intensity: color, inner_angle, outer_angle },
            PM_LIGHT_DIRECTIONAL => LightDesc::Directional { direction, irradiance: color },
            kind => return Err(Fault::argument(format!("PmLight.kind is {kind}, but there are 0 to 2"))),
        };
        builder.scene.light(name.unwrap_or_default(), desc);
        Ok(())
    })
}

/// Adds a camera; the first one is the default.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_camera(builder: *mut PmBuilder, camera: *const PmCamera) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, struct, and a name within it.
        let (builder, camera, name) = unsafe {
            let camera = pointer::read(camera)?;
            (pointer::exclusive(builder, "builder")?, camera, pointer::text_or_null(camera.name, "name")?)
        };
        let PmCamera { position, target, up, vertical_fov, half_height, lens_diameter, focus_distance, .. } = camera;
        let mut desc = CameraDesc::look_at(position, target, up, vertical_fov);
        if vertical_fov == 0.0 {
            desc = desc.with_projection(Projection::Orthographic { half_height });
        }
        // NaN is a lens too, and is refused later.
        if lens_diameter != 0.0 {
            desc = desc.with_lens(ThinLens::new(lens_diameter, focus_distance));
        }
        builder.scene.camera(name.unwrap_or_default(), desc);
        Ok(())
    })
}

/// Sets the light from all around, and replaces that of before.
///
/// `light`: an .exr or .hdr image in latitude and longitude, of radiance in W/(m² sr), whose centre is seen along -z;
/// "gradient", of radiance 1 + 0.9 d.w from direction w, with the unit vector d along (-2, 4, 3); "constant", of radiance 1, or
/// "constant:R,G,B"; or a clear sky with its sun, "sky:ELEVATION,TURBIDITY", in degrees and from 1 to 10.
/// `rotate`: degrees, counter-clockwise as seen from +y. `scale`: factor on the light, such as 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_environment(
    builder: *mut PmBuilder,
    light: *const c_char,
    rotate: f64,
    scale: f64,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and text.
        let (builder, light) = unsafe { (pointer::exclusive(builder, "builder")?, pointer::text(light, "light")?) };
        let name = light.parse::<EnvironmentName>();
        let name = name.map_err(|why| Fault::argument(format!("light is {light:?}: {why}")))?;
        let desc = name.desc(&mut builder.report, &LoadOptions::default())?;
        builder.scene.environment_from(&desc.rotated(rotate).scaled(scale))?;
        Ok(())
    })
}

/// Gives a dielectric densities, and replaces those of before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_grid(builder: *mut PmBuilder, grid: *const PmGrid) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, struct, a path and an array within it, which has the length within it.
        let (builder, given, file, densities) = unsafe {
            let given = pointer::read(grid)?;
            let file = pointer::text_or_null(given.file, "file")?;
            let [x, y, z] = given.cells.map(|cells| cells as usize);
            let cells = pointer::product(pointer::product(x, y, "PmGrid")?, z, "PmGrid")?;
            let count = if file.is_some() { 0 } else { cells };
            let densities = pointer::array(given.densities, count, "densities")?;
            (pointer::exclusive(builder, "builder")?, given, file, densities)
        };
        let material = builder.materials.get(given.material as usize).copied();
        let Some(material) = material.and_then(|id| builder.scene.material_mut(id)) else {
            return Err(Fault::argument(format!(
                "PmGrid.material is {}, but pm_builder_material() has made {}, numbered from 0",
                given.material,
                builder.materials.len()
            )));
        };
        let mut desc = match file {
            Some(file) => GridDesc::read(Path::new(file), &LoadOptions::default())?,
            None => GridDesc::new(given.cells, densities),
        };
        if given.transform != [[0.0; 4]; 4] {
            desc = desc.with_transform(given.transform);
        }
        if given.density_scale != 0.0 {
            desc = desc.with_density_scale(given.density_scale);
        }
        material.grid = Some(desc);
        Ok(())
    })
}

/// Sets the medium around all solids, and replaces that of before; without scattering and absorption there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_medium(builder: *mut PmBuilder, medium: *const PmMedium) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and struct.
        let (builder, given) = unsafe { (pointer::exclusive(builder, "builder")?, pointer::read(medium)?) };
        let phase = phase("PmMedium", given.phase, given.anisotropy, given.droplet_micrometres)?;
        let medium = AmbientMedium::new(given.scattering, given.absorption).with_phase(phase);
        let [low, high] = given.bounds;
        let is_bounded = given.bounds != [[0.0; 3]; 2];
        builder.scene.medium(if is_bounded { medium.with_bounds(low, high) } else { medium });
        Ok(())
    })
}

/// Applies the text of an override file: an environment, a medium, lights and cameras, and changes of materials that were
/// added before, by name. Images are sought from the working directory. If it fails, the builder may have part of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_overrides(builder: *mut PmBuilder, toml: *const c_char) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and text.
        let (builder, text) = unsafe { (pointer::exclusive(builder, "builder")?, pointer::text(toml, "toml")?) };
        Overrides::parse(text, Path::new("overrides"))?.apply(&mut builder.scene, &mut builder.report)?;
        Ok(())
    })
}

/// Checks everything and makes the scene. A scene without a camera gets one that shows all of it, and one without a light the
/// environment "gradient", of which pm_scene_report() has a line. The builder may be changed and built again. `*scene`
/// is to be freed with pm_scene_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_build(builder: *const PmBuilder, scene: *mut *mut PmScene) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, and pointer to a handle.
        unsafe { pointer::hand_out(scene, || pointer::shared(builder, "builder")?.build()) }
    })
}

/// Frees a builder; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_builder_free(builder: *mut PmBuilder) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(builder) });
}
