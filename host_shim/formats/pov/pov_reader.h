// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/formats/scene_reader.h"

namespace pm::host {

// Scenes of POV-Ray 3.7: docs/povray.md has what of the language is read and what is rendered.
class PovReader : public SceneReader {
  public:
    std::string_view name() const override { return "a POV-Ray scene"; }
    std::span<const std::string_view> endings() const override;
    SceneData read(const ReadRequest& request) const override;
};

}  // namespace pm::host
