//! The structs by which scenes are described.

use std::ffi::c_char;

use crate::pointer;

/// A diffuse surface (Lambert), on both sides.
pub const PM_MATERIAL_LAMBERT: u32 = 0;
/// A perfect mirror, on both sides.
pub const PM_MATERIAL_MIRROR: u32 = 1;
/// The boundary of a solid of glass or another medium, smooth or rough: a closed mesh whose fronts face outwards.
pub const PM_MATERIAL_DIELECTRIC: u32 = 2;
/// A sheet without thickness, which light passes without a change of direction if it is smooth.
pub const PM_MATERIAL_THIN: u32 = 3;
/// Rough reflection (GGX): the metallic-roughness model of glTF 2.0.
pub const PM_MATERIAL_GLOSSY: u32 = 4;
/// The boundary of mist, smoke or ink, which light passes without reflection, refraction or any other event: a closed mesh whose
/// fronts face outwards.
pub const PM_MATERIAL_BOUNDARY: u32 = 5;

/// One refractive index for all light.
pub const PM_DISPERSION_NONE: u32 = 0;
/// By the Abbe number, finite and above 0: the first of the numbers.
pub const PM_DISPERSION_ABBE: u32 = 1;
/// A, B of n = A + B/λ², λ in micrometres. They replace the refractive index.
pub const PM_DISPERSION_CAUCHY: u32 = 2;
/// B1, B2, B3, C1, C2, C3 of n² = 1 + Σ Bλ²/(λ² - C), λ in micrometres. They replace the refractive index.
pub const PM_DISPERSION_SELLMEIER: u32 = 3;

/// Scattering by the phase function of Henyey and Greenstein, of a mean cosine.
pub const PM_PHASE_HENYEY_GREENSTEIN: u32 = 0;
/// By particles much smaller than the wavelength: air.
pub const PM_PHASE_RAYLEIGH: u32 = 1;
/// By droplets of water of a diameter: fog and cloud.
pub const PM_PHASE_MIE: u32 = 2;

/// A material. Colours are linear RGB. Fields that its kind does not use are ignored.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmMaterial {
    /// sizeof(PmMaterial).
    pub size: usize,
    /// Name in messages and override files; NULL: none.
    pub name: *const c_char,
    /// One of PM_MATERIAL_….
    pub kind: u32,
    /// Not 0: the back emits too, not only the front.
    pub emits_both_sides: u32,
    /// Albedo (Lambert), reflectance (mirror), base colour (glossy), in [0, 1]; the factor on transmitted light
    /// (dielectric, thin).
    pub color: [f64; 3],
    /// Emitted radiance, the same in all directions, W/(m² sr), finite and at least 0.
    pub emission: [f64; 3],
    /// Refractive index, relative to vacuum (dielectric, thin; coat of glossy), finite and above 0.
    pub ior: f64,
    /// Absorption inside of a dielectric or boundary (Beer-Lambert), 1/m, finite and at least 0.
    pub absorption: [f64; 3],
    /// Roughness in [0, 1] (dielectric, thin, glossy); 0 is smooth.
    pub roughness: f64,
    /// Share of metal in [0, 1] (glossy).
    pub metallic: f64,
    /// Factor on the reflection of the coat in [0, 1], usually 1 (glossy).
    pub specular: f64,
    /// Where solids and boundaries overlap, the one with the highest priority counts (dielectric, boundary).
    pub priority: u32,
    /// Formula of the refractive index by the wavelength, one of PM_DISPERSION_… (dielectric; an error for thin).
    pub dispersion: u32,
    /// Its numbers.
    pub dispersion_terms: [f64; 6],
    /// Scattering inside of a dielectric or boundary, 1/m, finite and at least 0: milk, wax, mist.
    pub scattering: [f64; 3],
    /// Mean cosine of that scattering, in (-1, 1): 0 is even (PM_PHASE_HENYEY_GREENSTEIN).
    pub anisotropy: f64,
    /// Diameter of droplets in micrometres, 5 to 50 (PM_PHASE_MIE).
    pub droplet_micrometres: f64,
    /// Phase function of that scattering, one of PM_PHASE_….
    pub phase: u32,
}

/// The medium around all solids. Light from infinitely far away does not pass one without bounds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmMedium {
    /// sizeof(PmMedium).
    pub size: usize,
    /// Scattering coefficient, 1/m, linear RGB, finite and at least 0.
    pub scattering: [f64; 3],
    /// Absorption coefficient, 1/m, linear RGB, finite and at least 0.
    pub absorption: [f64; 3],
    /// Mean cosine of scattering, in (-1, 1): 0 is even (PM_PHASE_HENYEY_GREENSTEIN).
    pub anisotropy: f64,
    /// Diameter of droplets in micrometres, 5 to 50 (PM_PHASE_MIE).
    pub droplet_micrometres: f64,
    /// Phase function, one of PM_PHASE_….
    pub phase: u32,
    /// Lower and upper corner of the box that it fills, in m; all 0: without bounds.
    pub bounds: [[f64; 3]; 2],
}

