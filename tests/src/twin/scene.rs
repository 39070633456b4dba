//! A scene in f64, with the user's numbers unrounded or with the shipped f32 numbers.

use photon_core::glam::{DVec3, Vec3};
use photon_core::{Light, LightCone, Material, Medium, MediumStack, Solids};
use photon_scene::shapes::Shape;
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

use super::tree::Tree;

/// A scene as the user described it, beside what the builder makes of it.
#[derive(Clone, Debug, Default)]
pub struct Described {
    /// Meshes with their materials, in user space.
    pub meshes: Vec<(Shape, MaterialDesc)>,
    /// Lights other than emissive surfaces.
    pub lights: Vec<LightDesc>,
}

impl Described {
    /// A builder of it, without a camera.
    #[must_use]
    pub fn builder(&self) -> SceneBuilder {
        let mut builder = SceneBuilder::new();
        for (index, ((positions, triangles), material)) in self.meshes.iter().enumerate() {
            let id = builder.material(material.clone());
            builder.mesh(format!("mesh {index}"), positions.clone(), triangles.clone(), id);
        }
        for (index, light) in self.lights.iter().enumerate() {
            builder.light(format!("light {index}"), light.clone());
        }
        builder
    }

    /// The same scene as if its coordinates had been stored in 32 bits.
    #[must_use]
    pub fn stored_narrow(&self) -> Self {
        let narrow = |p: [f64; 3]| p.map(|x| f64::from(x as f32));
        let mut stored = self.clone();
        for p in stored.meshes.iter_mut().flat_map(|((positions, _), _)| positions) {
            *p = narrow(*p);
        }
        for light in &mut stored.lights {
            if let LightDesc::Point { position, .. } | LightDesc::Spot { position, .. } = light {
                *position = narrow(*position);
            }
        }
        stored
    }
}

/// The tables of a scene in f64, in normalised space.
#[derive(Clone, Debug)]
pub struct Wide {
    pub(crate) triangles: Vec<[DVec3; 3]>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) material_of: Vec<u32>,
    /// Colours, indices and powers are 32-bit input for both.
    pub(crate) materials: Vec<Material>,
    pub(crate) media: Vec<Medium>,
    /// The media in which photons from each light start, on its front and on its back.
    pub(crate) light_media: Vec<[MediumStack; 2]>,
    pub(crate) lights: Vec<Light>,
    pub(crate) light_places: Vec<DVec3>,
    pub(crate) light_cdf: Vec<u32>,
    pub(crate) light_cones: Vec<Option<LightCone>>,
    pub(crate) tree: Tree,
    /// Distance by which rays are offset from surfaces along their normals: against the rounding of f64, unless set
    /// otherwise. Points keep twice that distance from edges.
    pub step: f64,
}

impl Wide {
    /// The shipped numbers, each converted to f64: what differs from the shipped code is the arithmetic alone.
    #[must_use]
    pub fn rounded(scene: &Scene) -> Self {
        let view = scene.view();
        let corner = |&index: &u32| Vec3::from(view.positions[index as usize]).as_dvec3();
        let triangles: Vec<[DVec3; 3]> =
            view.triangles.iter().map(|triangle| std::array::from_fn(|i| corner(&triangle[i]))).collect();
        Self {
            normals: view
                .primitives
                .iter()
                .map(|primitive| Vec3::from(primitive.normal).as_dvec3().normalize_or_zero())
                .collect(),
            light_places: view.lights.iter().map(|light| Vec3::from(light.position).as_dvec3()).collect(),
            ..Self::with(scene, triangles)
        }
    }

    /// The user's numbers, transformed to normalised space without rounding them to f32.
    ///
    /// No triangle and no light may have been dropped.
    #[must_use]
    pub fn exact(scene: &Scene, described: &Described) -> Self {
        let units = scene.units();
        let place = |p: [f64; 3]| (DVec3::from(p) - DVec3::from(units.center)) / units.scale;
        // The builder sorts meshes and lights by what they are.
        let sources = scene.triangle_sources().map(|(mesh, triangle)| {
            let ((positions, indices), _) = &described.meshes[mesh as usize];
            indices[triangle as usize].map(|index| place(positions[index as usize]))
        });
        let triangles: Vec<_> = sources.collect();
        let all: usize = described.meshes.iter().map(|((_, indices), _)| indices.len()).sum();
        assert_eq!(triangles.len(), all, "a triangle was dropped");
        let mut wide = Self::with(scene, triangles);
        let surfaces = wide.lights.iter().filter(|light| light.kind == Light::TRIANGLE).count();
        wide.light_places = vec![DVec3::ZERO; surfaces];
        assert_eq!(surfaces + described.lights.len(), wide.lights.len(), "a light was dropped");
        let places: Vec<DVec3> = described
            .lights
            .iter()
            .filter_map(|light| match *light {
                LightDesc::Point { position, .. } | LightDesc::Spot { position, .. } => Some(place(position)),
                LightDesc::Directional { .. } => None,
                ref other => panic!("the twin has no such light: {other:?}"),
            })
            .collect();
        let exact = |light: &Light| {
            let rounded = Vec3::from(light.position).as_dvec3();
            let gap = |place: &&DVec3| place.distance_squared(rounded);
            let nearest = places.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
            nearest.copied().filter(|_| light.kind != Light::DIRECTIONAL).unwrap_or_default()
        };
        wide.light_places.extend(wide.lights[surfaces..].iter().map(exact));
        wide
    }

    /// The point with these weights of the second and third vertex, moved away from every edge by two steps, but by
    /// no more than a sixteenth of the triangle, as in `offset::within`.
    pub(crate) fn point(&self, primitive: usize, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.triangles[primitive];
        let margin = 2.0 * self.step;
        let above = [(a, b, c), (b, c, a), (c, a, b)].map(|(corner, from, to)| {
            let along = (corner - from).dot(to - from) / (to - from).length_squared();
            let height = corner - from - (to - from) * along;
            ((margin / height.abs().max_element()).min(1.0 / 16.0), along.clamp(0.0, 1.0))
        });
        let mut weights = [1.0 - u - v, u, v];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let lack = above[i].0 - weights[i];
            if lack > 0.0 {
                let spare = [j, k].map(|other| (weights[other] - above[other].0).max(0.0));
                let first = (lack * (1.0 - above[i].1)).max(lack - spare[1]).min(spare[0]);
                weights[i] += lack;
                weights[j] -= first;
                weights[k] -= lack - first;
            }
        }
        let way = (b - a) * (weights[1] - u) + (c - a) * (weights[2] - v);
        let length = way.abs().max_element();
        let limit = if length > 4.0 * margin { 4.0 * margin / length } else { 1.0 };
        a * (1.0 - u - v) + b * u + c * v + way * limit
    }

    fn with(scene: &Scene, triangles: Vec<[DVec3; 3]>) -> Self {
        let view = scene.view();
        let solids = Solids::of(&view);
        let locator = solids.locate();
        let normals = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).normalize_or_zero()).collect();
        Self {
            normals,
            material_of: view.primitives.iter().map(|primitive| primitive.material).collect(),
            materials: view.materials.to_vec(),
            media: view.media.to_vec(),
            light_media: view.lights.iter().map(|light| locator.of_light(light)).collect(),
            lights: view.lights.to_vec(),
            light_places: Vec::new(),
            light_cdf: view.light_cdf.to_vec(),
            light_cones: LightCone::of_lights(&view),
            tree: Tree::new(triangles.clone()),
            triangles,
            step: 1e-14,
        }
    }
}
