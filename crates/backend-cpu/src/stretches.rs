//! Media along rays: all that attenuates light is found here.

use std::cell::RefCell;

use photon_core::glam::Vec3;
use photon_core::{
    Boundaries, Columns, Enclosing, Features, Hit, Medium, MediumStack, Ray, RayCaster as _, Result, Segment,
    boundary_crossing, flight,
};
use photon_scene::Accel;

use crate::scene::{CpuScene, accel};

/// Part of a ray in one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Distance of its start from the origin of the ray.
    pub(crate) from: f32,
    /// Distance of its end.
    pub(crate) to: f32,
    /// Index of the medium.
    pub(crate) medium: u32,
    /// Unit normals of the boundaries at its start and its end, along the ray; `None` where there is none.
    pub(crate) planes: [Option<Vec3>; 2],
}

/// The boundaries of a scene, with a tree of their own.
pub(crate) struct CpuBoundaries {
    accel: Accel,
    /// Vertices, and the index of the medium behind.
    triangles: Vec<([Vec3; 3], u32)>,
    scale: f32,
}

/// A ray crosses a boundary.
#[derive(Clone, Copy)]
struct Crossing {
    t: f32,
    triangle: u32,
    /// 1 where the medium is entered, -1 where it is left.
    sign: i32,
}

impl CpuBoundaries {
    /// `None` without any.
    pub(crate) fn new(view: &Boundaries<'_>, threads: usize) -> Result<Option<Self>> {
        if view.is_empty() {
            return Ok(None);
        }
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| Vec3::from(view.positions[vertex as usize]));
        let triangles = view.triangles.iter().map(corners).zip(view.media.iter().copied()).collect();
        Ok(Some(Self { accel: accel(view.positions, view.triangles, threads)?, triangles, scale: view.scale }))
    }

    /// Bytes of the tree and the triangles.
    pub(crate) fn bytes(&self) -> u64 {
        self.accel.bytes() + size_of_val(self.triangles.as_slice()) as u64
    }

    /// All crossings of a ray, however far away, in order.
    fn crossings(&self, ray: &Ray) -> Vec<Crossing> {
        let scaled = Boundaries::scaled(self.scale, &Ray { t_max: f32::INFINITY, ..*ray });
        let found = RefCell::new(Vec::new());
        let note = |hit: &Hit| {
            let sign = boundary_crossing(&scaled, self.triangles[hit.primitive as usize].0);
            if sign != 0 {
                found.borrow_mut().push(Crossing { t: hit.t * self.scale, triangle: hit.primitive, sign });
            }
            false
        };
        // Nothing is kept, so that every hit is seen; this caster passes any number of them.
        let _ = self.accel.nearest_where(&scaled, &note);
        let mut found = found.into_inner();
        found.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        found
    }

    /// Unit normal of a triangle, along `direction`.
    fn normal(&self, triangle: u32, direction: Vec3) -> Vec3 {
        let ([a, b, c], _) = self.triangles[triangle as usize];
        let normal = (b - a).cross(c - a).normalize_or(direction);
        if normal.dot(direction) < 0.0 { -normal } else { normal }
    }
}

/// The parts of a ray, in order.
struct Stretches<'a> {
    boundaries: Option<&'a CpuBoundaries>,
    media: &'a [Medium],
    /// Index of the medium of the solids around the ray.
    solid: u32,
    direction: Vec3,
    /// Boundaries around the ray after those crossings that are not in `rest`.
    around: Enclosing,
    rest: std::vec::IntoIter<Crossing>,
    /// Start of the next part, and the boundary there.
    from: f32,
    plane: Option<Vec3>,
    end: f32,
    is_done: bool,
}

