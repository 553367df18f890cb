// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/lexer/words.h"

#include <algorithm>
#include <array>

namespace pm::host::pov {
namespace {

struct Words {
    WordUse use;
    std::string_view words;  // with blanks between them
};

// POV-Ray 3.7's reserved words, as its manual's 3.3.1.2 lists them.
constexpr std::array<Words, 9> kWords{{
    {WordUse::kDirective,
     "break case debug declare default else elseif end error fclose fopen for if ifdef ifndef "
     "include local macro range read render statistics switch undef warning while write"},
    {WordUse::kConstant, "false no off on pi t true u v x y yes z"},
    {WordUse::kVariable,
     "clock clock_delta clock_on final_clock final_frame frame_number image_height image_width "
     "initial_clock initial_frame input_file_name now version"},
    {WordUse::kNumberFunction,
     "abs acos acosh asc asin asinh atan atan2 atanh bitwise_and bitwise_or bitwise_xor "
     "ceil cos cosh defined degrees dimension_size dimensions div exp file_exists floor inside "
     "int ln log max max_extent min min_extent mod pow prod radians rand seed select sin sinh "
     "sqr sqrt strcmp strlen sum tan tanh trace val vaxis_rotate vcross vdot vlength vnormalize "
     "vrotate vturbulence"},
    {WordUse::kTextFunction, "chr concat datetime str strlwr strupr substr vstr"},
    {WordUse::kColour, "color colour"},
    {WordUse::kColourVector, "rgb rgbf rgbft rgbt srgb srgbf srgbft srgbt"},
    {WordUse::kColourComponent, "alpha blue filter gray green red transmit"},
    {WordUse::kStatement,
     "aa_level aa_threshold absorption accuracy adaptive adc_bailout agate agate_turb albedo "
     "all all_intersections altitude always_sample ambient ambient_light angle aoi aperture "
     "append arc_angle area_illumination area_light array ascii assumed_gamma autostop average "
     "b_spline background bezier_spline bicubic_patch black_hole blob blur_samples bokeh "
     "bounded_by box boxed bozo brick brick_size brightness brilliance bump_map bump_size "
     "bumps camera caustics cells charset checker circular clipped_by collect color_map "
     "colour_map component cone confidence conic_sweep conserve_energy contained_by "
     "control0 control1 coords count crackle crand cube cubic cubic_spline cubic_wave "
     "cutaway_textures cylinder cylindrical density density_file density_map dents "
     "deprecated df3 difference diffuse direction disc dispersion dispersion_samples dist_exp "
     "distance double_illuminate eccentricity emission error_bound evaluate expand_thresholds "
     "exponent exterior extinction face_indices facets fade_color fade_colour "
     "fade_distance fade_power falloff falloff_angle finish fisheye flatness flip focal_point "
     "fog fog_alt fog_offset fog_type form frequency fresnel function gamma gather gif "
     "global_lights global_settings gradient granite gray_threshold height_field "
     "hexagon hf_gray_16 hierarchy hollow hypercomplex iff image_map image_pattern "
     "importance inside_vector interior interior_texture internal interpolate intersection "
     "intervals inverse ior irid irid_wavelength isosurface jitter jpeg julia julia_fractal "
     "lambda lathe leopard light_group light_source linear_spline linear_sweep load_file "
     "location look_at looks_like low_error_factor magnet major_radius mandel map_type "
     "marble material material_map matrix max_distance max_gradient max_intersections "
     "max_iteration max_sample max_trace max_trace_level maximum_reuse media media_attenuation "
     "media_interaction merge mesh mesh2 mesh_camera metallic method metric minimum_reuse "
     "mm_per_unit mortar natural_spline nearest_count no_bump_scale no_image no_radiosity "
     "no_reflection no_shadow noise_generator normal normal_indices normal_map normal_vectors "
     "number_of_waves object octaves offset omega omnimax once onion open orient orientation "
     "orthographic ovus panoramic parallel parametric pass_through pattern pavement perspective "
     "pgm phase phong phong_size photons pigment pigment_map pigment_pattern planar plane png "
     "point_at poly poly_wave polygon polynomial pot ppm precision precompute premultiplied "
     "pretrace_end pretrace_start prism projected_through pwr quadratic_spline quadric quartic "
     "quaternion quick_color quick_colour quilted radial radiosity radius rainbow ramp_wave "
     "ratio rays_per_pixel reciprocal recursion_limit reflection reflection_exponent refraction "
     "repeat right ripples rotate roughness samples save_file scale scallop_wave scattering "
     "shadowless sine_wave sint16be sint16le sint32be sint32le sint8 size sky sky_sphere slice "
     "slope slope_map smooth smooth_triangle solid sor spacing specular sphere sphere_sweep "
     "spherical spiral1 spiral2 spline split_union spotlight spotted square strength sturm "
     "subsurface superellipsoid sys target text texture texture_list texture_map tga thickness "
     "threshold tiff tightness tile2 tiles tiling tolerance toroidal torus transform translate "
     "translucency triangle triangle_wave triangular ttf turb_depth turbulence type u_steps "
     "uint16be uint16le uint8 ultra_wide_angle union up use_alpha use_color use_colour "
     "use_index utf8 uv_indices uv_mapping uv_vectors v_steps variance vertex_vectors warp "
     "water_level waves width wood wrinkles"},
}};

}  // namespace

Names::Names() {
    for (const Words& group : kWords) {
        std::string_view rest = group.words;
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find(' '), rest.size());
            m_reservedTexts.push_back(rest.substr(0, end));
            id(m_reservedTexts.back());
            m_uses.resize(m_texts.size(), group.use);
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
    }
    m_reserved = static_cast<NameId>(m_texts.size());
}

NameId Names::id(std::string_view name) {
    if (const auto found = m_ids.find(name); found != m_ids.end()) return found->second;
    const auto id = static_cast<NameId>(m_texts.size());
    m_texts.emplace_back(name);
    m_ids.emplace(name, id);
    return id;
}

}  // namespace pm::host::pov
