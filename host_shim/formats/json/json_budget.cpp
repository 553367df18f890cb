// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/json/json_budget.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

// What we write ourselves takes about four times as much, lists of numbers of three letters eight.
constexpr std::uint64_t kOfTextByte = 8;
constexpr std::uint64_t kAlways = std::uint64_t{4} << 20;
constexpr double kMib = 1024.0 * 1024.0;

}  // namespace

JsonBudget::JsonBudget(std::string file, std::uint64_t textBytes, std::uint64_t memoryLimit)
    : m_file(std::move(file)), m_most(kAlways + kOfTextByte * textBytes) {
    m_isMemoryLimit = memoryLimit > 0 && memoryLimit < m_most;
    if (m_isMemoryLimit) m_most = memoryLimit;
}

JsonBudget JsonBudget::ofLimit(std::string file, std::uint64_t memoryLimit) {
    JsonBudget budget(std::move(file), 0);
    budget.m_isMemoryLimit = true;
    budget.m_most = memoryLimit == 0 ? std::numeric_limits<std::uint64_t>::max() : memoryLimit;
    return budget;
}

void JsonBudget::refuse() const {
    throw HostError(
        m_isMemoryLimit ? ExitCode::kMemory : ExitCode::kBadInput,
        fmt::format("{}: what it says takes more than {:.1f} MiB of memory, {}", m_file,
                    static_cast<double>(m_most) / kMib,
                    m_isMemoryLimit ? "the limit (--memory-limit)" : "the most for its size"));
}

}  // namespace pm::host
