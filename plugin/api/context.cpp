// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "plugin/session/callback_scope.h"
#include "plugin/session/setting_table.h"
#include "plugin/values/call_error.h"
#include "plugin/values/forks.h"

namespace pm::plugin {

namespace {

constexpr std::array<std::string_view, 6> kIsaNames = {"best", "sse2", "sse4.2",
                                                       "avx",  "avx2", "avx512"};

std::string checkedIsa(const char* given) {
    const std::string_view name = given == nullptr || *given == 0 ? kIsaNames[0] : given;
    if (std::find(kIsaNames.begin(), kIsaNames.end(), name) == kIsaNames.end())
        throw argumentError(
            fmt::format("isa is '{}'; it must be one of {}", name, fmt::join(kIsaNames, ", ")));
    return std::string(name);
}

int checkedThreads(std::uint32_t threads) {
    if (threads > kMaxThreads)
        throw argumentError(
            fmt::format("threads is {}; it must be 0 (all) to {}", threads, kMaxThreads));
    return static_cast<int>(threads);
}

}  // namespace

Context::Context(const PmrContextDesc& desc)
    : m_message(desc.message),
      m_user(desc.user),
      m_isa(checkedIsa(desc.isa)),
      m_threads(checkedThreads(desc.threads)) {
    if (desc.reserved != 0) throw argumentError("PmrContextDesc: reserved must be 0");
}

void Context::sendMessage(std::int32_t level, std::int32_t code, const std::string& text) const {
    if (m_message == nullptr) return;
    const CallbackScope scope;
    const Activity activity;
    try {
        m_message(m_user, nullptr, level, code, text.c_str());
    } catch (...) {
        // As of a render's callbacks: what a host throws through a C interface ends here.
    }
    if (activity.isOfParent()) throw cutOffError();
}

void Context::sendNotice(const Notice& notice) const {
    sendMessage(PMR_LEVEL_WARNING, static_cast<std::int32_t>(notice.code), notice.text);
}

void Context::nameMaterial(const std::string& name, std::weak_ptr<MaterialObject> material) {
    const std::lock_guard lock(m_namesMutex);
    m_materials[name] = std::move(material);
}

std::shared_ptr<MaterialObject> Context::materialOfName(const std::string& name) const {
    const std::lock_guard lock(m_namesMutex);
    const auto found = m_materials.find(name);
    return found == m_materials.end() ? nullptr : found->second.lock();
}

}  // namespace pm::plugin
