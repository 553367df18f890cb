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
constexpr std::uint64_t kStep = std::uint64_t{1} << 20;

// How sites of irradiance and pages share what is left for both.
struct Room {
    std::uint64_t sites = 0;
    float share = 1.0f;  // of the sites that there would be
    std::uint64_t pages = 0;
};

// Where sites would take more than half, what they lack is estimated again, from pages.
Room roomOf(const Plan& plan, std::uint32_t first, std::uint32_t last, std::uint64_t bytes) {
    Room room{plan.siteBytes(first, last, 1.0f)};
    const std::uint64_t half = bytes / 2;
    if (room.sites > half) {
        room.share =
            static_cast<float>(static_cast<double>(half) / static_cast<double>(room.sites));
        room.sites = plan.siteBytes(first, last, room.share);
    }
    room.pages = bytes > room.sites ? (bytes - room.sites) / kPagesTwice : 0;
    return room;
}

}  // namespace

void planPages(const Plan& plan, const SettingValues& values, std::uint64_t pointBytes,
               MemoryPlan& memory) {
    const auto demanded = static_cast<std::uint64_t>(values.number(Setting::kPhotonPages) * kMib);
    memory.smallest = memory.need.total();
    if (!plan.tracePhotons || RenderPhotons::isOnly(values)) return;
    const std::uint32_t passes = values.passLimit(), last = passes - 1;
    const std::uint32_t first = memory.byBuckets ? 0 : last;
    const std::uint64_t beside = plan.bytesBesidePages(first, last, pointBytes);
    const std::uint64_t others = memory.need.total() - memory.need.maps + beside;
    const auto room = [&](std::uint64_t limit) {
        return roomOf(plan, first, last, limit > others ? limit - others : 0);
    };
    Room found{plan.siteBytes(first, last, 1.0f), 1.0f, demanded};
    if (demanded > 0) {
        memory.smallest = others + found.sites + kPagesTwice * demanded;
    } else {
        std::uint64_t least = others;
        while (least < memory.smallest && room(least).pages < kLeastPages) least += kStep;
        memory.smallest = std::min(memory.smallest, least);
        if (memory.need.total() <= memory.limit || memory.smallest > memory.limit) return;
        found = room(memory.limit);
        if (found.pages < kLeastPages) return;
    }
    memory.roomForSites = found.share;
    memory.pages = found.pages;
    memory.pagedBytes = plan.pagedBytes() * (last - first + 1) + plan.pagedPilotBytes();
    memory.need.maps = beside + found.sites + kPagesTwice * found.pages;
}

}  // namespace pm::plugin
