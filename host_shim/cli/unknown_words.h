// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pm::host {

// What to say of words of a command line that belong to no option of the app: which are none, and
// which option each may be a slip of the hand for, or does here what it does elsewhere. unknown: in
// the order given, at least one.
std::string aboutUnknownWords(const CLI::App& app, const std::vector<std::string>& unknown);

// The same of an option with one dash in place of two ("-output x.exr"), which would be read as
// letters with their values, and of a word such as "+W640", which would be a file; "" where there
// is none.
std::string aboutSigns(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace pm::host
