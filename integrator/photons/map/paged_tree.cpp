// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/map/paged_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

namespace pm {

namespace {

constexpr std::uint32_t kHalfBits = 16;
constexpr std::uint32_t kDigits = 1u << kHalfBits;
constexpr std::uint64_t kCountBytes = kDigits * sizeof(std::uint32_t);
// Of one that reads while two are written, and the counts.
constexpr std::uint64_t kDividingBytes = 3 * PhotonSpool::kBufferBytes + kCountBytes;
static_assert(kDividingBytes < kLeastBuildBytes);
// Of the leaves on their way to the file.
constexpr std::uint64_t kWritingBytes = PhotonPages::kLeavesPerPage * sizeof(PagedLeaf);

// Rises as the coordinate does; the same for 0 and -0.
std::uint32_t keyOf(float coordinate) {
    const auto bits = std::bit_cast<std::uint32_t>(coordinate + 0.0f);
    return (bits >> 31) != 0 ? ~bits : bits | 1u << 31;
}

// What it takes to build a part of so many photons in memory and to write its leaves.
std::uint64_t builtBytes(std::uint64_t photons) {
    const std::uint64_t leaves = (photons + PhotonLeaf::kSize - 1) / PhotonLeaf::kSize;
    return bigArrayBytes<Photon>(photons) + treeBuildBytes(photons) +
           bigArrayBytes<PhotonLeaf>(leaves) + bigArrayBytes<LeafFluxes>(leaves) +
           bigArrayBytes<PhotonTree::Node>(std::bit_ceil(leaves)) + kWritingBytes;
}

// The most photons that can be built in so many bytes.
std::uint64_t mostBuilt(std::uint64_t bytes) {
    std::uint64_t fits = 0, tooMany = bytes / sizeof(Photon);
    while (fits + 1 < tooMany) {
        const std::uint64_t middle = fits + (tooMany - fits) / 2;
        (builtBytes(middle) <= bytes ? fits : tooMany) = middle;
    }
    return fits;
}

class PagedBuilder {
  public:
    PagedBuilder(PhotonTree& tree, PhotonPaging& paging, const CancelCheck& cancel)
        : m_tree(tree),
          m_paging(paging),
          m_cancel(cancel),
          m_most(mostBuilt(std::max(paging.buildBudget(), kLeastBuildBytes))) {}

    // Part of the tree, as in buildPhotonTree.
    struct Part {
        std::size_t node;
        std::uint32_t firstLeaf, leafCount;

        Part left() const { return {2 * node + 1, firstLeaf, PhotonTree::leftLeaves(leafCount)}; }
        Part right() const {
            const std::uint32_t before = PhotonTree::leftLeaves(leafCount);
            return {2 * node + 2, firstLeaf + before, leafCount - before};
        }
    };

    void split(std::unique_ptr<PhotonSpool> photons, const Part& part) {
        m_cancel.throwIfSet("building a photon map");
        if (photons->size() <= m_most) {
            build(std::move(photons), part);
            return;
        }
        const Vec3f size = photons->hi() - photons->lo();
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        auto [left, right] =
            divide(*photons, axis, std::uint64_t{part.left().leafCount} * PhotonLeaf::kSize,
                   m_tree.nodes[part.node]);
        photons.reset();
        split(std::move(left), part.left());
        split(std::move(right), part.right());
    }

  private:
    using Halves = std::pair<std::unique_ptr<PhotonSpool>, std::unique_ptr<PhotonSpool>>;

    // Half of a key's bits.
    struct Digit {
        std::uint32_t digit;
        std::uint64_t rank;  // among those of the same digit
    };
    // That of the photon which `rank` others precede, of those whose key is wanted(key).
    template <typename Wanted>
    Digit select(const PhotonSpool& photons, int axis, std::uint64_t rank, std::uint32_t shift,
                 const Wanted& wanted) const {
        std::vector<std::uint32_t> counts(kDigits);
        photons.visit([&](const Photon& photon) {
            const std::uint32_t key = keyOf(photon.position[axis]);
            if (wanted(key)) ++counts[key >> shift & (kDigits - 1)];
        });
        std::uint32_t digit = 0;
        for (; rank >= counts[digit]; ++digit) rank -= counts[digit];
        return {digit, rank};
    }

