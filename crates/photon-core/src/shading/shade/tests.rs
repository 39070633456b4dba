//! V4: frames of normal maps and anisotropy for tangents that give none, and lobes for directions along the normal and
//! opposite to each other.

use super::*;
use crate::scene::SceneView;
use crate::scene::material::{MaterialKind, Primitive};
use crate::scene::media::{Interface, MediumStack};
use crate::scene::medium::Medium;
use crate::shading::glossy::{Glossy, limited};
use crate::shading::rough_glass::RoughGlass;
use crate::shading::rough_glass_table::RoughGlassTable;
use crate::shading::sampling;

const NORMALS: [Vec3; 3] = [Vec3::Z, Vec3::NEG_Y, Vec3::new(0.48, 0.6, -0.64)];
const SIGNS: [f32; 2] = [1.0, -1.0];

/// Tangents without a direction on the surface.
fn useless(normal: Vec3) -> [Vec3; 6] {
    let infinite = Vec3::new(f32::INFINITY, 0.0, 1.0);
    [Vec3::ZERO, normal, -normal * 3.0, Vec3::splat(f32::NAN), infinite, normal * 1e-30]
}

fn assert_unit(vector: Vec3, what: &str) {
    assert!((vector.length() - 1.0).abs() < 1e-6, "{what}: {vector} has the length {}", vector.length());
}

#[test]
fn normals_are_unit_vectors_for_any_tangent() {
    let texels = [Vec3::new(0.9, 0.2, 0.7), Vec3::new(0.0, 0.5, 0.5), Vec3::new(0.5, 0.5, 0.0), Vec3::ZERO];
    for normal in NORMALS {
        let (across, _) = sampling::basis(normal);
        for (texel, sign) in texels.into_iter().flat_map(|texel| SIGNS.map(|sign| (texel, sign))) {
            for scale in [1.0, 0.0, 1e3] {
                for tangent in [across, across * 1e-12 + normal * 1e-13, across + normal * 1e3, across * 1e15] {
                    assert_unit(turned(tangent, sign, normal, texel, scale), "with a tangent");
                }
                for tangent in useless(normal) {
                    // Of a tangent that is parallel up to rounding, a direction may be left.
                    let found = turned(tangent, sign, normal, texel, scale);
                    assert_unit(found, "without");
                    let is_parallel = tangent.is_finite() && tangent.length() > 1e-3;
                    assert!(is_parallel || found == normal, "{tangent}: {found}");
                }
            }
        }
    }
}

/// Mirrored texture coordinates: the other sign turns the normal to the other side of the tangent, and nothing else.
#[test]
fn signs_mirror_normals() {
    for normal in NORMALS {
        let (tangent, bitangent) = sampling::basis(normal);
        let [plain, mirrored] = SIGNS.map(|sign| turned(tangent, sign, normal, Vec3::new(0.7, 0.8, 0.9), 1.0));
        assert!((plain.dot(tangent) - mirrored.dot(tangent)).abs() < 1e-6);
        assert!((plain.dot(normal) - mirrored.dot(normal)).abs() < 1e-6);
        assert!((plain.dot(bitangent) + mirrored.dot(bitangent)).abs() < 1e-6);
        assert!(plain.dot(normal.cross(tangent)) > 0.3, "{plain}");
    }
}

#[test]
fn directions_of_anisotropy_are_on_the_surface() {
    for (normal, sign) in NORMALS.into_iter().flat_map(|normal| SIGNS.map(|sign| (normal, sign))) {
        let (across, _) = sampling::basis(normal);
        // The least number beside 0 that a texel gives is 2 (½ + 2⁻²⁴) − 1.
        for direction in [[1.0, 0.0], [0.0, 1.0], [-0.6, 0.8], [0.0, 0.0], [1.2e-7, 0.0], [f32::NAN, 1.0]] {
            for tangent in [across, across + normal, across * 1e-12] {
                let found = turned_tangent(tangent, sign, normal, direction);
                assert_unit(found, "direction");
                assert!(found.dot(normal).abs() < 1e-6, "{found} for {normal}");
            }
            for tangent in [Vec3::ZERO, Vec3::splat(f32::NAN)] {
                assert_eq!(turned_tangent(tangent, sign, normal, direction), Vec3::ZERO);
            }
        }
    }
}

