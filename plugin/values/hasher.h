// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <fmt/format.h>
#include <xxhash.h>

#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm::plugin {

// Feeds values to one checksum. Only types without padding are taken as bytes, and every array goes
// in with its length, so that no two different inputs feed the same bytes.
class Hasher {
  public:
    Hasher() : m_state(XXH3_createState()) {
        if (!m_state) throw std::bad_alloc();
        XXH3_128bits_reset(m_state.get());
    }

    template <typename T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void add(T value) { XXH3_128bits_update(m_state.get(), &value, sizeof value); }
    void add(std::string_view text) {
        add(text.size());
        XXH3_128bits_update(m_state.get(), text.data(), text.size());
    }
    template <typename T>
    void addArray(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
        add(values.size());
        XXH3_128bits_update(m_state.get(), values.data(), values.size_bytes());
    }
    void add(const Rgb& c) {
        add(c.r);
        add(c.g);
        add(c.b);
    }
    void add(const Vec3d& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    }
    std::string text() const {
        const XXH128_hash_t hash = XXH3_128bits_digest(m_state.get());
        return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    }

  private:
    struct Free {
        void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
    };
    std::unique_ptr<XXH3_state_t, Free> m_state;
};

// The checksum of what `feed` adds to a hasher.
template <typename Feed>
std::string checksumOf(Feed feed) {
    Hasher hasher;
    feed(hasher);
    return hasher.text();
}

}  // namespace pm::plugin