/// Densities by which the scattering and absorption inside of a dielectric are multiplied: smoke, clouds. They are trilinear
/// between the centres of cells, and 0 outside of the box that cells fill. The array is copied.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmGrid {
    /// sizeof(PmGrid).
    pub size: usize,
    /// A .vol or .nvdb file of densities, UTF-8, in place of the array; NULL: the array.
    pub file: *const c_char,
    /// One density for each cell, x fastest, finite and at least 0.
    pub densities: *const f32,
    /// Number of cells along x, y and z, at least 1.
    pub cells: [u32; 3],
    /// Of pm_builder_material().
    pub material: u32,
    /// Rows of an affine transform from the unit cube, which the cells fill, to user space; all 0: the box of the file, or the
    /// unit cube.
    pub transform: [[f64; 4]; 4],
    /// Factor on the densities, finite and at least 0; 0: 1.
    pub density_scale: f64,
}

/// Triangles of one material. Arrays are copied.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmMesh {
    /// sizeof(PmMesh).
    pub size: usize,
    /// Name in messages; NULL: none.
    pub name: *const c_char,
    /// 3 coordinates for each vertex, user space, finite.
    pub positions: *const f64,
    /// 3 components of the normal at each vertex, towards the front, for smooth shading; NULL: flat triangles.
    pub normals: *const f64,
    /// Number of vertices.
    pub vertex_count: usize,
    /// 3 indices of vertices for each triangle, counter-clockwise as seen from the front.
    pub triangles: *const u32,
    /// Number of triangles.
    pub triangle_count: usize,
    /// Of pm_builder_material().
    pub material: u32,
}

/// Emits equally in all directions.
pub const PM_LIGHT_POINT: u32 = 0;
/// Emits within a cone.
pub const PM_LIGHT_SPOT: u32 = 1;
/// Parallel light from infinitely far away.
pub const PM_LIGHT_DIRECTIONAL: u32 = 2;

/// A light without extent. Area lights are meshes of a material that emits.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmLight {
    /// sizeof(PmLight).
    pub size: usize,
    /// Name in messages; NULL: none.
    pub name: *const c_char,
    /// One of PM_LIGHT_….
    pub kind: u32,
    /// User space (point, spot).
    pub position: [f64; 3],
    /// In which light travels, of any length but 0 (spot, directional).
    pub direction: [f64; 3],
    /// Linear RGB, finite and at least 0: radiant intensity, W/sr (point, spot), or irradiance on a plane perpendicular to
    /// the direction, W/m² (directional).
    pub color: [f64; 3],
    /// Angle from the axis up to which the intensity is full, radians (spot).
    pub inner_angle: f64,
    /// Angle from the axis at which the intensity reaches 0, radians, in (0, pi/2] (spot).
    pub outer_angle: f64,
}

/// A camera. The width of its view follows from the shape of the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmCamera {
    /// sizeof(PmCamera).
    pub size: usize,
    /// Name; NULL: none.
    pub name: *const c_char,
    /// User space; may lie outside of the scene.
    pub position: [f64; 3],
    /// Point in the middle of the picture, other than the position.
    pub target: [f64; 3],
    /// Upwards in the picture; not parallel to the view.
    pub up: [f64; 3],
    /// Angle between the lower and the upper edge of the picture, radians, in (0, pi); 0: orthographic.
    pub vertical_fov: f64,
    /// Half the height of what an orthographic camera sees, m.
    pub half_height: f64,
    /// Diameter of the lens, m; 0: everything is in focus.
    pub lens_diameter: f64,
    /// Distance of the plane in focus, m, if there is a lens.
    pub focus_distance: f64,
}

/// Facts about a scene. Normalised space, which ray casters see, is `(user - center) / scale`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmSceneInfo {
    /// sizeof(PmSceneInfo); set before the call.
    pub size: usize,
    /// Triangles that are rendered. Those without area are dropped.
    pub triangles: usize,
    /// Vertices that triangles use.
    pub vertices: usize,
    /// Meshes of the description.
    pub meshes: usize,
    /// Materials of the description.
    pub materials: usize,
    /// Records of lights: one for each triangle that emits, and others.
    pub lights: usize,
    /// Cameras.
    pub cameras: usize,
    /// Triangles without area, which were dropped.
    pub dropped: usize,
    /// Centre of the bounding box, user space.
    pub center: [f64; 3],
    /// User-space length of a normalised unit.
    pub scale: f64,
    /// Total flux of the lights, mean of RGB, W.
    pub power: f64,
}

pointer::versioned!(PmMaterial, PmMedium, PmGrid, PmMesh, PmLight, PmCamera, PmSceneInfo);
