// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/alloc/failing_malloc.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

// glibc's own, under the names that it has for programs like this one.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace pm::test {

namespace {

std::atomic<std::uint64_t> s_count{0}, s_failing{0};
std::atomic<std::int64_t> s_live{0};
std::atomic<Stack*> s_failed{nullptr};

// Whether this one is to fail.
bool isTheOne() {
    if (++s_count != s_failing.load(std::memory_order_relaxed)) return false;
    if (Stack* stack = s_failed)
        stack->count = backtrace(stack->frames.data(), static_cast<int>(stack->frames.size()));
    return true;
}

void* counted(void* memory) {
    if (memory != nullptr) ++s_live;
    return memory;
}

void* noMemory() {
    errno = ENOMEM;
    return nullptr;
}

}  // namespace

void failAllocation(std::uint64_t number, Stack* failed) {
    s_failing = 0;
    s_failed = failed;
    s_count = 0;
    s_failing = number;
}

std::uint64_t allocationCount() {
    return s_count;
}

bool hasFailed() {
    return s_failing != 0 && s_count >= s_failing;
}

std::int64_t liveAllocations() {
    return s_live;
}

}  // namespace pm::test

using pm::test::counted;
using pm::test::isTheOne;
using pm::test::noMemory;

// Seen by the libraries.
#pragma GCC visibility push(default)
extern "C" {

void* malloc(std::size_t size) {
    return isTheOne() ? noMemory() : counted(__libc_malloc(size));
}

void* calloc(std::size_t count, std::size_t size) {
    return isTheOne() ? noMemory() : counted(__libc_calloc(count, size));
}

void* realloc(void* old, std::size_t size) {
    if (isTheOne()) return noMemory();
    void* memory = __libc_realloc(old, size);
    if (old == nullptr) return counted(memory);
    if (memory == nullptr && size == 0) --pm::test::s_live;
    return memory;
}

void* memalign(std::size_t alignment, std::size_t size) {
    return isTheOne() ? noMemory() : counted(__libc_memalign(alignment, size));
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
    return memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
    if (isTheOne()) return ENOMEM;
    *memory = counted(__libc_memalign(alignment, size));
    return *memory == nullptr ? ENOMEM : 0;
}

void free(void* memory) {
    if (memory != nullptr) --pm::test::s_live;
    __libc_free(memory);
}

void* mmap(void* at, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
    if ((flags & MAP_ANONYMOUS) != 0 && isTheOne()) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    return reinterpret_cast<void*>(syscall(SYS_mmap, at, size, protection, flags, file, offset));
}

void* mmap64(void* at, std::size_t size, int protection, int flags, int file,
             off64_t offset) noexcept {
    return mmap(at, size, protection, flags, file, offset);
}
}
#pragma GCC visibility pop
