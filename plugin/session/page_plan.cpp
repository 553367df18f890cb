// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/page_plan.h"

#include <algorithm>

#include "plugin/session/render_photons.h"

namespace pm::plugin {

namespace {

// What is held, and what a map is traced and built in: each as much as the pages may take.
constexpr std::uint64_t kPagesTwice = 2;
constexpr double kMib = 1 << 20;

}  // namespace

void planPages(const Plan& plan, const SettingValues& values, std::uint64_t pointBytes,
               MemoryPlan& memory) {
    const auto demanded = static_cast<std::uint64_t>(values.number(Setting::kPhotonPages) * kMib);
    memory.smallest = memory.need.total();
    if (!plan.tracePhotons || RenderPhotons::isOnly(values)) return;
    const std::uint32_t passes = values.passLimit(), last = passes - 1;
    const std::uint32_t first = memory.byBuckets ? 0 : last;
    std::uint64_t beside = plan.bytesBesidePages(first, last, pointBytes);
    // What is read of a file comes at once.
    if (!values.word(Setting::kPhotonMap).empty())
        beside += plan.landingsPerPass() * sizeof(Photon);
    const std::uint64_t others = memory.need.total() - memory.need.maps + beside;
    std::uint64_t pages = demanded;
    memory.smallest = demanded > 0 ? others + kPagesTwice * demanded
                                   : std::min(memory.smallest, others + kPagesTwice * kLeastPages);
    if (demanded == 0) {
        if (memory.need.total() <= memory.limit || memory.smallest > memory.limit) return;
        pages = (memory.limit - others) / kPagesTwice;
    }
    memory.pages = pages;
    memory.pagedBytes = plan.pagedBytes() * (last - first + 1) + plan.pagedPilotBytes();
    memory.need.maps = beside + kPagesTwice * pages;
}

}  // namespace pm::plugin
