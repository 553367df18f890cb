// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Whether the plan's numbers are right: the time to an error by the plan as it is, and with each of
// its numbers halved and doubled.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <string_view>

#include "integrator/values/error.h"
#include "tests/bench/plan/plan_scenes.h"
#include "tests/bench/plot/error_curve.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/pass_renderer.h"
#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {
namespace {

struct Options {
    std::string csvFile, docsFile, scenes, number;
    std::int32_t size = 128;
    int seeds = 2, threads = 1;
    std::uint32_t referencePasses = 0, mostPasses = 64;
    double error = 0;
    bool quick = false;
};

constexpr std::uint32_t kLevel = 3, kLevelMost = 6;
constexpr double kThreshold = 0.01;
// The reference: photons to an estimate, least level, and the plan's numbers times these.
constexpr std::uint32_t kReferenceEstimate = 25, kReferenceLevel = 4;
constexpr double kReferencePhotons = 3, kReferenceRays = 2;
constexpr float kReferenceSpacing = 0.5f;
constexpr std::uint64_t kReferenceSeed = 9001;
constexpr double kQuickError = 3;  // times a scene's

// All that a number of the plan may be in.
struct Numbers {
    RenderSettings settings;
    Plan plan;
};

template <typename Integer>
Integer times(Integer value, double factor) {
    return static_cast<Integer>(std::lround(static_cast<double>(value) * factor));
}

struct Number {
    const char* name;
    // Halves or doubles it; false where there is nothing to scale.
    bool (*scale)(Numbers& numbers, double factor);
};

// Gather points: on a plane, so their number goes with the square of the spacing. Levels: the next,
// since the settings have none between.
constexpr Number kNumbers[] = {
    {"global photons",
     [](Numbers& n, double factor) {
         n.plan.globalPhotons = times(n.plan.globalPhotons, factor);
         return n.plan.globalMap;
     }},
    {"caustic photons",
     [](Numbers& n, double factor) {
         n.plan.causticPhotons = times(n.plan.causticPhotons, factor);
         return n.plan.causticMap;
     }},
    {"share of caustic photons followed on",
     [](Numbers& n, double factor) {
         n.plan.descent *= static_cast<float>(factor);
         return n.plan.descent > 0.0f && n.plan.descent <= 1.0f;
     }},
    {"gather points",
     [](Numbers& n, double factor) {
         n.plan.gatherSpacing /= static_cast<float>(std::sqrt(factor));
         return n.plan.globalMap;
     }},
    {"gather rays of a point",
     [](Numbers& n, double factor) {
         n.plan.gatherRays = times(n.plan.gatherRays, factor);
         return n.plan.globalMap;
     }},
    {"lamp samples of a camera sample",
     [](Numbers& n, double factor) {
         n.plan.lampSamples = times(n.plan.lampSamples, factor);
         return n.plan.lampSamples > 0;
     }},
    {"photons to an estimate",
     [](Numbers& n, double factor) {
         n.settings.estimatePhotons = times(n.settings.estimatePhotons, factor);
         return n.plan.tracePhotons;
     }},
    {"least samples, x 1/4 and x 4",
     [](Numbers& n, double factor) {
         n.settings.aaLevel = factor < 1 ? n.settings.aaLevel - 1 : n.settings.aaLevel + 1;
         return true;
     }},
    {"threshold of adaptive samples",
     [](Numbers& n, double factor) {
         n.settings.aaThreshold *= factor;
         return true;
     }},
};

// A render on its way to the error.
struct Run {
    std::unique_ptr<PassRenderer> renderer;
    double spent = 0;  // seconds of processor time
    ErrorCurve curve;
    std::optional<Reached> reached;

    // To the error, or as far as it came.
    double seconds() const { return reached ? reached->processorSeconds : spent; }
};

// The plan as it is, or one of its numbers changed, and the times it took, by seed.
struct Variant {
    std::size_t number = 0;
    double factor = 1;  // 1: as it is
    Numbers numbers;
    std::vector<double> seconds;  // of processor time to the error
    int byFirst = 0;              // renders that were there after the first pass
    int never = 0;                // renders that didn't come there

