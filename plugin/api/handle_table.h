// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

namespace pm::plugin {

enum class ObjectKind : std::int32_t {
    kContext,
    kMesh,
    kTexture,
    kMaterial,
    kScene,
    kRender,
    kMerge
};

// Which object a handle stands for. A handle is a number that is given out once and never again,
// dressed as a pointer that nobody follows: one that was released, made up, or of another kind is
// always recognised.
// Threads: every member may be called from any thread at any time; holdOffForks() is its lock, so
// it is whole in every child.
class HandleTable {
  public:
    // A new handle with one reference of the host's.
    std::uintptr_t insert(ObjectKind kind, std::shared_ptr<void> object);

    // The object of a live handle of that kind, else null. The caller shares it, so it lives on
    // while another thread releases the handle. Errors: CallError(STATE) for one that a fork cut
    // off (isCutOff).
    std::shared_ptr<void> find(std::uintptr_t handle, ObjectKind kind) const;

    // One reference more; false for a handle that is not live or of another kind.
    bool retain(std::uintptr_t handle, ObjectKind kind);

    // One reference less. Returns false for a handle that is not live or of another kind. With the
    // last reference the handle ends, and the object goes to `last`, to be destroyed by the caller
    // outside of the table's lock. What was made before this process was forked is never destroyed
    // in it: threads that it hasn't got may own a part, and libraries wait for theirs.
    bool release(std::uintptr_t handle, ObjectKind kind, std::shared_ptr<void>& last);

    // Whether it is a live handle of that kind that a fork cut off.
    bool isCutOff(std::uintptr_t handle, ObjectKind kind) const;

  private:
    struct Entry {
        ObjectKind kind;
        std::uint64_t references;  // 0: released, but not to be destroyed
        std::shared_ptr<void> object;
        std::uint32_t forkCount;  // when it was made
    };
    const Entry* findLive(std::uintptr_t handle, ObjectKind kind) const;

    std::uint64_t m_next = 1;
    std::unordered_map<std::uintptr_t, Entry> m_entries;
};

// The library's table. The C interface passes bare handles, so there must be one for the whole
// library; it is the only state that calls share. It is never destroyed: a host may end while
// renders run.
HandleTable& handleTable();

}  // namespace pm::plugin