impl Iterator for Stretches<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        if self.is_done {
            return None;
        }
        let mut medium = self.around.current(self.media, self.solid);
        if let Some(boundaries) = self.boundaries {
            while let Some(&crossing) = self.rest.as_slice().first()
                && crossing.t < self.end - flight::SHORTEST_STRETCH
            {
                let _ = self.rest.next();
                self.around.add(boundaries.triangles[crossing.triangle as usize].1, crossing.sign);
                let beyond = self.around.current(self.media, self.solid);
                if beyond == medium {
                    continue;
                }
                let normal = Some(boundaries.normal(crossing.triangle, self.direction));
                let plane = std::mem::replace(&mut self.plane, normal);
                // Boundaries may coincide.
                if crossing.t > self.from + flight::SHORTEST_STRETCH {
                    let from = std::mem::replace(&mut self.from, crossing.t);
                    return Some(Stretch { from, to: crossing.t, medium, planes: [plane, normal] });
                }
                medium = beyond;
            }
        }
        self.is_done = true;
        let to = if self.end == f32::INFINITY { self.from + flight::FAR } else { self.end };
        Some(Stretch { from: self.from, to, medium, planes: [self.plane, None] })
    }
}

impl CpuScene {
    /// The parts of a ray that starts in the solids `media`, in order; `end` is the distance of its first surface, infinite
    /// without one.
    #[inline]
    pub(crate) fn stretches(&self, ray: &Ray, end: f32, media: MediumStack) -> impl Iterator<Item = Stretch> {
        let boundaries = self.boundaries.as_ref();
        let crossings = boundaries.map_or_else(Vec::new, |boundaries| boundaries.crossings(ray));
        // Whatever the ray leaves more often than it enters it, it starts in.
        let mut around = Enclosing::default();
        if let Some(boundaries) = boundaries {
            for crossing in &crossings {
                around.add(boundaries.triangles[crossing.triangle as usize].1, -crossing.sign);
            }
        }
        Stretches {
            boundaries,
            media: self.media(),
            solid: self.solid(media),
            direction: ray.direction,
            around,
            rest: crossings.into_iter(),
            from: 0.0,
            plane: None,
            end,
            is_done: false,
        }
    }

    /// Integral of the density along a part of a ray: its length, where the medium is homogeneous.
    #[inline]
    pub(crate) fn column(&self, ray: &Ray, stretch: &Stretch) -> f32 {
        match self.grids.view().of(stretch.medium) {
            None => stretch.to - stretch.from,
            Some(density) => density.column(ray.origin, ray.direction, [stretch.from, stretch.to]),
        }
    }

    /// Goes along a part of a ray from the distance `from` on until the column is `limit`: the column, and the distance from the
    /// origin of the ray; all of it, if that is less.
    #[inline]
    pub(crate) fn until(&self, ray: &Ray, stretch: &Stretch, from: f32, limit: f32) -> (f32, f32) {
        let to = stretch.to;
        match self.grids.view().of(stretch.medium) {
            None if limit < to - from => (limit, from + limit),
            None => (to - from, to),
            Some(density) => density.until(ray.origin, ray.direction, [from, to], limit),
        }
    }

    /// The grid of a medium, if it has one, and whether that is thick: [`Density::is_thick`].
    #[inline]
    pub(crate) fn grid(&self, medium: u32) -> Option<bool> {
        Some(self.grids.view().of(medium)?.is_thick(self.medium_at(medium)))
    }

    /// The columns along a segment in the medium with this index; `None` if it is homogeneous.
    #[inline]
    pub(crate) fn columns(&self, segment: &Segment, medium: u32) -> Option<Columns<'_>> {
        let density = self.grids.view().of(medium)?;
        Some(Columns::new(density, segment.origin, segment.direction, segment.length))
    }

    /// Transmittance per channel of a part of a ray.
    #[inline]
    pub(crate) fn stretch_transmittance(&self, ray: &Ray, stretch: &Stretch) -> Vec3 {
        flight::transmittance(self.medium_at(stretch.medium), self.column(ray, stretch))
    }

    /// Transmittance per channel of a ray that starts in the solids `media` and meets no surface before the distance `end`.
    #[inline]
    pub(crate) fn transmittance(&self, ray: &Ray, end: f32, media: MediumStack) -> Vec3 {
        self.stretches(ray, end, media).map(|stretch| self.stretch_transmittance(ray, &stretch)).product()
    }

    /// Transmittance as of [`Self::transmittance`]; 1 immediately if nothing in the scene attenuates light.
    #[inline]
    pub(crate) fn attenuation(&self, ray: &Ray, end: f32, media: MediumStack) -> Vec3 {
        if !self.features.contains(Features::ABSORPTION) || !self.may_attenuate(media) {
            return Vec3::ONE;
        }
        self.transmittance(ray, end, media)
    }
}
