// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/handle_table.h"

#include <utility>

#include "plugin/values/forks.h"

namespace pm::plugin {

namespace {
// Multiples of 16 from here on look like pointers in a debugger and are never null.
constexpr std::uintptr_t kFirstHandle = 0x10000;
constexpr std::uintptr_t kHandleStep = 16;
}  // namespace

std::uintptr_t HandleTable::insert(ObjectKind kind, std::shared_ptr<void> object) {
    const auto lock = holdOffForks();
    const std::uintptr_t handle = kFirstHandle + kHandleStep * m_next++;
    m_entries.emplace(handle, Entry{kind, 1, std::move(object), forkCount()});
    return handle;
}

const HandleTable::Entry* HandleTable::findLive(std::uintptr_t handle, ObjectKind kind) const {
    const auto found = m_entries.find(handle);
    const bool isLive =
        found != m_entries.end() && found->second.kind == kind && found->second.references > 0;
    return isLive ? &found->second : nullptr;
}

std::shared_ptr<void> HandleTable::find(std::uintptr_t handle, ObjectKind kind) const {
    const auto lock = holdOffForks();
    const Entry* const entry = findLive(handle, kind);
    if (entry == nullptr) return nullptr;
    if (plugin::isCutOff(entry->forkCount)) throw cutOffError();
    return entry->object;
}

bool HandleTable::retain(std::uintptr_t handle, ObjectKind kind) {
    const auto lock = holdOffForks();
    if (findLive(handle, kind) == nullptr) return false;
    ++m_entries.at(handle).references;
    return true;
}

bool HandleTable::release(std::uintptr_t handle, ObjectKind kind, std::shared_ptr<void>& last) {
    const auto lock = holdOffForks();
    if (findLive(handle, kind) == nullptr) return false;
    Entry& entry = m_entries.at(handle);
    if (--entry.references == 0 && entry.forkCount == forkCount()) {
        last = std::move(entry.object);
        m_entries.erase(handle);
    }
    return true;
}

bool HandleTable::isCutOff(std::uintptr_t handle, ObjectKind kind) const {
    const auto lock = holdOffForks();
    const Entry* const entry = findLive(handle, kind);
    return entry != nullptr && plugin::isCutOff(entry->forkCount);
}

HandleTable& handleTable() {
    static HandleTable& table = *new HandleTable;
    return table;
}

}  // namespace pm::plugin
