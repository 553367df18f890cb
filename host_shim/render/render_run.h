// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"
#include "host_shim/log/progress.h"
#include "host_shim/render/picture_source.h"
#include "host_shim/render/scene_builder.h"
#include "host_shim/report/bucket_times.h"

namespace pm::host {

// Takes the pixels of a render that delivers bucket by bucket.
class BucketTaker {
  public:
    virtual ~BucketTaker() = default;
    // Inside the callback, while the bucket's pixels can be read. What it throws ends the render.
    virtual void take(const PmrBucketInfo& bucket) = 0;
};

// One render of a scene: settings, the run itself, and what it left.
class RenderRun : public PictureSource {
  public:
    // Settings are given here. identity: what of the host decides on the picture. bucketTimes:
    // where the buckets are timed, null where nobody asks. Errors: kUsage for a setting that the
    // plugin refuses.
    RenderRun(const PluginScene& scene, const Options& options, const std::string& identity,
              Log& log, Progress& progress, BucketTimes* bucketTimes);
    ~RenderRun() override;
    RenderRun(const RenderRun&) = delete;
    RenderRun& operator=(const RenderRun&) = delete;

    // Errors: kUsage for settings that go together badly.
    std::string explain() const;
    // Whether the frame is too large for the memory limit, so that its pixels come bucket by bucket
    // and some BucketTaker is needed. Before run.
    bool deliversBuckets() const;
    // Wants the whole frame, whatever it needs. reason: why, to say when that is too much.
    void keepFrame(const std::string& reason);
    void setTaker(BucketTaker* taker) { m_taker = taker; }
    // Renders; a signal cancels. Returns PMR_OK or PMR_ERROR_CANCELLED. Errors: those of the
    // plugin.
    PmrStatus run();

    const PluginContext& context() const override { return m_context; }
    std::uint32_t layerCount() const override;
    PmrLayerInfo layerInfo(std::uint32_t index) const override;
    void readPixels(const PmrRectangle& rectangle, const char* layer,
                    float* destination) const override;
    // The same with strides, in bytes.
    void readPixels(const PmrRectangle& rectangle, const char* layer, float* destination,
                    std::int64_t pixelStride, std::int64_t rowStride) const;
    std::string settingText(const std::string& name) const override;
    std::string statistics() const override;

  private:
    void apply(const GivenSetting& setting);
    // Throws when status is an error; what: before its text. What is wrong with the settings
    // together is wrong with the command line.
    void checkSettings(PmrStatus status, const std::string& what) const;
    std::string withOption(const std::string& text) const;
    static void onMessage(void* user, PmrRender, int32_t level, int32_t code, const char* text);
    static void onProgress(void* user, PmrRender, double fraction, double remainingSeconds);
    static void onBucketFinished(void* user, PmrRender, const PmrBucketInfo* bucket);
    static void onFinished(void* user, PmrRender, PmrStatus status);

    const PluginContext& m_context;
    Log& m_log;
    Progress& m_progress;
    BucketTimes* m_bucketTimes;
    BucketTaker* m_taker{};
    std::vector<GivenSetting> m_given;
    std::exception_ptr m_failure;  // of the taker
    std::string m_whyFrame;
    PmrRender m_handle{};
    bool m_finished{};
    PmrStatus m_status{PMR_OK};
};

// A message of the plugin, to the log. Also the message function of contexts, with a Log as user.
void PMR_CALL logPluginMessage(void* log, PmrRender, int32_t level, int32_t code, const char* text);

}  // namespace pm::host