/// o = n and i = −o: what glossy surfaces and rough glass reflect and transmit is finite, and nothing passes through an
/// opaque one.
#[test]
fn lobes_of_degenerate_directions_are_finite() {
    let of = |kind: MaterialKind, metallic: f32, roughness: f32| Material {
        kind: kind as u32,
        albedo: [0.8; 3],
        metallic,
        roughness,
        specular: 1.0,
        ior: 1.5,
        medium: u32::from(kind == MaterialKind::Dielectric),
        ..Material::default()
    };
    let media = [Medium::VACUUM, Medium { ior: 1.5, ..Medium::VACUUM }];
    let scene = SceneView {
        media: &media,
        materials: &[of(MaterialKind::Dielectric, 0.0, 0.5)],
        primitives: &[Primitive::default()],
        ..SceneView::default()
    };
    let table = RoughGlassTable::new(&scene).expect("a boundary");
    for (normal, roughness) in NORMALS.into_iter().flat_map(|normal| [0.032, 0.3, 1.0].map(|width| (normal, width))) {
        let (tangent, _) = sampling::basis(normal);
        for wo in [normal, (normal + tangent).normalize_or_zero(), (normal * 1e-3 + tangent).normalize_or_zero()] {
            let cosine = wo.dot(normal);
            for (metallic, anisotropy) in [(1.0, 0.0), (0.0, 0.0), (0.5, 0.9)] {
                let layers = Layers::NONE.with_anisotropy(anisotropy, tangent).with_sheen(Vec3::ONE, 0.3);
                let glossy = Glossy::new(&of(MaterialKind::Glossy, metallic, roughness), &layers, cosine);
                let through = glossy.evaluate(wo, -wo, normal);
                assert_eq!(through.weight(limited(-wo, normal, normal)), Vec3::ZERO);
                let back = glossy.evaluate(wo, wo, normal);
                assert!(back.value.is_finite() && back.pdf.is_finite() && back.pdf >= 0.0, "{back:?}");
                for k in 0..16 {
                    let (wi, found) = glossy.sample(wo, normal, k as f32 / 16.0, 0.3);
                    assert_unit(wi, "reflected");
                    assert!(found.value.is_finite() && found.pdf.is_finite(), "{found:?}");
                }
            }
            for (kind, eta) in
                [(MaterialKind::Dielectric, 1.5), (MaterialKind::Dielectric, 1.0 / 1.5), (MaterialKind::Thin, 1.5)]
            {
                let interface = Interface {
                    eta,
                    before: MediumStack::VACUUM,
                    transmitted: MediumStack::VACUUM,
                    is_active: true,
                    is_too_deep: false,
                };
                let glass = of(kind, 0.0, roughness);
                let Some(glass) = RoughGlass::new(&table, &glass, cosine, &interface) else {
                    assert!(roughness < 0.04, "{kind:?}");
                    continue;
                };
                for wi in [wo, -wo, normal, -normal] {
                    let found = glass.evaluate(&table, wo, wi, normal);
                    let is_valid = found.value.is_finite() && found.value.min_element() >= 0.0 && found.pdf.is_finite();
                    assert!(is_valid && found.pdf >= 0.0, "{kind:?} {wi}: {found:?}");
                }
                for k in 0..16 {
                    let sampled = glass.sample(&table, wo, normal, [k as f32 / 16.0, 0.0, 0.3]);
                    assert_unit(sampled.direction, "glass");
                    assert!(sampled.found.value.is_finite() && sampled.found.pdf.is_finite(), "{:?}", sampled.found);
                }
            }
        }
    }
}
