// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "plugin/include/pm_plugin.h"

namespace pm::host {

// libpm_plugin.so, loaded as any host loads it. Stays loaded as long as this lives.
class Plugin {
  public:
    // given, else $PM_PLUGIN_PATH, else beside this program, else in ../lib from there; never the
    // working folder. Errors: kInternal when there is none or it does not fit.
    explicit Plugin(const std::filesystem::path& given);
    ~Plugin();
    Plugin(const Plugin&) = delete;
    Plugin& operator=(const Plugin&) = delete;

    const PmrApi& api() const { return *m_api; }
    const std::filesystem::path& file() const { return m_file; }

  private:
    void* m_library{};
    const PmrApi* m_api{};
    std::filesystem::path m_file;
};

// A context of the plugin, and its errors as ours.
class PluginContext {
  public:
    PluginContext(const Plugin& plugin, const PmrContextDesc& desc);
    ~PluginContext();
    PluginContext(const PluginContext&) = delete;
    PluginContext& operator=(const PluginContext&) = delete;

    const PmrApi& api() const { return m_api; }
    PmrContext handle() const { return m_handle; }
    std::string lastError() const;
    // Throws when status is an error; what goes before its text. Errors: as exitCodeOf.
    void check(PmrStatus status, const std::string& what) const;

  private:
    const PmrApi& m_api;
    PmrContext m_handle{};
};

// The exit code for a status of the plugin.
int exitCodeOf(PmrStatus status);

// Calls a function of the plugin that fills a text buffer.
template <typename Call>
std::string pluginText(const Call& call) {
    uint64_t needed = 0;
    call(nullptr, uint64_t{0}, &needed);
    // It may grow between two calls; then it is asked for again.
    for (std::string text; needed > text.size();) {
        text.assign(needed, '\0');
        if (call(text.data(), uint64_t{text.size()}, &needed) != PMR_OK) continue;
        text.resize(needed - 1);
        return text;
    }
    return {};
}

}  // namespace pm::host
