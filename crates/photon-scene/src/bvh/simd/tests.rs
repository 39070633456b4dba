//! Compares the tree with brute force, and checks watertightness where rays hit edges and vertices.

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{Hit, RandomKind, Ray, RayCaster};

use super::{Accel, AccelError, BruteForce, traverse};

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

fn numbers(path: u32) -> impl FnMut() -> f32 {
    let mut sampler = Sampler::new(RandomKind::Counter, 7, 0, Domain::Eye, path);
    let mut block = 0;
    let mut words = [0; 4];
    let mut left = 0;
    move || {
        if left == 0 {
            words = sampler.words(block);
            block += 1;
            left = 4;
        }
        left -= 1;
        unit_f32(words[left])
    }
}

fn direction(next: &mut impl FnMut() -> f32) -> Vec3 {
    photon_core::sampling::uniform_sphere(next(), next())
}

/// A closed sphere of radius 0.4: `rings` rings of twice as many segments.
fn sphere(rings: u32) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 0.4]];
    let segments = 2 * rings;
    for ring in 1..rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let at = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            positions.push(at.map(|c| (0.4 * c) as f32));
        }
    }
    positions.push([0.0, 0.0, -0.4]);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let mut triangles = Vec::new();
    for segment in 0..segments {
        triangles.push([0, at(1, segment), at(1, segment + 1)]);
        triangles.push([last, at(rings - 1, segment + 1), at(rings - 1, segment)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    (positions, triangles)
}

fn soup(count: u32) -> Mesh {
    let mut next = numbers(count);
    let positions: Vec<[f32; 3]> = (0..count)
        .flat_map(|_| {
            let center = [next(), next(), next()].map(|c| c - 0.5);
            let mut near = || std::array::from_fn(|axis| center[axis] + 0.1 * (next() - 0.5));
            [near(), near(), near()]
        })
        .collect();
    (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|h| [h.t.to_bits(), h.primitive, h.u.to_bits(), h.v.to_bits()])
}

#[test]
fn the_tree_agrees_with_every_triangle_to_the_bit() {
    for (positions, triangles) in [soup(1), soup(3), soup(5), soup(700), sphere(16)] {
        let accel = Accel::build(&positions, &triangles).unwrap();
        let brute = BruteForce::build(&positions, &triangles).unwrap();
        let mut next = numbers(1);
        let mut hits = 0;
        for i in 0..20_000 {
            let origin = Vec3::new(next(), next(), next()) - 0.5;
            let mut along = direction(&mut next);
            // Some rays are axis-parallel, some start at coordinates of a vertex.
            match i % 5 {
                0 => along = [Vec3::X, -Vec3::Y, Vec3::Z][i / 5 % 3],
                1 => along = Vec3::from(positions[i % positions.len()]) - origin,
                _ => {}
            }
            let t_max = if i % 7 == 0 { next() } else { f32::INFINITY };
            let ray = Ray { origin, direction: along.normalize_or(Vec3::X), t_max };
            let expected = brute.nearest(&ray);
            assert_eq!(bits(accel.nearest(&ray)), bits(expected), "{ray:?}");
            assert_eq!(bits(traverse::portable(&accel.nodes, &accel.packets, &ray)), bits(expected));
            assert_eq!(accel.occluded(&ray), expected.is_some());
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 10, "{} triangles: {hits} hits", triangles.len());
    }
}

/// All triangles whose boxes overlap a box are among those that are found; fewer than all are; too little room is noticed.
#[test]
fn triangles_near_a_box() {
    for (positions, triangles) in [soup(1), soup(5), soup(700), sphere(16)] {
        let accel = Accel::build(&positions, &triangles).unwrap();
        let mut next = numbers(9);
        let mut found_in_all = 0;
        for _ in 0..2_000 {
            let centre = Vec3::new(next(), next(), next()) - 0.5;
            let half = Vec3::new(next(), next(), next()) * 0.1;
            let (low, high) = (centre - half, centre + half);
            let mut room = [0; 1000];
            let near = accel.overlapping(low, high, &mut room).unwrap().to_vec();
            for (index, corners) in triangles.iter().enumerate() {
                let corners = corners.map(|corner| Vec3::from(positions[corner as usize]));
                let (least, most) =
                    (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
                if least.cmple(high).all() && most.cmpge(low).all() {
                    assert!(near.contains(&(index as u32)), "{index} in {low} to {high}");
                }
            }
            found_in_all += near.len();
            let mut tight = vec![0; near.len()];
            assert_eq!(accel.overlapping(low, high, &mut tight), Some(&near[..]));
            if let Some((_, less)) = tight.split_first_mut() {
                assert_eq!(accel.overlapping(low, high, less), None);
            }
        }
        // Half of a box's width is 0.05 on average, that of a leaf less: a tenth of all triangles is far more than are near.
        assert!(triangles.len() < 100 || found_in_all < 200 * triangles.len(), "{found_in_all}");
    }
    assert_eq!(Accel::build(&[], &[]).unwrap().overlapping(Vec3::ZERO, Vec3::ONE, &mut []), Some(&[][..]));
}

/// Some triangles are not there: the tree and brute force find the same hits, which are those of the meshes without
/// these triangles, apart from indices.
#[test]
fn triangles_that_are_not_kept_are_not_there() {
    for (positions, triangles) in [soup(1), soup(3), soup(5), soup(700), sphere(16)] {
        let accel = Accel::build(&positions, &triangles).unwrap();
        let brute = BruteForce::build(&positions, &triangles).unwrap();
        let there = |index: u32| !index.is_multiple_of(3);
        let kept: Vec<u32> = (0..triangles.len() as u32).filter(|&index| there(index)).collect();
        let fewer: Vec<[u32; 3]> = kept.iter().map(|&index| triangles[index as usize]).collect();
        let fewer = BruteForce::build(&positions, &fewer).unwrap();
        let keep = |hit: &Hit| there(hit.primitive);
        let mut next = numbers(4);
        for _ in 0..5_000 {
            let origin = Vec3::new(next(), next(), next()) - 0.5;
            let target = Vec3::from(positions[(next() * positions.len() as f32) as usize]);
            let along = if next() < 0.3 { target - origin } else { direction(&mut next) };
            let ray = Ray { origin, direction: along.normalize_or(Vec3::X), t_max: f32::INFINITY };
            let expected = fewer.nearest(&ray).map(|hit| Hit { primitive: kept[hit.primitive as usize], ..hit });
            assert_eq!(bits(accel.nearest_where(&ray, &keep).unwrap()), bits(expected), "{ray:?}");
            assert_eq!(bits(brute.nearest_where(&ray, &keep).unwrap()), bits(expected), "{ray:?}");
            assert_eq!(accel.occluded_where(&ray, &keep), Ok(expected.is_some()));
            assert_eq!(accel.nearest_where(&ray, &|_| false), Ok(None));
        }
    }
}

/// V15: any number of surfaces at the same place that are not there.
#[test]
fn a_thousand_coincident_triangles_can_be_skipped() {
    let positions = vec![[-0.1, -0.1, 0.0], [0.1, -0.1, 0.0], [0.0, 0.1, 0.0]];
    let accel = Accel::build(&positions, &vec![[0, 1, 2]; 1_000]).unwrap();
    let ray = Ray { origin: Vec3::new(0.0, 0.0, -1.0), direction: Vec3::Z, t_max: f32::INFINITY };
    for there in [0, 17, 999] {
        let hit = accel.nearest_where(&ray, &|hit| hit.primitive >= there).unwrap();
        assert_eq!(hit.map(|hit| hit.primitive), Some(there));
    }
    assert_eq!(accel.nearest_where(&ray, &|_| false), Ok(None));
}

/// S2: no ray from inside a closed surface escapes, whatever its direction.
#[test]
fn no_cracks_at_edges_and_vertices() {
    let (positions, triangles) = sphere(48);
    let accel = Accel::build(&positions, &triangles).unwrap();
    let mut next = numbers(2);
    let vertex = |index: u32| Vec3::from(positions[index as usize]);
    for i in 0..1_000_000_usize {
        let origin = (Vec3::new(next(), next(), next()) - 0.5) * 0.4;
        let [a, b, c] = triangles[i % triangles.len()].map(vertex);
        let target = match i % 3 {
            0 => a,
            1 => a + (b - a) * next(),
            _ => c + (a - c) * next(),
        };
        let ray = Ray { origin, direction: (target - origin).normalize(), t_max: f32::INFINITY };
        assert!(accel.nearest(&ray).is_some(), "{ray:?}");
    }
}

#[test]
fn rays_along_the_axes_hit_faces_of_boxes_up_to_their_edges() {
    let positions = vec![[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]];
    let accel = Accel::build(&positions, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    for x in [-0.5, -0.5 + 1.2e-7, 0.0, 0.5 - 1.2e-7, 0.5_f32] {
        for y in [-0.5, 0.3, 0.5_f32] {
            for z in [-0.5, -9.0, -1e4_f32] {
                let ray = Ray { origin: Vec3::new(x, y, z), direction: Vec3::Z, t_max: f32::INFINITY };
                assert!(accel.nearest(&ray).is_some(), "{ray:?}");
            }
        }
    }
    let beside = Ray { origin: Vec3::new(0.500_001, 0.0, 0.0), direction: Vec3::Z, t_max: f32::INFINITY };
    assert!(accel.nearest(&beside).is_none());
}

/// S8: identical boxes, for which obvhs builds a list instead of a tree.
#[test]
fn ten_thousand_identical_triangles() {
    let positions = vec![[-0.1, -0.1, 0.0], [0.1, -0.1, 0.0], [0.0, 0.1, 0.0]];
    let accel = Accel::build(&positions, &vec![[0, 1, 2]; 10_000]).unwrap();
    let ray = Ray { origin: Vec3::new(0.0, 0.0, -1.0), direction: Vec3::Z, t_max: f32::INFINITY };
    assert_eq!(accel.nearest(&ray).map(|hit| hit.primitive), Some(0));
}

/// S5: triangles degenerated to one or two points are never hit; collinear ones, which rounding may give a
/// tiny area, and slivers are hit consistently and with valid results.
#[test]
fn degenerate_triangles_and_slivers() {
    let positions = vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1e-6, 0.0]];
    let accel = Accel::build(&positions, &[[0, 0, 1], [2, 2, 2]]).unwrap();
    let thin = [[0, 1, 2], [0, 1, 3]]
        .map(|t| (Accel::build(&positions, &[t]).unwrap(), BruteForce::build(&positions, &[t]).unwrap()));
    let mut next = numbers(3);
    for _ in 0..10_000 {
        let target = Vec3::new(next() - 0.5, next() * 5e-7, 0.0);
        let origin = Vec3::new(next(), next(), -next() - 0.1);
        let ray = Ray { origin, direction: (target - origin).normalize(), t_max: f32::INFINITY };
        assert!(accel.nearest(&ray).is_none());
        for (tree, brute) in &thin {
            let hit = tree.nearest(&ray);
            assert_eq!(bits(hit), bits(brute.nearest(&ray)));
            if let Some(hit) = hit {
                assert!(hit.t.is_finite() && (0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v), "{hit:?}");
            }
        }
    }
}

#[test]
fn limits_and_nonsense() {
    let empty = Accel::build(&[], &[]).unwrap();
    let (positions, triangles) = sphere(8);
    let accel = Accel::build(&positions, &triangles).unwrap();
    let ray = |origin, direction, t_max| Ray { origin, direction, t_max };
    assert!(empty.nearest(&ray(Vec3::ZERO, Vec3::X, f32::INFINITY)).is_none());
    assert!(accel.nearest(&ray(Vec3::ZERO, Vec3::X, 0.3)).is_none());
    for nonsense in [
        ray(Vec3::ZERO, Vec3::ZERO, 1.0),
        ray(Vec3::ZERO, Vec3::NAN, 1.0),
        ray(Vec3::NAN, Vec3::X, 1.0),
        ray(Vec3::ZERO, Vec3::X, f32::NAN),
        ray(Vec3::ZERO, Vec3::X, -1.0),
        ray(Vec3::ZERO, Vec3::X * f32::INFINITY, 1.0),
    ] {
        assert!(accel.nearest(&nonsense).is_none() && !accel.occluded(&nonsense));
    }
    // Hits at exactly t_max and at 0 count.
    let hit = accel.nearest(&ray(Vec3::ZERO, Vec3::X, f32::INFINITY)).unwrap();
    assert!(accel.nearest(&ray(Vec3::ZERO, Vec3::X, hit.t)).is_some());
    assert_eq!(
        Accel::build(&[], &[[0, 1, 2]]).unwrap_err(),
        AccelError::OutOfRange { triangle: 0, vertex: 0, count: 0 }
    );
    for bad in [f32::NAN, f32::INFINITY, 1e20] {
        let found = Accel::build(&[[0.0; 3], [bad, 0.0, 0.0]], &[[0, 1, 0]]);
        assert!(matches!(found, Err(AccelError::NotNormalised { vertex: 1, .. })));
    }
}

/// An independent formula (Möller and Trumbore 1997) in f64, for one triangle: `t`, `u`, `v`, and the error bound
/// of single precision. Edge functions err by some ULPs of the longest edge times the scene's size,
/// 1, and are divided by the determinant, twice the triangle's area as projected along the ray.
fn reference(corners: [[f32; 3]; 3], ray: &Ray) -> Option<([f64; 3], f64)> {
    let [a, b, c] = corners.map(|corner| Vec3::from(corner).as_dvec3());
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let from = origin - a;
    let u = from.dot(across) / determinant;
    let turned = from.cross(ab);
    let v = direction.dot(turned) / determinant;
    let t = ac.dot(turned) / determinant;
    let longest = ab.length().max(ac.length()).max((c - b).length());
    let bound = 32.0 * f64::from(f32::EPSILON) * (1.0 + longest / determinant.abs());
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(([t, u, v], bound))
}

/// Where the two formulas disagree on whether a ray hits, it passes within rounding error of an edge.
#[test]
fn the_triangle_test_agrees_with_another_in_double_precision() {
    let (positions, triangles) = soup(400);
    let mut next = numbers(401);
    let (mut hits, mut edges) = (0, 0);
    for triangle in triangles {
        let corners = triangle.map(|vertex| positions[vertex as usize]);
        let mesh = BruteForce::build(&corners, &[[0, 1, 2]]).unwrap();
        for _ in 0..200 {
            // Towards a point on or near the triangle, from a random origin.
            let weights = [next() * 1.4 - 0.2, next() * 1.4 - 0.2];
            let [a, b, c] = corners.map(Vec3::from);
            let target = a + (b - a) * weights[0] + (c - a) * weights[1];
            let origin = target + direction(&mut next) * (0.2 + next());
            let ray = Ray { origin, direction: (target - origin).normalize_or(Vec3::X), t_max: f32::INFINITY };
            match (mesh.nearest(&ray), reference(corners, &ray)) {
                (Some(found), Some(([t, u, v], bound))) => {
                    hits += 1;
                    let apart = [f64::from(found.t) - t, f64::from(found.u) - u, f64::from(found.v) - v];
                    assert!(apart.iter().all(|d| d.abs() <= bound), "{apart:?}, {bound} for {corners:?} {ray:?}");
                }
                (None, None) => {}
                _ => edges += 1,
            }
        }
    }
    assert!(hits > 20_000 && edges < 20, "{hits} hits, {edges} differ");
}
