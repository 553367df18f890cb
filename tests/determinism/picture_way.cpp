// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/picture_way.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <clocale>
#include <cstdint>
#include <cstdio>
#include <locale>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "tests/abi/host.h"

namespace pm::test {

namespace {

// The host's floating-point modes and locale, put back at the end.
class HostState {
  public:
    explicit HostState(const Way& way) {
        if (!way.locale.empty()) {
            std::locale::global(std::locale(way.locale));
            EXPECT_STREQ(",", std::localeconv()->decimal_point) << way.locale;
        }
#if defined(__SSE__)
        // Flush-to-zero, denormals-are-zero, towards zero.
        if (way.flushesDenormals) _mm_setcsr(m_modes | 0xe040);
#endif
    }
    ~HostState() {
#if defined(__SSE__)
        _mm_setcsr(m_modes);
#endif
        std::locale::global(m_locale);
    }
    HostState(const HostState&) = delete;
    HostState& operator=(const HostState&) = delete;

  private:
#if defined(__SSE__)
    unsigned m_modes = _mm_getcsr();
#endif
    std::locale m_locale;
};

// A run of the layers of a render or merge, by the calls that are theirs.
template <typename Count, typename Info, typename Read>
LayeredPicture readLayers(const PmrRectangle& window, Count&& count, Info&& info, Read&& read) {
    LayeredPicture picture{window, {}};
    const auto area = static_cast<std::size_t>((window.x1 - window.x0) * (window.y1 - window.y0));
    std::uint32_t layers = 0;
    EXPECT_EQ(PMR_OK, count(&layers));
    for (std::uint32_t i = 0; i < layers; ++i) {
        PmrLayerInfo layer = PMR_INIT(PmrLayerInfo);
        EXPECT_EQ(PMR_OK, info(i, &layer));
        picture.layers.push_back({layer.name, layer.channels, layer.channelCount,
                                  std::vector<float>(area * layer.channelCount, -7.0f)});
        EXPECT_EQ(PMR_OK, read(&window, layer.name, picture.layers.back().values.data()));
    }
    return picture;
}

struct Seen {
    std::uint32_t cancelAfterPasses = 0;  // and half of a pass; 0 = never
    std::uint32_t buckets = 0;
    std::string infos;
};

void onBucket(void* user, PmrRender render, const PmrBucketInfo* bucket) {
    auto* seen = static_cast<Seen*>(user);
    const std::uint32_t wanted =
        seen->cancelAfterPasses * bucket->bucketCount + std::max(1u, bucket->bucketCount / 2);
    if (++seen->buckets == wanted && seen->cancelAfterPasses > 0) api().cancelRender(render);
}

void onMessage(void* user, PmrRender, std::int32_t level, std::int32_t, const char* text) {
    if (level == PMR_LEVEL_INFO) static_cast<Seen*>(user)->infos += std::string(text) + "\n";
}

// The scene of one way in a context of its own, and the renders of it.
class Studio {
  public:
    Studio(const Way& way, const Settings& settings, const SceneChoice& scene,
           const std::string& folder)
        : m_way(way),
          m_settings(settings),
          m_checkpoint(folder + "/checkpoint"),
          m_part(folder + "/part") {
        PmrContextDesc desc = PMR_INIT(PmrContextDesc);
        desc.threads = static_cast<std::uint32_t>(way.threads);
        EXPECT_EQ(PMR_OK, api().createContext(&desc, &m_context));
        m_scene = transportScene(m_context, scene);
        const PmrRectangle& window = way.window;
        if (way.isCropped)
            m_settings["crop"] =
                fmt::format("{},{},{},{}", window.x0, window.y0, window.x1, window.y1);
        m_settings["bucketOrder"] = way.order;
    }
    ~Studio() {
        EXPECT_EQ(PMR_OK, api().releaseScene(m_scene));
        EXPECT_EQ(PMR_OK, api().releaseContext(m_context));
    }
    Studio(const Studio&) = delete;
    Studio& operator=(const Studio&) = delete;

