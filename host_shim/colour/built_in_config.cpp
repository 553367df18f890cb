// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/built_in_config.h"

#include <sstream>

namespace pm::host {
namespace {

// The second alias of a space is its ID of the colour-interop forum [1], the others are what
// published configs call it. Everything is made of OpenColorIO's builtin transforms and the
// curve of IEC 61966-2-1. The reference space is ACES2065-1; the white point is adapted by
// Bradford's matrix.
// [1] ASWF Color Interop Forum, "Color Space Encodings for Texture Assets and CG Rendering"
constexpr const char* kBuiltInConfig = R"(ocio_profile_version: 2.1
name: pm-built-in-1
description: pm's own config, without LUT files
environment: {}
search_path: ""
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]

roles:
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE XYZ D65
  color_picking: sRGB texture
  data: raw
  default: raw
  scene_linear: Linear Rec.709
  texture_paint: sRGB texture

file_rules:
  - !<Rule> {name: Default, colorspace: raw}

displays:
  sRGB:
    - !<View> {name: ACES SDR, view_transform: ACES SDR, display_colorspace: sRGB display}
    - !<View> {name: untone-mapped, view_transform: untone-mapped, display_colorspace: sRGB display}
    - !<View> {name: raw, colorspace: raw}
  Rec.1886:
    - !<View> {name: ACES SDR, view_transform: ACES SDR, display_colorspace: Rec.1886 display}
    - !<View> {name: untone-mapped, view_transform: untone-mapped, display_colorspace: Rec.1886 display}
    - !<View> {name: raw, colorspace: raw}

active_displays: [sRGB, Rec.1886]
active_views: [ACES SDR, untone-mapped, raw]
inactive_colorspaces: [CIE XYZ D65]
default_view_transform: untone-mapped

view_transforms:
  - !<ViewTransform>
    name: untone-mapped
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}

  - !<ViewTransform>
    name: ACES SDR
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}

display_colorspaces:
  - !<ColorSpace>
    name: CIE XYZ D65
    aliases: [cie_xyz_d65, lin_ciexyzd65_display]
    encoding: display-linear
    isdata: false

  - !<ColorSpace>
    name: sRGB display
    aliases: [srgb_display, srgb_rec709_display]
    encoding: sdr-video
    isdata: false
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}

  - !<ColorSpace>
    name: Rec.1886 display
    aliases: [rec1886_rec709_display, g24_rec709_display]
    encoding: sdr-video
    isdata: false
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}

colorspaces:
  - !<ColorSpace>
    name: Linear Rec.709
    aliases: [lin_rec709, lin_rec709_scene, lin_rec709_srgb, lin_srgb]
    encoding: scene-linear
    isdata: false
    to_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}

  - !<ColorSpace>
    name: ACEScg
    aliases: [lin_ap1, lin_ap1_scene]
    encoding: scene-linear
    isdata: false
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}

  - !<ColorSpace>
    name: ACES2065-1
    aliases: [aces2065_1, lin_ap0_scene, lin_ap0]
    encoding: scene-linear
    isdata: false

  - !<ColorSpace>
    name: sRGB texture
    aliases: [srgb_tx, srgb_rec709_scene, srgb_texture, sRGB]
    encoding: sdr-video
    isdata: false
    to_scene_reference: !<GroupTransform>
      children:
        - !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0]}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}

  - !<ColorSpace>
    name: raw
    aliases: [utility_raw]
    encoding: data
    isdata: true
)";

}  // namespace

OCIO_NAMESPACE::ConstConfigRcPtr makeBuiltInConfig() {
    std::istringstream text(kBuiltInConfig);
    return OCIO_NAMESPACE::Config::CreateFromStream(text);
}

}  // namespace pm::host
