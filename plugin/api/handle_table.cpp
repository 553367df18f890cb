// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/handle_table.h"

#include <utility>

namespace pm::plugin {

namespace {
// Multiples of 16 from here on look like pointers in a debugger and are never null.
constexpr std::uintptr_t kFirstHandle = 0x10000;
constexpr std::uintptr_t kHandleStep = 16;
}  // namespace

std::uintptr_t HandleTable::insert(ObjectKind kind, std::shared_ptr<void> object) {
    const std::lock_guard lock(m_mutex);
    const std::uintptr_t handle = kFirstHandle + kHandleStep * m_next++;
    m_entries.emplace(handle, Entry{kind, 1, std::move(object)});
    return handle;
}

std::shared_ptr<void> HandleTable::find(std::uintptr_t handle, ObjectKind kind) const {
    const std::lock_guard lock(m_mutex);
    const auto found = m_entries.find(handle);
    if (found == m_entries.end() || found->second.kind != kind) return nullptr;
    return found->second.object;
}

bool HandleTable::retain(std::uintptr_t handle, ObjectKind kind) {
    const std::lock_guard lock(m_mutex);
    const auto found = m_entries.find(handle);
    if (found == m_entries.end() || found->second.kind != kind) return false;
    ++found->second.references;
    return true;
}

bool HandleTable::release(std::uintptr_t handle, ObjectKind kind, std::shared_ptr<void>& last) {
    const std::lock_guard lock(m_mutex);
    const auto found = m_entries.find(handle);
    if (found == m_entries.end() || found->second.kind != kind) return false;
    if (--found->second.references == 0) {
        last = std::move(found->second.object);
        m_entries.erase(found);
    }
    return true;
}

HandleTable& handleTable() {
    static HandleTable& table = *new HandleTable;
    return table;
}

}  // namespace pm::plugin
