//! The conformance suite, as generic functions over a backend: every backend runs the same tests.
//!
//! Names begin with the number of the closed form or of the failure mode in the tables of `tests/README.md`. Random
//! numbers are fixed by seeds; statistical bounds are 4.5 standard errors, computed where they are used.
#![forbid(unsafe_code)]
#![expect(clippy::unwrap_used, clippy::missing_panics_doc, reason = "all of this is test code")]

pub mod accuracy;
pub mod aiming;
pub mod alpha;
pub mod alpha_surfaces;
pub mod anisotropy;
pub mod backends;
pub mod blocks;
pub mod boundaries;
pub mod bright_texels;
pub mod camera_samples;
pub mod caustic_roughness;
pub mod clearcoat;
mod closed_room;
pub mod coated_lights;
pub mod debias;
pub mod determinism;
pub mod dielectrics;
pub mod diffuse_transmission;
pub mod direct;
pub mod dispersion;
pub mod display;
pub mod edges;
pub mod environment;
pub mod equivalence;
pub mod estimators;
pub mod everything;
pub mod extremes;
pub mod fields;
pub mod footprint;
pub mod forecasts;
pub mod furnace_pixels;
pub mod gloss;
pub mod gloss_behind_glass;
pub mod gloss_caustics;
mod gloss_reference;
pub mod harness;
pub mod inside;
pub mod interreflection;
pub mod lens;
pub mod lights_outside;
pub mod many_lights;
pub mod media;
pub mod media_equivalence;
pub mod media_grids;
pub mod media_spots;
pub mod mirrors_and_glass;
pub mod narrow_estimates;
pub mod nesting;
pub mod numerics;
pub mod odd_normals;
pub mod paper;
pub mod partial_transmission;
pub mod photon_formats;
pub mod portals;
pub mod precision;
pub mod rainbow;
pub mod required_format;
pub mod rough_glass;
pub mod rough_glass_photons;
pub mod shading_normals;
pub mod shadow_terminator;
pub mod sheen;
pub mod sheets;
pub mod smooth_metals;
pub mod specular_colors;
pub mod stats;
pub mod stopping;
mod stripes;
pub mod sun;
pub mod surface_claims;
pub mod tangents;
pub mod texture_limits;
pub mod textures;
pub mod touching;
pub mod twin;
pub mod views;

/// The examples in the README, compiled and run as doctests. Packages of the library contain no file from outside of their
/// folder, so they stand here.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

/// The examples in the guide, likewise.
#[cfg(doctest)]
#[doc = include_str!("../../docs/getting-started.md")]
struct GettingStarted;

/// Generates a `#[test]` of each function for one backend.
#[macro_export]
macro_rules! suite {
    ($backend:ty, $($module:ident :: { $($name:ident),+ $(,)? })+) => {
        $(mod $module {
            #[allow(unused_imports, reason = "not needed if the backend is named by its full path")]
            use super::*;
            $(#[test]
            fn $name() {
                if <$backend as $crate::harness::TestBackend>::available() {
                    $crate::$module::$name::<$backend>();
                    $crate::harness::drop_kept();
                }
            })+
        })+
    };
}

