// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/map/photon_pages.h"

#include <algorithm>

namespace pm {

namespace {

void raise(std::atomic<std::uint64_t>& most, std::uint64_t value) {
    std::uint64_t known = most.load(std::memory_order_relaxed);
    while (known < value && !most.compare_exchange_weak(known, value)) {
    }
}

CacheCounts& operator+=(CacheCounts& sum, const CacheCounts& counts) {
    sum.misses += counts.misses;
    sum.madeAgain += counts.madeAgain;
    sum.waits += counts.waits;
    sum.bytesMade += counts.bytesMade;
    for (std::size_t i = 0; i < kCacheUsers; ++i) sum.missesOf[i] += counts.missesOf[i];
    return sum;
}

}  // namespace

void PhotonPaging::setBudget(std::uint64_t bytes) {
    m_budget.store(bytes, std::memory_order_relaxed);
    const std::lock_guard lock(m_mutex);
    share();
}

CacheCounts PhotonPaging::counts() const {
    const std::lock_guard lock(m_mutex);
    CacheCounts sum = m_ofGone;
    for (const PhotonPages* const pages : m_maps) sum += pages->counts();
    sum.bytesHeld = m_bytesHeld.load(std::memory_order_relaxed);
    sum.mostBytesHeld = m_mostBytesHeld.load(std::memory_order_relaxed);
    return sum;
}

void PhotonPaging::add(PhotonPages& pages) {
    const std::lock_guard lock(m_mutex);
    m_maps.push_back(&pages);
    raise(m_mostWholeBytes, m_wholeBytes.fetch_add(pages.wholeBytes()) + pages.wholeBytes());
    share();
}

void PhotonPaging::remove(PhotonPages& pages) {
    const std::lock_guard lock(m_mutex);
    std::erase(m_maps, &pages);
    m_wholeBytes.fetch_sub(pages.wholeBytes());
    m_ofGone += pages.counts();
    share();
}

void PhotonPaging::share() {
    const auto whole = static_cast<double>(std::max<std::uint64_t>(wholeBytes(), 1));
    for (PhotonPages* const pages : m_maps) {
        const double part = static_cast<double>(pages->wholeBytes()) / whole;
        pages->m_cache.setBudget(static_cast<std::uint64_t>(part * static_cast<double>(budget())));
    }
}

void PhotonPaging::held(std::uint64_t bytes) {
    raise(m_mostBytesHeld, m_bytesHeld.fetch_add(bytes, std::memory_order_relaxed) + bytes);
}

PhotonPaging::Building::Building(PhotonPaging& paging, std::uint64_t bytes)
    : m_paging(paging), m_bytes(bytes) {
    raise(paging.m_mostBuildBytes,
          paging.m_buildBytes.fetch_add(bytes, std::memory_order_relaxed) + bytes);
}

PhotonPages::PhotonPages(PhotonPaging& paging, std::uint32_t leaves)
    : m_paging(paging), m_leafCount(leaves), m_file(paging.makeFile()), m_cache(pageCount(), 0) {
    paging.add(*this);
}

PhotonPages::~PhotonPages() {
    m_paging.remove(*this);
}

void PhotonPages::write(std::uint32_t firstLeaf, std::span<const PagedLeaf> leaves) {
    m_file->write(std::uint64_t{firstLeaf} * sizeof(PagedLeaf), std::as_bytes(leaves));
}

PhotonPages::Pin PhotonPages::page(std::uint32_t number) const {
    return m_cache.get(number, [&](std::size_t key) {
        const std::uint64_t first = key * kLeavesPerPage;
        const auto count = static_cast<std::uint32_t>(
            std::min<std::uint64_t>(kLeavesPerPage, m_leafCount - first));
        auto page = std::make_unique<PhotonPage>(m_paging, count);
        m_file->read(first * sizeof(PagedLeaf), std::as_writable_bytes(page->leaves()));
        return page;
    });
}

}  // namespace pm
