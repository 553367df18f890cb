// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>

#include "tests/bench/run/ladder.h"

namespace pm::bench {

// The same scene with its spheres as meshes, read from OBJ by pm_host.
struct TessellatedFloor {
    double common = 0;      // error of two renders in common, against the reference
    double difference = 0;  // energy of what the tessellation alone changes
};

// Renders the scene's OBJ form twice as `step` was rendered (which must hold two pictures). Nothing
// when the script neutral_to_obj.py is not beside scenesFile, or there is no python3. Throws
// Error(kInternal) when a program fails.
std::optional<TessellatedFloor> tessellatedFloor(const NeutralScene& scene,
                                                 const std::filesystem::path& scenesFile,
                                                 const Yardstick& yardstick,
                                                 const LadderRequest& request,
                                                 const LadderStep& step);

}  // namespace pm::bench
