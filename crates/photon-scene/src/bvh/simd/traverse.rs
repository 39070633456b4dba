//! Traversal, compiled once for the baseline and once for AVX2; both give identical bits, since
//! neither fuses a product and a sum.

use std::mem::MaybeUninit;

use photon_core::{Hit, Ray};

use super::node::{Child, Node, WIDTH};
use super::slabs::{Entered, Slabs};
use super::triangle::{LANES, Packet, Sheared, intersect};

/// Deepest tree that the traversal stack supports.
pub(crate) const MAX_DEPTH: usize = 40;
/// Each level leaves at most seven children on the stack.
pub(crate) const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// Whether a hit counts: all of them, or those of surfaces that are there.
pub(crate) trait Keep: Copy {
    /// Whether some hits may not count.
    const SKIPS: bool;

    fn keeps(self, hit: &Hit) -> bool;
}

/// Every hit counts; without a cost.
#[derive(Clone, Copy)]
pub(crate) struct All;

impl Keep for All {
    const SKIPS: bool = false;

    #[inline(always)]
    fn keeps(self, _: &Hit) -> bool {
        true
    }
}

impl Keep for &dyn Fn(&Hit) -> bool {
    const SKIPS: bool = true;

    #[inline(always)]
    fn keeps(self, hit: &Hit) -> bool {
        self(hit)
    }
}

pub(crate) fn nearest<K: Keep>(nodes: &[Node], packets: &[Packet], ray: &Ray, keep: K) -> Option<Hit> {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[allow(unsafe_code, reason = "a function compiled for more than the baseline can be called in no other way")]
        // SAFETY: the check above found that the processor has AVX2.
        return unsafe { avx2::nearest(nodes, packets, ray, keep) };
    }
    walk::<false, K>(nodes, packets, ray, keep, Slabs::enter)
}

pub(crate) fn occluded<K: Keep>(nodes: &[Node], packets: &[Packet], ray: &Ray, keep: K) -> bool {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[allow(unsafe_code, reason = "a function compiled for more than the baseline can be called in no other way")]
        // SAFETY: the check above found that the processor has AVX2.
        return unsafe { avx2::occluded(nodes, packets, ray, keep) };
    }
    walk::<true, K>(nodes, packets, ray, keep, Slabs::enter).is_some()
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Hit, Keep, Node, Packet, Ray, walk};

    #[target_feature(enable = "avx2")]
    pub(super) fn nearest<K: Keep>(nodes: &[Node], packets: &[Packet], ray: &Ray, keep: K) -> Option<Hit> {
        walk::<false, K>(nodes, packets, ray, keep, |slabs, node, far| slabs.enter_avx2(node, far))
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn occluded<K: Keep>(nodes: &[Node], packets: &[Packet], ray: &Ray, keep: K) -> bool {
        walk::<true, K>(nodes, packets, ray, keep, |slabs, node, far| slabs.enter_avx2(node, far)).is_some()
    }
}

/// The baseline version, for tests of the AVX2 version.
#[cfg(test)]
pub(crate) fn portable(nodes: &[Node], packets: &[Packet], ray: &Ray) -> Option<Hit> {
    walk::<false, All>(nodes, packets, ray, All, Slabs::enter)
}

pub(crate) fn brute_force<K: Keep>(packets: &[Packet], ray: &Ray, keep: K) -> Option<Hit> {
    let sheared = Sheared::new(ray)?;
    let mut best = Best::new(ray)?;
    for packet in packets {
        best.test(packet, &sheared, keep);
    }
    best.hit()
}

/// The nearest hit so far; of hits at equal distance, the one with the lowest index.
struct Best {
    t: f32,
    id: u32,
    u: f32,
    v: f32,
}

impl Best {
    /// `None` where no hit can count.
    #[inline(always)]
    fn new(ray: &Ray) -> Option<Self> {
        if ray.t_max >= 0.0 { Some(Self { t: ray.t_max, id: u32::MAX, u: 0.0, v: 0.0 }) } else { None }
    }

    #[inline(always)]
    fn test<K: Keep>(&mut self, packet: &Packet, ray: &Sheared, keep: K) {
        let found = intersect(packet, ray, self.t);
        let mut hits = found.hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let (t, id) = (found.t[lane % LANES], packet.ids[lane % LANES]);
            if t < self.t || t == self.t && id < self.id {
                let [u, v] = found.weights(lane);
                // A spare lane repeats the first triangle of its packet, which is nearer by its index if it is kept.
                if !K::SKIPS || (id != u32::MAX && keep.keeps(&Hit { t, primitive: id, u, v })) {
                    *self = Self { t, id, u, v };
                }
            }
        }
    }

    #[inline(always)]
    fn hit(&self) -> Option<Hit> {
        (self.id != u32::MAX).then_some(Hit { t: self.t, primitive: self.id, u: self.u, v: self.v })
    }
}

/// Prefetches the cache lines of data that will be visited soon.
#[inline(always)]
fn fetch<T>(soon: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = std::ptr::from_ref(soon).cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(64) {
            #[allow(unsafe_code, reason = "the hint has no other form")]
            // SAFETY: a prefetch of a valid reference, which reads nothing.
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line));
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = soon;
}

#[inline(always)]
fn walk<const ANY: bool, K: Keep>(
    nodes: &[Node],
    packets: &[Packet],
    ray: &Ray,
    keep: K,
    enter: impl Fn(&Slabs, &Node, f32) -> Entered,
) -> Option<Hit> {
    let sheared = Sheared::new(ray)?;
    let mut best = Best::new(ray)?;
    if nodes.is_empty() {
        return None;
    }
    let slabs = Slabs::new(ray);
    let mut stack = [const { MaybeUninit::<(Child, f32)>::uninit() }; STACK];
    let mut top = 0;
    let mut next = Child::default();
    loop {
        if next.packets > 0 {
            for packet in &packets[next.first as usize..(next.first + next.packets) as usize] {
                best.test(packet, &sheared, keep);
            }
            if ANY && best.id != u32::MAX {
                return best.hit();
            }
        } else {
            let node = &nodes[next.first as usize];
            let (entry, mut mask) = enter(&slabs, node, best.t);
            let mut take = || {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask.wrapping_sub(1);
                (lane < WIDTH).then_some(lane)
            };
            if let Some(mut nearest) = take() {
                let bottom = top;
                while let Some(lane) = take() {
                    let (nearer, farther) =
                        if entry[lane] < entry[nearest] { (lane, nearest) } else { (nearest, lane) };
                    nearest = nearer;
                    // Insertion sort: nearer children lie above.
                    let mut place = top;
                    while place > bottom {
                        #[allow(unsafe_code, reason = "to clear the stack takes a sixth of a ray's time")]
                        // SAFETY: every entry below `top` has been written.
                        let other = unsafe { stack[place - 1].assume_init() };
                        if other.1 >= entry[farther] {
                            break;
                        }
                        stack[place].write(other);
                        place -= 1;
                    }
                    let child = node.children[farther];
                    if child.packets > 0 {
                        fetch(&packets[child.first as usize]);
                    } else {
                        fetch(&nodes[child.first as usize]);
                    }
                    stack[place].write((child, entry[farther]));
                    top += 1;
                }
                next = node.children[nearest];
                continue;
            }
        }
        next = loop {
            if top == 0 {
                return best.hit();
            }
            top -= 1;
            #[allow(unsafe_code, reason = "as above")]
            // SAFETY: as above.
            let (child, entry) = unsafe { stack[top].assume_init() };
            if entry <= best.t {
                break child;
            }
        };
    }
}
