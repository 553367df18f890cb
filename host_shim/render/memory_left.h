// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

namespace pm::host {

// Bytes that this process may still take: of limitGib (--memory-limit), or where that is 0 of the
// least limit of its cgroups, or else of 90 % of the machine's memory; and of its address space
// (ulimit -v). Threads: any; reads small files.
std::uint64_t memoryLeftBytes(double limitGib);

}  // namespace pm::host
