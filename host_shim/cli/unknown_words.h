// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pm::host {

// What to say of words of a command line that belong to no option of the app: which is none, and
// which option it may be a slip of the hand for. unknown: in the order given, at least one.
std::string aboutUnknownWords(const CLI::App& app, const std::vector<std::string>& unknown);

}  // namespace pm::host
