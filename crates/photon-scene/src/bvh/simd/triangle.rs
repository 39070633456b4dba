//! The watertight ray-triangle test (Woop, Benthin and Wald 2013), four triangles at a time.

use glam::{BVec4A, DVec3, Vec4};
use photon_core::Ray;

use crate::bvh::CompressedTree;

/// Triangles per packet.
pub(crate) const LANES: usize = 4;

/// Vertices of four triangles, by vertex, axis, lane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    pub(crate) vertices: [[[f32; LANES]; 3]; 3],
    /// Index of each triangle; `u32::MAX` for an empty lane.
    pub(crate) ids: [u32; LANES],
}

impl Packet {
    /// A packet of up to four triangles. Spare lanes repeat the first triangle under the empty index, so that they
    /// take the same path through the test and never count.
    pub(crate) fn of(ids: &[u32], corners: &dyn Fn(u32) -> [[f32; 3]; 3]) -> Self {
        let mut packet = Self { vertices: [[[0.0; LANES]; 3]; 3], ids: [u32::MAX; LANES] };
        for lane in 0..LANES {
            let id = ids.get(lane).copied();
            if let Some(shown) = id.or(ids.first().copied()) {
                packet.set(lane, id.unwrap_or(u32::MAX), corners(shown));
            }
        }
        packet
    }

    fn set(&mut self, lane: usize, id: u32, corners: [[f32; 3]; 3]) {
        self.ids[lane] = id;
        for (vertex, corner) in self.vertices.iter_mut().zip(corners) {
            for (axis, value) in vertex.iter_mut().zip(corner) {
                axis[lane] = value;
            }
        }
    }
}

/// A ray in the coordinate frame of the test: sheared so that it runs along its largest axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheared {
    axes: [usize; 3],
    shear: [f32; 3],
    origin: [f32; 3],
}

impl Sheared {
    /// `None` for a ray with zero direction or with components that are not finite.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let d = ray.direction.to_array();
        let [x, y, z] = d.map(f32::abs);
        let kz = if x > y {
            if x > z { 0 } else { 2 }
        } else if y > z {
            1
        } else {
            2
        };
        // NaN, infinity and a zero direction fail here.
        if !(ray.direction.is_finite() && ray.origin.is_finite() && d[kz] != 0.0) {
            return None;
        }
        let (kx, ky) = match kz {
            0 => (1, 2),
            1 => (2, 0),
            _ => (0, 1),
        };
        // Swapping preserves the winding, and with it the sign of the edge functions.
        let (kx, ky) = if d[kz] < 0.0 { (ky, kx) } else { (kx, ky) };
        Some(Self {
            axes: [kx, ky, kz],
            shear: [d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]],
            origin: ray.origin.to_array(),
        })
    }
}

/// Result of testing one packet of four triangles.
pub(crate) struct Found {
    /// Bit mask of the lanes that are hit; the numbers of other lanes are meaningless.
    pub(crate) hits: u32,
    /// Distance.
    pub(crate) t: [f32; LANES],
    /// Edge functions: each is the weight of the opposite vertex times their sum.
    edges: [Vec4; 3],
    determinant: Vec4,
}

impl Found {
    /// Barycentric weights of the second and third vertex. Computed only for the closest hits: saves two divisions.
    #[inline(always)]
    pub(crate) fn weights(&self, lane: usize) -> [f32; 2] {
        let of = |v: Vec4| v.to_array()[lane % LANES];
        [of(self.edges[1]) / of(self.determinant), of(self.edges[2]) / of(self.determinant)]
    }
}

