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

struct FreeMemory {
    void operator()(void* memory) const { std::free(memory); }
};

// An array on a cache line's boundary; a large one asks the system for pages of 2 MiB. With the
// usual 4 KiB, first touching 10 million photons' arrays and giving them back took a tenth of the
// time of building their map, and what is looked up in no order found most pages' places anew.
template <typename T>
using BigArray = std::unique_ptr<T[], FreeMemory>;

namespace big_array {

inline constexpr std::size_t kLine = 64, kLargePage = std::size_t{1} << 21;

// Not 0 bytes: that may be answered by a null pointer.
template <typename T>
constexpr std::size_t bytesOf(std::size_t count) {
    return std::max<std::size_t>(count, 1) * sizeof(T);
}

constexpr std::size_t alignmentOf(std::size_t bytes) {
    return bytes >= kLargePage ? kLargePage : kLine;
}

// A wish: where it isn't granted, nothing but the time changes.
inline void wishForLargePages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (bytes >= kLargePage) ::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
}

// Writes zeros, in parallel in the calling TBB arena.
void zero(void* memory, std::size_t bytes);

}  // namespace big_array

// What an array of so many takes: whole units of its alignment, as std::aligned_alloc wants them.
template <typename T>
constexpr std::size_t bigArrayBytes(std::size_t count) {
    const std::size_t wanted = big_array::bytesOf<T>(count);
    const std::size_t alignment = big_array::alignmentOf(wanted);
    return (wanted + alignment - 1) / alignment * alignment;
}

// Not initialised. Throws std::bad_alloc.
template <typename T>
BigArray<T> makeBigArray(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T> &&
                  alignof(T) <= big_array::kLine);
    const std::size_t bytes = bigArrayBytes<T>(count);
    void* const memory =
        std::aligned_alloc(big_array::alignmentOf(big_array::bytesOf<T>(count)), bytes);
    if (!memory) throw std::bad_alloc();
    big_array::wishForLargePages(memory, bytes);
    return BigArray<T>(static_cast<T*>(memory));
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

// All bytes 0, which is what a T begins with: numbers, atomic or not. Written in parallel in the
// calling TBB arena: memory that the heap gives again has to be, and that new from the system, read
// first and written then, would be faulted in twice, and the second time all processors be told.
// Throws std::bad_alloc.
template <typename T>
BigArray<T> makeBigZeroedArray(std::size_t count) {
    static_assert(std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>);
    BigArray<T> array = makeBigArray<T>(count);
    big_array::zero(array.get(), count * sizeof(T));
    return array;
}

}  // namespace pm
