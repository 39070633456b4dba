//! Cells in the space of a light's random numbers, and those whose photons could hit a sphere.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::ControlFlow;

use glam::{DVec2, DVec3, Vec3};

use super::clusters::Sphere;
use super::environment::{Cap, EnvironmentBeams, ProjectionDisc, slope};
use crate::parallel;
use crate::sampling;
use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::shading::light_cone::LightCone;

/// Bits of a cell for each number of a light's point and direction, with at most `most` in total.
pub(super) fn bits(light: &Light, most: u32) -> (u32, u32) {
    match light.kind {
        Light::POINT | Light::SPOT => (0, (most / 2).min(8)),
        Light::DIRECTIONAL => ((most / 2).min(8), 0),
        Light::ENVIRONMENT => {
            let direction = most / 4;
            ((most / 2 - direction).min(8), direction)
        }
        _ => {
            let direction = (most / 2).min(6);
            ((most / 2 - direction).min(3), direction)
        }
    }
}

/// Receives each marked cell, and returns whether to continue.
type Sink<'a> = &'a mut dyn FnMut(u32) -> ControlFlow<()>;

/// Calls `sink` with the cells of `light` from which a photon could hit one of `spheres`, and adds the
/// number of blocks of cells that were tested to `blocks`. There is a disc if the light is infinitely far away, and a cone if
/// photons leave it only towards the scene.
pub(super) fn mark(
    scene: &SceneView<'_>,
    light: &Light,
    bits: (u32, u32),
    (disc, cone): (Option<ProjectionDisc>, Option<LightCone>),
    spheres: &[Sphere],
    blocks: &mut u64,
    sink: Sink<'_>,
) -> ControlFlow<()> {
    let both = light.flags & Light::BOTH_SIDES != 0;
    let cells = 2 * (bits.0 + bits.1);
    let by_threads = cells >= PARALLEL_BITS && spheres.len() >= PARALLEL_SPHERES;
    for side in 0..if both { 2 } else { 1 } {
        let beams = &Beams::new(scene, light, side == 1, (disc, cone), bits.1);
        let near = (0..spheres.len() as u32).collect();
        let marking = Marking { beams, bits, side, spheres, near, blocks: 0 };
        if by_threads {
            marking.mark_by_threads(blocks, sink)?;
        } else {
            let mut marking = marking;
            let end = marking.descend(Block::default(), 0, sink);
            *blocks += marking.blocks;
            end?;
        }
    }
    ControlFlow::Continue(())
}

/// With fewer cells or spheres, several threads are not worth starting.
const PARALLEL_BITS: u32 = 14;
const PARALLEL_SPHERES: usize = 16;

/// Levels above the blocks that threads take, and how many of these are taken before their cells are received.
const COARSE: u32 = 4;
const BATCH: usize = 64;

/// A block of cells: its position among blocks of its size, for both numbers of the point and of the
/// direction, and the number of bits of each.
#[derive(Clone, Copy, Default)]
struct Block {
    point: [u32; 2],
    point_bits: u32,
    direction: [u32; 2],
    direction_bits: u32,
}

impl Block {
    /// Levels below the block of everything.
    fn level(&self) -> u32 {
        self.point_bits + self.direction_bits
    }

    /// Its four parts, for cells of `bits`: splits the point first, as far as there are bits, then the direction; those of
    /// an environment the other way round, since the disc of its points lies across the direction.
    fn quarters(self, bits: (u32, u32), direction_first: bool) -> [Self; 4] {
        let part = |[x, y]: [u32; 2], i: u32| [2 * x + (i >> 1), 2 * y + (i & 1)];
        let point = if direction_first { self.direction_bits == bits.1 } else { self.point_bits < bits.0 };
        [0, 1, 2, 3].map(|i| {
            if point {
                Self { point: part(self.point, i), point_bits: self.point_bits + 1, ..self }
            } else {
                Self { direction: part(self.direction, i), direction_bits: self.direction_bits + 1, ..self }
            }
        })
    }
}

#[derive(Clone)]
struct Marking<'a> {
    beams: &'a Beams,
    bits: (u32, u32),
    side: u32,
    spheres: &'a [Sphere],
    /// Indices of the spheres that the current blocks can hit, those of each block after its parent's.
    near: Vec<u32>,
    /// Number of blocks that were tested.
    blocks: u64,
}

