// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace pm {

// Memory that comes from the system as zeros, of which nothing is touched before it is used.
template <typename T>
struct ZeroedMemory {
    static_assert(std::is_trivially_copyable_v<T>);
    using value_type = T;

    T* allocate(std::size_t count) {
        void* const memory = std::calloc(count, sizeof(T));
        if (!memory) throw std::bad_alloc();
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t) { std::free(memory); }

    template <typename U>
    void construct(U*) noexcept {}  // 0 already
    template <typename U, typename... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const ZeroedMemory&) const = default;
};

// Of numbers, or of structs of them that begin as 0. Making a large one takes no time, and what is
// never written no memory. To be given its size once: what it had before would come back.
template <typename T>
using ZeroedVector = std::vector<T, ZeroedMemory<T>>;

}  // namespace pm
