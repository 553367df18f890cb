// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/formats/scene_reader.h"

namespace pm::host {

// Text with a triangle a line: "matt" or "lamp", then nine coordinates.
class TriReader : public SceneReader {
  public:
    std::string_view name() const override { return "a TRI file"; }
    std::span<const std::string_view> endings() const override;
    SceneData read(const ReadRequest& request) const override;
};

}  // namespace pm::host
