// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLibraryName = "libpm_plugin.so";

fs::path findLibrary(const fs::path& given) {
    // A name without a slash would be looked for in the system's library folders.
    if (!given.empty()) return fs::absolute(given);
    const char* variable = std::getenv("PM_PLUGIN_PATH");
    if (variable != nullptr && *variable != '\0') return fs::absolute(variable);
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    const std::vector<fs::path> candidates{folder / kLibraryName,
                                           folder.parent_path() / "lib" / kLibraryName,
                                           folder.parent_path() / PM_LIBRARY_FOLDER / kLibraryName};
    for (const fs::path& candidate : candidates) {
        if (fs::exists(candidate, error)) return candidate;
    }
    throw HostError(ExitCode::kInternal,
                    fmt::format("no plugin: {} is neither in {} nor in {}; give --plugin FILE or "
                                "set PM_PLUGIN_PATH",
                                kLibraryName, candidates[0].parent_path().string(),
                                candidates[1].parent_path().string()));
}

}  // namespace

Plugin::Plugin(const fs::path& given) : m_file(findLibrary(given)) {
    std::error_code ignored;
    // The loader would wait for who writes into a pipe.
    if (fs::exists(m_file, ignored) && !fs::is_regular_file(m_file, ignored))
        throw HostError(ExitCode::kInternal,
                        fmt::format("no plugin: {} is no file", m_file.string()));
    m_library = dlopen(m_file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (m_library == nullptr) {
        throw HostError(ExitCode::kInternal, fmt::format("no plugin: {} can't be loaded: {}",
                                                         m_file.string(), dlerror()));
    }
    const auto getApi =
        reinterpret_cast<PmrGetApiFunction>(dlsym(m_library, "pmrGetApi"));  // NOLINT
    if (getApi == nullptr || getApi(PMR_ABI_VERSION, &m_api) != PMR_OK || m_api == nullptr ||
        m_api->size < sizeof(PmrApi)) {
        dlclose(m_library);
        throw HostError(ExitCode::kInternal,
                        fmt::format("no plugin: {} does not offer version {} of the interface",
                                    m_file.string(), PMR_ABI_VERSION));
    }
}

Plugin::~Plugin() {
    dlclose(m_library);
}

PluginContext::PluginContext(const Plugin& plugin, const PmrContextDesc& desc)
    : m_api(plugin.api()) {
    const PmrStatus status = m_api.createContext(&desc, &m_handle);
    if (status == PMR_OK) return;
    const bool isaGiven = desc.isa != nullptr && *desc.isa != '\0';
    if (isaGiven && (status == PMR_ERROR_ARGUMENT || status == PMR_ERROR_UNSUPPORTED)) {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--isa '{}': allowed are best, sse2, sse4.2, avx, avx2 and "
                                    "avx512, as far as this processor has them",
                                    desc.isa));
    }
    throw HostError(static_cast<ExitCode>(exitCodeOf(status)),
                    fmt::format("the plugin can't be set up: {}", m_api.statusText(status)));
}

PluginContext::~PluginContext() {
    m_api.releaseContext(m_handle);
}

std::string PluginContext::lastError() const {
    return pluginText([this](char* buffer, uint64_t capacity, uint64_t* needed) {
        return m_api.lastError(m_handle, buffer, capacity, needed);
    });
}

void PluginContext::check(PmrStatus status, const std::string& what) const {
    if (status == PMR_OK) return;
    if (status == PMR_ERROR_CANCELLED) throwIfInterrupted();
    std::string text = lastError();
    if (text.empty()) text = m_api.statusText(status);
    throw HostError(static_cast<ExitCode>(exitCodeOf(status)), fmt::format("{}: {}", what, text));
}

int exitCodeOf(PmrStatus status) {
    switch (status) {
        case PMR_OK:
            return 0;
        case PMR_ERROR_ARGUMENT:
        case PMR_ERROR_SCENE:
        case PMR_ERROR_UNSUPPORTED:
        case PMR_ERROR_FILE:
        case PMR_ERROR_MISMATCH:
            return 3;
        case PMR_ERROR_NAME:
            return 2;
        case PMR_ERROR_IO:
            return 4;
        case PMR_ERROR_MEMORY:
            return 5;
        case PMR_ERROR_CANCELLED:
            return 130;
        default:
            return 1;
    }
}

}  // namespace pm::host