impl Marking<'_> {
    /// As [`Self::descend`], by all cores: the same cells in the same order.
    fn mark_by_threads(mut self, blocks: &mut u64, sink: Sink<'_>) -> ControlFlow<()> {
        let mut coarse = Vec::new();
        self.collect(Block::default(), 0, &mut coarse);
        *blocks += self.blocks;
        for batch in coarse.chunks(BATCH) {
            let parts = parallel::map(parallel::threads(), batch.iter(), |_, (block, near)| {
                let mut own = Self { near: near.clone(), blocks: 0, ..self.clone() };
                let mut cells = Vec::new();
                let _ = own.descend(*block, 0, &mut |cell| {
                    cells.push(cell);
                    ControlFlow::Continue(())
                });
                (cells, own.blocks)
            });
            for (cells, tested) in parts {
                *blocks += tested;
                cells.into_iter().try_for_each(&mut *sink)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The blocks at level [`COARSE`] that can hit one of the spheres in `near` from `first` on, and these spheres, in the
    /// order of [`Self::descend`].
    fn collect(&mut self, block: Block, first: usize, coarse: &mut Vec<(Block, Vec<u32>)>) {
        if block.level() == COARSE {
            coarse.push((block, self.near[first..].to_vec()));
            return;
        }
        self.blocks += 1;
        let last = self.test(&block, first, false);
        if self.near.len() > last {
            for quarter in block.quarters(self.bits, self.beams.environment.is_some()) {
                self.collect(quarter, last, coarse);
            }
        }
        self.near.truncate(last);
    }

    /// Appends those of the spheres in `near` from `first` on that a block can hit, or only one of them, and returns the index
    /// of the first.
    fn test(&mut self, block: &Block, first: usize, one: bool) -> usize {
        let beam = self.beams.of(block);
        let last = self.near.len();
        for i in first..last {
            let sphere = self.near[i];
            if beam.meets(&self.spheres[sphere as usize]) {
                self.near.push(sphere);
                if one {
                    break;
                }
            }
        }
        last
    }

    /// Marks the cells of a block that can hit one of the spheres in `near` from `first` on.
    fn descend(&mut self, block: Block, first: usize, sink: Sink<'_>) -> ControlFlow<()> {
        self.blocks += 1;
        let whole = (block.point_bits, block.direction_bits) == self.bits;
        let last = self.test(&block, first, whole);
        if self.near.len() > last {
            if whole {
                let (p, q) = self.bits;
                let ([a, b], [c, d]) = (block.point, block.direction);
                sink((((self.side << p | a) << p | b) << q | c) << q | d)?;
            } else {
                for quarter in block.quarters(self.bits, self.beams.environment.is_some()) {
                    self.descend(quarter, last, sink)?;
                }
            }
        }
        self.near.truncate(last);
        ControlFlow::Continue(())
    }
}

/// Bounds on the rays of the photons of a block.
enum Beam<'a> {
    /// From a point in a sphere, within an angle to an axis; sine and cosine of the largest angle.
    Cone { from: Sphere, axis: DVec3, sin: f64, cos: f64 },
    /// Along a direction perpendicular to both axes, or within an angle to it whose tangent is `slope`, through a disc in
    /// the plane of both axes through `origin`; its centre is given in the coordinates of the axes.
    Tube { axes: [DVec3; 2], along: DVec3, origin: DVec3, centre: DVec2, radius: f64, slope: f64 },
    /// Along the directions of a cap, through a part of the disc of an environment.
    Environment { beams: &'a EnvironmentBeams, cap: &'a Cap, part: (DVec2, f64) },
}

impl Beam<'_> {
    /// Whether one of the rays could hit a sphere. Conservative: may return true if none does.
    fn meets(&self, sphere: &Sphere) -> bool {
        match self {
            Self::Cone { from, axis, sin, cos } => {
                let way = sphere.centre - from.centre;
                let squared = way.length_squared();
                let reach = sphere.radius + from.radius;
                // Squared length of a tangent from the cone's apex to the sphere; not positive if it starts
                // inside.
                let along = squared - reach * reach;
                if along <= 0.0 {
                    return true;
                }
                // The cosine of the sum of the beam's angle and that of the sphere, times the distance; it
                // decreases as the sum grows, up to half a turn.
                let along = along.sqrt();
                let least = cos * along - sin * reach;
                let more_than_half = sin * along + cos * reach <= 0.0;
                more_than_half || way.dot(*axis) >= least - 1e-12
            }
            Self::Tube { axes, along, origin, centre, radius, slope } => {
                let from_origin = sphere.centre - *origin;
                let at = DVec2::new(from_origin.dot(axes[0]), from_origin.dot(axes[1]));
                let aside = slope * (from_origin.dot(*along).abs() + sphere.radius);
                at.distance(*centre) <= radius + sphere.radius + aside
            }
            Self::Environment { beams, cap, part } => beams.meets(cap, *part, sphere),
        }
    }
}

/// Maps random numbers of a light to rays: the same as emission, with intervals.
struct Beams {
    light: Light,
    corners: [DVec3; 3],
    axis: DVec3,
    axes: [DVec3; 2],
    disc: Option<ProjectionDisc>,
    cone: Option<LightCone>,
    environment: Option<EnvironmentBeams>,
}

