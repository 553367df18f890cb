// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/farm_planning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <thread>

#include "host_shim/cli/frame_options.h"
#include "host_shim/cli/option_values.h"
#include "host_shim/farm/farm_words.h"
#include "host_shim/farm/instruction_set.h"
#include "host_shim/farm/job/run_cut.h"
#include "host_shim/farm/pilot_costs.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// Settings of the library by their defaults, which are not known to the command line.
constexpr std::int64_t kBucketSize = 32;
constexpr std::int64_t kPasses = 4;
// Costs are told by fewer photons.
constexpr std::int64_t kPilotPhotons = 100'000;

std::int64_t numberGiven(const FarmOptions& farm, const char* option, std::int64_t standard) {
    const std::string* text = givenValue(farm, option);
    return text == nullptr ? standard : integerValue(option, *text, 0, std::int64_t{1} << 62);
}

std::int32_t bucketSizeOf(const FarmOptions& farm) {
    const std::int64_t size = numberGiven(farm, "--bucket-size", kBucketSize);
    if (size < 8 || size > 1024 || size % 8 != 0)
        throw HostError(
            ExitCode::kUsage,
            fmt::format("--bucket-size {}: a multiple of 8 from 8 to 1024 is wanted", size));
    return static_cast<std::int32_t>(size);
}

PixelRect windowOf(const Options& options) {
    return options.crop.value_or(PixelRect{0, 0, options.width, options.height});
}

// The grid of buckets begins at the window's corner, moved out to a multiple of 8 pixels.
std::uint32_t bucketCountOf(const PixelRect& window, std::int32_t size) {
    const auto along = [size](std::int32_t begin, std::int32_t end) {
        const auto origin = static_cast<std::int64_t>(std::floor(begin / 8.0)) * 8;
        return static_cast<std::uint32_t>((end - origin + size - 1) / size);
    };
    return along(window.x0, window.x1) * along(window.y0, window.y1);
}

class Planning {
  public:
    Planning(const std::vector<Options>& frames, const JobFolder& folder, Log& log)
        : m_frames(frames),
          m_farm(*frames.front().farm),
          m_folder(folder),
          m_log(log),
          m_bucketSize(bucketSizeOf(m_farm)) {}

    FarmPlan make(const std::vector<FarmMachine>& machines) {
        m_log.info("a small picture is rendered, to see what costs how much");
        m_pilot = renderFarmPilot(m_frames.front(), pilotWords(), m_bucketSize);
        findErrorScale();
        FarmPlan plan;
        plan.program = fs::read_symlink("/proc/self/exe");
        plan.folder = fs::current_path();
        const std::string* isa = givenValue(m_farm, "--isa");
        plan.isa =
            isa != nullptr && *isa != "best" ? *isa : commonInstructionSet(m_pilot.isa, machines);
        plan.bucketCount = bucketCountOf(windowOf(m_frames.front()), m_bucketSize);
        for (const Options& options : m_frames)
            plan.frames.push_back({numberOf(options), mergeWords(options)});
        addPhotons(plan);
        addRuns(machines.size(), plan);
        checkWords(plan);
        return plan;
    }

