// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/log/log.h"
#include "host_shim/render/picture_source.h"

namespace pm::host {

// Parts of one picture, put together by the plugin.
class MergeRun : public PictureSource {
  public:
    explicit MergeRun(const PluginContext& context);
    ~MergeRun() override;
    MergeRun(const MergeRun&) = delete;
    MergeRun& operator=(const MergeRun&) = delete;

    // Adds all parts that are good and names the others in the log. Errors: kBadInput where a part
    // is of another picture than the first good one, or none is good.
    void add(const std::vector<std::filesystem::path>& parts, Log& log);
    // Adds one part. None where it is in; else why it is not: it is damaged, can't be read, or is
    // of another picture than the first good one.
    std::optional<std::string> tryAdd(const std::filesystem::path& part);
    // Of the whole picture; once a part is there.
    std::uint32_t bucketCount() const;
    // Buckets that no part has: "A:B", one range a line.
    std::string missing() const;

    const PluginContext& context() const override { return m_context; }
    std::uint32_t layerCount() const override;
    PmrLayerInfo layerInfo(std::uint32_t index) const override;
    void readPixels(const PmrRectangle& rectangle, const char* layer,
                    float* destination) const override;
    std::string settingText(const std::string& name) const override;
    std::string statistics() const override;

  private:
    const PluginContext& m_context;
    PmrMerge m_handle{};
};

}  // namespace pm::host
