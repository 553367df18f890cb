// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <vector>

namespace pm {

// Memory in whole pages of the system's, given back at once. For values of caches: from the usual
// heap, what is evicted leaves holes between what others keep, and a cache of 100 MiB was seen to
// take 180. Threads: any.
template <typename T>
struct PageAllocator {
    using value_type = T;
    static constexpr std::size_t kPage = 4096;

    PageAllocator() = default;
    template <typename U>
    PageAllocator(const PageAllocator<U>&) {}

    // What so many take.
    static constexpr std::size_t bytesOf(std::size_t count) {
        return (count * sizeof(T) + kPage - 1) / kPage * kPage;
    }
    // Throws std::bad_alloc.
    T* allocate(std::size_t count) {
        void* const memory = ::mmap(nullptr, bytesOf(count), PROT_READ | PROT_WRITE,
                                    MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) { ::munmap(memory, bytesOf(count)); }

    bool operator==(const PageAllocator&) const = default;
};

template <typename T>
using PagedVector = std::vector<T, PageAllocator<T>>;

}  // namespace pm
