// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_shim/report/report_pictures.h"
#include "host_shim/watch/part_list.h"

namespace pm::host {

// What pm_host watch knows at a moment.
struct WatchState {
    struct Part {
        ListedPart listed;
        bool isIn{};
        std::string refusal;      // why it is not; empty: nothing is there yet
        std::uint32_t buckets{};  // of its own; those that others have as well count for the first
    };
    std::string name;  // of the picture
    std::vector<Part> parts;
    std::vector<int> owners;  // of each bucket, in their order: index of a part, -1: none yet
    EmbeddedPicture picture;  // may be empty

    std::size_t bucketsIn() const;
    double share() const;  // of the buckets, in [0, 1]
    bool isWhole() const;
};

// The page; refreshSeconds as in wholePage.
std::string watchPage(const WatchState& state, int refreshSeconds);

}  // namespace pm::host