  private:
    static std::optional<std::int64_t> numberOf(const Options& options) {
        const std::string* frame = givenValue(*options.farm, "--frame");
        std::int64_t number = 0;
        if (frame == nullptr || !parseInteger(*frame, number)) return std::nullopt;
        return number;
    }
    std::vector<std::string> pilotWords() const {
        std::vector<std::string> words = renderWords(m_frames.front(), numberOf(m_frames.front()));
        const std::string* photons = givenValue(m_farm, "--photons");
        std::int64_t count = 0;
        if (photons != nullptr && parseInteger(*photons, count) && count > kPilotPhotons)
            words.insert(words.end(), {"--photons", std::to_string(kPilotPhotons)});
        if (const std::string* isa = givenValue(m_farm, "--isa"))
            words.insert(words.end(), {"--isa", *isa});
        return words;
    }
    // A shot has its first frame's, as where one machine renders it; what a task finds alone is the
    // same for all of its picture.
    void findErrorScale() {
        if (m_frames.size() < 2 || tellsErrorScale(m_frames.front())) return;
        m_errorScale = findFarmErrorScale(m_frames.front(), pilotWords());
    }
    void addPhotons(FarmPlan& plan) const {
        if (!m_pilot.hasPhotons || m_farm.photonsEach || !m_frames.front().photonMap.empty())
            return;
        for (std::size_t i = 0; i < m_frames.size(); ++i) {
            FarmTask task;
            task.kind = FarmTask::Kind::kPhotons;
            task.frame = i;
            task.product = m_folder.photons(i);
            task.words = photonWords(m_frames[i], plan.frames[i].number);
            task.words.insert(task.words.end(),
                              {"--photons-only", "--photon-map", task.product.string()});
            finish(plan, task);
        }
    }
    void addRuns(std::size_t machines, FarmPlan& plan) const {
        double seconds = 0;
        for (const double bucket : m_pilot.bucketSeconds) seconds += bucket;
        const PixelRect window = windowOf(m_frames.front());
        const double pixels = static_cast<double>(window.width()) * window.height();
        const auto passes = static_cast<double>(numberGiven(m_farm, "--passes", kPasses));
        const double scale = pixels / std::max(m_pilot.pixels, 1.0) * passes;
        const auto count =
            m_farm.runs > 0
                ? static_cast<std::uint32_t>(m_farm.runs)
                : runCount({seconds * scale / threadCount(), eachRunSeconds(pixels, passes)},
                           m_frames.size(), machines);
        const std::vector<BucketRun> runs = cutRuns(m_pilot.bucketSeconds, plan.bucketCount, count);
        for (std::size_t i = 0; i < m_frames.size(); ++i)
            for (const BucketRun& run : runs) addRun(i, run, scale, plan);
    }
    static double threadCount() { return std::max(1u, std::thread::hardware_concurrency()); }
    // On a machine like this one. The pilot has fewer photons than a picture where their number is
    // given, else by its size.
    double eachRunSeconds(double pixels, double passes) const {
        const auto given = static_cast<double>(numberGiven(m_farm, "--photons", 0));
        const double more = given > 0 ? std::max(1.0, given / kPilotPhotons)
                                      : pixels / std::max(m_pilot.pixels, 1.0);
        const double ofAPass =
            m_pilot.mapSeconds + (m_farm.photonsEach ? m_pilot.photonSeconds : 0);
        return m_pilot.startSeconds + ofAPass * more * passes;
    }
    void addRun(std::size_t frame, const BucketRun& run, double scale, FarmPlan& plan) const {
        FarmTask task;
        task.frame = frame;
        task.first = run.first;
        task.last = run.last;
        task.predictedCost = run.cost * scale;
        task.product = m_folder.part(static_cast<int>(plan.tasks.size()) + 1);
        task.words = renderWords(m_frames[frame], plan.frames[frame].number);
        const fs::path photons =
            plan.photonsOf(frame) > 0 ? m_folder.photons(frame) : m_frames[frame].photonMap;
        if (!photons.empty())
            task.words.insert(task.words.end(), {"--photon-map", photons.string()});
        // Where a local render would measure it, all runs measure the same.
        const bool isDecided = m_frames[frame].exposure.kind != ExposureOption::Kind::kNotGiven ||
                               !m_frames[frame].reference.empty();
        if (m_pilot.measuresExposure && !isDecided)
            task.words.insert(task.words.end(), {"--exposure", "auto"});
        if (m_errorScale)
            task.words.insert(task.words.end(), {"--error-scale", std::to_string(*m_errorScale)});
        task.words.insert(task.words.end(),
                          {"--bucket-size", std::to_string(m_bucketSize), "--buckets",
                           fmt::format("{}:{}", run.first, run.last), "-o", task.product.string()});
        finish(plan, task);
    }
    // What all tasks have.
    void finish(FarmPlan& plan, FarmTask& task) const {
        const int number = static_cast<int>(plan.tasks.size()) + 1;
        task.words.insert(task.words.end(), {"--isa", plan.isa, "--progress", "json", "--stats",
                                             m_folder.statistics(number).string()});
        plan.tasks.push_back(task);
    }
    // A task is a line of a file.
    static void checkWords(const FarmPlan& plan) {
        for (const FarmTask& task : plan.tasks)
            for (const std::string& word : task.words)
                if (word.find('\n') != std::string::npos)
                    throw HostError(ExitCode::kUsage,
                                    "farm: names with a line break can't be handed on");
    }

    const std::vector<Options>& m_frames;
    const FarmOptions& m_farm;
    const JobFolder& m_folder;
    Log& m_log;
    std::int32_t m_bucketSize;
    PilotFindings m_pilot;
    std::optional<std::int32_t> m_errorScale;  // of a shot that tells none
};

using Values = std::map<std::string, std::vector<std::string>>;

Values valuesOf(const std::vector<GivenOption>& options) {
    Values values;
    for (const GivenOption& option : options) values[option.name] = option.values;
    return values;
}

std::string textOf(const Values& values, const std::string& name) {
    const auto found = values.find(name);
    if (found == values.end()) return "not given";
    return found->second.empty() ? "given" : fmt::format("{}", fmt::join(found->second, " "));
}

}  // namespace

FarmPlan planFarm(const std::vector<Options>& frames, const JobFolder& folder,
                  const std::vector<FarmMachine>& machines, Log& log) {
    return Planning(frames, folder, log).make(machines);
}

void checkPlanFits(const FarmPlan& plan, const FarmOptions& farm, const JobFolder& folder) {
    const Values theirs = valuesOf(plan.given), ours = valuesOf(planOptions(farm));
    Values all = theirs;
    all.insert(ours.begin(), ours.end());
    for (const auto& [name, value] : all) {
        const std::string there = textOf(theirs, name), here = textOf(ours, name);
        if (there != here)
            throw HostError(ExitCode::kUsage,
                            fmt::format("--job {}: holds another picture; {}: {} there, {} here. "
                                        "Another folder begins anew",
                                        folder.path().string(), name, there, here));
    }
    if (plan.folder != fs::current_path())
        throw HostError(ExitCode::kUsage,
                        fmt::format("--job {}: was begun in {}, where its names begin; go there, "
                                    "or take another folder",
                                    folder.path().string(), plan.folder.string()));
}

}  // namespace pm::host
