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
    const std::uint64_t beside = plan.bytesBesidePages(first, last, pointBytes);
    const std::uint64_t others = memory.need.total() - memory.need.maps + beside;
    std::uint64_t pages = demanded, sites = plan.siteBytes(first, last, 1.0f);
    float room = 1.0f;
    if (demanded == 0) {
        // Where sites would take more than half, what they lack is estimated again, from pages.
        const std::uint64_t half = memory.limit > others ? (memory.limit - others) / 2 : 0;
        if (sites > half) {
            room = static_cast<float>(static_cast<double>(half) / static_cast<double>(sites));
            sites = plan.siteBytes(first, last, room);
        }
        if (others + sites + kPagesTwice * kLeastPages > memory.limit) return;
        pages = (memory.limit - others - sites) / kPagesTwice;
    }
    memory.roomForSites = room;
    memory.pages = pages;
    memory.pagedBytes = plan.pagedBytes() * (last - first + 1) + plan.pagedPilotBytes();
    memory.need.maps = beside + sites + kPagesTwice * pages;
}

}  // namespace pm::plugin