impl Beams {
    fn new(
        scene: &SceneView<'_>,
        light: &Light,
        back: bool,
        (disc, cone): (Option<ProjectionDisc>, Option<LightCone>),
        direction_bits: u32,
    ) -> Self {
        let area = light.kind == Light::TRIANGLE;
        let mut corners = [Vec3::from(light.position); 3];
        let axis = match (light.kind, cone) {
            (_, Some(cone)) => cone.axis,
            (Light::POINT | Light::ENVIRONMENT, None) => Vec3::Z,
            (Light::SPOT | Light::DIRECTIONAL, None) => Vec3::from(light.direction),
            _ => {
                let front = Vec3::from(scene.primitives[light.primitive as usize].normal);
                if back { -front } else { front }
            }
        };
        if area {
            corners = scene.triangles[light.primitive as usize].map(|v| Vec3::from(scene.positions[v as usize]));
        }
        let (tangent, bitangent) = sampling::basis(axis);
        Self {
            light: *light,
            corners: corners.map(Vec3::as_dvec3),
            // Small cells far away are compared by their cosines.
            axis: axis.as_dvec3().normalize_or_zero(),
            axes: [tangent.as_dvec3(), bitangent.as_dvec3()],
            disc,
            cone,
            environment: disc
                .filter(|_| light.kind == Light::ENVIRONMENT)
                .zip(scene.environment)
                .map(|(disc, map)| EnvironmentBeams::new(map, disc, direction_bits)),
        }
    }

    fn of(&self, block: &Block) -> Beam<'_> {
        let point = block.point.map(|at| interval(at, block.point_bits));
        if let Some(beams) = &self.environment {
            let cap = beams.cap(block.direction, block.direction_bits);
            return Beam::Environment { beams, cap, part: ring(point) };
        }
        let direction = block.direction.map(|at| interval(at, block.direction_bits));
        if let Some(disc) = &self.disc {
            let (scale, origin) = (f64::from(disc.radius), disc.centre.as_dvec3());
            let (centre, radius) = ring(point);
            let (axes, along, slope) = (self.axes, self.axis, slope(&self.light));
            return Beam::Tube { axes, along, origin, centre: centre * scale, radius: radius * scale, slope };
        }
        let (axis, angle) = self.cone(direction);
        let (sin, cos) = libm::sincos(angle.min(PI));
        Beam::Cone { from: self.origins(point), axis, sin, cos }
    }

    /// A sphere around the origins.
    fn origins(&self, [a, b]: [[f64; 2]; 2]) -> Sphere {
        let [p, q, r] = self.corners;
        if self.light.kind != Light::TRIANGLE {
            return Sphere { centre: p, radius: 0.0 };
        }
        // `sampling::triangle` is linear in v and in the square root of u: the points lie between four
        // corners.
        let at = |u: f64, v: f64| p + (q - p) * (u.sqrt() * (1.0 - v)) + (r - p) * (u.sqrt() * v);
        let ends = [at(a[0], b[0]), at(a[0], b[1]), at(a[1], b[0]), at(a[1], b[1])];
        let centre = (ends[0] + ends[1] + ends[2] + ends[3]) / 4.0;
        Sphere { centre, radius: ends.iter().map(|end| end.distance(centre)).fold(0.0, f64::max) }
    }

    /// An axis, and the largest angle of a direction to it.
    fn cone(&self, [height, turn]: [[f64; 2]; 2]) -> (DVec3, f64) {
        let [low, high] = height.map(|u| self.polar(u));
        if turn == [0.0, 1.0] {
            return (self.axis, high);
        }
        let middle = 0.5 * (low + high);
        let steepest = if low <= FRAC_PI_2 && high >= FRAC_PI_2 { 1.0 } else { libm::sin(low).max(libm::sin(high)) };
        // At most the length of the path that is linear in height and turn.
        let (along, around) = (0.5 * (high - low), steepest * PI * (turn[1] - turn[0]));
        let (sin, cos) = libm::sincos(PI * (turn[0] + turn[1]));
        let axis = (self.axes[0] * cos + self.axes[1] * sin) * libm::sin(middle) + self.axis * libm::cos(middle);
        (axis, libm::hypot(along, around))
    }

    /// The angle to the axis of a direction whose first number is `u`.
    fn polar(&self, u: f64) -> f64 {
        let from_versine = |versine: f64| 2.0 * libm::asin((0.5 * versine).max(0.0).sqrt().min(1.0));
        match (self.light.kind, self.cone) {
            (_, Some(cone)) => from_versine(f64::from(cone.versine) * u),
            (Light::POINT, None) => from_versine(2.0 * u),
            (Light::SPOT, None) => {
                let (inner, outer) = (self.light.versine_inner, self.light.versine_outer);
                let versine = if u < 1.0 { sampling::spot_versine(inner, outer, u as f32) } else { outer };
                from_versine(f64::from(versine))
            }
            _ => libm::asin(u.sqrt()),
        }
    }
}

/// A disc around the results of `sampling::disc` for intervals.
fn ring([u, v]: [[f64; 2]; 2]) -> (DVec2, f64) {
    let [low, high] = u.map(f64::sqrt);
    if v == [0.0, 1.0] {
        return (DVec2::ZERO, high);
    }
    let (sin, cos) = libm::sincos(0.5 * TAU * (v[0] + v[1]));
    let centre = DVec2::new(cos, sin) * (0.5 * (low + high));
    (centre, libm::hypot(0.5 * (high - low), high * PI * (v[1] - v[0])))
}

/// Interval `at` when the unit interval is divided into 2^`bits` equal ones.
fn interval(at: u32, bits: u32) -> [f64; 2] {
    let width = 1.0 / f64::from(1_u32 << bits);
    [f64::from(at) * width, f64::from(at + 1) * width]
}
