// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/map/photon_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

namespace pm {

namespace {

// Where a photon is and which; moved about in place of it.
struct alignas(16) Entry {
    std::array<float, 3> position;
    std::uint32_t index;
};

// A chunk is one thread's work; small enough for every part worth dividing to have several.
constexpr std::size_t kChunk = 8192;
// Below this many photons a part of the tree is built by one thread.
constexpr std::size_t kParallelSize = 4096;
constexpr std::uint32_t kMostBuckets = 256;
// So many leaves' photons are asked for at once: enough to wait for all together, few enough to
// stay at hand until they are read.
constexpr std::uint32_t kPrefetchedLeaves = 8;

using Counts = std::array<std::uint32_t, kMostBuckets>;

struct Box {
    Vec3f lo{std::numeric_limits<float>::max()}, hi{std::numeric_limits<float>::lowest()};

    void add(const Box& b) {
        lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
        hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
    }
};

// entries: at least one.
Box boxOf(std::span<const Entry> entries) {
#if defined(__SSE2__)
    // The fourth numbers are indices, and what becomes of them is not looked at. Two boxes, as each
    // minimum waits for the one before.
    const auto load = [&](std::size_t i) { return _mm_load_ps(entries[i].position.data()); };
    __m128 lo[2] = {load(0), load(0)}, hi[2] = {lo[0], lo[0]};
    for (std::size_t i = 0; i + 1 < entries.size(); i += 2)
        for (const std::size_t k : {0u, 1u}) {
            const __m128 p = load(i + k);
            lo[k] = _mm_min_ps(lo[k], p);
            hi[k] = _mm_max_ps(hi[k], p);
        }
    const __m128 last = load(entries.size() - 1);
    alignas(16) std::array<float, 4> least, most;
    _mm_store_ps(least.data(), _mm_min_ps(_mm_min_ps(lo[0], lo[1]), last));
    _mm_store_ps(most.data(), _mm_max_ps(_mm_max_ps(hi[0], hi[1]), last));
    return {{least[0], least[1], least[2]}, {most[0], most[1], most[2]}};
#else
    Box box;
    for (const auto& [p, index] : entries) {
        const Vec3f position{p[0], p[1], p[2]};
        box.add({position, position});
    }
    return box;
#endif
}

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
    std::int32_t last;

    Buckets(float lo_, float hi, std::size_t entries)
        : lo(lo_),
          last(static_cast<std::int32_t>(std::clamp<std::size_t>(entries / 8, 8, kMostBuckets) -
                                         1)) {
        scale = static_cast<float>(last + 1) / (hi - lo);
        // Too narrow or too wide to be divided: one bucket for all, by no difference that may be
        // infinite.
        if (!(scale > 0.0f && scale < 1e30f)) lo = scale = 0.0f;
    }
    std::uint8_t of(float coordinate) const {
        return static_cast<std::uint8_t>(
            std::min(static_cast<std::int32_t>((coordinate - lo) * scale), last));
    }
};

// The entry at which a part is divided.
struct Pivot {
    int axis;
    float position;
    std::uint32_t index;

    Pivot(int axis_, const Entry& e)
        : axis(axis_), position(e.position[static_cast<std::size_t>(axis_)]), index(e.index) {}
    // In the order of the coordinate, of equals in that of index.
    bool follows(const Entry& e) const {
        const float p = e.position[static_cast<std::size_t>(axis)];
        return p != position ? p < position : e.index < index;
    }
};

class Builder {
  public:
    Builder(std::span<const Photon> photons, PhotonTree& tree, const CancelCheck& cancel)
        : m_photons(photons),
          m_tree(tree),
          m_cancel(cancel),
          m_entries{makeBigArray<Entry>(photons.size()), makeBigArray<Entry>(photons.size())},
          m_buckets(makeBigArray<std::uint8_t>(photons.size())) {}

    void build() {
        const std::size_t count = m_photons.size();
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kChunk), [&](const auto& r) {
            for (std::size_t i = r.begin(); i < r.end(); ++i) {
                const Vec3f& p = m_photons[i].position;
                m_entries[0][i] = {{p.x, p.y, p.z}, static_cast<std::uint32_t>(i)};
            }
        });
        const Part whole{0, 0, m_tree.leafCount, 0, count, 0};
        const Box box = boxOfPart(whole);
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
    // How many entries of each chunk precede the pivot, summed up over the chunks before.
    using Lefts = PerChunk<std::size_t>;

