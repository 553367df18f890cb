// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace pm::host::pov {

// Where something stands in the text of a scene or an include file.
struct Place {
    std::shared_ptr<const std::string> file;
    std::uint32_t line{};    // from 1
    std::uint32_t column{};  // from 1, bytes

    // "FILE:LINE:COLUMN"
    std::string text() const;
};

}  // namespace pm::host::pov
