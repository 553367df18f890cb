// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "integrator/caches/bounded_cache.h"
#include "integrator/caches/scratch.h"
#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon_leaf.h"

namespace pm {

class PhotonPages;

// A leaf as a page has it.
struct PagedLeaf {
    PhotonLeaf places;
    LeafFluxes fluxes;
};
static_assert(sizeof(PagedLeaf) == sizeof(PhotonLeaf) + sizeof(LeafFluxes));

// The photon maps of a render whose leaves are kept in files, and the memory that their pages
// share: each map has of the budget the share that it has of all maps' bytes. Outlives them.
// Threads: all functions from any, at once.
class PhotonPaging {
  public:
    // budget: bytes of pages that are held at once; each thread that reads holds two more at most.
    // folder must outlive this.
    PhotonPaging(ScratchFolder& folder, std::uint64_t budget)
        : m_folder(folder), m_buildBudget(budget), m_budget(budget) {}
    PhotonPaging(const PhotonPaging&) = delete;
    PhotonPaging& operator=(const PhotonPaging&) = delete;

    std::uint64_t budget() const { return m_budget.load(std::memory_order_relaxed); }
    // Evicts at once where it is less than what is held.
    void setBudget(std::uint64_t bytes);
    // What tracing photons and building a map may take beside: the budget at first.
    std::uint64_t buildBudget() const { return m_buildBudget; }
    // Of all maps so far.
    CacheCounts counts() const;
    // Of the pages of the maps that there are now, and the most there were, if all were held.
    std::uint64_t wholeBytes() const { return m_wholeBytes.load(std::memory_order_relaxed); }
    std::uint64_t mostWholeBytes() const {
        return m_mostWholeBytes.load(std::memory_order_relaxed);
    }
    // A file for what is to be sorted, or for pages. Errors: the folder's.
    std::unique_ptr<ScratchFile> makeFile() { return m_folder.make(); }

    // What building a map takes at once in memory, photons and buffers; the most so far.
    class Building;
    std::uint64_t mostBuildBytes() const {
        return m_mostBuildBytes.load(std::memory_order_relaxed);
    }

  private:
    friend class PhotonPage;
    friend class PhotonPages;
    void add(PhotonPages& pages);
    void remove(PhotonPages& pages);
    void share();  // m_mutex held
    void held(std::uint64_t bytes);
    void released(std::uint64_t bytes) { m_bytesHeld.fetch_sub(bytes, std::memory_order_relaxed); }

    ScratchFolder& m_folder;
    const std::uint64_t m_buildBudget;
    std::atomic<std::uint64_t> m_budget;
    std::atomic<std::uint64_t> m_bytesHeld{0}, m_mostBytesHeld{0};
    std::atomic<std::uint64_t> m_wholeBytes{0}, m_mostWholeBytes{0};
    std::atomic<std::uint64_t> m_buildBytes{0}, m_mostBuildBytes{0};
    mutable std::mutex m_mutex;  // of what follows
    std::vector<PhotonPages*> m_maps;
    CacheCounts m_ofGone;  // of maps that are there no more
};

// Counts bytes as those of building while it lives.
class PhotonPaging::Building {
  public:
    Building(PhotonPaging& paging, std::uint64_t bytes);
    ~Building() { m_paging.m_buildBytes.fetch_sub(m_bytes, std::memory_order_relaxed); }
    Building(const Building&) = delete;
    Building& operator=(const Building&) = delete;

  private:
    PhotonPaging& m_paging;
    const std::uint64_t m_bytes;
};

// Leaves that follow each other in the tree, and so are near each other.
class PhotonPage {
  public:
    // Not filled.
    PhotonPage(PhotonPaging& paging, std::uint32_t leaves)
        : m_paging(paging), m_count(leaves), m_leaves(makeBigArray<PagedLeaf>(leaves)) {
        m_paging.held(memoryBytes());
    }
    ~PhotonPage() { m_paging.released(memoryBytes()); }
    PhotonPage(const PhotonPage&) = delete;
    PhotonPage& operator=(const PhotonPage&) = delete;

    std::uint64_t memoryBytes() const { return m_count * sizeof(PagedLeaf) + sizeof(*this); }
    std::span<PagedLeaf> leaves() { return {m_leaves.get(), m_count}; }
    const PagedLeaf& operator[](std::uint32_t leaf) const { return m_leaves[leaf]; }

  private:
    PhotonPaging& m_paging;
    const std::uint32_t m_count;
    BigArray<PagedLeaf> m_leaves;
};

// The leaves of a map in a file, read page by page when they are asked for and forgotten by use.
// Threads: const functions from any, at once.
class PhotonPages {
  public:
    // 28 KiB, 1,024 photons.
    static constexpr std::uint32_t kLeavesPerPage = 64;
    using Pin = BoundedCache<PhotonPage>::Pin;

    // Errors: the folder's. paging must outlive this.
    PhotonPages(PhotonPaging& paging, std::uint32_t leaves);
    ~PhotonPages();
    PhotonPages(const PhotonPages&) = delete;
    PhotonPages& operator=(const PhotonPages&) = delete;

    // Before any is read. Errors: the file's.
    void write(std::uint32_t firstLeaf, std::span<const PagedLeaf> leaves);
    // The page of a leaf. Errors: the file's.
    Pin page(std::uint32_t number) const;

    std::uint64_t wholeBytes() const { return m_leafCount * sizeof(PagedLeaf); }
    // Without pages: those are PhotonPaging's.
    std::uint64_t memoryBytes() const { return m_cache.bytesFor(pageCount()); }
    CacheCounts counts() const { return m_cache.counts(); }

  private:
    friend class PhotonPaging;
    std::uint32_t pageCount() const { return (m_leafCount + kLeavesPerPage - 1) / kLeavesPerPage; }

    PhotonPaging& m_paging;
    const std::uint32_t m_leafCount;
    const std::unique_ptr<ScratchFile> m_file;
    mutable BoundedCache<PhotonPage> m_cache;
};

}  // namespace pm
