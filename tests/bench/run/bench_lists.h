// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace pm::bench {

// Of one value or more.
inline double meanOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

// Whether a key is among those that were asked for, with commas between; all are where none was.
inline bool isAskedFor(const std::string& keys, const std::string& key) {
    if (keys.empty()) return true;
    std::istringstream all(keys);
    for (std::string wanted; std::getline(all, wanted, ',');)
        if (wanted == key) return true;
    return false;
}

}  // namespace pm::bench
