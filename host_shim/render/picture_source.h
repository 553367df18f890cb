// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "host_shim/render/plugin.h"

namespace pm::host {

// What a picture is read from: a render, or parts that were put together. Errors: those of the
// plugin.
class PictureSource {
  public:
    virtual ~PictureSource() = default;

    virtual const PluginContext& context() const = 0;
    const PmrApi& api() const { return context().api(); }

    virtual std::uint32_t layerCount() const = 0;
    virtual PmrLayerInfo layerInfo(std::uint32_t index) const = 0;
    // All channels side by side, row by row.
    virtual void readPixels(const PmrRectangle& rectangle, const char* layer,
                            float* destination) const = 0;
    virtual std::string settingText(const std::string& name) const = 0;
    virtual std::string statistics() const = 0;  // JSON
};

}  // namespace pm::host
