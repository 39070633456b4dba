//! Stripes of surfaces, each seen by some of eight columns of pixels.

use photon_core::EnvironmentMap;
use photon_core::glam::DVec3;
use photon_scene::{CameraDesc, MaterialDesc, Projection, Scene, SceneBuilder, VertexAttributes};

/// Towards the camera of [`add`].
pub(crate) const VIEW: DVec3 = DVec3::new(0.0, 1.2, 0.8);

/// Adds stripes at y = 0 of the given numbers of columns, eight in all, across which the first coordinate of textures runs
/// from 0 to 1, and a camera for 8×8 pixels; with `pane` a sheet of glass above, behind which only photons find lights.
pub(crate) fn add(builder: &mut SceneBuilder, descs: impl IntoIterator<Item = (u32, MaterialDesc)>, pane: bool) {
    let uvs = vec![[0.0, 0.5], [1.0, 0.5], [1.0, 0.5], [0.0, 0.5]];
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    add_with(builder, descs.into_iter().map(|(columns, desc)| (columns, desc, attributes.clone())), pane);
}

/// The same with vertex attributes of the corners at (0, 1), (1, 1), (1, 0) and (0, 0), from the lower left on.
pub(crate) fn add_with(
    builder: &mut SceneBuilder,
    descs: impl IntoIterator<Item = (u32, MaterialDesc, VertexAttributes)>,
    pane: bool,
) {
    let mut x = -1.0;
    for (columns, desc, attributes) in descs {
        let material = builder.material(desc);
        let end = x + 0.25 * f64::from(columns);
        let positions = vec![[x, 0.0, 1.5], [end, 0.0, 1.5], [end, 0.0, -1.5], [x, 0.0, -1.5]];
        builder.mesh_with("stripe", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        x = end;
    }
    if pane {
        let glass = builder.material(MaterialDesc::thin("pane", 1.5));
        builder.quad("pane", [[-3.0, 2.5, 3.0], [3.0, 2.5, 3.0], [3.0, 2.5, -3.0], [-3.0, 2.5, -3.0]], glass);
    }
    let projection = Projection::Orthographic { half_height: 1.0 };
    builder.camera("oblique", CameraDesc::new(VIEW.to_array(), (-VIEW).to_array(), [0.0, 1.0, 0.0], projection));
}

/// A scene of such stripes in an environment of radiance 1; with `panes` below two sheets of glass, where paths do not split
/// any more.
pub(crate) fn in_even_light(
    mut builder: SceneBuilder,
    descs: impl IntoIterator<Item = (u32, MaterialDesc)>,
    panes: bool,
) -> Scene {
    add(&mut builder, descs, false);
    for y in [0.3, 0.6] {
        let glass = builder.material(MaterialDesc::thin("pane", 1.5));
        if panes {
            builder.quad("pane", [[-3.0, y, 3.0], [3.0, y, 3.0], [3.0, y, -3.0], [-3.0, y, -3.0]], glass);
        }
    }
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    builder.build().unwrap()
}
