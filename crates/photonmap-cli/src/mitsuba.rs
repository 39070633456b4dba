//! Export to Mitsuba 3 (Jakob et al. 2022): an XML file, and a PLY file for each material.
//!
//! Each boundary of a medium is exported as one against the ambient medium: nested ones are not expressed. User space, radiance in
//! W/(m²·sr), linear RGB. Surfaces scatter on both sides, as here. What Mitsuba handles differently is a warning, what
//! it cannot express an error.

mod environment;
mod medium;
mod metal;
mod ply;
mod unsupported;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use photon_core::glam::Vec3;
use photon_core::{
    Camera, Features, Light, Material, MaterialKind, MediaFeatures, Medium, Solids, partial_transmission,
};
use photon_scene::Scene;

use crate::atomic_write;
use crate::fault::Fault;

/// The files written besides the XML file, and warnings.
#[derive(Clone, Debug)]
pub struct Written {
    /// The folder of the meshes.
    pub folder: PathBuf,
    /// Number of files in it.
    pub meshes: usize,
    /// What differs from this renderer.
    pub warnings: Vec<String>,
}

/// Writes the scene with the given camera.
///
/// # Errors
/// [`Fault::Input`] for what is not written: textures, vertex normals and colours, glossy surfaces that are not all metal,
/// clearcoats, a material that emits from both sides; [`Fault::Failure`] if a file cannot be written.
pub fn write(path: &Path, scene: &Scene, camera: &Camera, size: (u32, u32)) -> Result<Written, Fault> {
    let view = scene.view();
    unsupported::refuse(scene)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder_name = format!("{stem}-meshes");
    let folder = path.with_file_name(&folder_name);
    std::fs::create_dir_all(&folder).map_err(|why| Fault::writing(&folder, why))?;
    let mut written = Written { folder: folder.clone(), meshes: 0, warnings: Vec::new() };
    let features = Solids::of(&view).features();
    if features.contains(MediaFeatures::NESTED) && !features.contains(MediaFeatures::DISPERSION) {
        written.warnings.push(
            "solids that lie within one another or overlap are written as if each was in a vacuum: light inside them \
             differs in Mitsuba"
                .into(),
        );
    }
    let has_media = view.media.iter().any(Medium::attenuates);
    let mut text = String::from("<scene version=\"3.0.0\">\n");
    // Only the volumetric path tracers support media; for those whose coefficients differ by colour there is one of its own.
    let is_coloured = |medium: &Medium| medium.extinction() != Vec3::splat(medium.extinction().x);
    let has_colours = view.media.iter().any(|medium| medium.scatters() && is_coloured(medium));
    let _ = writeln!(
        text,
        "    <integrator type=\"{}\">",
        match (has_media, has_colours) {
            (true, true) => "volpathmis",
            (true, false) => "volpath",
            _ => "path",
        }
    );
    text += "        <integer name=\"max_depth\" value=\"-1\"/>\n    </integrator>\n";
    text += &medium::ambient(scene);
    text += &sensor(scene, camera, size);
    for (index, (material, material_name)) in view.materials.iter().zip(scene.material_names()).enumerate() {
        let name = format!("material-{index}.ply");
        if ply::write(scene, index as u32, &folder.join(&name))? > 0 {
            written.meshes += 1;
            let file = format!("{folder_name}/{name}");
            text += &shape(scene, (material_name, material), &file, &mut written.warnings)?;
        }
    }
    for index in 1..view.media.len() as u32 {
        let name = format!("boundary-{index}.ply");
        if ply::write_boundary(scene, index, &folder.join(&name))? > 0 {
            written.meshes += 1;
            let file = format!("{folder_name}/{name}");
            text += &boundary(scene, index, &file, &mut written.warnings);
        }
    }
    text += &environment::emitter(scene, &folder, &folder_name)?;
    for light in view.lights {
        text += &emitter(scene, light, &mut written.warnings);
    }
    text += "</scene>\n";
    atomic_write::write_bytes(path, text.as_bytes())?;
    Ok(written)
}

fn list<T: std::fmt::Display>(values: [T; 3]) -> String {
    values.map(|value| value.to_string()).join(", ")
}

fn rgb<T: std::fmt::Display>(name: &str, values: [T; 3]) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\"/>", list(values))
}

