//! A scene on the device: its tables and its BVH.

use std::time::Instant;

use bytemuck::Pod;
use photon_core::glam::Vec3;
use photon_core::{
    Boundaries, Error, Features, LightCone, Locator, MediaFeatures, Requirements, Result, SceneView, Solids, Spectrum,
    light_probability, offset, parallel,
};
use photon_scene::CompressedTree;

use crate::device::Memory;
use crate::vulkan::Vulkan;

pub(crate) use kind::SceneKind;
#[cfg(test)]
pub(crate) use kind::WITH_TABLES;

/// Triangles uploaded at a time.
const BLOCK: usize = 1 << 20;

/// A scene on the device, ready for tracing.
#[derive(Debug)]
pub struct VulkanScene {
    /// One `SceneRef`, which holds the addresses of all tables.
    record: Memory,
    /// The tables that `record` points to.
    _tables: Vec<Memory>,
    /// Facts that kernels are specialized to.
    pub(crate) kind: SceneKind,
    /// Address and number of the portals.
    portals: (u64, u32),
    /// Labels and sizes in bytes of the tables.
    bytes: Vec<(&'static str, u64)>,
    /// Time to build the BVH on the CPU, in seconds.
    pub build_seconds: f64,
}

host_struct! {
    /// `SceneRef` of scene.glsl.
    struct SceneRef {
        nodes: u64,
        corners: u64,
        primitives: u64,
        materials: u64,
        lights: u64,
        light_cdf: u64,
        emissions: u64,
        media: u64,
        triangles: u32,
        light_count: u32,
        shading: u64,
        environment: u64,
        light_tree: u64,
        spectrum: u64,
        grids: u64,
        boundaries: u64,
    }
}

host_struct! {
    /// `BoundariesRef` of scene.glsl.
    struct BoundariesRef {
        nodes: u64,
        corners: u64,
        scale: f32,
        pad: u32,
    }
}

host_struct! {
    /// `Emission` of scene.glsl.
    struct Emission {
        carried: [f32; 3],
        probability: f32,
        a: [f32; 3],
        b: [f32; 3],
        c: [f32; 3],
        /// Of the triangle; of a point or spot light with photons in a [`LightCone`] its axis.
        normal: [f32; 3],
        /// Of the triangle; or the versine of the cone, 0 without one.
        margin: f32,
        /// Media that paths start in, on the front and on the back side.
        media: [u32; 2],
        /// Position of the triangle in BVH order.
        slot: u32,
    }
}

impl VulkanScene {
    /// # Errors
    /// As [`SceneView::validate`]; [`Error::MissingFeatures`]; [`Error::Backend`] if building the BVH fails;
    /// [`Error::OutOfMemory`].
    pub(crate) fn new(on: &mut Vulkan, view: &SceneView<'_>, required: &Requirements) -> Result<Self> {
        view.validate()?;
        let present = Features::of(view);
        required.check(present)?;
        let solids = Solids::of(view);
        required.check_media(solids.features())?;
        let inside = required.media.contains(MediaFeatures::NESTED) || required.features.contains(Features::ABSORPTION);
        let locator = inside.then(|| solids.locate());
        let (tree, build_seconds) = match on.tree.take().filter(|(tree, _)| tree.order.len() == view.triangles.len()) {
            Some(built) => built,
            None => {
                let start = Instant::now();
                let tree = tree(view.positions, view.triangles)?;
                let seconds = start.elapsed().as_secs_f64();
                (tree, seconds)
            }
        };
        let mut upload = Upload { on, tables: Vec::new(), bytes: Vec::new() };
        let nodes = upload.table("BVH nodes", &tree.nodes)?;
        let corners = upload.by_triangle("triangles", &tree.order, |id| corners(view, id))?;
        let primitives = upload.by_triangle("primitives", &tree.order, |id| view.primitives[id as usize])?;
        let cones = LightCone::of_lights(view);
        let mut emissions: Vec<Emission> =
            (0..view.lights.len()).map(|index| emission(view, index, &cones, locator.as_ref())).collect();
        if present.intersects(Features::TEXTURED_LIGHTS.union(Features::COATED_LIGHTS)) {
            let mut slots = vec![0; tree.order.len()];
            for (slot, &id) in (0..).zip(&tree.order) {
                slots[id as usize] = slot;
            }
            for (emission, light) in emissions.iter_mut().zip(view.lights) {
                emission.slot = slots.get(light.primitive as usize).copied().unwrap_or(0);
            }
        }
        let lit_by_tree = SceneKind::has_light_tree(present, required);
        let shading = shading::upload(&mut upload, view, &tree.order)?;
        let record = SceneRef {
            nodes,
            corners,
            primitives,
            materials: upload.table("materials", view.materials)?,
            lights: upload.table("lights", view.lights)?,
            light_cdf: upload.table("lights", view.light_cdf)?,
            emissions: upload.table("lights", &emissions)?,
            media: upload.table("media", view.media)?,
            triangles: view.triangles.len() as u32,
            light_count: view.lights.len() as u32,
            shading,
            environment: environment::upload(&mut upload, view)?,
            light_tree: if lit_by_tree { light_tree::upload(&mut upload, view)? } else { 0 },
            spectrum: if solids.features().contains(MediaFeatures::DISPERSION) {
                upload.table("media", Spectrum::get().cells())?
            } else {
                0
            },
            grids: grids::upload(&mut upload, view)?,
            boundaries: upload_boundaries(&mut upload, &view.boundaries)?,
        };
        let portals = match view.portals {
            [] => 0,
            portals => upload.table("portals", portals)?,
        };
        upload.table("scene", &[record])?;
        let Upload { mut tables, bytes, .. } = upload;
        let Some(record) = tables.pop() else { return Err(Error::DeviceLost) };
        let portals = (portals, view.portals.len() as u32);
        Ok(Self { record, _tables: tables, kind: SceneKind::of(view, required), portals, bytes, build_seconds })
    }

