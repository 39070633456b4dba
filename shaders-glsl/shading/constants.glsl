// Numbers that Rust and GLSL share. Written by `cargo xtask constants`.
#ifndef CONSTANTS_GLSL
#define CONSTANTS_GLSL

// Material::kind.
const uint MATERIAL_LAMBERT = 0u;
const uint MATERIAL_MIRROR = 1u;
const uint MATERIAL_DIELECTRIC = 2u;
const uint MATERIAL_THIN = 3u;
const uint MATERIAL_GLOSSY = 4u;

// Material::flags.
const uint MATERIAL_EMITS_BOTH_SIDES = 1u;
const uint MATERIAL_ALPHA = 2u;
const uint MATERIAL_DIFFUSE_TRANSMISSION = 4u;
const uint MATERIAL_PARTIAL_TRANSMISSION = 8u;

// Light::kind.
const uint LIGHT_TRIANGLE = 0u;
const uint LIGHT_POINT = 1u;
const uint LIGHT_SPOT = 2u;
const uint LIGHT_DIRECTIONAL = 3u;
const uint LIGHT_ENVIRONMENT = 4u;

// MediaFeatures: bits of a specialization constant.
const uint MEDIA_NESTED = 1u;
const uint MEDIA_DISPERSION = 2u;
const uint MEDIA_SCATTERING = 4u;
const uint MEDIA_AMBIENT = 8u;
const uint MEDIA_PHASES = 16u;
const uint MEDIA_GRIDS = 32u;
const uint MEDIA_BOUNDARIES = 64u;

// Medium::dispersion.
const uint MEDIUM_CAUCHY = 1u;
const uint MEDIUM_SELLMEIER = 2u;
const uint MEDIUM_MATCHED = 3u;

// Medium::phase.
const uint MEDIUM_RAYLEIGH = 1u;
const uint MEDIUM_MIE = 2u;

// Light::flags.
const uint LIGHT_BOTH_SIDES = 1u;

// Camera::kind.
const uint CAMERA_PERSPECTIVE = 0u;
const uint CAMERA_ORTHOGRAPHIC = 1u;

// Estimate::flags.
const uint ESTIMATE_SINGULAR = 1u;

// Bits of Features: specialization constant 0.
const uint FEATURE_DIFFUSE = 1u;
const uint FEATURE_MIRROR = 2u;
const uint FEATURE_DIELECTRIC = 4u;
const uint FEATURE_THIN = 8u;
const uint FEATURE_ABSORPTION = 16u;
const uint FEATURE_AREA_LIGHTS = 32u;
const uint FEATURE_POINT_LIGHTS = 64u;
const uint FEATURE_SPOT_LIGHTS = 128u;
const uint FEATURE_DIRECTIONAL_LIGHTS = 256u;
const uint FEATURE_TEXTURES = 512u;
const uint FEATURE_SHADING_NORMALS = 1024u;
const uint FEATURE_NORMAL_MAPS = 2048u;
const uint FEATURE_VERTEX_COLORS = 4096u;
const uint FEATURE_TEXTURED_LIGHTS = 8192u;
const uint FEATURE_ENVIRONMENT = 16384u;
const uint FEATURE_GLOSSY = 32768u;
const uint FEATURE_ROUGH_GLASS = 65536u;
const uint FEATURE_ALPHA = 131072u;
const uint FEATURE_LIGHT_TREE = 262144u;
const uint FEATURE_THIN_LENS = 524288u;
const uint FEATURE_SPECULAR_COLORS = 1048576u;
const uint FEATURE_CLEARCOAT = 2097152u;
const uint FEATURE_SUN = 4194304u;
const uint FEATURE_ANISOTROPY = 8388608u;
const uint FEATURE_DIFFUSE_TRANSMISSION = 16777216u;
const uint FEATURE_CLEARCOAT_NORMALS = 33554432u;
const uint FEATURE_COATED_LIGHTS = 67108864u;
const uint FEATURE_SHEEN = 134217728u;
const uint FEATURE_PARTIAL_TRANSMISSION = 268435456u;
const uint FEATURE_PORTALS = 536870912u;
const uint FEATURE_SPECULAR = 32782u;
const uint FEATURE_ALL = 1073741823u;

// TexelFormat, Wrap, Filter.
const uint TEXEL_LINEAR8 = 0u;
const uint TEXEL_SRGB8 = 1u;
const uint TEXEL_FLOAT32 = 2u;
const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRROR = 1u;
const uint WRAP_CLAMP = 2u;
const uint FILTER_LINEAR = 0u;
const uint FILTER_NEAREST = 1u;