    // f(chunk, begin, end) for each chunk, in parallel.
    template <typename F>
    void forChunks(const Part& part, const F& f) const {
        const std::size_t chunks = part.chunks();
        if (chunks == 1) {
            f(0, part.begin, part.end);
            return;
        }
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
            m_cancel.throwIfSet("building a photon map");
            const std::size_t begin = part.begin + chunk * kChunk;
            f(chunk, begin, std::min(begin + kChunk, part.end));
        });
    }

    Box boxOfPart(const Part& part) const {
        const Entry* const entries = m_entries[part.list].get();
        PerChunk<Box> boxes(part.chunks());
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            boxes[chunk] = boxOf({entries + begin, end - begin});
        });
        Box box = boxes[0];
        for (std::size_t c = 1; c < part.chunks(); ++c) box.add(boxes[c]);
        return box;
    }

    // Finds each entry's bucket; counts: how many are in each, for each chunk.
    void count(const Part& part, int axis, const Buckets& buckets, PerChunk<Counts>& counts) {
        const float* const coordinates = &m_entries[part.list][0].position[0] + axis;
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            // Of its own: what is written to bytes might change anything else.
            const Buckets mine = buckets;
            std::uint8_t* const to = m_buckets.get();
            std::uint32_t* const count = counts[chunk].data();
            std::fill_n(count, mine.last + 1, 0u);
            for (std::size_t i = begin; i < end; ++i) {
                to[i] = mine.of(coordinates[i * (sizeof(Entry) / sizeof(float))]);
                ++count[to[i]];
            }
        });
    }

    // The entry that `rank` others of the part precede; lefts: as many as chunks and one. Uses the
    // part of the other list.
    Pivot select(const Part& part, int axis, const Buckets& buckets, std::size_t rank,
                 Lefts& lefts) {
        PerChunk<Counts> counts(part.chunks());
        count(part, axis, buckets, counts);
        std::fill_n(&lefts[0], part.chunks() + 1, 0);
        std::uint8_t bucket = 0;
        for (;; ++bucket) {
            std::size_t here = 0;
            for (std::size_t c = 0; c < part.chunks(); ++c) here += counts[c][bucket];
            if (rank < here) break;
            rank -= here;
            for (std::size_t c = 0; c < part.chunks(); ++c) lefts[c + 1] += counts[c][bucket];
        }
        PerChunk<std::size_t> starts(part.chunks() + 1);
        starts[0] = part.begin;
        for (std::size_t c = 0; c < part.chunks(); ++c)
            starts[c + 1] = starts[c] + counts[c][bucket];
        collect(part, bucket, starts);
        const Pivot pivot = nth(part, axis, rank, starts, lefts);
        for (std::size_t c = 0; c < part.chunks(); ++c) lefts[c + 1] += lefts[c];
        return pivot;
    }

    // The entries of a bucket, in their order, into the other list.
    void collect(const Part& part, std::uint8_t bucket, PerChunk<std::size_t>& starts) {
        const Entry* const entries = m_entries[part.list].get();
        Entry* const found = m_entries[1 - part.list].get();
        const std::uint8_t* const ofAll = m_buckets.get();
        forChunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            std::size_t to = starts[chunk];
            for (const std::uint8_t *at = ofAll + begin, *const last = ofAll + end;; ++at) {
                at = static_cast<const std::uint8_t*>(
                    std::memchr(at, bucket, static_cast<std::size_t>(last - at)));
                if (!at) break;
                found[to++] = entries[at - ofAll];
            }
        });
    }

    // Of what was collected, in which `rank` entries precede the pivot.
    Pivot nth(const Part& part, int axis, std::size_t rank, PerChunk<std::size_t>& starts,
              Lefts& lefts) const {
        const std::span<Entry> found(m_entries[1 - part.list].get() + part.begin,
                                     starts[part.chunks()] - part.begin);
        const auto nthOf = [&](std::span<Entry> entries) {
            const auto precedes = [axis](const Entry& a, const Entry& b) {
                return Pivot{axis, b}.follows(a);
            };
            const auto nth = entries.begin() + static_cast<std::ptrdiff_t>(rank);
            std::nth_element(entries.begin(), nth, entries.end(), precedes);
            return Pivot{axis, *nth};
        };
        if (part.chunks() == 1) return nthOf(found);
        // Of a copy, as it has to be known of which chunk they are.
        std::vector<Entry> copy(found.begin(), found.end());
        const Pivot pivot = nthOf(copy);
        for (std::size_t c = 0; c < part.chunks(); ++c)
            for (std::size_t i = starts[c]; i < starts[c + 1]; ++i)
                lefts[c + 1] += pivot.follows(found[i - part.begin]);
        return pivot;
    }

    // Into the other list: what precedes the pivot, then the rest, each in the order it was in.
    void partition(const Part& part, const Pivot& pivot, std::size_t leftCount, Lefts& lefts) {
        const Entry* const from = m_entries[part.list].get();
        Entry* const to = m_entries[1 - part.list].get();
        forChunks(part, [&, pivot](std::size_t chunk, std::size_t begin, std::size_t end) {
            std::size_t left = part.begin + lefts[chunk];
            std::size_t right = begin + leftCount - lefts[chunk];
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t isLeft = pivot.follows(from[i]);
                to[isLeft ? left : right] = from[i];
                left += isLeft;
                right += 1 - isLeft;
            }
        });
    }

    void split(const Part& part) {
        if (part.leafCount == 1) {
            fillLeaf(part);
            return;
        }
        const Box box = boxOfPart(part);
        const Vec3f size = box.hi - box.lo;
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const std::uint32_t leftLeaves = PhotonTree::leftLeaves(part.leafCount);
        const std::size_t leftCount = std::size_t{leftLeaves} * PhotonLeaf::kSize;
        Lefts lefts(part.chunks() + 1);
        const Pivot pivot =
            select(part, axis, Buckets(box.lo[axis], box.hi[axis], part.size()), leftCount, lefts);
        m_tree.nodes[part.node] = {pivot.position, static_cast<std::uint32_t>(axis)};
        partition(part, pivot, leftCount, lefts);
        const std::size_t middle = part.begin + leftCount;
        const Part left{2 * part.node + 1, part.firstLeaf, leftLeaves,
                        part.begin,        middle,         1 - part.list};
        const Part right{2 * part.node + 2,
                         part.firstLeaf + leftLeaves,
                         part.leafCount - leftLeaves,
                         middle,
                         part.end,
                         1 - part.list};
        if (part.size() > kParallelSize) {
            tbb::parallel_invoke([&] { split(left); }, [&] { split(right); });
            return;
        }
        for (const Part& half : {left, right}) {
            if (part.leafCount > kPrefetchedLeaves && half.leafCount <= kPrefetchedLeaves)
                prefetch(half);
            split(half);
        }
    }

    // The photons of a part lie anywhere among all.
    void prefetch(const Part& part) const {
        const Entry* const entries = m_entries[part.list].get();
        for (std::size_t i = part.begin; i < part.end; ++i) {
            const Photon& photon = m_photons[entries[i].index];
            __builtin_prefetch(&photon);
            __builtin_prefetch(&photon.normal);  // perhaps on the next line
        }
    }

    void fillLeaf(const Part& part) {
        const Entry* const entries = m_entries[part.list].get() + part.begin;
        PhotonLeaf& leaf = m_tree.leaves[part.firstLeaf];
        LeafFluxes& fluxes = m_tree.fluxes[part.firstLeaf];
        for (std::uint32_t i = 0; i < part.size(); ++i) {
            const Photon& photon = m_photons[entries[i].index];
            leaf.set(i, photon.position, photon.normal);
            fluxes.set(i, photon.flux);
        }
        for (auto i = static_cast<std::uint32_t>(part.size()); i < PhotonLeaf::kSize; ++i) {
            leaf.x[i] = leaf.y[i] = leaf.z[i] = 0.0f;
            leaf.normals[i] = 0;
            fluxes.set(i, {});
        }
    }

    std::span<const Photon> m_photons;
    PhotonTree& m_tree;
    CancelCheck m_cancel;
    std::array<BigArray<Entry>, 2> m_entries;
    BigArray<std::uint8_t> m_buckets;  // of the entries of the part that is being divided
};

}  // namespace

std::uint64_t treeBuildBytes(std::uint64_t photons) {
    return 2 * bigArrayBytes<Entry>(photons) + bigArrayBytes<std::uint8_t>(photons);
}

PhotonTree buildPhotonTree(std::span<const Photon> photons, const CancelCheck& cancel) {
    PhotonTree tree;
    if (photons.empty()) return tree;
    tree.size = photons.size();
    tree.leafCount =
        static_cast<std::uint32_t>((photons.size() + PhotonLeaf::kSize - 1) / PhotonLeaf::kSize);
    tree.nodes = makeBigArray<PhotonTree::Node>(tree.nodeCount());
    tree.leaves = makeBigArray<PhotonLeaf>(tree.leafCount);
    tree.fluxes = makeBigArray<LeafFluxes>(tree.leafCount);
    Builder(photons, tree, cancel).build();
    return tree;
}

}  // namespace pm
