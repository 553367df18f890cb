// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon maps in pages against those in memory: the same bits, of a working set of many budgets.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "integrator/photons/map/paged_tree.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/sampling/warps.h"
#include "tests/support/memory_scratch.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr std::uint32_t kMany = 100'000;
constexpr std::uint64_t kWhole = kMany * 28, kBudget = kWhole / 16;

std::unique_ptr<PhotonSpool> spooled(const std::vector<Photon>& photons, PhotonPaging& paging) {
    auto spool = std::make_unique<PhotonSpool>(paging.makeFile());
    spool->append(photons);
    spool->finish();
    return spool;
}

struct Paged {
    explicit Paged(const std::vector<Photon>& photons, std::uint64_t budget = kBudget)
        : paging(folder, budget), map(spooled(photons, paging), paging) {}

    MemoryScratch folder;
    PhotonPaging paging;
    PhotonMap map;
};

// By f(random) each; of a flux of its own, so that it can be told apart.
template <typename Place>
std::vector<Photon> photonsAt(std::uint32_t count, const Place& place) {
    Random random(7);
    std::vector<Photon> photons;
    for (std::uint32_t i = 0; i < count; ++i)
        photons.push_back({place(random), Rgb(static_cast<float>(i + 1)), PackedNormal({0, 0, 1})});
    return photons;
}

std::vector<Photon> evenly(std::uint32_t count) {
    return photonsAt(count, [](Random& random) {
        const Vec2f p = random.next2D();
        return Vec3f{p.x - 0.5f, p.y, 0};
    });
}

// Narrow heaps, on a grid: many ties, and coordinates of both zeros.
std::vector<Photon> clustered(std::uint32_t count) {
    return photonsAt(count, [](Random& random) {
        const Vec2f p = random.next2D(), q = random.next2D();
        const auto heap = [](float u, float v) {
            return std::round(4 * u - 2) + std::round(v * v * v * 32) / 256;
        };
        return Vec3f{heap(p.x, q.x), std::copysign(heap(p.y, q.y), p.x - 0.5f), 0};
    });
}

void expectSamePhotons(const PhotonMap& a, const PhotonMap& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        const Photon one = a.photon(i), other = b.photon(i);
        ASSERT_EQ(std::memcmp(&one, &other, sizeof(Photon)), 0) << i;
    }
    EXPECT_EQ(a.gate({1, 2, 3}, {0, 0, 1}).planeToleranceSquared,
              b.gate({1, 2, 3}, {0, 0, 1}).planeToleranceSquared);
}

struct Answers {
    TwoRadii flux, near, plane, some;
    float radius = 0;
    std::vector<NearestPhotons::Found> nearest;
    std::vector<std::uint32_t> visited;
};

// All look-ups at a place among photons.
Answers ask(const PhotonMap& map, const Photon& place, NearestPhotons& scratch) {
    const Vec3f& at = place.position;
    const Vec3f up{0, 0, 1};
    const float radius = 0.02f;
    Answers answers;
    answers.flux = map.fluxWithin(at, up, radius);
    answers.near = map.fluxWithin(at, up, radius, scratch);
    answers.plane = map.fluxInPlane(at, up, 10 * radius);
    answers.some =
        map.fluxWithin(at, up, 2 * radius, [](std::uint32_t index) { return index % 3 != 0; });
    map.visitAccepted(at, up, radius, scratch,
                      [&](std::uint32_t index, float) { answers.visited.push_back(index); });
    answers.radius = map.radiusOf({at, up, 40, 0.5f}, scratch);
    map.findNearest({at, up, 60, 0.5f}, scratch);
    answers.nearest = scratch.found();
    return answers;
}

