// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

namespace pm::plugin {

// Who made the processor that this runs on, as it says of itself ("GenuineIntel", "AuthenticAMD");
// "unknown" where it says nothing. The same bits are promised among processors of one vendor only.
const std::string& processorVendor();

}  // namespace pm::plugin