    // The first leftCount in the order of the coordinate, of equals in the order they are in, and
    // the rest, each in the order it was in; node: the plane is at the first of the rest.
    Halves divide(const PhotonSpool& photons, int axis, std::uint64_t leftCount,
                  PhotonTree::Node& node) const {
        const PhotonPaging::Building counted(m_paging, kDividingBytes);
        const Digit upper =
            select(photons, axis, leftCount, kHalfBits, [](std::uint32_t) { return true; });
        m_cancel.throwIfSet("building a photon map");
        const Digit lower = select(photons, axis, upper.rank, 0, [&](std::uint32_t key) {
            return key >> kHalfBits == upper.digit;
        });
        m_cancel.throwIfSet("building a photon map");
        const std::uint32_t pivot = upper.digit << kHalfBits | lower.digit;
        Halves halves{std::make_unique<PhotonSpool>(m_paging.makeFile()),
                      std::make_unique<PhotonSpool>(m_paging.makeFile())};
        std::uint64_t equals = 0;
        photons.visit([&](const Photon& photon) {
            const std::uint32_t key = keyOf(photon.position[axis]);
            const bool isEqual = key == pivot;
            const bool isLeft = key < pivot || (isEqual && equals < lower.rank);
            if (isEqual && equals++ == lower.rank)
                node = {photon.position[axis], static_cast<std::uint32_t>(axis)};
            (isLeft ? halves.first : halves.second)->append(photon);
        });
        halves.first->finish();
        halves.second->finish();
        return halves;
    }

    void build(std::unique_ptr<PhotonSpool> spool, const Part& part) {
        const PhotonPaging::Building counted(m_paging, builtBytes(spool->size()));
        BigVector<Photon> photons(spool->size());
        spool->read(0, photons);
        spool.reset();
        const PhotonTree built = buildPhotonTree(photons, m_cancel);
        copyNodes(built, 0, part);
        std::vector<PagedLeaf> leaves;
        leaves.reserve(PhotonPages::kLeavesPerPage);
        for (std::uint32_t i = 0; i < part.leafCount; ++i) {
            leaves.push_back({built.leaves[i], built.fluxes[i]});
            if (leaves.size() < PhotonPages::kLeavesPerPage && i + 1 < part.leafCount) continue;
            m_tree.pages->write(part.firstLeaf + i + 1 - static_cast<std::uint32_t>(leaves.size()),
                                leaves);
            leaves.clear();
        }
    }

    void copyNodes(const PhotonTree& built, std::size_t node, const Part& part) {
        if (part.leafCount == 1) return;
        m_tree.nodes[part.node] = built.nodes[node];
        copyNodes(built, 2 * node + 1, part.left());
        copyNodes(built, 2 * node + 2, part.right());
    }

    PhotonTree& m_tree;
    PhotonPaging& m_paging;
    CancelCheck m_cancel;
    const std::uint64_t m_most;  // photons that are built in memory at once
};

}  // namespace

PhotonTree buildPagedTree(std::unique_ptr<PhotonSpool> photons, PhotonPaging& paging,
                          const CancelCheck& cancel) {
    PhotonTree tree;
    if (photons->size() == 0) return tree;
    tree.size = photons->size();
    tree.lo = photons->lo();
    tree.hi = photons->hi();
    tree.leafCount =
        static_cast<std::uint32_t>((tree.size + PhotonLeaf::kSize - 1) / PhotonLeaf::kSize);
    tree.nodes = makeBigArray<PhotonTree::Node>(tree.nodeCount());
    tree.pages = std::make_unique<PhotonPages>(paging, tree.leafCount);
    PagedBuilder(tree, paging, cancel).split(std::move(photons), {0, 0, tree.leafCount});
    return tree;
}

}  // namespace pm