void expectSame(const Answers& a, const Answers& b) {
    for (const auto& member : {&Answers::flux, &Answers::near, &Answers::plane, &Answers::some}) {
        EXPECT_EQ((a.*member).wide, (b.*member).wide);
        EXPECT_EQ((a.*member).narrow, (b.*member).narrow);
    }
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.visited, b.visited);
    ASSERT_EQ(a.nearest.size(), b.nearest.size());
    for (std::size_t i = 0; i < a.nearest.size(); ++i) {
        EXPECT_EQ(a.nearest[i].index, b.nearest[i].index);
        EXPECT_EQ(a.nearest[i].distanceSquared, b.nearest[i].distanceSquared);
    }
}

void expectSameAnswers(const PhotonMap& map, const PhotonMap& paged, int threads) {
    constexpr std::size_t kPlaces = 3000;
    std::vector<Answers> answers(kPlaces), ofPaged(kPlaces);
    const auto all = [&](const PhotonMap& asked, std::vector<Answers>& into) {
        tbb::parallel_for(std::size_t{0}, kPlaces, [&](std::size_t i) {
            NearestPhotons scratch;
            // Far from each other, so that pages are left and come back to.
            const std::size_t number = i * 7919 % map.size();
            into[i] = ask(asked, map.photon(static_cast<std::uint32_t>(number)), scratch);
        });
    };
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
    tbb::task_arena(threads).execute([&] {
        all(map, answers);
        all(paged, ofPaged);
    });
    for (std::size_t i = 0; i < kPlaces; ++i) expectSame(answers[i], ofPaged[i]);
}

TEST(PagedMap, HasThePhotonsOfTheMapInMemory) {
    std::vector<std::vector<Photon>> sets = {evenly(kMany), clustered(kMany), evenly(1),
                                             evenly(16),    evenly(17),       evenly(1024),
                                             evenly(1025)};
    // All at one place: no plane parts them but by their order.
    sets.push_back(photonsAt(kMany, [](Random&) { return Vec3f{0.3f, 0.2f, -0.1f}; }));
    // Wider than what a float can hold.
    sets.push_back(photonsAt(kMany, [](Random& random) {
        const Vec2f p = random.next2D();
        return Vec3f{p.x - 0.5f, p.y - 0.5f, p.x} * 2.0f * 3e38f;
    }));
    for (const std::vector<Photon>& photons : sets) {
        SCOPED_TRACE(photons.size());
        const PhotonMap map(photons);
        const Paged paged(photons);
        EXPECT_TRUE(paged.map.isPaged());
        expectSamePhotons(map, paged.map);
    }
}

TEST(PagedMap, NoPhotons) {
    const Paged none(std::vector<Photon>{});
    EXPECT_TRUE(none.map.empty());
    NearestPhotons scratch;
    EXPECT_EQ(none.map.fluxWithin({0, 0, 0}, {0, 0, 1}, 1).wide, Rgb(0.0f));
    EXPECT_TRUE(std::isinf(none.map.radiusOf({{}, {0, 0, 1}, 10, 1}, scratch)));
}

TEST(PagedMap, AnswersAsTheMapInMemory) {
    for (const std::vector<Photon>& photons : {evenly(kMany), clustered(kMany)}) {
        const PhotonMap map(photons);
        for (const int threads : {1, 2, 5}) {
            const Paged paged(photons);
            expectSameAnswers(map, paged.map, threads);
            const CacheCounts counts = paged.paging.counts();
            // What was asked for is many budgets, and was read again and again.
            EXPECT_GE(counts.bytesMade, 8 * kBudget);
            EXPECT_GE(paged.paging.mostWholeBytes(), 8 * kBudget);
            EXPECT_GT(counts.madeAgain, counts.misses / 2);
            // Each thread holds two pages more.
            const std::uint64_t page = PhotonPages::kLeavesPerPage * sizeof(PagedLeaf) + 64;
            EXPECT_LE(counts.mostBytesHeld,
                      kBudget + 2 * static_cast<std::uint64_t>(threads) * page);
        }
    }
}