// MaterialTextures without a texture; a triangle without vertex normals.
const uint NO_TEXTURE = 4294967295u;
const uint FLAT_TRIANGLE = 2147516416u;

// RandomKind.
const uint RANDOM_COUNTER = 0u;
const uint RANDOM_LCG = 1u;

// random::Domain.
const uint DOMAIN_PHOTON = 0u;
const uint DOMAIN_EYE = 1u;
const uint DOMAIN_SHADOW = 2u;
const uint DOMAIN_GATHER = 3u;
const uint DOMAIN_AREA = 4u;
const uint DOMAIN_AIMED = 5u;
const uint DOMAIN_FLIGHT = 6u;
const uint DOMAIN_DEPOSIT = 7u;
const uint DOMAIN_SEGMENT = 8u;
const uint DOMAIN_WAVELENGTH = 9u;

// Blocks of dimensions.
const uint BLOCK_LIGHT = 0u;
const uint BLOCK_START = 1u;
const uint BLOCK_SURFACES = 2u;
const uint BLOCK_LIGHTS = 1073741824u;
const uint BLOCK_LIGHT_SIDES = 1610612736u;
const uint BLOCK_SEGMENTS = 536870912u;
const uint GOLDEN_STEP = 2654435769u;

// Kernel::number.
const uint KERNEL_CONSTANT = 0u;
const uint KERNEL_EPANECHNIKOV = 1u;

// Layer.
const uint LAYER_EMISSION = 0u;
const uint LAYER_DIRECT = 1u;
const uint LAYER_CAUSTIC = 2u;
const uint LAYER_INDIRECT = 3u;

// MapKind, how many there are, and the bits that one takes beside an ordinal.
const uint MAP_DIRECT = 0u;
const uint MAP_CAUSTIC = 1u;
const uint MAP_GLOBAL = 2u;
const uint MAP_COUNT = 3u;
const uint MAP_BITS = 3u;

// Camera paths that one pixel of one pass may end in.
const uint QUERIES_PER_PIXEL = 4u;

// Lobe.
const uint LOBE_DIFFUSE = 0u;
const uint LOBE_SPECULAR_REFLECTION = 1u;
const uint LOBE_SPECULAR_TRANSMISSION = 2u;

// bsdf.
const float NEGLIGIBLE_THROUGHPUT = 9.999999974752427e-7;

// Fate; the maximum power of a path; one over the unit of flux in sums.
const uint FATE_ABSORBED = 0u;
const uint FATE_ESCAPED = 1u;
const uint FATE_TRUNCATED = 2u;
const uint FATE_DROPPED = 3u;
const uint FATE_TERMINATED = 4u;
const uint FATE_COUNT = 5u;
const float FATE_MAX_POWER = 1048576.0;
const float FATE_FLUX_ONE = 1099511627776.0;

// PhotonFormat::number.
const uint FORMAT_MONO = 0u;
const uint FORMAT_NO_DIRECTION = 1u;
const uint FORMAT_FULL = 2u;

// area.
const uint AREA_SPOKES = 8u;
const uint AREA_RINGS = 3u;
const float AREA_HEIGHT = 0.5;
const float AREA_MIN_SHARE = 0.0625;
const float AREA_MIN_RADIUS = 3.814697265625e-6;
const uint AREA_SHEETS = 4u;
const float AREA_OUTER = 0.75;

// light_sampler.
const uint LIGHT_SAMPLER_MAX_LIGHTS = 16u;
const float LIGHT_SAMPLER_DEFENSIVE_SHARE = 0.1;
const float LIGHT_SAMPLER_UNSEEN_SHARE = 0.001;

// light_tree.
const uint LIGHT_TREE_WORDS = 3865470566u;
const uint LIGHT_TREE_LEAF = 2147483648u;
const uint LIGHT_TREE_NO_CHILD = 4294967295u;
const uint LIGHT_TREE_WIDTH = 8u;
const float LIGHT_TREE_MAX_WORDS = 2147483520.0;
const uint LIGHT_TREE_TRAIL_BITS = 3u;
const float LIGHT_TREE_COSINE_STEPS = 32767.0;
const float LIGHT_TREE_MIN_DISTANCE_SHARE = 0.5;
const float LIGHT_TREE_MIN_SQUARED = 9.094947017729282e-13;
const uint LIGHT_TREE_MULTIPLIER = 1664525u;
const uint LIGHT_TREE_INCREMENT = 1013904223u;

// octahedral.
const float OCTAHEDRAL_STEPS = 32767.0;

