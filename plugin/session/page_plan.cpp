// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/page_plan.h"

#include "plugin/session/render_photons.h"

namespace pm::plugin {

namespace {

// Less would be read again all the time: some pages for each of many threads.
constexpr std::uint64_t kLeastPages = std::uint64_t{8} << 20;
// What is held, and what a map is traced and built in: each as much as the pages may take.
constexpr std::uint64_t kPagesTwice = 2;
constexpr double kMib = 1 << 20;

}  // namespace

void planPages(const Plan& plan, const SettingValues& values, std::uint64_t pointBytes,
               MemoryPlan& memory) {
    const auto demanded = static_cast<std::uint64_t>(values.number(Setting::kPhotonPages) * kMib);
    if (!plan.tracePhotons || RenderPhotons::isOnly(values)) return;
    if (demanded == 0 && memory.need.total() <= memory.limit) return;
    const std::uint32_t passes = values.passLimit(), last = passes - 1;
    const std::uint32_t first = memory.byBuckets ? 0 : last;
    std::uint64_t beside = plan.bytesBesidePages(first, last, pointBytes);
    // What is read of a file comes at once.
    if (!values.word(Setting::kPhotonMap).empty())
        beside += plan.landingsPerPass() * sizeof(Photon);
    const std::uint64_t others = memory.need.total() - memory.need.maps + beside;
    std::uint64_t pages = demanded;
    if (demanded == 0) {
        if (others + kPagesTwice * kLeastPages > memory.limit) return;
        pages = (memory.limit - others) / kPagesTwice;
    }
    memory.pages = pages;
    memory.pagedBytes = plan.pagedBytes() * (last - first + 1) + plan.pagedPilotBytes();
    memory.need.maps = beside + kPagesTwice * pages;
}

}  // namespace pm::plugin
