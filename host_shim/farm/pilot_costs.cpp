// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/pilot_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "host_shim/farm/job/task_events.h"
#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/process/child_process.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/temporary_folder.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kPilotBucket = 8;  // pixels, the least
// So large a pilot has a fine enough grid of costs, and takes little of a large picture's time.
constexpr double kLongestSide = 512;
constexpr const char* kPasses = "2";  // the first one alone also fills caches

struct Scaled {
    std::int32_t width, height;
    std::string crop;
};

// Buckets of the pilot are those of the picture where they can be: as small as buckets get.
Scaled scaledFrame(const Options& options, std::int32_t bucketSize) {
    const double longer = std::max(options.width, options.height);
    const double scale =
        std::min(static_cast<double>(kPilotBucket) / bucketSize, kLongestSide / longer);
    const auto up = [scale](std::int32_t pixels) {
        return static_cast<std::int32_t>(std::ceil(pixels * scale));
    };
    Scaled scaled{std::max(1, up(options.width)), std::max(1, up(options.height)), {}};
    if (options.crop) {
        const auto down = [scale](std::int32_t pixels) {
            return static_cast<std::int32_t>(std::floor(pixels * scale));
        };
        const PixelRect& c = *options.crop;
        scaled.crop = fmt::format("{},{},{},{}", down(c.x0), down(c.y0), up(c.x1), up(c.y1));
    }
    return scaled;
}

// bucket,x0,y0,x1,y1,seconds,passes
void readBucketTimes(const fs::path& file, PilotFindings& findings) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
        std::array<double, 7> numbers{};
        std::size_t begin = 0;
        for (double& number : numbers) {
            const std::size_t end = std::min(line.find(',', begin), line.size());
            if (!parseNumber(std::string_view(line).substr(begin, end - begin), number))
                throw HostError(ExitCode::kInternal, "the pilot's times can't be read: " + line);
            begin = std::min(end + 1, line.size());
        }
        const auto [bucket, x0, y0, x1, y1, seconds, passes] = numbers;
        findings.bucketSeconds.push_back(seconds / std::max(passes, 1.0));
        findings.pixels += (x1 - x0) * (y1 - y0);
    }
}

auto statisticsOf(const fs::path& file) {
    auto json = parseJsonFile(file, throwIfInterrupted);
    if (!json.is_object() || !json.contains("isa"))
        throw HostError(ExitCode::kInternal, "the pilot's statistics can't be read");
    return json;
}

void readStatistics(const fs::path& file, PilotFindings& findings) {
    const auto json = statisticsOf(file);
    findings.isa = json.at("isa").get<std::string>();
    findings.hasPhotons = json.at("plan").value("tracePhotons", false);
    const auto& phases = json.at("phases");
    const auto seconds = [&](const char* name) { return phases.value(name, 0.0); };
    const double passes = std::max(json.value("passesDone", 1.0), 1.0);
    findings.mapSeconds = seconds("mapSeconds") / passes;
    findings.photonSeconds = seconds("photonSeconds") / passes;
    findings.startSeconds =
        std::max(0.0, seconds("elapsedSeconds") - seconds("writePicturesSeconds") -
                          seconds("renderSeconds") - seconds("beginPassSeconds"));
    // Exposure that nobody gave is 0, and one that was measured is a fraction.
    const auto colour = json.find("colour");
    findings.measuresExposure = colour != json.end() && colour->value("exposureStops", 0.0) != 0;
}

void runPilot(std::vector<std::string> words, const fs::path& folder) {
    const ChildTask task{std::move(words), fs::current_path(), folder / "log"};
    const auto forEver = std::chrono::duration<double>(std::numeric_limits<double>::infinity());
    const ChildResult end = runChildren({task}, 1, forEver, [](auto, const auto&) {}).front();
    if (end.end == ChildResult::End::kExited && end.code == 0) return;
    const std::string said = lastMessage(task.log);
    const bool isExit = end.end == ChildResult::End::kExited;
    throw HostError(
        isExit ? static_cast<ExitCode>(end.code) : ExitCode::kInternal,
        said.starts_with("pm_host: ")
            ? said.substr(std::string_view("pm_host: ").size())
            : fmt::format("the small render for costs ended with {}: {}", end.code, said));
}

bool hasDisplayOutput(const Options& options) {
    return std::ranges::any_of(options.outputs, [](const fs::path& file) {
        return isDisplayReferred(pictureFormat(file));
    });
}

}  // namespace

PilotFindings renderFarmPilot(const Options& options, std::vector<std::string> words,
                              std::int32_t bucketSize) {
    TemporaryFolder folder;
    const auto file = [&](const char* name) { return (folder.path() / name).string(); };
    const Scaled scaled = scaledFrame(options, bucketSize);
    words.insert(words.end(), {"--size", fmt::format("{}x{}", scaled.width, scaled.height),
                               "--bucket-size", std::to_string(kPilotBucket), "--passes", kPasses,
                               "--bucket-times", file("times"), "--stats", file("stats"), "-o",
                               file("pilot.exr"), "--progress", "none", "-q"});
    if (!scaled.crop.empty()) words.insert(words.end(), {"--crop", scaled.crop});
    if (hasDisplayOutput(options)) words.insert(words.end(), {"-o", file("pilot.png")});
    runPilot(std::move(words), folder.path());
    PilotFindings findings;
    readBucketTimes(file("times"), findings);
    readStatistics(file("stats"), findings);
    return findings;
}

std::int32_t findFarmErrorScale(const Options& options, std::vector<std::string> words) {
    TemporaryFolder folder;
    const auto file = [&](const char* name) { return (folder.path() / name).string(); };
    words.insert(words.end(), {"--size", fmt::format("{}x{}", options.width, options.height),
                               "--crop", "0,0,8,8", "--passes", "1", "--photons", "1000", "--stats",
                               file("stats"), "-o", file("pilot.exr"), "--progress", "none", "-q"});
    runPilot(std::move(words), folder.path());
    return statisticsOf(file("stats")).value("errorScaleStops", 0);
}

}  // namespace pm::host