/// All tests for one backend, in one list, so that every backend runs all of them.
#[macro_export]
macro_rules! whole_suite {
    ($backend:ty) => {
        $crate::suite! {
            $backend,
            accuracy::{
                e1_claims_hold_in_smooth_fields, e2_edges_have_intervals_and_folds_are_flagged, e3_noise_alone_does_not_cover,
                e4_spread_of_known_photons, e5_errors_leave_the_picture_alone, e6_gathered_light_is_claimed,
                e8_an_error_asked_for_is_reached,
            }
            forecasts::{ e9_what_an_error_takes_is_foretold }
            debias::{
                d1_light_at_edges_is_whole, d2_nothing_changes_within_a_surface, d3_irradiance_found_beforehand,
                d4_radii_of_pixels_keep_the_mean, d7_second_radii_at_ends_tell_no_bias,
                d8_errors_change_no_share_of_the_picture,
            }
            sheets::{
                d5_a_sheet_beside_does_not_shine_through, d6_a_sheet_in_the_shade_is_dark, d9_a_board_above_hides_no_area,
            }
            aiming::{
                g1_aimed_photons_have_the_same_expectation, g2_all_ways_to_something_specular_are_marked,
                g3_aimed_pictures_have_the_same_mean, g4_aimed_paths_are_accounted_for,
                g5_directions_about_poles_are_fine,
            }
            edges::{ s1_no_light_through_edges }
            estimators::{
                a1_naive_knn_is_too_bright, a2_corrected_knn_is_unbiased, a3_kernel_in_knn_is_unbiased,
                a6_fixed_radius_mean_and_variance, a7_bias_of_curvature, a8_loss_at_edges, a9_no_bias_on_a_sphere,
                a12_progressive_variance, a13_threshold_darkens,
            }
            footprint::{ a15_spots_narrower_than_a_pixel_are_found, a16_radii_are_at_least_half_a_pixel }
            direct::{
                b1_point_light, b2_flux_through_a_disc, b3_lambertian_disc, b4_rectangle, b5_form_factors,
                b8_power_of_emitters, b9_area_lights_near_by, b10_no_shadow_ray_outshines_its_area_light,
                b11_each_light_has_a_shadow_ray, direct_light_by_photons_agrees,
            }
            lights_outside::{ lights_outside_give_what_arrives }
            many_lights::{
                g14_grid_of_point_lights, v14_powers_apart_and_coincident_lights, sun_among_many_lights,
            }
            interreflection::{
                c1_furnace, c1_furnace_of_high_albedo, c1_depth_cap, c2_integrating_sphere, c3_sphere_of_two_halves,
                c6_plates_between_mirrors, c7_point_light_and_mirrors, c8_path_lengths, c9_conservation,
            }
            dielectrics::{
                t1_t2_t3_fresnel, t4_slab, camera_paths_through_dark_glass, t6_light_at_the_centre, t7_trapped_light,
                t9_ball_lens, t13_ior_one_is_invisible,
            }
            inside::{
                g1_even_sky_over_glass, light_inside_glass, furnace_with_glass, glow_from_inside,
                light_through_an_absorber, light_in_an_absorber,
            }
            touching::{
                glass_on_a_floor, layers_in_contact, clear_layers_in_even_light, the_order_of_meshes_changes_no_bit,
            }
            dispersion::{
                p22_prism, p24_slab, even_light_stays_white, gathered_light_stays_white,
                dispersion_is_required_where_it_is,
            }
            rainbow::{ p21_rainbow }
            media::{
                p2_airlight, p2_sees_the_direction_of_scattering, p3_shaft, p10_slabs, p12_furnace, p13_body_in_even_light,
                light_of_fog_is_not_gathered_twice,
                intervals_of_a_shaft,
                p14_endless_fog, memory_is_limited_with_a_mirror, paths_are_accounted_for,
                radius_of_more_pixels_than_tell_it, what_media_do_not_go_with_is_refused,
            }
            media_spots::{ light_of_spots_is_scattered_once, spots_beside_the_view_are_not_seen }
            media_grids::{
                airlight_in_a_slope, slopes_let_light_through, clouds_in_even_light, even_grids_are_homogeneous,
                thick_grids_scatter_as_much,
            }
            boundaries::{
                rays_cross_media, shadow_rays_and_photons_pass, p3_shaft, p12_furnace, a_clear_boundary_changes_no_bit,
            }
            nesting::{
                p20_glass_on_water, camera_in_three_solids, light_in_two_solids, a_fifth_solid_is_counted,
                nesting_is_required_where_it_is,
            }
            paper::{a14_extra_cosine_loses_a_third, the_clamp_is_the_papers}
            numerics::{
                s1_no_leaks, s1_no_leaks_through_slivers, s6_coincident_photons, s7_fewer_photons_than_k, s8_degenerate_maps, s9_not_finite,
                s10_n1_many_small_numbers, s15_albedo_one_ends_at_the_cap, s4_s17_scale_and_brightness,
                s19_random_numbers, s20_ends_of_the_unit_interval, s27_neighbour_sets_are_exact, s29_nothing_to_render,
                s30_least_of_everything,
            }
            required_format::{
                m1_grey_is_what_treats_channels_alike, m2_less_is_the_same_picture, m3_too_little_is_refused,
            }
            photon_formats::{ m4_the_same_photons_are_found }
            gloss::{
                g4_white_furnace, highlights_of_a_point_light, reflections_of_an_area_light, caustics_of_a_glossy_plate,
                textured_specular_factor, g5_closed_room,
            }
            smooth_metals::{
                g15_a_narrow_metal_is_a_mirror, v1_light_reflected_around_the_threshold,
                v1_seen_around_the_threshold, v1_furnace_around_the_threshold,
                v1_metals_brighten_towards_grazing, v1_invalid_roughness,
            }
            tangents::{ v4_tangents_without_a_frame }
            gloss_behind_glass::{ plastic_behind_panes }
            specular_colors::{ channels_are_grey_coats }
            clearcoat::{ white_furnace, sunlit_surfaces, own_normals }
            sheen::{ sunlit_surfaces, white_furnace, furnace_at_grazing_angles, g5_closed_room }
            coated_lights::{ seen_by_the_camera, light_of_a_wall, power_of_a_plate, furnace }
            anisotropy::{ brushed_plates }
            diffuse_transmission::{
                sunlit_from_behind, white_furnace, g5_closed_room, photons_leave_on_both_sides,
            }
            partial_transmission::{
                sunlit_surfaces, seen_through, light_on_a_floor, white_furnace, g5_closed_room, furnace_of_a_solid,
                two_texels_are_two_materials,
            }
            gloss_caustics::{
                sun_through_a_pane, photons_behind_a_pane_are_like_shadow_rays, tilted_normals_behind_a_pane,
                point_light_in_a_mirror, seen_in_another_metal, rough_panes_are_not_counted_twice,
                errors_and_requirements,
            }
            caustic_roughness::{
                area_light_behind_a_pane, area_light_in_a_mirror, lights_of_both_kinds, white_furnace, g5_closed_room,
                all_values_have_the_same_expectation, counting_twice_is_seen, only_what_it_is_for_is_changed,
            }
            rough_glass::{ g4_white_furnace, light_behind_a_boundary, g5_closed_room }
            rough_glass_photons::{
                g6_photons_through_a_boundary, v1_seen_through_sheets_around_the_threshold,
            }
            furnace_pixels::{ g4_every_pixel }
            narrow_estimates::{ g7_variance_of_narrow_reflections }
            surface_claims::{ claims_hold_on_textures, claims_hold_on_glossy_surfaces }
            bright_texels::{ v6_claims_under_a_bright_texel, v13_power_of_odd_environments }
            odd_normals::{ v12_bad_vertex_normals, v12_bad_normal_maps }
            texture_limits::{ g8_textured_floor_under_an_even_sky, v11_extreme_transforms }
            everything::{ v16_sizes_and_requirements }
            textures::{
                g8_textured_floor, g8_textured_floor_by_photons, v9_16384_squared, g13_ramp_light, two_coloured_light, vertex_colours,
            }
            alpha::{
                g12_sheets_transmit, g12_masks_transmit, v15_a_thousand_sheets,
            }
            alpha_surfaces::{
                a_sheet_reflects_its_share, a_light_emits_its_share, holes_show_the_environment, g5_furnace_with_sheets, opaque_scenes_are_unchanged,
            }
            shading_normals::{
                g9_parallel_light, g9_light_from_the_sides, g9_even_sky, photons_scattered_by_a_tilted_normal,
                a_mirror_with_tilted_normals, smooth_balls_in_an_even_shell,
            }
            shadow_terminator::{
                parallel_light_on_a_coarse_sphere, hollow_and_flat_meshes_are_unchanged, offsets_do_not_pass_through_walls,
                furnace_of_coarse_spheres,
            }
            environment::{
                sky_and_sun, g10_plate_under_a_gradient, g10_power, seen_by_the_camera, g10_one_texel_among_lights,
                even_light_through_glass, transparent_background,
            }
            portals::{ flux_does_not_depend_on_portals, more_photons_enter, aimed_photons_do_not_need_portals }
            sun::{
                g11_irradiance, g11_seen_by_the_camera, g11_seen_in_a_paraboloid, g11_focus_of_a_paraboloid,
                g11_aimed_at_a_mirror,
            }
            mirrors_and_glass::{
                in_an_even_environment, a_light_in_a_mirror, cut_paths_are_counted, cut_gather_rays_are_counted,
            }
            camera_samples::{
                means_are_those_of_one_sample, maps_are_read_for_the_first_sample, noise_falls_with_their_number,
                first_surfaces_are_means,
            }
            lens::{ l1_edge_out_of_focus, l2_in_focus, l3_invalid_lenses }
            views::{ v1_hand_filled_views_are_checked }
            blocks::{ films_of_blocks }
            stopping::{
                abandoned_passes_leave_no_trace, films_know_their_camera_samples, blocks_before_an_abandoned_one_are_kept, a_first_pass_may_have_fewer_samples,
            }
            display::{ pictures_while_rendering_are_those_of_the_film }
            determinism::{
                photons_do_not_depend_on_sharing, pictures_do_not_depend_on_threads, pictures_do_not_depend_on_batches,
                wider_requirements_change_nothing, forecasts_change_nothing, passes_merge, one_backend_renders_again, a_restart_is_a_fresh_start, other_settings_are_a_fresh_start, s31_full_photon_buffers,
            }
        }
    };
}
