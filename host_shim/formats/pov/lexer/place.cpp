// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/lexer/place.h"

#include <fmt/format.h>

namespace pm::host::pov {

std::string Place::text() const {
    return fmt::format("{}:{}:{}", file ? *file : std::string("?"), line, column);
}

}  // namespace pm::host::pov
