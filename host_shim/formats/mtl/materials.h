// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

using NameFilter = std::function<bool(const std::string& name)>;

// Where an MTL text comes from, and how it is read.
struct MtlSource {
    std::string fileName;          // for messages
    std::filesystem::path folder;  // where picture names begin
    MtlDialect dialect{MtlDialect::kGeneric};
};

// The material of faces that name none, or one that no library has: grey, Kd 0.8.
MaterialData defaultMaterial(const std::string& name);

// The materials of an MTL text, by name; of two with the same name the first counts. What can't be
// rendered, is out of range or is not understood is warned of as "FILE:LINE: material NAME: ...".
// Meaning, once it is translated from its dialect: illum 3 with Ks is a mirror (Ns, when given, its
// roughness), illum 5 a mirror with Fresnel, illum 4, 6, 7 or d below 1 with an Ni a dielectric
// tinted by Tf, d below 1 without Ni lets light straight through, all else is diffuse plus a glossy
// lobe of exponent Ns.
// isUsed: those of whose names it says no are passed over, whatever is wrong with them; empty: all
// count.
std::map<std::string, MaterialData> readMaterials(std::string_view mtlText, const MtlSource& source,
                                                  SceneFiles& files, const WarningSink& warn,
                                                  const NameFilter& isUsed = {});

}  // namespace pm::host
