//! A camera for models without one.

use photon_core::SceneView;
use photon_core::glam::DVec3;
use photon_scene::{CameraDesc, Projection};

/// Share of the vertices that may be outside of the picture at each side: the far corners of a ground, for instance.
const OUTSIDE: f64 = 0.02;

/// A camera that looks at the scene obliquely from above, from the right of +z, and is as near as it can be with nearly
/// all vertices in a square picture.
pub(crate) fn camera(view: &SceneView<'_>) -> CameraDesc {
    let axis = |axis: usize| {
        let mut values: Vec<f64> =
            view.triangles.iter().flatten().map(|&vertex| f64::from(view.positions[vertex as usize][axis])).collect();
        values.sort_unstable_by(f64::total_cmp);
        let skipped = (values.len() as f64 * OUTSIDE) as usize;
        match values.as_slice() {
            [] => (-0.5, 0.5),
            all => (all[skipped], all[all.len() - 1 - skipped]),
        }
    };
    let ranges = [axis(0), axis(1), axis(2)];
    let (low, high) = (DVec3::from(ranges.map(|range| range.0)), DVec3::from(ranges.map(|range| range.1)));
    let center = 0.5 * (low + high);
    let backwards = DVec3::new(0.5, 0.45, 1.0);
    let backwards = backwards / backwards.length();
    let right = DVec3::Y.cross(backwards) / DVec3::Y.cross(backwards).length();
    let up = backwards.cross(right);
    let vertical_fov = 35_f64.to_radians();
    let slope = (0.5 * vertical_fov).tan();
    let distance = (0..8).map(|corner| {
        let corner =
            DVec3::from(std::array::from_fn(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] }));
        let from = corner - center;
        from.dot(backwards) + from.dot(right).abs().max(from.dot(up).abs()) / slope
    });
    // A margin of a twentieth, and some distance from a single point.
    let distance = 1.05 * distance.fold(1e-3, f64::max);
    let position = view.units.point_to_user((center + distance * backwards).as_vec3().to_array());
    let projection = Projection::Perspective { vertical_fov };
    CameraDesc::new(position, (-backwards).to_array(), [0.0, 1.0, 0.0], projection)
}