    const char* bound() const { return never > 0 ? "more than " : byFirst > 0 ? "at most " : ""; }
};

struct Ratio {
    double mean = 0, least = 0, most = 0;  // of the seeds', the mean of their logarithms
    double variance = 0;                   // of the logarithms
};

Ratio ratioOf(const Variant& variant, const Variant& plan) {
    std::vector<double> logarithms;
    for (std::size_t i = 0; i < plan.seconds.size(); ++i)
        logarithms.push_back(std::log(variant.seconds[i] / plan.seconds[i]));
    const auto count = static_cast<double>(logarithms.size());
    const double mean = std::reduce(logarithms.begin(), logarithms.end()) / count;
    double squares = 0;
    for (const double l : logarithms) squares += (l - mean) * (l - mean);
    const auto [least, most] = std::ranges::minmax(logarithms);
    return {std::exp(mean), std::exp(least), std::exp(most), count > 1 ? squares / (count - 1) : 0};
}

class PlanBench {
  public:
    explicit PlanBench(const Options& options) : m_options(options) {}
    void run();

  private:
    void measure(const PlanScene& planScene);
    Numbers asPlanned(const std::shared_ptr<const Scene>& scene) const;
    std::vector<Variant> variants(const std::shared_ptr<const Scene>& scene) const;
    Yardstick reference(const std::shared_ptr<const Scene>& scene, std::uint32_t passes) const;
    std::unique_ptr<PassRenderer> begin(const std::shared_ptr<const Scene>& scene,
                                        const Numbers& numbers, std::uint64_t seed) const;
    void time(const PlanScene& planScene, const std::shared_ptr<const Scene>& scene,
              const Yardstick& yardstick, std::uint64_t seed, std::vector<Variant>& variants) const;
    double errorOf(const PlanScene& planScene) const {
        if (m_options.error > 0) return m_options.error;
        return m_options.quick ? kQuickError * planScene.error : planScene.error;
    }
    void tell(const PlanScene& planScene, const Yardstick& yardstick,
              const std::vector<Variant>& variants, double referenceSeconds);

