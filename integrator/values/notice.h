// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

namespace pm {

// Something the user should know that does not stop the work. The codes are those of PMR_MESSAGE_*
// in pm_plugin.h.
enum class NoticeCode : std::int32_t {
    kNoLight = 100,
    kNoPhotons = 101,
    kNoCausticPhotons = 102,
    kBadValues = 103,
    kLostPhotons = 104,
    kDegenerateGeometry = 105,
    kTexture = 106,
    kNotCovered = 107,
};

struct Notice {
    NoticeCode code;
    std::string text;
};

}  // namespace pm
