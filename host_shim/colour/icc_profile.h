// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "host_shim/colour/primaries.h"
#include "host_shim/colour/transfer_curve.h"

namespace pm::host {

// What an ICC profile says where it is three primaries behind one curve, or a curve of grey.
struct ProfileColours {
    TransferCurve curve{};
    std::optional<Chromaticities> chromaticities{};  // none of grey, and where they are Rec.709's
};

// Reads the tags rXYZ, gXYZ, bXYZ and rTRC, gTRC, bTRC, or kTRC of grey (ICC.1:2010). None for
// profiles of other kinds (tables of colours, three different curves, curves that no formula here
// has) and for broken ones: never more than `bytes` is looked at.
std::optional<ProfileColours> readIccProfile(std::span<const std::uint8_t> bytes);

}  // namespace pm::host