fn sensor(scene: &Scene, camera: &Camera, (width, height): (u32, u32)) -> String {
    let origin = scene.units().point_to_user(camera.origin);
    let target: [f64; 3] = std::array::from_fn(|axis| origin[axis] + f64::from(camera.forward[axis]));
    let length = |v: [f32; 3]| v.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
    let (half_width, half_height) = (length(camera.right), length(camera.up));
    let mut text = String::new();
    let perspective = camera.kind == Camera::PERSPECTIVE;
    let has_lens = camera.features().contains(Features::THIN_LENS);
    let kind = match (perspective, has_lens) {
        (true, true) => "thinlens",
        (true, false) => "perspective",
        (false, _) => "orthographic",
    };
    let _ = writeln!(text, "    <sensor type=\"{kind}\">");
    if has_lens {
        let [radius, focus] =
            [camera.lens_radius, camera.focus_distance].map(|length| scene.units().length_to_user(length));
        let _ = writeln!(text, "        <float name=\"aperture_radius\" value=\"{radius}\"/>");
        let _ = writeln!(text, "        <float name=\"focus_distance\" value=\"{focus}\"/>");
    }
    let mut scale = String::new();
    if perspective {
        let degrees = 2.0 * half_width.atan().to_degrees();
        let _ = writeln!(text, "        <float name=\"fov\" value=\"{degrees}\"/>");
        text += "        <string name=\"fov_axis\" value=\"x\"/>\n";
    } else {
        let [x, y] = [half_width, half_height].map(|half| half * scene.units().scale);
        scale = format!("            <scale x=\"{x}\" y=\"{y}\" z=\"1\"/>\n");
    }
    let up = camera.up.map(|c| f64::from(c) / half_height);
    let _ = writeln!(
        text,
        "        <float name=\"near_clip\" value=\"{}\"/>\n        <float name=\"far_clip\" value=\"{}\"/>",
        1e-5 * scene.units().scale,
        1e4 * scene.units().scale
    );
    let _ = writeln!(
        text,
        "        <transform name=\"to_world\">\n{scale}            <lookat origin=\"{}\" target=\"{}\" up=\"{}\"/>\n        </transform>",
        list(origin),
        list(target),
        list(up)
    );
    // A box filter: each pixel is the mean over its square, as here.
    let _ = writeln!(
        text,
        "        <film type=\"hdrfilm\">
            <integer name=\"width\" value=\"{width}\"/>
            <integer name=\"height\" value=\"{height}\"/>
            <rfilter type=\"box\"/>
            <string name=\"pixel_format\" value=\"rgb\"/>
            <string name=\"component_format\" value=\"float32\"/>
        </film>
        <sampler type=\"independent\"/>{}
    </sensor>",
        medium::around(scene)
    );
    text
}

/// The material's BSDF.
fn bsdf(name: &str, material: &Material, warnings: &mut Vec<String>) -> Result<String, Fault> {
    let colour = material.albedo;
    let ior = format!("<float name=\"int_ior\" value=\"{}\"/><float name=\"ext_ior\" value=\"1\"/>", material.ior);
    let two_sided = |inner: &str| format!("<bsdf type=\"twosided\">{inner}</bsdf>");
    Ok(match material.kind() {
        MaterialKind::Lambert => two_sided(&format!("<bsdf type=\"diffuse\">{}</bsdf>", rgb("reflectance", colour))),
        MaterialKind::Mirror if material.metallic > 0.0 && colour != [1.0; 3] => {
            metal::smooth_metal(name, material, warnings)
        }
        MaterialKind::Mirror => two_sided(&format!(
            "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/>{}</bsdf>",
            rgb("specular_reflectance", colour)
        )),
        MaterialKind::Thin if material.is_rough_glass() => {
            return Err(Fault::input(format!(
                "material '{name}' is a rough sheet, which cannot be written for Mitsuba; give it roughness = 0 in an \
                 override file"
            )));
        }
        MaterialKind::Dielectric if material.is_rough_glass() => {
            warnings.push(format!(
                "material '{name}' has no multiple scattering in Mitsuba, and is darker there: its distribution has the \
                 width {}",
                material.roughness * material.roughness
            ));
            let alpha = material.roughness * material.roughness;
            format!(
                "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" \
                 value=\"{alpha}\"/>{ior}{}</bsdf>",
                rgb("specular_transmittance", colour)
            )
        }
        // Light passes it unchanged, also on its way to emitters.
        MaterialKind::Dielectric if material.ior == 1.0 && colour == [1.0; 3] => "<bsdf type=\"null\"/>".to_owned(),
        MaterialKind::Dielectric => {
            format!("<bsdf type=\"dielectric\">{ior}{}</bsdf>", rgb("specular_transmittance", colour))
        }
        MaterialKind::Thin => {
            format!("<bsdf type=\"thindielectric\">{ior}{}</bsdf>", rgb("specular_transmittance", colour))
        }
        MaterialKind::Glossy if material.metallic == 1.0 => metal::rough_metal(name, material, warnings),
        MaterialKind::Glossy => {
            return Err(Fault::input(format!(
                "material '{name}' has a glossy coat, which cannot be written for Mitsuba; make it all metal, or give \
                 it specular = 0 in an override file"
            )));
        }
        other => {
            return Err(Fault::input(format!(
                "material '{name}' is of the kind {other:?}, which cannot be written for Mitsuba; give it another \
                 surface"
            )));
        }
    })
}