    Options m_options;
    Report m_report{"pm_bench_plan"};
    std::vector<std::vector<std::string>> m_sceneRows;
};

Numbers PlanBench::asPlanned(const std::shared_ptr<const Scene>& scene) const {
    RenderSettings settings;
    settings.width = settings.height = m_options.size;
    settings.window = {0, 0, m_options.size, m_options.size};
    settings.aaLevel = kLevel;
    settings.aaLevelMost = kLevelMost;
    settings.aaThreshold = kThreshold;
    settings.passes = m_options.mostPasses;
    // With what the pilot of seed 1 finds.
    FrameRenderer renderer(scene, settings);
    renderer.prepare(std::atomic<bool>(false));
    return {settings, renderer.plan()};
}

std::vector<Variant> PlanBench::variants(const std::shared_ptr<const Scene>& scene) const {
    const Numbers planned = asPlanned(scene);
    std::vector<Variant> result = {{0, 1, planned, {}, 0, 0}};
    for (std::size_t i = 0; i < std::size(kNumbers); ++i) {
        if (std::string_view(kNumbers[i].name).find(m_options.number) == std::string_view::npos)
            continue;
        for (const double factor : {0.5, 2.0}) {
            Numbers changed = planned;
            if (kNumbers[i].scale(changed, factor))
                result.push_back({i, factor, changed, {}, 0, 0});
        }
    }
    return result;
}

std::unique_ptr<PassRenderer> PlanBench::begin(const std::shared_ptr<const Scene>& scene,
                                               const Numbers& numbers, std::uint64_t seed) const {
    RenderSettings settings = numbers.settings;
    settings.seed = seed;
    return std::make_unique<PassRenderer>(scene, settings, numbers.plan, m_options.threads);
}

Yardstick PlanBench::reference(const std::shared_ptr<const Scene>& scene,
                               std::uint32_t passes) const {
    Numbers numbers = asPlanned(scene);
    numbers.settings.estimatePhotons = kReferenceEstimate;
    numbers.settings.aaLevel = kReferenceLevel;
    numbers.plan.globalPhotons = times(numbers.plan.globalPhotons, kReferencePhotons);
    numbers.plan.causticPhotons = times(numbers.plan.causticPhotons, kReferencePhotons);
    numbers.plan.gatherRays = times(numbers.plan.gatherRays, kReferenceRays);
    numbers.plan.gatherSpacing *= kReferenceSpacing;
    std::vector<std::vector<double>> halves;
    for (const std::uint64_t seed : {kReferenceSeed, kReferenceSeed + 1}) {
        const std::unique_ptr<PassRenderer> renderer = begin(scene, numbers, seed);
        for (std::uint32_t i = 0; i < passes; ++i) renderer->next();
        halves.push_back(renderer->beauty());
    }
    Yardstick yardstick{halves[0], 0, 0, 0};
    for (std::size_t i = 0; i < halves[0].size(); ++i)
        yardstick.reference[i] = (halves[0][i] + halves[1][i]) / 2;
    // Each half is as far from the mean as the mean is, on average, from the truth.
    yardstick.ownNoise = yardstick.relMse(halves[0]);
    return yardstick;
}

// One seed of all variants, pass by pass in turns, so that a slow moment of the machine meets all.
void PlanBench::time(const PlanScene& planScene, const std::shared_ptr<const Scene>& scene,
                     const Yardstick& yardstick, std::uint64_t seed,
                     std::vector<Variant>& variants) const {
    std::vector<Run> runs(variants.size());
    for (std::uint32_t pass = 1; pass <= m_options.mostPasses; ++pass)
        for (std::size_t i = 0; i < runs.size(); ++i) {
            Run& run = runs[i];
            if (run.reached) continue;
            const double start = processorSeconds();
            if (!run.renderer) run.renderer = begin(scene, variants[i].numbers, seed);
            run.renderer->next();
            run.spent += processorSeconds() - start;
            if (pass > 1 && pass % 2 == 1) continue;  // the halves are uneven
            run.curve.points.push_back(
                {"", run.spent, run.spent, yardstick.relMse(run.renderer->beauty())});
            run.reached = reach(errorOf(planScene), run.curve);
            if (run.reached) run.renderer.reset();
        }
    for (std::size_t i = 0; i < runs.size(); ++i) {
        fmt::print(stderr, "  {} x {}, seed {}:", kNumbers[variants[i].number].name,
                   variants[i].factor, seed);
        for (const ErrorPoint& p : runs[i].curve.points)
            fmt::print(stderr, " {:.2f} s {:.1e},", p.processorSeconds, p.error);
        fmt::print(stderr, "\n");
        if (!runs[i].reached && i == 0)
            throw Error(Status::kInvalidArgument,
                        fmt::format("{}: relMSE {} is not reached in {} passes (--most-passes)",
                                    planScene.key, errorOf(planScene), m_options.mostPasses));
        variants[i].seconds.push_back(runs[i].seconds());
        variants[i].byFirst += runs[i].reached && runs[i].reached->byFirst ? 1 : 0;
        variants[i].never += runs[i].reached ? 0 : 1;
    }
}

void PlanBench::tell(const PlanScene& planScene, const Yardstick& yardstick,
                     const std::vector<Variant>& variants, double referenceSeconds) {
    double variance = 0;
    for (std::size_t i = 0; i < std::size(kNumbers); ++i) {
        std::vector<std::string> row = {planScene.key, kNumbers[i].name};
        for (const double factor : {0.5, 2.0}) {
            const auto variant = std::ranges::find_if(
                variants, [&](const Variant& v) { return v.factor == factor && v.number == i; });
            if (variant == variants.end()) {
                row.emplace_back();
                continue;
            }
            const Ratio ratio = ratioOf(*variant, variants.front());
            variance += ratio.variance / static_cast<double>(variants.size() - 1);
            row.push_back(fmt::format("{}{:.2f} ({:.2f} to {:.2f})", variant->bound(), ratio.mean,
                                      ratio.least, ratio.most));
        }
        if (!row[2].empty() || !row[3].empty()) m_report.row(std::move(row));
    }
    const Spread seconds = spreadOf(variants.front().seconds);
    const double error = std::sqrt(variance / static_cast<double>(m_options.seeds));
    m_sceneRows.push_back({planScene.key, planScene.what, show(errorOf(planScene)),
                           show(yardstick.ownNoise), show(referenceSeconds), show(seconds),
                           m_options.seeds > 1 ? fmt::format("{:.1f} %", 100 * error) : ""});
}

void PlanBench::measure(const PlanScene& planScene) {
    const std::shared_ptr<const Scene> scene = planScene.maker.build();
    fmt::print(stderr, "{}\n", planScene.key);
    const double start = processorSeconds();
    const std::uint32_t passes =
        m_options.referencePasses > 0 ? m_options.referencePasses : planScene.referencePasses;
    const Yardstick yardstick = reference(scene, passes);
    const double referenceSeconds = processorSeconds() - start;
    fmt::print(stderr, "  reference: own noise {:.2e}, {:.1f} s\n", yardstick.ownNoise,
               referenceSeconds);
    std::vector<Variant> all = variants(scene);
    for (int seed = 1; seed <= m_options.seeds; ++seed)
        time(planScene, scene, yardstick, static_cast<std::uint64_t>(seed), all);
    tell(planScene, yardstick, all, referenceSeconds);
}

void PlanBench::run() {
    m_report.table(
        fmt::format("Processor time to an error over that of the plan as it is, {0} x {0} pixels: "
                    "mean of {1} seeds (least to most)",
                    m_options.size, m_options.seeds),
        {"scene", "number", "halved / plan", "doubled / plan"});
    for (const PlanScene& scene : planScenes())
        if (m_options.scenes.empty() || m_options.scenes.find(scene.key) != std::string::npos)
            measure(scene);
    m_report.table("The scenes", {"scene", "what", "relMSE to reach", "the reference's own noise",
                                  "processor seconds of the reference",
                                  "of the plan as it is, to the error: median (quartiles)",
                                  "standard error of a ratio above"});
    for (const std::vector<std::string>& row : m_sceneRows) m_report.row(row);
    m_report.publish(m_options.csvFile, m_options.docsFile);
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Time to an error with each number of the plan halved and doubled");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the tables into this Markdown file");
    app.add_option("--scenes", options.scenes,
                   "of hall, mirror, window, glass, lantern, gallery; with commas (all)");
    app.add_option("--number", options.number, "only those with this in their name (all)");
    app.add_option("--size", options.size, "pixels, both ways, a multiple of 8 (128)")
        ->check(CLI::Validator(
            [](const std::string& text) {
                const int size = std::atoi(text.c_str());
                return size > 0 && size % 8 == 0 ? "" : "a multiple of 8, at least 8";
            },
            "PIXELS"));
    app.add_option("--seeds", options.seeds, "renders of each plan (2)")->check(CLI::Range(1, 999));
    app.add_option("--error", options.error, "relMSE to reach (0: the scene's own)")
        ->check(CLI::Range(0.0, 1.0));
    app.add_option("--most-passes", options.mostPasses, "then a render gives up (64)")
        ->check(CLI::Range(1, 9999));
    app.add_option("--reference-passes", options.referencePasses,
                   "of either half of the reference (0: the scene's own)")
        ->check(CLI::Range(0, 9999));
    app.add_option("--threads", options.threads, "threads (1)")->check(CLI::Range(1, 256));
    app.add_flag("--quick", options.quick, "64 x 64 pixels, 1 seed, larger errors");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        options.size = 64;
        options.seeds = 1;
        options.referencePasses = 4;
    }
    try {
        PlanBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_plan: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
