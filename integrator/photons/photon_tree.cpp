// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/photon_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

namespace pm {

namespace {

// Where a photon is and which; moved about in place of it.
struct Entry {
    Vec3f position;
    std::uint32_t index;
};

// Below this many photons a part of the tree is built by one thread, in one chunk.
constexpr std::size_t kChunk = 1 << 16;
constexpr std::size_t kParallelSize = 8192;
constexpr std::uint32_t kMostBuckets = 256;

using Counts = std::array<std::uint32_t, kMostBuckets>;

struct Box {
    Vec3f lo{std::numeric_limits<float>::max()}, hi{std::numeric_limits<float>::lowest()};

    void add(const Box& b) {
        lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
        hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
    }
    void add(const Vec3f& p) { add(Box{p, p}); }
};

// One T for each chunk; not initialised. Most parts have a single chunk, and no time to allocate.
template <typename T>
class PerChunk {
  public:
    explicit PerChunk(std::size_t count)
        : m_many(count > m_few.size() ? std::make_unique_for_overwrite<T[]>(count) : nullptr) {}
    T& operator[](std::size_t i) { return m_many ? m_many[i] : m_few[i]; }

  private:
    std::array<T, 2> m_few;
    std::unique_ptr<T[]> m_many;
};

// A coordinate's bucket; never falls where the coordinate rises.
struct Buckets {
    float lo, scale;
    std::uint32_t last;

    Buckets(float lo_, float hi, std::size_t entries)
        : lo(lo_),
          last(static_cast<std::uint32_t>(std::clamp<std::size_t>(entries / 8, 8, kMostBuckets) -
                                          1)) {
        scale = static_cast<float>(last + 1) / (hi - lo);
        // Too narrow or too wide to be divided: one bucket for all.
        if (!(scale > 0.0f && scale < 1e30f)) scale = 0.0f;
    }
    std::uint32_t of(float coordinate) const {
        if (scale == 0.0f) return 0;
        return std::min(static_cast<std::uint32_t>((coordinate - lo) * scale), last);
    }
};

class Builder {
  public:
    Builder(std::span<const Photon> photons, PhotonTree& tree, const CancelCheck& cancel)
        : m_photons(photons),
          m_tree(tree),
          m_cancel(cancel),
          m_entries{std::make_unique_for_overwrite<Entry[]>(photons.size()),
                    std::make_unique_for_overwrite<Entry[]>(photons.size())} {}

    void build() {
        const std::size_t count = m_photons.size();
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kChunk), [&](const auto& r) {
            for (std::size_t i = r.begin(); i < r.end(); ++i)
                m_entries[0][i] = {m_photons[i].position, static_cast<std::uint32_t>(i)};
        });
        const Part whole{0, 0, m_tree.leafCount, 0, count, 0};
        const Box box = boxOf(whole);
        m_tree.lo = box.lo;
        m_tree.hi = box.hi;
        split(whole);
        // Giving back that much memory takes the system a while, too.
        tbb::parallel_invoke([&] { m_entries[0].reset(); }, [&] { m_entries[1].reset(); });
    }

  private:
    // Part of the tree: its entries are [begin, end) of m_entries[list], in the order of index.
    struct Part {
        std::size_t node;
        std::uint32_t firstLeaf, leafCount;
        std::size_t begin, end;
        int list;

        std::size_t size() const { return end - begin; }
        std::size_t chunks() const { return (size() + kChunk - 1) / kChunk; }
    };

    // f(chunk, begin, end) for each chunk, in parallel.
    template <typename F>
    void forChunks(const Part& part, const F& f) const {
        const std::size_t chunks = part.chunks();
        const auto one = [&](std::size_t chunk) {
            m_cancel.throwIfSet("building a photon map");
            const std::size_t begin = part.begin + chunk * kChunk;
            f(chunk, begin, std::min(begin + kChunk, part.end));
        };
        if (chunks == 1) {
            one(0);
        } else {
            tbb::parallel_for(std::size_t{0}, chunks, one);
        }
    }

