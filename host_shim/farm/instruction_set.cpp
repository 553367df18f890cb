// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/instruction_set.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

namespace pm::host {
namespace {

struct InstructionSet {
    const char* name;
    std::vector<std::string_view> flags;  // that come to those of the one before
};

// From the least on; what Embree asks for (kernels/../sysinfo.h).
const std::array<InstructionSet, 5>& allSets() {
    static const std::array<InstructionSet, 5> sets{{
        {"sse2", {"sse2"}},
        {"sse4.2", {"ssse3", "sse4_1", "sse4_2", "popcnt"}},
        {"avx", {"avx"}},
        // Not abm, which Embree asks for, too: all that have bmi1 have it, and under some
        // hypervisors the system doesn't list it.
        {"avx2", {"avx2", "f16c", "rdrand", "fma", "bmi1", "bmi2"}},
        {"avx512", {"avx512f", "avx512dq", "avx512cd", "avx512bw", "avx512vl"}},
    }};
    return sets;
}

std::size_t rankOf(const std::string& name) {
    const auto found = std::ranges::find(
        allSets(), name, [](const InstructionSet& set) { return std::string(set.name); });
    return static_cast<std::size_t>(found - allSets().begin());
}

}  // namespace

std::string instructionSetOf(const std::string& cpuFlags) {
    std::set<std::string, std::less<>> flags;
    std::istringstream stream(cpuFlags);
    for (std::string flag; stream >> flag;) flags.insert(flag);
    std::string best = allSets().front().name;
    for (const InstructionSet& set : allSets()) {
        if (!std::ranges::all_of(set.flags, [&](std::string_view f) { return flags.contains(f); }))
            break;
        best = set.name;
    }
    return best;
}

std::string commonInstructionSet(const std::string& own, const std::vector<FarmMachine>& machines) {
    std::size_t least = rankOf(own);
    for (const FarmMachine& machine : machines)
        if (!machine.cpuFlags.empty())
            least = std::min(least, rankOf(instructionSetOf(machine.cpuFlags)));
    return least < allSets().size() ? allSets()[least].name : own;
}

}  // namespace pm::host