// flight.
const float FLIGHT_FAR = 56.0;
const uint FLIGHT_MAX_COLLISIONS = 1024u;
const uint FLIGHT_FOCUSED_DEPOSITS = 8u;
const float FLIGHT_SHORTEST_STRETCH = 9.5367431640625e-7;

// grid.
const uint GRID_BRICK = 8u;
const uint GRID_NODES = 9u;
const uint GRID_STORED = 2147483648u;
const uint GRID_ROOT_STEPS = 16u;
const float GRID_THICK = 8.0;
const uint GRID_KNOTS = 32u;

// offset.
const float OFFSET_STEP = 9.5367431640625e-7;
const float OFFSET_MARGIN = 1.9073486328125e-6;
const float OFFSET_MAX_SLOPE = 0.0625;

// shading_normal.
const float SHADING_MAX_RATIO = 32.0;
const float SHADING_MIN_COSINE = 0.0010000000474974513;

// ggx.
const float GGX_MIN_ALPHA = 0.0010000000474974513;

// rough_glass, RoughGlassTable.
const float ROUGH_GLASS_MIN_CONTRAST = 9.999999747378752e-5;
const uint ROUGH_GLASS_STRIDE = 1056u;

// Spectrum.
const uint SPECTRUM_CELLS = 256u;
const float SPECTRUM_FIRST = 0.3799999952316284;
const float SPECTRUM_STEP = 0.0015625000232830644;

// AlbedoTable.
const uint ALBEDO_TABLE_SIZE = 32u;

// glossy.
const float GLOSSY_MIN_SHARE = 9.999999974752427e-7;
const float GLOSSY_COAT_ROUGHNESS = 1023.0;
const float GLOSSY_COAT_F0 = 4095.0;
const float GLOSSY_COAT_F90 = 1023.0;

// anisotropy.
const float ANISOTROPY_STRENGTHS = 32767.0;
const float ANISOTROPY_DIRECTIONS = 65536.0;

// clearcoat.
const float CLEARCOAT_F0 = 0.03999999910593033;
const uint CLEARCOAT_NODES = 8u;
const float CLEARCOAT_LOWER_ROUGHNESS = 63.0;
const float CLEARCOAT_LOWER_F0 = 127.0;
const float CLEARCOAT_LOWER_F90 = 15.0;
const float CLEARCOAT_WEIGHT = 63.0;
const float CLEARCOAT_ROUGHNESS = 63.0;

// sheen, SheenTable.
const float SHEEN_MIN_ROUGHNESS = 0.07000000029802322;
const float SHEEN_MIN_COSINE = 0.0010000000474974513;
const uint SHEEN_TABLE_SIZE = 64u;
const uint SHEEN_NODES = 16u;

// solid_angle.
const float COSINE_WARP_EVEN_SHARE = 0.10000000149011612;
const float COSINE_WARP_MIN_EVEN = 9.999999960041972e-13;
const float SOLID_ANGLE_NEAR = 32.0;
const float SOLID_ANGLE_MIN_HEIGHT = 4.76837158203125e-7;

// Minimum squared radius that an estimate divides by: neighbour_radius.
const float NEIGHBOUR_MIN_RADIUS_SQUARED = 9.094947017729282e-13;

// PhotonMoments.
const float ERROR_MOMENTS_OFF_PLANE = 0.25;
const float MOMENTS_MIN_PHOTONS = 8.0;
const float MOMENTS_MAX_STRAY = 0.019999999552965164;
const float MOMENTS_MAX_OFFSET = 0.25;
const float MOMENTS_MAX_QUADRUPOLE = 0.05000000074505806;

// ConfidenceInterval.
const float INTERVAL_MIN_PHOTONS = 32.0;
const float INTERVAL_MIN_BOUNDED_PHOTONS = 8.0;
const float INTERVAL_MINOR = 0.05000000074505806;

// PixelRadii: bounds of the factor on r, largest change of its square, pixels to each side.
const float RADII_LEAST = 0.25;
const float RADII_GREATEST = 2.8284270763397217;
const float RADII_STEP = 2.0;
const uint RADII_REACH = 2u;

// kd_tree.
const uint KD_TREE_WIDTH = 16u;
const uint KD_TREE_LEAF = 2147483648u;
const uint KD_TREE_MAX_DEPTH = 64u;
const uint VVH_SLABS = 32u;
const uint VVH_SAMPLE = 64u;
const uint VVH_HEURISTIC_DEPTH = 24u;
const int MORTON_BITS = 21;

// CompressedTree.
const uint BVH_MAX_DEPTH = 32u;
const float BVH_PLANE_TOLERANCE = 4.76837158203125e-7;

#endif