    /// Address of the record that is passed to kernels.
    pub(crate) fn address(&self) -> u64 {
        self.record.address()
    }

    /// Address and number of the portals; 0 without any.
    pub(crate) fn portals(&self) -> (u64, u32) {
        self.portals
    }

    /// Labels and sizes in bytes of everything the scene holds on the device.
    pub(crate) fn bytes(&self) -> &[(&'static str, u64)] {
        &self.bytes
    }
}

fn tree(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<CompressedTree> {
    CompressedTree::build(positions, triangles)
        .map_err(|source| Error::Backend { backend: "vulkan: building the BVH", source: Box::new(source) })
}

/// Uploads boundaries with a tree of their own; returns the address of their record, 0 without any. `w` of a triangle's first
/// vertex holds its index, of the second the medium behind it.
fn upload_boundaries(upload: &mut Upload<'_>, view: &Boundaries<'_>) -> Result<u64> {
    if view.is_empty() {
        return Ok(0);
    }
    let tree = tree(view.positions, view.triangles)?;
    let corners = |id: u32| {
        let [a, b, c] = view.triangles[id as usize].map(|vertex| view.positions[vertex as usize]);
        let with = |[x, y, z]: [f32; 3], w: u32| [x, y, z, f32::from_bits(w)];
        [with(a, id), with(b, view.media[id as usize]), with(c, 0)]
    };
    let record = BoundariesRef {
        nodes: upload.table("boundaries", &tree.nodes)?,
        corners: upload.by_triangle("boundaries", &tree.order, corners)?,
        scale: view.scale,
        pad: 0,
    };
    upload.table("scene", &[record])
}

/// Three vertices; `w` of the first holds the index of the triangle, of the second its margin, of the third 1 if its
/// material has alpha.
fn corners(view: &SceneView<'_>, id: u32) -> [[f32; 4]; 3] {
    let [a, b, c] = view.triangles[id as usize].map(|vertex| view.positions[vertex as usize]);
    let with = |[x, y, z]: [f32; 3], w: f32| [x, y, z, w];
    let has_alpha = view.materials[view.primitives[id as usize].material as usize].has_alpha();
    [with(a, f32::from_bits(id)), with(b, margin([a, b, c])), with(c, f32::from_bits(has_alpha.into()))]
}

fn margin(corners: [[f32; 3]; 3]) -> f32 {
    offset::margin(corners.map(Vec3::from))
}

/// The power that a path from this light carries, within its cone if it has one, and, for area lights, the triangle it starts
/// from.
fn emission(
    view: &SceneView<'_>,
    index: usize,
    cones: &[Option<LightCone>],
    locator: Option<&Locator<'_>>,
) -> Emission {
    let light = &view.lights[index];
    let share = light_probability(view.light_cdf, index);
    let cone = cones.get(index).and_then(Option::as_ref);
    let area = light.kind == photon_core::Light::TRIANGLE;
    let ([a, b, c], normal, margin) = if area {
        let primitive = light.primitive as usize;
        let corners = view.triangles[primitive].map(|vertex| view.positions[vertex as usize]);
        (corners, view.primitives[primitive].normal, margin(corners))
    } else {
        ([[0.0; 3]; 3], cone.map_or([0.0; 3], |cone| cone.axis.into()), cone.map_or(0.0, |cone| cone.versine))
    };
    let per_path = cone.map_or(1.0, |cone| cone.share(light)) / share;
    let carried = light.power.map(|power| (f64::from(power) * per_path) as f32);
    let media = locator.map_or([0; 2], |locator| locator.of_light(light).map(|stack| stack.bits()));
    Emission { carried, probability: share as f32, a, b, c, normal, margin, media, slot: 0 }
}

/// Tables being uploaded.
struct Upload<'a> {
    on: &'a mut Vulkan,
    tables: Vec<Memory>,
    bytes: Vec<(&'static str, u64)>,
}

impl Upload<'_> {
    /// Allocates a table of `length` elements, to be written later, and returns its address.
    fn room<T>(&mut self, label: &'static str, length: usize) -> Result<u64> {
        let bytes = (length * size_of::<T>()) as u64;
        let memory = self.on.memory(label, bytes).map_err(|error| match error {
            Error::OutOfMemory { bytes, .. } => Error::OutOfMemory { label, bytes },
            other => other,
        })?;
        let address = memory.address();
        self.bytes.push((label, memory.bytes()));
        self.tables.push(memory);
        Ok(address)
    }

    fn write<T: Pod>(&mut self, first: usize, part: &[T]) -> Result<()> {
        let Some(memory) = self.tables.last() else { return Ok(()) };
        self.on.write(memory, (first * size_of::<T>()) as u64, bytemuck::cast_slice(part))
    }

    fn table<T: Pod>(&mut self, label: &'static str, table: &[T]) -> Result<u64> {
        let address = self.room::<T>(label, table.len())?;
        for (block, part) in table.chunks(BLOCK).enumerate() {
            self.write(block * BLOCK, part)?;
        }
        Ok(address)
    }

    /// A table with one entry per triangle, in BVH order.
    fn by_triangle<T: Pod + Send>(
        &mut self,
        label: &'static str,
        order: &[u32],
        entry: impl Fn(u32) -> T + Sync,
    ) -> Result<u64> {
        let address = self.room::<T>(label, order.len())?;
        for (block, ids) in order.chunks(BLOCK).enumerate() {
            let part: Vec<T> = parallel::collect(ids.len(), |i| entry(ids[i]));
            self.write(block * BLOCK, &part)?;
        }
        Ok(address)
    }
}

mod environment;
mod grids;
mod kind;
mod light_tree;
mod shading;
#[cfg(test)]
mod silhouette;
#[cfg(test)]
mod tests;
