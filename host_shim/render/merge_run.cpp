// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/merge_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

MergeRun::MergeRun(const PluginContext& context) : m_context(context) {
    m_context.check(api().createMerge(m_context.handle(), &m_handle), "merge");
}

MergeRun::~MergeRun() {
    api().releaseMerge(m_handle);
}

void MergeRun::add(const std::vector<std::filesystem::path>& parts, Log& log) {
    std::size_t good = 0;
    for (const std::filesystem::path& part : parts) {
        throwIfInterrupted();
        const PmrStatus status = api().addPart(m_handle, part.c_str());
        // One that is damaged may be there twice, or is missing: only then it has to be made anew.
        if (status == PMR_OK)
            ++good;
        else if (status == PMR_ERROR_FILE || status == PMR_ERROR_IO)
            log.message(Level::kError, m_context.lastError());
        else
            m_context.check(status, "merge");
    }
    if (good == 0) throw HostError(ExitCode::kBadInput, "merge: none of the parts can be used");
}

std::optional<std::string> MergeRun::tryAdd(const std::filesystem::path& part) {
    const PmrStatus status = api().addPart(m_handle, part.c_str());
    if (status == PMR_OK) return std::nullopt;
    const bool isOfPart =
        status == PMR_ERROR_FILE || status == PMR_ERROR_IO || status == PMR_ERROR_MISMATCH;
    if (!isOfPart) m_context.check(status, "merge");
    return m_context.lastError();
}

std::uint32_t MergeRun::bucketCount() const {
    const auto json = nlohmann::json::parse(statistics(), nullptr, false);
    return json.at("buckets").at("count").get<std::uint32_t>();
}

std::string MergeRun::missing() const {
    return pluginText([this](char* buffer, uint64_t capacity, uint64_t* needed) {
        return api().mergeMissing(m_handle, buffer, capacity, needed);
    });
}

std::uint32_t MergeRun::layerCount() const {
    std::uint32_t count = 0;
    m_context.check(api().mergeLayerCount(m_handle, &count), "layers");
    return count;
}

PmrLayerInfo MergeRun::layerInfo(std::uint32_t index) const {
    auto info = PMR_INIT(PmrLayerInfo);
    m_context.check(api().mergeLayerInfo(m_handle, index, &info), "layers");
    return info;
}

void MergeRun::readPixels(const PmrRectangle& rectangle, const char* layer,
                          float* destination) const {
    m_context.check(api().readMergedPixels(m_handle, &rectangle, layer, destination, 0, 0),
                    fmt::format("layer {}", layer));
}

std::string MergeRun::settingText(const std::string& name) const {
    return pluginText([&](char* buffer, uint64_t capacity, uint64_t* needed) {
        return api().mergeSettingText(m_handle, name.c_str(), buffer, capacity, needed);
    });
}

std::string MergeRun::statistics() const {
    return pluginText([this](char* buffer, uint64_t capacity, uint64_t* needed) {
        return api().mergeStatistics(m_handle, buffer, capacity, needed);
    });
}

}  // namespace pm::host
