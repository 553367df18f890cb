// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "integrator/caches/scratch.h"
#include "integrator/photons/map/photon.h"

namespace pm {

// Photons in a file, in the order in which they were appended. Threads: one.
class PhotonSpool {
  public:
    // So many are read or written at a time.
    static constexpr std::size_t kBlock = 4096;
    static constexpr std::uint64_t kBufferBytes = kBlock * sizeof(Photon);

    explicit PhotonSpool(std::unique_ptr<ScratchFile> file) : m_file(std::move(file)) {
        m_buffer.reserve(kBlock);
    }

    // Errors of these: the file's.
    void append(const Photon& photon) {
        m_buffer.push_back(photon);
        ++m_size;
        const Vec3f& p = photon.position;
        m_lo = {std::min(m_lo.x, p.x), std::min(m_lo.y, p.y), std::min(m_lo.z, p.z)};
        m_hi = {std::max(m_hi.x, p.x), std::max(m_hi.y, p.y), std::max(m_hi.z, p.z)};
        if (m_buffer.size() == kBlock) flush();
    }
    void append(std::span<const Photon> photons) {
        for (const Photon& photon : photons) append(photon);
    }
    // After the last: writes what is left, and keeps no buffer.
    void finish() {
        flush();
        std::vector<Photon>().swap(m_buffer);
    }

    // Of finished ones.
    void read(std::uint64_t first, std::span<Photon> photons) const {
        m_file->read(first * sizeof(Photon), std::as_writable_bytes(photons));
    }
    // visit(photon) for all, in their order.
    template <typename Visit>
    void visit(const Visit& visit) const {
        std::vector<Photon> block(std::min<std::uint64_t>(kBlock, m_size));
        for (std::uint64_t first = 0; first < m_size; first += kBlock) {
            const auto count =
                static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, m_size - first));
            read(first, {block.data(), count});
            for (std::size_t i = 0; i < count; ++i) visit(block[i]);
        }
    }

    std::uint64_t size() const { return m_size; }
    // Their box, scene units; of none upside down.
    const Vec3f& lo() const { return m_lo; }
    const Vec3f& hi() const { return m_hi; }

  private:
    void flush() {
        if (m_buffer.empty()) return;
        m_file->write((m_size - m_buffer.size()) * sizeof(Photon),
                      std::as_bytes(std::span(m_buffer)));
        m_buffer.clear();
    }

    std::unique_ptr<ScratchFile> m_file;
    std::uint64_t m_size = 0;
    Vec3f m_lo{std::numeric_limits<float>::max()}, m_hi{std::numeric_limits<float>::lowest()};
    std::vector<Photon> m_buffer;  // the last ones, not yet written
};

}  // namespace pm
