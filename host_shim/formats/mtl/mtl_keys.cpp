// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/mtl_keys.h"

#include <algorithm>
#include <array>

#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

using enum MtlKind;

constexpr std::array<MtlKey, 52> kKeys{{
    {"Kd", "Kd", kColour},
    {"Ks", "Ks", kColour},
    {"Ke", "Ke", kColour},
    {"Tf", "Tf", kColour},
    {"Kt", "Tf", kColour},
    {"Ka", "Ka", kColour},
    {"Ns", "Ns", kNumber},
    {"Ni", "Ni", kNumber},
    {"d", "d", kNumber},
    {"Tr", "Tr", kNumber},
    {"illum", "illum", kNumber},
    {"Pr", "Pr", kNumber},
    {"Pm", "Pm", kNumberLeftOut},
    {"Ps", "Ps", kNumber},
    {"Pc", "Pc", kNumber},
    {"map_Kd", "map_Kd", kMap},
    {"map_Ks", "map_Ks", kMap},
    {"map_Ke", "map_Ke", kMap},
    {"map_Tf", "map_Tf", kMap},
    {"map_Kt", "map_Tf", kMap},
    {"map_Ns", "map_Ns", kMap},
    {"map_d", "map_d", kMap},
    {"map_opacity", "map_d", kMap},
    {"map_Pr", "map_Pr", kMap},
    {"map_Pm", "map_Pm", kMapOfNumber},
    {"map_Ps", "map_Ps", kMapOfNumber},
    {"map_Pc", "map_Pc", kMapOfNumber},
    {"map_Pcr", "map_Pcr", kMapOfNumber},
    {"map_aniso", "map_aniso", kMapOfNumber},
    {"map_anisor", "map_anisor", kMapOfNumber},
    {"map_Tr", "map_Tr", kMapLeftOut},
    {"map_Ni", "map_Ni", kMapLeftOut},
    {"bump", "map_bump", kMap},
    {"map_bump", "map_bump", kMap},
    {"norm", "norm", kMap},
    {"map_norm", "norm", kMap},
    {"map_Kn", "norm", kMap},
    {"disp", "disp", kMap},
    {"map_disp", "disp", kMap},
    {"refl", "refl", kMapLeftOut},
    {"map_refl", "map_refl", kMapLeftOut},
    {"map_ao", "map_ao", kNoWeight},
    {"map_Ka", "map_Ka", kNoWeight},
    {"map_aat", "map_aat", kNoWeight},
    {"sharpness", "sharpness", kNoWeight},
    {"aniso", "aniso", kNumber},
    {"anisor", "anisor", kNumber},
    {"Pcr", "Pcr", kNumber},
    {"decal", "decal", kNoWeight},
    {"Km", "Km", kNoWeight},
    {"map_decal", "map_decal", kNoWeight},
    {"newmtl", "newmtl", kNoWeight},
}};

constexpr std::array<MapOption, 14> kOptions{{
    {"-s", MapOptionKind::kNumbers, 3, 1, true},
    {"-o", MapOptionKind::kNumbers, 3, 0, true},
    {"-mm", MapOptionKind::kNumbers, 2, 1, true},
    {"-clamp", MapOptionKind::kOnOff, 0, 0, true},
    {"-colorspace", MapOptionKind::kWord, 0, 0, true},
    {"-imfchan", MapOptionKind::kWord, 0, 0, false},
    {"-t", MapOptionKind::kNumbers, 3, 0, false},
    {"-cc", MapOptionKind::kOnOff, 0, 0, false},
    {"-blendu", MapOptionKind::kOnOff, 0, 0, false},
    {"-blendv", MapOptionKind::kOnOff, 0, 0, false},
    {"-boost", MapOptionKind::kNumbers, 1, 0, false},
    {"-bm", MapOptionKind::kNumbers, 1, 1, true},
    {"-type", MapOptionKind::kWord, 0, 0, false},
    {"-texres", MapOptionKind::kWord, 0, 0, false},
}};

}  // namespace

std::span<const MtlKey> mtlKeys() {
    return kKeys;
}

const MtlKey* findMtlKey(std::string_view word) {
    const auto found = std::ranges::find_if(
        kKeys, [word](const MtlKey& key) { return equalInAnyCase(word, key.key); });
    return found != kKeys.end() ? &*found : nullptr;
}

std::span<const MapOption> mapOptions() {
    return kOptions;
}

const MapOption* findMapOption(std::string_view word) {
    const auto found = std::ranges::find_if(
        kOptions, [word](const MapOption& option) { return equalInAnyCase(word, option.option); });
    return found != kOptions.end() ? &*found : nullptr;
}

}  // namespace pm::host
