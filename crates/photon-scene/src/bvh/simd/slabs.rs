//! Slab tests: where a ray enters the eight boxes of a node.

use photon_core::Ray;

use super::node::{Node, WIDTH};

/// Slab distances are widened by this factor on either side, so that rounding never makes a ray miss a box
/// that contains a triangle on its face (after Ize 2013).
const WIDER: f32 = 1.0 + 8.0 * f32::EPSILON;
const NARROWER: f32 = 1.0 - 8.0 * f32::EPSILON;

/// Distances at which a ray enters the boxes of a node, and the bit mask of those that it enters.
pub(crate) type Entered = ([f32; WIDTH], u32);

/// A ray as slab tests need it.
pub(crate) struct Slabs {
    origin: [f32; 3],
    /// Infinite where the direction is 0: such a slab is either always or never entered.
    inverse: [f32; 3],
    /// Index of the nearer bound of each axis.
    near: [usize; 3],
}

impl Slabs {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.to_array().map(|d| 1.0 / d);
        let near = std::array::from_fn(|axis| 2 * axis + usize::from(inverse[axis].is_sign_negative()));
        Self { origin: ray.origin.to_array(), inverse, near }
    }

    /// The boxes of a node that the ray enters no farther than `far`.
    #[inline(always)]
    pub(crate) fn enter(&self, node: &Node, far: f32) -> Entered {
        let (mut enter, mut leave) = ([0.0_f32; WIDTH], [far; WIDTH]);
        for axis in 0..3 {
            let (first, last) = (&node.bounds[self.near[axis]], &node.bounds[self.near[axis] ^ 1]);
            for lane in 0..WIDTH {
                let a = (first[lane] - self.origin[axis]) * self.inverse[axis];
                let b = (last[lane] - self.origin[axis]) * self.inverse[axis];
                // 0·∞ is NaN, which neither comparison takes: the ray runs within that face.
                enter[lane] = if a > enter[lane] { a } else { enter[lane] };
                leave[lane] = if b < leave[lane] { b } else { leave[lane] };
            }
        }
        let mut mask = 0;
        for lane in 0..WIDTH {
            enter[lane] *= NARROWER;
            mask |= u32::from(enter[lane] <= leave[lane] * WIDER) << lane;
        }
        (enter, mask)
    }

    /// [`Self::enter`] in half of the instructions that the compiler makes of it.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(crate) fn enter_avx2(&self, node: &Node, far: f32) -> Entered {
        use std::arch::x86_64::{
            __m256, _CMP_LE_OQ, _mm256_cmp_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
            _mm256_set1_ps, _mm256_setzero_ps, _mm256_sub_ps,
        };
        let (mut enter, mut leave) = (_mm256_setzero_ps(), _mm256_set1_ps(far));
        for axis in 0..3 {
            let along = |bound: &[f32; WIDTH]| {
                let from = _mm256_sub_ps(bytemuck::cast::<_, __m256>(*bound), _mm256_set1_ps(self.origin[axis]));
                _mm256_mul_ps(from, _mm256_set1_ps(self.inverse[axis]))
            };
            // Of a NaN and a number, both give the second, the number.
            enter = _mm256_max_ps(along(&node.bounds[self.near[axis]]), enter);
            leave = _mm256_min_ps(along(&node.bounds[self.near[axis] ^ 1]), leave);
        }
        enter = _mm256_mul_ps(enter, _mm256_set1_ps(NARROWER));
        leave = _mm256_mul_ps(leave, _mm256_set1_ps(WIDER));
        let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave));
        (bytemuck::cast(enter), mask as u32)
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use photon_core::glam::Vec3;

    use super::*;
    use crate::bvh::simd::node::Child;

    /// Both versions give the same bits: rays along faces, within them, from them, away from boxes, and past empty slots.
    #[test]
    fn versions_are_alike() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            eprintln!("skipped: the processor has no AVX2");
            return;
        }
        #[target_feature(enable = "avx2")]
        fn by_avx2(slabs: &Slabs, node: &Node, far: f32) -> Entered {
            slabs.enter_avx2(node, far)
        }
        const NUMBERS: [f32; 7] = [-1.0, -0.25, -0.0, 0.0, 0.25, 1.0, 1e-30];
        let (mut entered, mut cases) = (0, 0);
        for case in 0..20_000_usize {
            let number = |at: usize| NUMBERS[(case * 31 + at * at * 7 + case / 7 * at) % NUMBERS.len()];
            let mut node = Node { bounds: [[0.0; WIDTH]; 6], children: [Child::default(); WIDTH] };
            for lane in 0..WIDTH {
                for axis in 0..3 {
                    let [a, b] = [number(lane + axis), number(3 * lane + axis + 1)];
                    // The last slot is empty.
                    let bounds =
                        if lane + 1 < WIDTH { [a.min(b), a.max(b)] } else { [f32::INFINITY, f32::NEG_INFINITY] };
                    [node.bounds[2 * axis][lane], node.bounds[2 * axis + 1][lane]] = bounds;
                }
            }
            let vector = |at: usize| Vec3::new(number(at), number(at + 1), number(at + 2));
            let ray = Ray { origin: vector(5), direction: vector(case % 11), t_max: f32::INFINITY };
            let slabs = Slabs::new(&ray);
            for far in [f32::INFINITY, 1.0, 0.0] {
                #[allow(
                    unsafe_code,
                    reason = "a function compiled for more than the baseline can be called in no other way"
                )]
                // SAFETY: the processor has AVX2, see above.
                let (entry, mask) = unsafe { by_avx2(&slabs, &node, far) };
                let (expected, boxes) = slabs.enter(&node, far);
                assert_eq!(entry.map(f32::to_bits), expected.map(f32::to_bits), "{node:?} {ray:?}");
                assert_eq!((mask, mask >> (WIDTH - 1)), (boxes, 0), "{node:?} {ray:?}");
                entered += mask.count_ones();
                cases += WIDTH as u32;
            }
        }
        assert!(entered > cases / 20, "{entered} of {cases}");
    }
}
