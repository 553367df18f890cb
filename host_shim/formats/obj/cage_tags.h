// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host_shim/formats/obj/mesh_assembly.h"
#include "host_shim/formats/obj/obj_text.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Which faces of the file a mesh holds: [first, first + count).
struct FaceRange {
    std::uint64_t first{};
    std::uint64_t count{};
};

// Tags that are obeyed; docs/obj_mtl.md has a row for each.
std::vector<std::string> cageTagNames();

// Turns the t statements of a group into tags of its mesh; assembly has just assembled it.
// Errors: kBadInput, with file and line, for a vertex that the group does not have, a face outside
// the file, and numbers that don't fit each other. What is not obeyed is warned of.
CageTags readCageTags(std::span<const SubdivisionTag> tags, const MeshAssembly& assembly,
                      FaceRange faces, const std::string& fileName, const WarningSink& warn);

}  // namespace pm::host