/// Tests a packet, for hits at `0 ≤ t ≤ far`. Both sides count; edges and vertices belong to every
/// adjacent triangle, so that no ray passes between two.
///
/// Two triangles that share an edge compute the same two products for it, and their difference with
/// opposite sign: rounding cannot put the ray outside of both. Where a difference is zero it is
/// recomputed in f64, in which products of f32 are exact. A port without f64 may take the sign from
/// the products' rounding errors instead.
#[inline(always)]
pub(crate) fn intersect(packet: &Packet, ray: &Sheared, far: f32) -> Found {
    let [kx, ky, kz] = ray.axes;
    let [sx, sy, sz] = ray.shear.map(Vec4::splat);
    let [ox, oy, oz] = [ray.origin[kx], ray.origin[ky], ray.origin[kz]].map(Vec4::splat);
    let mut x = [Vec4::ZERO; 3];
    let mut y = [Vec4::ZERO; 3];
    let mut z = [Vec4::ZERO; 3];
    for (vertex, corner) in packet.vertices.iter().enumerate() {
        let of = |axis: usize| Vec4::from_array(corner[axis]);
        let height = of(kz) - oz;
        x[vertex] = (of(kx) - ox) - sx * height;
        y[vertex] = (of(ky) - oy) - sy * height;
        z[vertex] = sz * height;
    }
    let mut e = [x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]];
    let zero = Vec4::ZERO;
    let vanishes: BVec4A = e[0].cmpeq(zero) | e[1].cmpeq(zero) | e[2].cmpeq(zero);
    if vanishes.any() {
        again(&x, &y, &mut e);
    }
    let [u, v, w] = e;
    let determinant = u + v + w;
    let left = u.cmpge(zero) & v.cmpge(zero) & w.cmpge(zero);
    let right = u.cmple(zero) & v.cmple(zero) & w.cmple(zero);
    // A determinant of 0 would give a distance that is infinite or NaN.
    let met = (left | right) & determinant.cmpne(zero);
    if !met.any() {
        return Found { hits: 0, t: [0.0; LANES], edges: e, determinant };
    }
    let mut t = (u * z[0] + v * z[1] + w * z[2]) / determinant;
    // A weighted mean of numbers of one sign has that sign.
    let straddles = z[0].min(z[1]).min(z[2]).cmple(Vec4::splat(PLANE_TOLERANCE))
        & z[0].max(z[1]).max(z[2]).cmpge(Vec4::splat(-PLANE_TOLERANCE));
    let unsure = met & straddles;
    if unsure.any() {
        side(packet, ray, unsure, &mut t);
    }
    let there = met & t.cmpge(zero) & t.cmple(Vec4::splat(far));
    Found { hits: there.bitmask(), t: t.to_array(), edges: e, determinant }
}

/// The intersection test is the same on GPUs.
const PLANE_TOLERANCE: f32 = CompressedTree::PLANE_TOLERANCE;

/// Recomputes the distances of triangles around the origin, in f64 and from their planes. As means of the vertices'
/// distances, those of slivers are off by more than the offset of rays from surfaces, so that a ray hit the triangle
/// that it had just left and ended behind it. In a drum of 512 sides that happened to 7 of 10⁴ diffuse bounces.
#[inline(never)]
fn side(packet: &Packet, ray: &Sheared, lanes: BVec4A, t: &mut Vec4) {
    // Without `map` of arrays, which is not always inlined.
    let [first, second, third] = [ray.axes[0] % 3, ray.axes[1] % 3, ray.axes[2] % 3];
    let wide = |x: f32, y: f32, z: f32| DVec3::new(f64::from(x), f64::from(y), f64::from(z));
    let origin = wide(ray.origin[first], ray.origin[second], ray.origin[third]);
    let [x, y, z] = ray.shear;
    let direction = wide(x, y, 1.0) / f64::from(z);
    for lane in (0..LANES).filter(|lane| lanes.bitmask() >> lane & 1 == 1) {
        let corner = |at: usize| {
            let corner = &packet.vertices[at];
            wide(corner[first][lane], corner[second][lane], corner[third][lane])
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let normal = (b - a).cross(c - a);
        let along = normal.dot(direction);
        if along != 0.0 {
            t[lane] = (normal.dot(a - origin) / along) as f32;
        }
    }
}

/// Recomputes in f64 the lanes in which an edge function was zero.
#[cold]
#[inline(never)]
fn again(x: &[Vec4; 3], y: &[Vec4; 3], e: &mut [Vec4; 3]) {
    for lane in 0..LANES {
        if e.iter().all(|edge| edge[lane] != 0.0) {
            continue;
        }
        for edge in 0..3 {
            let (b, c) = ((edge + 1) % 3, (edge + 2) % 3);
            let wide = |a: f32, b: f32| f64::from(a) * f64::from(b);
            e[edge][lane] = (wide(x[c][lane], y[b][lane]) - wide(y[c][lane], x[b][lane])) as f32;
        }
    }
}
