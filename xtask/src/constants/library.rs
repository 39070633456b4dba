//! Numbers of algorithms in photon-core and photon-scene that have a twin in GLSL.

use photon_core::{
    AlbedoTable, Coat, ConfidenceInterval, Fate, FixedFlux, Lobe, NEGLIGIBLE_THROUGHPUT, PhotonFormat, PhotonMoments,
    PixelRadii, RoughGlassTable, SheenTable, Spectrum, anisotropy, area, clearcoat, cosine_warp, flight, ggx, glossy,
    grid, kd_tree, light_sampler, light_tree, neighbour_radius, octahedral, offset, rough_glass, shading_normal, sheen,
    solid_angle,
};
use photon_scene::CompressedTree;

use super::file::{Group, Number};

/// They follow the numbers of records in `shading/constants.glsl`.
pub(super) fn groups() -> Vec<Group> {
    vec![
        (
            "Lobe.",
            vec![
                ("LOBE_DIFFUSE", (Lobe::Diffuse as u32).into()),
                ("LOBE_SPECULAR_REFLECTION", (Lobe::SpecularReflection as u32).into()),
                ("LOBE_SPECULAR_TRANSMISSION", (Lobe::SpecularTransmission as u32).into()),
            ],
        ),
        ("bsdf.", vec![("NEGLIGIBLE_THROUGHPUT", NEGLIGIBLE_THROUGHPUT.into())]),
        (
            "Fate; the maximum power of a path; one over the unit of flux in sums.",
            vec![
                ("FATE_ABSORBED", (Fate::Absorbed as u32).into()),
                ("FATE_ESCAPED", (Fate::Escaped as u32).into()),
                ("FATE_TRUNCATED", (Fate::Truncated as u32).into()),
                ("FATE_DROPPED", (Fate::Dropped as u32).into()),
                ("FATE_TERMINATED", (Fate::Terminated as u32).into()),
                ("FATE_COUNT", (Fate::COUNT as u32).into()),
                ("FATE_MAX_POWER", Fate::MAX_POWER.into()),
                ("FATE_FLUX_ONE", FixedFlux::ONE.into()),
            ],
        ),
        (
            "PhotonFormat::number.",
            vec![
                ("FORMAT_MONO", PhotonFormat::Mono.number().into()),
                ("FORMAT_NO_DIRECTION", PhotonFormat::NoDirection.number().into()),
                ("FORMAT_FULL", PhotonFormat::Full.number().into()),
            ],
        ),
        (
            "area.",
            vec![
                ("AREA_SPOKES", area::SPOKES.into()),
                ("AREA_RINGS", area::RINGS.into()),
                ("AREA_HEIGHT", area::HEIGHT.into()),
                ("AREA_MIN_SHARE", area::MIN_SHARE.into()),
                ("AREA_MIN_RADIUS", area::MIN_RADIUS.into()),
                ("AREA_SHEETS", area::SHEETS.into()),
                ("AREA_OUTER", area::OUTER.into()),
            ],
        ),
        (
            "light_sampler.",
            vec![
                ("LIGHT_SAMPLER_MAX_LIGHTS", (light_sampler::MAX_LIGHTS as u32).into()),
                ("LIGHT_SAMPLER_DEFENSIVE_SHARE", Number::Float(light_sampler::DEFENSIVE_SHARE)),
                ("LIGHT_SAMPLER_UNSEEN_SHARE", Number::Float(light_sampler::UNSEEN_SHARE)),
            ],
        ),
        (
            "light_tree.",
            vec![
                ("LIGHT_TREE_WORDS", light_tree::TREE_WORDS.into()),
                ("LIGHT_TREE_LEAF", light_tree::LEAF.into()),
                ("LIGHT_TREE_NO_CHILD", light_tree::NO_CHILD.into()),
                ("LIGHT_TREE_WIDTH", (light_tree::WIDTH as u32).into()),
                ("LIGHT_TREE_MAX_WORDS", light_tree::MAX_WORDS.into()),
                ("LIGHT_TREE_TRAIL_BITS", light_tree::TRAIL_BITS.into()),
                ("LIGHT_TREE_COSINE_STEPS", light_tree::COSINE_STEPS.into()),
                ("LIGHT_TREE_MIN_DISTANCE_SHARE", light_tree::MIN_DISTANCE_SHARE.into()),
                ("LIGHT_TREE_MIN_SQUARED", light_tree::MIN_SQUARED.into()),
                ("LIGHT_TREE_MULTIPLIER", light_tree::NEXT_WORD[0].into()),
                ("LIGHT_TREE_INCREMENT", light_tree::NEXT_WORD[1].into()),
            ],
        ),
        ("octahedral.", vec![("OCTAHEDRAL_STEPS", octahedral::STEPS.into())]),
        (
            "flight.",
            vec![
                ("FLIGHT_FAR", flight::FAR.into()),
                ("FLIGHT_MAX_COLLISIONS", flight::MAX_COLLISIONS.into()),
                ("FLIGHT_FOCUSED_DEPOSITS", flight::FOCUSED_DEPOSITS.into()),
                ("FLIGHT_SHORTEST_STRETCH", flight::SHORTEST_STRETCH.into()),
            ],
        ),
        (
            "grid.",
            vec![
                ("GRID_BRICK", grid::BRICK.into()),
                ("GRID_NODES", grid::NODES.into()),
                ("GRID_STORED", grid::STORED.into()),
                ("GRID_ROOT_STEPS", grid::ROOT_STEPS.into()),
                ("GRID_THICK", grid::THICK.into()),
                ("GRID_KNOTS", (grid::KNOTS as u32).into()),
            ],
        ),
        (
            "offset.",
            vec![
                ("OFFSET_STEP", offset::STEP.into()),
                ("OFFSET_MARGIN", offset::MARGIN.into()),
                ("OFFSET_MAX_SLOPE", offset::MAX_SLOPE.into()),
            ],
        ),
        (
            "shading_normal.",
            vec![
                ("SHADING_MAX_RATIO", shading_normal::MAX_RATIO.into()),
                ("SHADING_MIN_COSINE", shading_normal::MIN_COSINE.into()),
            ],
        ),
        ("ggx.", vec![("GGX_MIN_ALPHA", ggx::MIN_ALPHA.into())]),
        (
            "rough_glass, RoughGlassTable.",
            vec![
                ("ROUGH_GLASS_MIN_CONTRAST", rough_glass::MIN_CONTRAST.into()),
                ("ROUGH_GLASS_STRIDE", (RoughGlassTable::STRIDE as u32).into()),
            ],
        ),
        (
            "Spectrum.",
            vec![
                ("SPECTRUM_CELLS", Spectrum::CELLS.into()),
                ("SPECTRUM_FIRST", Spectrum::FIRST.into()),
                ("SPECTRUM_STEP", Spectrum::STEP.into()),
            ],
        ),
        ("AlbedoTable.", vec![("ALBEDO_TABLE_SIZE", (AlbedoTable::SIZE as u32).into())]),
        (
            "glossy.",
            vec![
                ("GLOSSY_MIN_SHARE", glossy::MIN_SHARE.into()),
                ("GLOSSY_COAT_ROUGHNESS", Coat::STEPS[0].into()),
                ("GLOSSY_COAT_F0", Coat::STEPS[1].into()),
                ("GLOSSY_COAT_F90", Coat::STEPS[2].into()),
            ],
        ),
        (
            "anisotropy.",
            vec![
                ("ANISOTROPY_STRENGTHS", anisotropy::STEPS[0].into()),
                ("ANISOTROPY_DIRECTIONS", anisotropy::STEPS[1].into()),
            ],
        ),
        (
            "clearcoat.",
            vec![
                ("CLEARCOAT_F0", clearcoat::F0.into()),
                ("CLEARCOAT_NODES", clearcoat::NODES.into()),
                ("CLEARCOAT_LOWER_ROUGHNESS", clearcoat::STEPS[0].into()),
                ("CLEARCOAT_LOWER_F0", clearcoat::STEPS[1].into()),
                ("CLEARCOAT_LOWER_F90", clearcoat::STEPS[2].into()),
                ("CLEARCOAT_WEIGHT", clearcoat::STEPS[3].into()),
                ("CLEARCOAT_ROUGHNESS", clearcoat::STEPS[4].into()),
            ],
        ),
        (
            "sheen, SheenTable.",
            vec![
                ("SHEEN_MIN_ROUGHNESS", sheen::MIN_ROUGHNESS.into()),
                ("SHEEN_MIN_COSINE", sheen::MIN_COSINE.into()),
                ("SHEEN_TABLE_SIZE", (SheenTable::SIZE as u32).into()),
                ("SHEEN_NODES", sheen::NODES.into()),
            ],
        ),
        (
            "solid_angle.",
            vec![
                ("COSINE_WARP_EVEN_SHARE", cosine_warp::EVEN_SHARE.into()),
                ("COSINE_WARP_MIN_EVEN", cosine_warp::MIN_EVEN.into()),
                ("SOLID_ANGLE_NEAR", solid_angle::NEAR.into()),
                ("SOLID_ANGLE_MIN_HEIGHT", solid_angle::MIN_HEIGHT.into()),
            ],
        ),
        (
            "Minimum squared radius that an estimate divides by: neighbour_radius.",
            vec![(
                "NEIGHBOUR_MIN_RADIUS_SQUARED",
                (neighbour_radius::MIN_RADIUS * neighbour_radius::MIN_RADIUS).into(),
            )],
        ),
        (
            "PhotonMoments.",
            vec![
                ("ERROR_MOMENTS_OFF_PLANE", PhotonMoments::OFF_PLANE.into()),
                ("MOMENTS_MIN_PHOTONS", (PhotonMoments::MIN_PHOTONS as f32).into()),
                ("MOMENTS_MAX_STRAY", (PhotonMoments::MAX_STRAY as f32).into()),
                ("MOMENTS_MAX_OFFSET", (PhotonMoments::MAX_OFFSET as f32).into()),
                ("MOMENTS_MAX_QUADRUPOLE", (PhotonMoments::MAX_QUADRUPOLE as f32).into()),
            ],
        ),
        (
            "ConfidenceInterval.",
            vec![
                ("INTERVAL_MIN_PHOTONS", (ConfidenceInterval::MIN_PHOTONS as f32).into()),
                ("INTERVAL_MIN_BOUNDED_PHOTONS", (ConfidenceInterval::MIN_BOUNDED_PHOTONS as f32).into()),
                ("INTERVAL_MINOR", (ConfidenceInterval::MINOR as f32).into()),
            ],
        ),
        (
            "PixelRadii: bounds of the factor on r, largest change of its square, pixels to each side.",
            vec![
                ("RADII_LEAST", (PixelRadii::BOUNDS[0].sqrt() as f32).into()),
                ("RADII_GREATEST", (PixelRadii::BOUNDS[1].sqrt() as f32).into()),
                ("RADII_STEP", (PixelRadii::STEP as f32).into()),
                ("RADII_REACH", PixelRadii::REACH.into()),
            ],
        ),
        (
            "kd_tree.",
            vec![
                ("KD_TREE_WIDTH", kd_tree::WIDTH.into()),
                ("KD_TREE_LEAF", kd_tree::LEAF.into()),
                ("KD_TREE_MAX_DEPTH", kd_tree::MAX_DEPTH.into()),
                ("VVH_SLABS", kd_tree::SLABS.into()),
                ("VVH_SAMPLE", kd_tree::SAMPLE.into()),
                ("VVH_HEURISTIC_DEPTH", kd_tree::HEURISTIC_DEPTH.into()),
                ("MORTON_BITS", Number::Int(kd_tree::MORTON_BITS as i32)),
            ],
        ),
        (
            "CompressedTree.",
            vec![
                ("BVH_MAX_DEPTH", CompressedTree::MAX_DEPTH.into()),
                ("BVH_PLANE_TOLERANCE", CompressedTree::PLANE_TOLERANCE.into()),
            ],
        ),
    ]
}