TEST(PagedMap, IsBuiltWithinWhatIsStated) {
    for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{2} << 20, kWhole * 8}) {
        const Paged paged(clustered(kMany), budget);
        EXPECT_LE(paged.paging.mostBuildBytes(), std::max(budget, kLeastBuildBytes));
        EXPECT_GT(paged.paging.mostBuildBytes(), std::min(budget, kWhole) / 2);
        // The last leaf is filled up.
        EXPECT_LE(paged.folder.most, 2 * kWhole + sizeof(PagedLeaf));
        // What was sorted is gone.
        EXPECT_EQ(paged.folder.files, 1u);
        EXPECT_LE(paged.folder.bytes, kWhole + sizeof(PagedLeaf));
    }
}

TEST(PagedMap, MapsShareTheBudget) {
    MemoryScratch folder;
    PhotonPaging paging(folder, kWhole / 4);
    const std::vector<Photon> photons = evenly(kMany);
    const auto readAll = [](const PhotonMap& map) {
        for (std::uint32_t i = 0; i < map.size(); ++i) map.photon(i);
    };
    {
        const PhotonMap first(spooled(photons, paging), paging);
        const PhotonMap second(spooled(photons, paging), paging);
        readAll(first);
        readAll(second);
        EXPECT_LE(paging.counts().bytesHeld, kWhole / 4);
        EXPECT_GT(paging.counts().bytesHeld, kWhole / 5);
        EXPECT_EQ(paging.wholeBytes(), 2 * kWhole);
        paging.setBudget(0);
        EXPECT_EQ(paging.counts().bytesHeld, 0u);
    }
    // What gone maps counted stays counted.
    EXPECT_EQ(paging.wholeBytes(), 0u);
    EXPECT_EQ(paging.mostWholeBytes(), 2 * kWhole);
    EXPECT_EQ(paging.counts().misses, 2 * ((kMany + 1023) / 1024));
    EXPECT_EQ(folder.files, 0u);
}

// A disk that gets full after so many writes, and breaks after so many reads.
class BadScratch : public MemoryScratch {
  public:
    std::unique_ptr<ScratchFile> make() override {
        return std::make_unique<Breaking>(MemoryScratch::make(), *this);
    }
    std::atomic<int> writes{1 << 30}, reads{1 << 30};

  private:
    struct Breaking : ScratchFile {
        Breaking(std::unique_ptr<ScratchFile> file_, BadScratch& disk_)
            : file(std::move(file_)), disk(disk_) {}
        void write(std::uint64_t offset, std::span<const std::byte> bytes) override {
            if (--disk.writes < 0) throw std::runtime_error("the disk is full");
            file->write(offset, bytes);
        }
        void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
            if (--disk.reads < 0) throw std::runtime_error("the disk is broken");
            file->read(offset, bytes);
        }
        std::unique_ptr<ScratchFile> file;
        BadScratch& disk;
    };
};

TEST(PagedMap, TellsOfAFullOrBrokenDisk) {
    const std::vector<Photon> photons = evenly(kMany);
    for (const int writes : {3, 40, 120}) {
        BadScratch disk;
        disk.writes = writes;
        PhotonPaging paging(disk, kBudget);
        EXPECT_THROW(PhotonMap(spooled(photons, paging), paging), std::runtime_error) << writes;
        EXPECT_EQ(disk.files, 0u);
        EXPECT_EQ(paging.wholeBytes(), 0u);
    }
    BadScratch disk;
    PhotonPaging paging(disk, kBudget);
    const PhotonMap map(spooled(photons, paging), paging);
    disk.reads = 0;
    EXPECT_THROW(map.photon(0), std::runtime_error);
    disk.reads = 1 << 30;
    EXPECT_EQ(map.photon(0).normal.dotWith({0, 0, 1}), 1.0f);
}

TEST(PagedMap, IsCancelledWhileItIsBuilt) {
    MemoryScratch folder;
    PhotonPaging paging(folder, kBudget);
    const std::atomic<bool> cancelled{true};
    EXPECT_THROW(PhotonMap(spooled(evenly(kMany), paging), paging, CancelCheck(cancelled)), Error);
    EXPECT_EQ(folder.files, 0u);
}

}  // namespace
}  // namespace pm::test
