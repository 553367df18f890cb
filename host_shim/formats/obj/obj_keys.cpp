// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/obj_keys.h"

#include <algorithm>
#include <array>

namespace pm::host {
namespace {

using enum ObjStatement;

// The most frequent first.
constexpr std::array<ObjKey, 45> kKeys{{
    {"v", kVertex},
    {"vt", kTextureCoordinate},
    {"vn", kNormal},
    {"f", kFace},
    {"fo", kFace},
    {"g", kGroup},
    {"o", kGroup},
    {"usemtl", kMaterial},
    {"mtllib", kLibrary},
    {"t", kTag},
    {"l", kLeftOut},
    {"p", kLeftOut},
    {"curv", kLeftOut},
    {"surf", kLeftOut},
    {"cstype", kLeftOut},
    {"s", kNoWeight},
    {"mg", kNoWeight},
    {"vp", kNoWeight},
    {"vw", kNoWeight},
    {"lod", kNoWeight},
    {"bevel", kNoWeight},
    {"c_interp", kNoWeight},
    {"d_interp", kNoWeight},
    {"maplib", kNoWeight},
    {"usemap", kNoWeight},
    {"deg", kNoWeight},
    {"bmat", kNoWeight},
    {"step", kNoWeight},
    {"parm", kNoWeight},
    {"trim", kNoWeight},
    {"hole", kNoWeight},
    {"scrv", kNoWeight},
    {"sp", kNoWeight},
    {"end", kNoWeight},
    {"con", kNoWeight},
    {"bsp", kNoWeight},
    {"bzp", kNoWeight},
    {"cdc", kNoWeight},
    {"cdp", kNoWeight},
    {"shadow_obj", kNoWeight},
    {"trace_obj", kNoWeight},
    {"ctech", kNoWeight},
    {"stech", kNoWeight},
    {"curv2", kNoWeight},
    {"res", kNoWeight},
}};

}  // namespace

std::span<const ObjKey> objKeys() {
    return kKeys;
}

ObjStatement statementOf(std::string_view word) {
    const auto found =
        std::ranges::find_if(kKeys, [word](const ObjKey& entry) { return word == entry.key; });
    return found != kKeys.end() ? found->statement : kUnknown;
}

}  // namespace pm::host
