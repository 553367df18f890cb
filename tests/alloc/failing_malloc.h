// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The memory of the whole process, one allocation of which can be made to fail. failing_malloc.cpp
// defines malloc and its relatives in the program, and those go before the C library's for every
// library that is loaded: operator new, Embree, TBB, OpenImageIO, OpenSubdiv, xxHash, and the place
// of thread-local variables. Anonymous maps count too: TBB's and Embree's own stores live on them.
#pragma once

#include <array>
#include <cstdint>

namespace pm::test {

// A stack as backtrace() gives it.
struct Stack {
    std::array<void*, 48> frames{};
    int count = 0;
};

// Counts from 0 again; the number-th allocation from now on, of whatever thread, fails, and no
// other. 0: none. Where it fails, its stack goes to `failed` (may be null).
void failAllocation(std::uint64_t number, Stack* failed);

// Since failAllocation.
std::uint64_t allocationCount();
bool hasFailed();

// Allocated and not freed by now.
std::int64_t liveAllocations();

}  // namespace pm::test
