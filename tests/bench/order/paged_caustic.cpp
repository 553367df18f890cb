// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/scratch_disk.h"
#include "tests/bench/order/cache_scenes.h"
#include "tests/bench/run/bench_scenes.h"

namespace pm::bench {

namespace {

struct Pages {
    plugin::ScratchDisk disk;
    PhotonPaging paging;

    // What a map is built in: of no account here.
    explicit Pages(const std::string& folder)
        : disk(folder), paging(disk, std::uint64_t{256} << 20) {}
};

}  // namespace

CacheScene pagedCaustic(std::int32_t side, const std::filesystem::path& folder) {
    const auto pages = std::make_shared<Pages>(folder.string());
    CacheScene made;
    made.name = "caustic";
    made.unit = "pages of photons";
    made.scene = boxWithSpheres().build();
    made.settings = test::smallFrame(side, side, IntegratorKind::kPhoton, 1, 2);
    made.settings.photons = 2'000'000;
    made.photons = std::shared_ptr<PhotonPaging>(pages, &pages->paging);
    made.empty = [pages] { pages->paging.setBudget(0); };
    made.setBudget = [pages](std::uint64_t bytes) { pages->paging.setBudget(bytes); };
    made.misses = [pages] { return pages->paging.counts().misses; };
    return made;
}

}  // namespace pm::bench
