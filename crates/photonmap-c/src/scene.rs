//! Finished scenes.

use std::ffi::c_char;
use std::sync::Arc;

use photonmap::scene::{LoadOptions, LoadReport, Scene};

use crate::builder::PmBuilder;
use crate::describe::PmSceneInfo;
use crate::error::{Fault, PmStatus, call, free, length};
use crate::options::{self, PmLoadOptions};
use crate::pointer;

/// A scene. It does not change, and may be used by several threads at once.
#[derive(Debug)]
pub struct PmScene {
    pub(crate) scene: Arc<Scene>,
    report: String,
}

impl PmScene {
    pub(crate) fn new(scene: Scene, report: &LoadReport) -> Self {
        let lines = report.lines.iter().map(ToString::to_string);
        let report: Vec<String> = lines.chain(scene.warnings().iter().cloned()).collect();
        Self { scene: Arc::new(scene), report: report.join("\n") }
    }
}

/// Reads a scene file: .gltf, .glb, .obj, .ply or .stl.
///
/// `overrides`: a TOML file that changes or adds materials, lights, cameras and an environment; NULL for none. A scene
/// without a camera gets one that shows all of it, and one without a light the environment "gradient", of which pm_scene_report()
/// has a line. Paths are UTF-8. `*scene` is to be freed with pm_scene_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_load(
    file: *const c_char,
    overrides: *const c_char,
    scene: *mut *mut PmScene,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's texts, and pointer to a handle.
        unsafe {
            pointer::hand_out(scene, || {
                let overrides = pointer::text_or_null(overrides, "overrides")?;
                PmBuilder::from_file(pointer::text(file, "file")?, (overrides, LoadOptions::default()))?.build()
            })
        }
    })
}

/// As pm_scene_load(), with options, which may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_load_with(
    file: *const c_char,
    options: *const PmLoadOptions,
    scene: *mut *mut PmScene,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's text, struct, and pointer to a handle.
        unsafe {
            pointer::hand_out(scene, || {
                PmBuilder::from_file(pointer::text(file, "file")?, options::loading(options)?)?.build()
            })
        }
    })
}

/// Makes one of the built-in scenes, such as "cornell-glass"; the error of another name lists them. `*scene` is to be
/// freed with pm_scene_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_builtin(name: *const c_char, scene: *mut *mut PmScene) -> PmStatus {
    call(|| {
        // SAFETY: the caller's text, and pointer to a handle.
        unsafe { pointer::hand_out(scene, || PmBuilder::built_in(pointer::text(name, "name")?)?.build()) }
    })
}

/// Frees a scene; NULL is ignored. Renderers that were made with it go on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_free(scene: *mut PmScene) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(scene) });
}

/// Fills in `*info`, whose size has to be set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_info(scene: *const PmScene, info: *mut PmSceneInfo) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle.
        let scene = &unsafe { pointer::shared(scene, "scene") }?.scene;
        let (view, units) = (scene.view(), scene.units());
        let found = PmSceneInfo {
            size: size_of::<PmSceneInfo>(),
            triangles: view.triangles.len(),
            vertices: view.positions.len(),
            meshes: scene.mesh_names().count(),
            materials: scene.material_names().count(),
            lights: view.lights.len(),
            cameras: scene.camera_names().count(),
            dropped: usize::try_from(scene.dropped_triangles()).unwrap_or(usize::MAX),
            center: units.center,
            scale: units.scale,
            power: units.power,
        };
        // SAFETY: the caller's struct.
        unsafe { pointer::write(info, &found) }
    })
}

/// Copies what the loader approximated or left out, and warnings, one to a line: as pm_last_error().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_report(scene: *const PmScene, text: *mut c_char, room: usize) -> usize {
    // SAFETY: the caller's handle, and buffer of `room` bytes.
    length(|| Ok(unsafe { pointer::copy_text(&pointer::shared(scene, "scene")?.report, text, room) }))
}

/// What each of the `count` triangles was in the description: index of the mesh, in the order in which meshes were added
/// or are in the file, and index of the triangle within the mesh. Ray casters see triangles in this order.
///
/// `count` has to be PmSceneInfo.triangles; each array may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_triangle_sources(
    scene: *const PmScene,
    meshes: *mut u32,
    triangles: *mut u32,
    count: usize,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle.
        let scene = &unsafe { pointer::shared(scene, "scene") }?.scene;
        let expected = scene.view().triangles.len();
        if count != expected {
            return Err(Fault::argument(format!("count is {count}, but the scene has {expected} triangles")));
        }
        let room = |array: *mut u32| if array.is_null() { 0 } else { count };
        // SAFETY: the caller's arrays of `count` elements, or NULL.
        let (meshes, triangles) = unsafe {
            (
                pointer::array_mut(meshes, room(meshes), "meshes")?,
                pointer::array_mut(triangles, room(triangles), "triangles")?,
            )
        };
        for (index, (mesh, triangle)) in scene.triangle_sources().enumerate() {
            if let Some(slot) = meshes.get_mut(index) {
                *slot = mesh;
            }
            if let Some(slot) = triangles.get_mut(index) {
                *slot = triangle;
            }
        }
        Ok(())
    })
}

/// Copies the name of a mesh: as pm_last_error(). Returns 0 for one that does not exist.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_scene_mesh_name(scene: *const PmScene, mesh: u32, text: *mut c_char, room: usize) -> usize {
    length(|| {
        // SAFETY: the caller's handle.
        let scene = &unsafe { pointer::shared(scene, "scene") }?.scene;
        let count = scene.mesh_names().count();
        let missing = || Fault::argument(format!("mesh is {mesh}, but there are {count}, numbered from 0"));
        let name = scene.mesh_names().nth(mesh as usize).ok_or_else(missing)?;
        // SAFETY: the caller's buffer of `room` bytes.
        Ok(unsafe { pointer::copy_text(name, text, room) })
    })
}
