//! Portals of a description: triangles in user space, or the name of a material or of a mesh.

use glam::DVec3;
use photon_core::Portal;

use crate::builder::SceneBuilder;
use crate::error::SceneError;
use crate::normalise::Frame;
use crate::similar;

/// Smallest area of a portal that is not a line, as a share of its longest edge squared.
const MIN_SHARE: f64 = 1e-9;

/// An opening, as it was added.
#[derive(Clone, Debug)]
pub(crate) enum PortalDesc {
    /// Triangles of its own, with the name for messages.
    Triangles(String, Vec<[[f64; 3]; 3]>),
    /// Those of a material or of a mesh.
    Named(String),
}

/// The records of all portals.
///
/// # Errors
/// [`SceneError::Portal`].
pub(crate) fn table(scene: &SceneBuilder, frame: Frame, radius: f64) -> Result<Vec<Portal>, SceneError> {
    let mut portals = Vec::new();
    for desc in &scene.portals {
        let found;
        let (name, triangles) = match desc {
            PortalDesc::Triangles(name, triangles) => (name, triangles),
            PortalDesc::Named(name) => {
                found = named(scene, name)?;
                (name, &found)
            }
        };
        let fault = |what: String, hint| SceneError::Portal { portal: name.clone(), what, hint };
        for corners in triangles {
            portals.push(record(*corners, frame, radius).map_err(|(what, hint)| fault(what, hint))?);
        }
        if portals.len() > Portal::MAX {
            let what = format!("with it there are {} triangles, more than {}", portals.len(), Portal::MAX);
            let hint = "every photon of the environment is tested against all of them; give the corners of a \
                        quadrilateral for each opening instead";
            return Err(fault(what, hint.to_owned()));
        }
    }
    Ok(portals)
}

/// One triangle, or what is wrong with it and what would be valid.
fn record(corners: [[f64; 3]; 3], frame: Frame, radius: f64) -> Result<Portal, (String, String)> {
    if let Some(corner) = corners.iter().find(|at| at.iter().any(|part| !part.is_finite())) {
        return Err((format!("a corner is {corner:?}"), "every coordinate must be a finite number".to_owned()));
    }
    let places = corners.map(|at| frame.point(at));
    let reach = f64::from(Portal::REACH) * radius;
    if let Some(index) = places.iter().position(|at| at.length() > reach) {
        let what = format!("its corner {:?} is far outside of the scene", corners[index]);
        let hint =
            format!("a portal is an opening of the scene, at most {} of its radii from its centre", Portal::REACH);
        return Err((what, hint));
    }
    let portal = Portal::new(places.map(|at| at.to_array()));
    let longest = longest_squared(places);
    let area = DVec3::from(portal.area.map(f64::from)).length();
    // Comparisons that fail for NaN.
    if !(area >= f64::from(Portal::MIN_AREA) && area >= MIN_SHARE * longest) {
        let hint = "the corners must be those of a triangle, not of a line or a point";
        return Err((format!("the triangle {corners:?} has no area"), hint.to_owned()));
    }
    Ok(portal)
}

/// Square of the longest edge.
fn longest_squared([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared())
}

/// The triangles of the meshes that have this name, or a material of this name; those without area are left out.
fn named(scene: &SceneBuilder, name: &str) -> Result<Vec<[[f64; 3]; 3]>, SceneError> {
    let material = |mesh: &crate::mesh::Mesh| &scene.materials[mesh.material.0 as usize].name;
    let mut meshes = scene.meshes.iter().filter(|mesh| *mesh.name == *name || material(mesh) == name).peekable();
    let portal = || name.to_owned();
    if meshes.peek().is_none() {
        let what = "no triangle has a material or a mesh of that name".to_owned();
        return Err(SceneError::Portal { portal: portal(), what, hint: similar(scene, name) });
    }
    let corners = |mesh: &crate::mesh::Mesh, triangle: &[u32; 3]| triangle.map(|index| mesh.positions[index as usize]);
    let all = meshes.flat_map(|mesh| mesh.triangles.iter().map(move |triangle| corners(mesh, triangle)));
    let found: Vec<_> = all
        .filter(|corners| {
            let corners = corners.map(DVec3::from_array);
            let [a, b, c] = corners;
            0.5 * (b - a).cross(c - a).length() > 2.0 * MIN_SHARE * longest_squared(corners)
        })
        .collect();
    if found.is_empty() {
        let what = "its triangles have no area".to_owned();
        return Err(SceneError::Portal { portal: portal(), what, hint: "name another, or give corners".to_owned() });
    }
    Ok(found)
}

/// The names that exist and are most like `name`.
fn similar(scene: &SceneBuilder, name: &str) -> String {
    let mut names: Vec<&str> = scene.meshes.iter().map(|mesh| &*mesh.name).collect();
    names.extend(scene.meshes.iter().map(|mesh| scene.materials[mesh.material.0 as usize].name.as_str()));
    names.sort_unstable();
    names.dedup();
    similar::did_you_mean(name, names)
}
