//! Facts about a scene that kernels are specialized to.

use photon_core::{Features, LightGroups, MediaFeatures, Requirements, SceneView, light_sampler, roughest_caustic};

/// Features with tables of their own. Kernels are specialized to those that the scene has: what only the requirements
/// have would be read at address 0.
pub(crate) const WITH_TABLES: Features = Features::SHADED
    .union(Features::TEXTURED_LIGHTS)
    .union(Features::COATED_LIGHTS)
    .union(Features::ENVIRONMENT)
    .union(Features::LIGHT_TREE)
    .union(Features::RANDOM_SURFACES)
    .union(Features::PORTALS);

/// Up to this many lights, each query weights the lights individually.
const MAX_LIGHTS: u32 = light_sampler::MAX_LIGHTS as u32;

/// Facts that kernels for a scene are specialized to, known before the scene is on the device.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneKind {
    /// Features that kernels must support.
    pub(crate) features: Features,
    /// Media features that kernels must support.
    pub(crate) media: MediaFeatures,
    /// Number of lights that kernels weight at each point; 0 if they are chosen by power alone.
    pub(crate) weighed: u32,
    /// Groups of lights that each have a shadow ray, if there are rays enough.
    pub(crate) light_groups: LightGroups,
    /// Whether triangles have vertex normals.
    pub(crate) has_vertex_normals: bool,
    /// [`roughest_caustic`] of the scene.
    pub(crate) roughest_caustic: f32,
    /// Whether the scene has [`Features::DELTA_LIGHTS`].
    pub(crate) has_lights_without_extent: bool,
}

impl SceneKind {
    pub(crate) fn of(view: &SceneView<'_>, required: &Requirements) -> Self {
        let present = Features::of(view);
        let unlit = if Self::has_light_tree(present, required) { Features::NONE } else { Features::LIGHT_TREE };
        // A lens is the view's: camera kernels add it.
        let absent = WITH_TABLES.without(present).union(unlit).union(Features::THIN_LENS);
        let mut without_table = MediaFeatures::NONE;
        without_table.set(MediaFeatures::BOUNDARIES, view.boundaries.is_empty());
        without_table.set(MediaFeatures::GRIDS, view.grids.grids.is_empty());
        let lights = view.lights.len() as u32;
        Self {
            features: required.features.without(absent),
            media: required.media.difference(without_table),
            weighed: if (2..=MAX_LIGHTS).contains(&lights) { lights } else { 0 },
            light_groups: LightGroups::new(view),
            has_vertex_normals: !view.shading.normals.is_empty(),
            roughest_caustic: roughest_caustic(view),
            has_lights_without_extent: present.intersects(Features::DELTA_LIGHTS),
        }
    }

    /// Whether lights are chosen by a tree, for a scene with these features.
    pub(super) fn has_light_tree(present: Features, required: &Requirements) -> bool {
        present.contains(Features::LIGHT_TREE) && required.samples_lights(present)
    }
}
