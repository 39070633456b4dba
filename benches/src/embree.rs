//! The part of Embree 3's interface that the comparison needs.
//!
//! Embree (Wald et al. 2014) is C++ that cargo does not build: the feature `embree`, which is off by
//! default, links the library of the system (Debian: `libembree-dev`). Layouts and numbers are those
//! of version 3.13.
#![allow(unsafe_code, reason = "a foreign library")]

use std::ffi::{c_char, c_void};
use std::ptr::{NonNull, null};

const TRIANGLES: u32 = 0;
const INDICES: u32 = 0;
const VERTICES: u32 = 1;
const UINT3: u32 = 0x5003;
const FLOAT3: u32 = 0x9003;
const ROBUST: u32 = 1 << 2;
const HIGH_QUALITY: u32 = 2;
const NOTHING: u32 = u32::MAX;

/// A ray, and after a call its hit: `RTCRayHit`.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
}

/// `RTCIntersectContext` of a library that was built for one level of instances.
#[repr(C)]
struct Context {
    flags: u32,
    filter: *const c_void,
    instance: u32,
    /// Space for what other builds of the library put here.
    spare: [u32; 5],
}

#[link(name = "embree3")]
unsafe extern "C" {
    fn rtcNewDevice(config: *const c_char) -> *mut c_void;
    fn rtcReleaseDevice(device: *mut c_void);
    fn rtcGetDeviceError(device: *mut c_void) -> u32;
    fn rtcNewScene(device: *mut c_void) -> *mut c_void;
    fn rtcReleaseScene(scene: *mut c_void);
    fn rtcSetSceneFlags(scene: *mut c_void, flags: u32);
    fn rtcSetSceneBuildQuality(scene: *mut c_void, quality: u32);
    fn rtcCommitScene(scene: *mut c_void);
    fn rtcNewGeometry(device: *mut c_void, kind: u32) -> *mut c_void;
    fn rtcReleaseGeometry(geometry: *mut c_void);
    fn rtcCommitGeometry(geometry: *mut c_void);
    fn rtcAttachGeometry(scene: *mut c_void, geometry: *mut c_void) -> u32;
    fn rtcSetNewGeometryBuffer(
        geometry: *mut c_void,
        kind: u32,
        slot: u32,
        format: u32,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    fn rtcIntersect1(scene: *mut c_void, context: *mut Context, ray: *mut RayHit);
}

/// A mesh in Embree's robust mode (`RTC_SCENE_FLAG_ROBUST`), built with high quality.
#[expect(missing_debug_implementations, reason = "pointers to what is foreign")]
pub struct Robust {
    device: NonNull<c_void>,
    scene: NonNull<c_void>,
}

impl Robust {
    /// Builds it. `None` if an index is out of range, or if Embree fails.
    #[must_use]
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        if triangles.iter().flatten().any(|&index| index as usize >= positions.len()) {
            return None;
        }
        // SAFETY: each pointer comes from Embree, is checked before it is used, and is released once,
        // by `Drop` or here; the buffers have the sizes asked for and are filled before the commit.
        unsafe {
            let device = NonNull::new(rtcNewDevice(null()))?;
            let Some(scene) = NonNull::new(rtcNewScene(device.as_ptr())) else {
                rtcReleaseDevice(device.as_ptr());
                return None;
            };
            let built = Self { device, scene };
            rtcSetSceneFlags(scene.as_ptr(), ROBUST);
            rtcSetSceneBuildQuality(scene.as_ptr(), HIGH_QUALITY);
            let geometry = NonNull::new(rtcNewGeometry(device.as_ptr(), TRIANGLES))?.as_ptr();
            let corners = rtcSetNewGeometryBuffer(geometry, VERTICES, 0, FLOAT3, 12, positions.len());
            let faces = rtcSetNewGeometryBuffer(geometry, INDICES, 0, UINT3, 12, triangles.len());
            if !corners.is_null() && !faces.is_null() {
                corners.cast::<[f32; 3]>().copy_from_nonoverlapping(positions.as_ptr(), positions.len());
                faces.cast::<[u32; 3]>().copy_from_nonoverlapping(triangles.as_ptr(), triangles.len());
                rtcCommitGeometry(geometry);
                rtcAttachGeometry(scene.as_ptr(), geometry);
                rtcCommitScene(scene.as_ptr());
            }
            rtcReleaseGeometry(geometry);
            (!corners.is_null() && !faces.is_null() && rtcGetDeviceError(device.as_ptr()) == 0).then_some(built)
        }
    }

    /// Distance and triangle of the nearest hit, in units of the direction's length.
    #[inline]
    #[must_use]
    pub fn nearest(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<(f32, u32)> {
        let mut ray = RayHit {
            origin,
            near: 0.0,
            direction,
            time: 0.0,
            far: f32::INFINITY,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: NOTHING,
            geometry: NOTHING,
            instance: NOTHING,
        };
        let mut context = Context { flags: 0, filter: null(), instance: NOTHING, spare: [0; 5] };
        // SAFETY: a committed scene, and two records of the expected layout, which outlive the call.
        unsafe { rtcIntersect1(self.scene.as_ptr(), &raw mut context, &raw mut ray) };
        (ray.geometry != NOTHING).then_some((ray.far, ray.primitive))
    }
}

impl Drop for Robust {
    fn drop(&mut self) {
        // SAFETY: created by `build`, and released only here.
        unsafe {
            rtcReleaseScene(self.scene.as_ptr());
            rtcReleaseDevice(self.device.as_ptr());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_those_of_the_header() {
        assert_eq!((size_of::<RayHit>(), align_of::<RayHit>()), (80, 16));
        assert_eq!(std::mem::offset_of!(RayHit, normal), 48);
        assert_eq!(std::mem::offset_of!(Context, instance), 16);
    }

    #[test]
    fn one_triangle() {
        let mesh = Robust::build(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]).unwrap();
        assert_eq!(mesh.nearest([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]), Some((2.0, 0)));
        assert_eq!(mesh.nearest([0.75, 0.75, 2.0], [0.0, 0.0, -1.0]), None);
    }
}
