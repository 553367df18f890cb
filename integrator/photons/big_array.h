// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace pm {

// Of a block that may begin before the array in it.
struct FreeMemory {
    void* block = nullptr;
    void operator()(void*) const { std::free(block); }
};

// An array on a cache line's boundary; a large one asks the system for pages of 2 MiB. With the
// usual 4 KiB, first touching 10 million photons' arrays and giving them back took a tenth of the
// time of building their map, and what is looked up in no order found most pages' places anew.
// Tables that begin as zeros cost more: a page that is read first and written then is faulted in
// twice, and the second time all processors are told.
template <typename T>
using BigArray = std::unique_ptr<T[], FreeMemory>;

namespace big_array {

inline constexpr std::size_t kLine = 64, kLargePage = std::size_t{1} << 21;

// Not 0 bytes: that may be answered by a null pointer.
template <typename T>
std::size_t bytesOf(std::size_t count) {
    return std::max<std::size_t>(count, 1) * sizeof(T);
}

inline std::size_t alignmentOf(std::size_t bytes) {
    return bytes >= kLargePage ? kLargePage : kLine;
}

// A wish: where it isn't granted, nothing but the time changes.
inline void wishForLargePages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (bytes >= kLargePage) ::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
}

}  // namespace big_array

// Not initialised. Throws std::bad_alloc.
template <typename T>
BigArray<T> makeBigArray(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T> &&
                  alignof(T) <= big_array::kLine);
    const std::size_t wanted = big_array::bytesOf<T>(count);
    const std::size_t alignment = big_array::alignmentOf(wanted);
    // Whole units of the alignment, as std::aligned_alloc wants them.
    const std::size_t bytes = (wanted + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, bytes);
    if (!memory) throw std::bad_alloc();
    big_array::wishForLargePages(memory, bytes);
    return BigArray<T>(static_cast<T*>(memory), FreeMemory{memory});
}

// For vectors whose elements somebody else writes: resize() leaves them as they are.
template <typename T>
struct BigAllocator {
    using value_type = T;

    BigAllocator() = default;
    template <typename Other>
    explicit BigAllocator(const BigAllocator<Other>& /*unused*/) {}
    T* allocate(std::size_t count) { return makeBigArray<T>(count).release(); }
    void deallocate(T* memory, std::size_t /*unused*/) { std::free(memory); }
    template <typename Element, typename... Arguments>
    void construct(Element* at, Arguments&&... arguments) {
        if constexpr (sizeof...(Arguments) > 0)
            std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
    friend bool operator==(const BigAllocator&, const BigAllocator&) { return true; }
};
template <typename T>
using BigVector = std::vector<T, BigAllocator<T>>;

// All bytes 0, which is what a T begins with: numbers, atomic or not. What is never touched takes
// no memory as a rule. Throws std::bad_alloc.
template <typename T>
BigArray<T> makeBigZeroedArray(std::size_t count) {
    static_assert(std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>);
    const std::size_t wanted = big_array::bytesOf<T>(count);
    const std::size_t alignment = big_array::alignmentOf(wanted);
    std::size_t space = wanted + alignment;
    void* const block = std::calloc(space, 1);
    if (!block) throw std::bad_alloc();
    void* memory = block;
    std::align(alignment, wanted, memory, space);
    big_array::wishForLargePages(memory, wanted);
    return BigArray<T>(static_cast<T*>(memory), FreeMemory{block});
}

}  // namespace pm