fn shape(
    scene: &Scene,
    (name, material): (&str, &Material),
    file: &str,
    warnings: &mut Vec<String>,
) -> Result<String, Fault> {
    let mut bsdf = bsdf(name, material, warnings)?;
    let mut medium = material.medium;
    if material.has_partial_transmission()
        && let Some(entry) = scene.view().shading.partial_transmissions.get(material.textures as usize - 1)
    {
        let glass = &scene.view().materials[entry.glass as usize];
        let share = partial_transmission::share(entry.factor, 1.0, material.metallic);
        let second = self::bsdf(name, glass, warnings)?;
        bsdf = format!("<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"{share}\"/>{bsdf}{second}</bsdf>");
        medium = glass.medium;
    }
    let mut text = String::from("    <shape type=\"ply\">\n");
    let _ = writeln!(text, "        <string name=\"filename\" value=\"{}\"/>", escaped(file));
    let _ = writeln!(text, "        <boolean name=\"face_normals\" value=\"true\"/>\n        {bsdf}");
    let units = scene.units();
    let inside = scene.view().media[medium as usize];
    if inside.is_dispersive() {
        let ior = inside.ior;
        warnings.push(format!("material '{name}' does not disperse light in Mitsuba: its refractive index is {ior}"));
    }
    if scene.view().grids.of(medium).is_some() {
        warnings.push(format!(
            "material '{name}' is homogeneous in Mitsuba, of its largest density: give it the grid as a gridvolume"
        ));
    }
    if medium > 0 {
        text += &medium::sides(scene, &inside);
    }
    if material.emission != [0.0; 3] {
        if material.flags & Material::EMITS_BOTH_SIDES != 0 {
            return Err(Fault::input(format!(
                "material '{name}' emits from both sides, which area lights of Mitsuba do not; give it two \
                 meshes, one facing each way"
            )));
        }
        let radiance = rgb("radiance", material.emission.map(|c| f64::from(c) * units.radiance_to_user()));
        let _ = writeln!(text, "        <emitter type=\"area\">{radiance}</emitter>");
    }
    text += "    </shape>\n";
    Ok(text)
}

/// The boundary of the medium with this index.
fn boundary(scene: &Scene, medium: u32, file: &str, warnings: &mut Vec<String>) -> String {
    let inside = scene.view().media[medium as usize];
    if inside.priority > 0 {
        warnings.push(format!("the priority {} of a boundary has no effect in Mitsuba", inside.priority));
    }
    let mut text = String::from("    <shape type=\"ply\">\n");
    let _ = writeln!(text, "        <string name=\"filename\" value=\"{}\"/>", escaped(file));
    let _ = writeln!(text, "        <bsdf type=\"null\"/>");
    text + &medium::sides(scene, &inside) + "    </shape>\n"
}

/// The emitter of a light; empty for triangles, which are exported as shapes, and for the environment.
fn emitter(scene: &Scene, light: &Light, warnings: &mut Vec<String>) -> String {
    let units = scene.units();
    let watts = light.power.map(|c| f64::from(c) * units.power);
    let origin = units.point_to_user(light.position);
    let per = |divisor: f64| watts.map(|w| w / divisor);
    match light.kind {
        Light::POINT => format!(
            "    <emitter type=\"point\"><point name=\"position\" value=\"{}\"/>{}{}</emitter>\n",
            list(origin),
            rgb("intensity", per(4.0 * std::f64::consts::PI)),
            medium::around(scene)
        ),
        Light::SPOT => {
            // Radians from the axis: full intensity up to the inner angle, zero from the outer one on.
            let angle = |versine: f32| 2.0 * (0.5 * f64::from(versine)).sqrt().min(1.0).asin();
            let (inner, outer) = (f64::from(light.versine_inner), f64::from(light.versine_outer));
            // Full intensity within the inner cone, and on average a third over the solid angle beyond: the square of a ramp.
            let solid_angle = 2.0 * std::f64::consts::PI * (inner + (outer - inner) / 3.0);
            warnings.push(
                "a spot light falls off linearly with the angle in Mitsuba, here with the square of the cosine".into(),
            );
            let target: [f64; 3] = std::array::from_fn(|axis| origin[axis] + f64::from(light.direction[axis]));
            format!(
                "    <emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"{}\" target=\"{}\" \
                 up=\"{}\"/></transform>{}<float name=\"cutoff_angle\" value=\"{}\"/><float name=\"beam_width\" \
                 value=\"{}\"/>{}</emitter>\n",
                list(origin),
                list(target),
                list(perpendicular(light.direction)),
                rgb("intensity", per(solid_angle)),
                angle(light.versine_outer).to_degrees(),
                angle(light.versine_inner).to_degrees(),
                medium::around(scene)
            )
        }
        Light::DIRECTIONAL => {
            // Its light enters through a disc around the scene.
            if light.is_sun() {
                let degrees = 2.0 * (1.0 - light.versine_outer).acos().to_degrees();
                warnings.push(format!("the disc of the sun, of {degrees:.2} degrees, is a point in Mitsuba"));
            }
            let radius = units.length_to_user(light.radius);
            format!(
                "    <emitter type=\"directional\"><vector name=\"direction\" value=\"{}\"/>{}</emitter>\n",
                list(light.direction),
                rgb("irradiance", per(std::f64::consts::PI * radius * radius))
            )
        }
        _ => String::new(),
    }
}

/// A perpendicular direction.
fn perpendicular([x, y, z]: [f32; 3]) -> [f32; 3] {
    if x.abs() < 0.5 { [0.0, z, -y] } else { [y, -x, 0.0] }
}

/// Escapes text for a quoted XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
