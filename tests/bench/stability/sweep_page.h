// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <span>

#include "tests/bench/stability/sweep.h"

namespace pm::bench {

// Writes the page, and beside it lab/NAME.csv with all points and the plots into
// images/NAME/, NAME being the page's without .md. Throws Error(kIo).
void writeSweepPage(const std::filesystem::path& page, std::span<const SweepResult> results);

// "placement, moved (photon): flat from 1 to 1e+08: ..." in one line.
std::string outcomeLine(const SweepResult& result, double limit);

}  // namespace pm::bench