    LayeredPicture makeAtOnce(Interruptions& interruptions) {
        Settings settings = m_settings;
        int threads = m_way.threads, bucketSize = m_way.bucketSize;
        if (m_way.resumeThreads > 0) {
            interrupt(settings);
            threads = m_way.resumeThreads;
            bucketSize = m_way.resumeBucketSize;
        }
        LayeredPicture picture;
        render(settings, threads, bucketSize, 0, &picture, interruptions);
        std::remove(m_checkpoint.c_str());
        return picture;
    }

    LayeredPicture makeOfParts(Interruptions& interruptions) {
        PmrMerge merge = nullptr;
        EXPECT_EQ(PMR_OK, api().createMerge(m_context, &merge));
        const int parts = std::min(3, bucketCount());
        for (int i = 1; i <= parts; ++i) {
            Settings settings = m_settings;
            settings["buckets"] = fmt::format("{}/{}", i, parts);
            int threads = m_way.threads;
            if (m_way.resumeThreads > 0 && i == parts) {
                interrupt(settings);
                threads = m_way.resumeThreads;
            }
            settings["part"] = m_part;
            render(settings, threads, m_way.bucketSize, 0, nullptr, interruptions);
            EXPECT_EQ(PMR_OK, api().addPart(merge, m_part.c_str())) << lastError();
            std::remove(m_part.c_str());
        }
        std::remove(m_checkpoint.c_str());
        const LayeredPicture picture = readLayers(
            m_way.window, [&](std::uint32_t* count) { return api().mergeLayerCount(merge, count); },
            [&](std::uint32_t i, PmrLayerInfo* info) {
                return api().mergeLayerInfo(merge, i, info);
            },
            [&](const PmrRectangle* window, const char* layer, float* pixels) {
                return api().readMergedPixels(merge, window, layer, pixels, 0, 0);
            });
        EXPECT_EQ(PMR_OK, api().releaseMerge(merge));
        return picture;
    }

  private:
    std::string lastError() const {
        return textOf([this](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().lastError(m_context, buffer, capacity, needed);
        });
    }

    // Of the way's window; buckets begin at multiples of 8 pixels.
    int bucketCount() const {
        const auto along = [this](int low, int high) {
            const int start = low & ~7;
            return (high - start + m_way.bucketSize - 1) / m_way.bucketSize;
        };
        const PmrRectangle& window = m_way.window;
        return along(window.x0, window.x1) * along(window.y0, window.y1);
    }

    // Leaves a checkpoint, and in the settings that it is to be gone on with.
    void interrupt(Settings& settings) {
        settings["checkpoint"] = m_checkpoint;
        settings["resume"] = std::string("1");
        Interruptions none;
        render(settings, m_way.threads, m_way.bucketSize, 1, nullptr, none);
    }

    // cancelAfterPasses: these and half of the next; 0 = not.
    void render(Settings settings, int threads, int bucketSize, std::uint32_t cancelAfterPasses,
                LayeredPicture* picture, Interruptions& interruptions) {
        Seen seen;
        seen.cancelAfterPasses = cancelAfterPasses;
        PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
        desc.user = &seen;
        desc.bucketFinished = onBucket;
        desc.message = onMessage;
        PmrRender render = nullptr;
        ASSERT_EQ(PMR_OK, api().createRender(m_scene, &desc, &render)) << lastError();
        settings["threads"] = fmt::format("{}", threads);
        settings["bucketSize"] = fmt::format("{}", bucketSize);
        for (const auto& [name, value] : settings)
            EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()))
                << lastError();
        EXPECT_EQ(PMR_OK, api().startRender(render)) << lastError();
        const PmrStatus status = api().waitRender(render, -1.0);
        // A cancelled one may have been through before its last events came.
        const bool isCancelled = cancelAfterPasses > 0 && status == PMR_ERROR_CANCELLED;
        EXPECT_TRUE(status == PMR_OK || isCancelled) << lastError();
        if (picture != nullptr) *picture = readPixels(render);
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        if (settings.contains("checkpoint")) note(seen.infos, settings, interruptions);
    }

