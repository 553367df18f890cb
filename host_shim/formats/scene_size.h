// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Bytes that a scene's lists take, with what the allocator adds.
std::uint64_t bytesOf(const SceneData& scene);

}  // namespace pm::host
