// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pm::host {

// The frames that a sequence names, in its order, each once: "3", "1-10", "1-10x3" (every third),
// "1-10y3" (all but every third), several separated by commas; OpenImageIO reads it.
// option: for messages. Errors: kUsage for another text, a number that --frame would not take, or
// more than 100,000 frames.
std::vector<std::int64_t> frameNumbers(const std::string& option, const std::string& text);

}  // namespace pm::host