    Box boxOf(const Part& part) const {
        const Entry* const entries = m_entries[part.list].get();
        PerChunk<Box> boxes(part.chunks());
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Box box;
            for (std::size_t i = begin; i < end; ++i) box.add(entries[i].position);
            boxes[chunk] = box;
        });
        Box box;
        for (std::size_t c = 0; c < part.chunks(); ++c) box.add(boxes[c]);
        return box;
    }

    // The entry that `rank` others of the part precede: in the order of the coordinate, of equals
    // in that of index. Uses the part of the other list.
    Entry select(const Part& part, int axis, const Buckets& buckets, std::size_t rank) const {
        const Entry* const entries = m_entries[part.list].get();
        PerChunk<Counts> counts(part.chunks());
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Counts& mine = counts[chunk];
            std::fill_n(mine.begin(), buckets.last + 1, 0u);
            for (std::size_t i = begin; i < end; ++i) ++mine[buckets.of(entries[i].position[axis])];
        });
        std::uint32_t bucket = 0;
        for (std::size_t before = 0;; ++bucket) {
            std::size_t here = 0;
            for (std::size_t c = 0; c < part.chunks(); ++c) here += counts[c][bucket];
            if (rank < before + here) {
                rank -= before;
                break;
            }
            before += here;
        }
        PerChunk<std::size_t> starts(part.chunks() + 1);
        starts[0] = part.begin;
        for (std::size_t c = 0; c < part.chunks(); ++c)
            starts[c + 1] = starts[c] + counts[c][bucket];
        Entry* const found = m_entries[1 - part.list].get();
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            std::size_t to = starts[chunk];
            for (std::size_t i = begin; i < end; ++i)
                if (buckets.of(entries[i].position[axis]) == bucket) found[to++] = entries[i];
        });
        Entry* const nth = found + part.begin + rank;
        std::nth_element(found + part.begin, nth, found + starts[part.chunks()],
                         [axis](const Entry& a, const Entry& b) {
                             const float pa = a.position[axis], pb = b.position[axis];
                             return pa < pb || (pa == pb && a.index < b.index);
                         });
        return *nth;
    }

    // Into the other list: what precedes the pivot, then the rest, each in the order it was in.
    void partition(const Part& part, int axis, const Entry& pivot, std::size_t leftCount) {
        const Entry* const from = m_entries[part.list].get();
        Entry* const to = m_entries[1 - part.list].get();
        const float split = pivot.position[axis];
        const auto isLeft = [&](const Entry& e) {
            const float p = e.position[axis];
            return static_cast<std::size_t>(p < split) |
                   (static_cast<std::size_t>(p == split) &
                    static_cast<std::size_t>(e.index < pivot.index));
        };
        PerChunk<std::size_t> lefts(part.chunks() + 1);
        lefts[0] = 0;
        if (part.chunks() > 1)
            forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                std::size_t count = 0;
                for (std::size_t i = begin; i < end; ++i) count += isLeft(from[i]);
                lefts[chunk + 1] = count;
            });
        for (std::size_t c = 1; c < part.chunks(); ++c) lefts[c] += lefts[c - 1];
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            std::size_t left = part.begin + lefts[chunk];
            std::size_t right = begin + leftCount - lefts[chunk];
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t isL = isLeft(from[i]);
                to[isL ? left : right] = from[i];
                left += isL;
                right += 1 - isL;
            }
        });
    }

    void split(const Part& part) {
        if (part.leafCount == 1) {
            fillLeaf(part);
            return;
        }
        const Box box = boxOf(part);
        const Vec3f size = box.hi - box.lo;
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const std::uint32_t leftLeaves = PhotonTree::leftLeaves(part.leafCount);
        const std::size_t leftCount = std::size_t{leftLeaves} * PhotonLeaf::kSize;
        const Entry pivot =
            select(part, axis, Buckets(box.lo[axis], box.hi[axis], part.size()), leftCount);
        m_tree.nodes[part.node] = {pivot.position[axis], static_cast<std::uint32_t>(axis)};
        partition(part, axis, pivot, leftCount);
        const std::size_t middle = part.begin + leftCount;
        const auto left = [&] {
            split(
                {2 * part.node + 1, part.firstLeaf, leftLeaves, part.begin, middle, 1 - part.list});
        };
        const auto right = [&] {
            split({2 * part.node + 2, part.firstLeaf + leftLeaves, part.leafCount - leftLeaves,
                   middle, part.end, 1 - part.list});
        };
        if (part.size() > kParallelSize) {
            tbb::parallel_invoke(left, right);
        } else {
            left();
            right();
        }
    }

    void fillLeaf(const Part& part) {
        const Entry* const entries = m_entries[part.list].get() + part.begin;
        PhotonLeaf& leaf = m_tree.leaves[part.firstLeaf];
        for (std::uint32_t i = 0; i < part.size(); ++i) {
            const Photon& photon = m_photons[entries[i].index];
            leaf.set(i, photon.position, photon.normal);
            float* const flux = &m_tree.fluxes[3 * (part.begin + i)];
            flux[0] = photon.flux.r;
            flux[1] = photon.flux.g;
            flux[2] = photon.flux.b;
        }
        for (auto i = static_cast<std::uint32_t>(part.size()); i < PhotonLeaf::kSize; ++i) {
            leaf.x[i] = leaf.y[i] = leaf.z[i] = 0.0f;
            leaf.normals[i] = 0;
        }
    }

    std::span<const Photon> m_photons;
    PhotonTree& m_tree;
    CancelCheck m_cancel;
    std::array<std::unique_ptr<Entry[]>, 2> m_entries;
};

}  // namespace

PhotonTree buildPhotonTree(std::span<const Photon> photons, const CancelCheck& cancel) {
    PhotonTree tree;
    if (photons.empty()) return tree;
    tree.size = photons.size();
    tree.leafCount =
        static_cast<std::uint32_t>((photons.size() + PhotonLeaf::kSize - 1) / PhotonLeaf::kSize);
    tree.nodes = std::make_unique_for_overwrite<PhotonTree::Node[]>(tree.nodeCount());
    tree.leaves = std::make_unique_for_overwrite<PhotonLeaf[]>(tree.leafCount);
    tree.fluxes = std::make_unique_for_overwrite<float[]>(3 * tree.size);
    Builder(photons, tree, cancel).build();
    return tree;
}

}  // namespace pm