    LayeredPicture readPixels(PmrRender render) const {
        return readLayers(
            m_way.window,
            [&](std::uint32_t* count) { return api().renderLayerCount(render, count); },
            [&](std::uint32_t i, PmrLayerInfo* info) {
                return api().renderLayerInfo(render, i, info);
            },
            [&](const PmrRectangle* window, const char* layer, float* pixels) {
                return api().readPixels(render, window, layer, pixels, 0, 0);
            });
    }

    static void note(const std::string& infos, const Settings& settings,
                     Interruptions& interruptions) {
        if (infos.find(settings.at("passes") + " passes and") != std::string::npos)
            ++interruptions.tooLate;
        else if (infos.find(" passes and 0 % of") != std::string::npos)
            ++interruptions.betweenPasses;
        else if (infos.find(" passes and ") != std::string::npos)
            ++interruptions.withinAPass;
    }

    const Way& m_way;
    Settings m_settings;
    std::string m_checkpoint, m_part;
    PmrContext m_context = nullptr;
    PmrScene m_scene = nullptr;
};

std::string channelName(const LayerPixels& layer, std::size_t channel) {
    std::size_t begin = 0;
    for (; channel > 0; --channel) begin = layer.channels.find(',', begin) + 1;
    return layer.channels.substr(begin, layer.channels.find(',', begin) - begin);
}

std::size_t indexOf(const PmrRectangle& window, int x, int y) {
    return static_cast<std::size_t>((y - window.y0) * (window.x1 - window.x0) + x - window.x0);
}

std::string layerDifference(const LayerPixels& a, const PmrRectangle& windowA, const LayerPixels& b,
                            const PmrRectangle& windowB) {
    if (a.name != b.name || a.channels != b.channels)
        return fmt::format("layer {} where {} is expected", a.name, b.name);
    std::string first;
    int different = 0, pixels = 0;
    for (int y = std::max(windowA.y0, windowB.y0); y < std::min(windowA.y1, windowB.y1); ++y) {
        for (int x = std::max(windowA.x0, windowB.x0); x < std::min(windowA.x1, windowB.x1); ++x) {
            const float* p = &a.values[indexOf(windowA, x, y) * a.channelCount];
            const float* q = &b.values[indexOf(windowB, x, y) * a.channelCount];
            std::size_t c = 0;
            while (c < a.channelCount &&
                   std::bit_cast<std::uint32_t>(p[c]) == std::bit_cast<std::uint32_t>(q[c]))
                ++c;
            ++pixels;
            if (c == a.channelCount) continue;
            if (different++ == 0)
                first = fmt::format("pixel {},{}, layer {}, channel {}: {:a} in place of {:a}", x,
                                    y, a.name, channelName(a, c), p[c], q[c]);
        }
    }
    if (pixels == 0) return "no pixel in common";
    return different == 0 ? ""
                          : fmt::format("{}; {} of {} pixels differ", first, different, pixels);
}

}  // namespace

std::string Way::text() const {
    std::string text =
        fmt::format("threads {}, buckets of {} in {} order, pixels {},{} to {},{}", threads,
                    bucketSize, order, window.x0, window.y0, window.x1, window.y1);
    if (resumeThreads > 0) {
        text += fmt::format(", resumed with threads {}", resumeThreads);
        if (!isInParts) text += fmt::format(" and buckets of {}", resumeBucketSize);
    }
    if (isInParts) text += ", in parts";
    if (flushesDenormals) text += ", flush-to-zero";
    if (!locale.empty()) text += ", locale " + locale;
    return text;
}

LayeredPicture makePicture(const Way& way, const Settings& settings, const SceneChoice& scene,
                           const std::string& folder, Interruptions& interruptions) {
    const HostState state(way);
    Studio studio(way, settings, scene, folder);
    return way.isInParts ? studio.makeOfParts(interruptions) : studio.makeAtOnce(interruptions);
}

std::string difference(const LayeredPicture& picture, const LayeredPicture& expected) {
    if (picture.layers.size() != expected.layers.size())
        return fmt::format("{} layers in place of {}", picture.layers.size(),
                           expected.layers.size());
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const std::string text =
            layerDifference(picture.layers[i], picture.window, expected.layers[i], expected.window);
        if (!text.empty()) return text;
    }
    return "";
}

}  // namespace pm::test
