// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What adaptive samples gain: the time to the true error of a fixed level, beside that of an oracle
// that knows each pixel's variance.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include "integrator/values/error.h"
#include "scheduler/film/sample_allotment.h"
#include "tests/bench/adaptive/adaptive_run.h"
#include "tests/bench/adaptive/adaptive_scenes.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/pass_renderer.h"
#include "tests/bench/run/pictures.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {
namespace {

struct Options {
    std::filesystem::path peers = PM_SHARED_PEERS, keep;
    std::filesystem::path pictures;  // where to, in place of measuring
    std::string csvFile, docsFile, scenes;
    std::vector<std::string> levels = {"3:5"};
    std::vector<double> thresholds = {0.01}, oracles = {0.01, 0.005, 0.0025};
    std::int32_t size = 96;
    int seeds = 4, threads = 1;
    std::uint32_t passes = 16, pathPasses = 4, photonPasses = 64, knownPasses = 16;
    bool quick = false;
};

constexpr std::uint32_t kFixedLevel = 3;
constexpr int kResamples = 400;
// The share of a gain below that is nothing but noise.
constexpr double kLeastGain = 1.1;

// A way and its curves by seed.
struct Rival {
    std::string name;
    Way way;
    std::vector<TimedErrors> curves;
};

// Mean of the curves of these seeds, as far as all of them go.
TimedErrors meanCurve(const Rival& rival, const std::vector<std::size_t>& seeds) {
    TimedErrors mean;
    std::size_t passes = rival.curves[seeds[0]].errors.size();
    for (const std::size_t seed : seeds)
        passes = std::min(passes, rival.curves[seed].errors.size());
    mean.errors.resize(passes);
    mean.seconds.resize(passes);
    for (const std::size_t seed : seeds)
        for (std::size_t i = 0; i < passes; ++i) {
            mean.errors[i] += rival.curves[seed].errors[i] / static_cast<double>(seeds.size());
            mean.seconds[i] += rival.curves[seed].seconds[i] / static_cast<double>(seeds.size());
        }
    return mean;
}

// Times of the first rival over those of the others, to its error after so many passes.
std::vector<double> gainsOf(const std::vector<Rival>& rivals, std::uint32_t passes,
                            const std::vector<std::size_t>& seeds) {
    const TimedErrors fixed = meanCurve(rivals[0], seeds);
    const double error = fixed.errors[passes - 1], seconds = fixed.seconds[passes - 1];
    std::vector<double> gains;
    for (std::size_t i = 1; i < rivals.size(); ++i)
        gains.push_back(seconds / secondsTo(error, meanCurve(rivals[i], seeds)));
    return gains;
}

std::string interval(double value, std::vector<double> resampled) {
    std::ranges::sort(resampled);
    const auto at = [&](double share) {
        return resampled[static_cast<std::size_t>(share *
                                                  static_cast<double>(resampled.size() - 1))];
    };
    return fmt::format("{:.2f} ({:.2f} to {:.2f})", value, at(0.025), at(0.975));
}

class AdaptiveBench {
  public:
    explicit AdaptiveBench(const Options& options) : m_options(options) {}
    void run();

  private:
    RenderSettings settings(std::uint32_t least, std::uint32_t most, double threshold) const;
    RenderSettings settingsOf(const std::string& range, double threshold) const;  // LEAST:MOST
    Truth truthOf(const AdaptiveScene& adaptive, const std::shared_ptr<const Scene>& scene) const;
    std::vector<Rival> rivals(const Scene& scene, const Known& known) const;
    void measure(const AdaptiveScene& adaptive);
    void paint(const AdaptiveScene& adaptive) const;
    void tell(const AdaptiveScene& adaptive, const std::vector<Rival>& rivals);

    Options m_options;
    Report m_report{"pm_bench_adaptive"};
};

RenderSettings AdaptiveBench::settings(std::uint32_t least, std::uint32_t most,
                                       double threshold) const {
    RenderSettings s;
    s.width = s.height = m_options.size;
    s.window = {0, 0, m_options.size, m_options.size};
    s.passes = m_options.passes;
    s.aaLevel = least;
    s.aaLevelMost = most > least ? most : 0;
    s.aaThreshold = threshold;
    return s;
}

RenderSettings AdaptiveBench::settingsOf(const std::string& range, double threshold) const {
    return settings(static_cast<std::uint32_t>(range[0] - '0'),
                    static_cast<std::uint32_t>(range[2] - '0'), threshold);
}

Truth AdaptiveBench::truthOf(const AdaptiveScene& adaptive,
                             const std::shared_ptr<const Scene>& scene) const {
    const std::uint32_t passes = adaptive.byPaths ? m_options.pathPasses : m_options.photonPasses;
    const auto file =
        m_options.keep / fmt::format("{}_{}_{}.truth", adaptive.key, m_options.size, passes);
    Truth truth;
    const std::size_t count = 3u * static_cast<std::size_t>(m_options.size * m_options.size);
    truth.first.resize(count);
    truth.second.resize(count);
    const auto bytes = static_cast<std::streamsize>(count * sizeof(double));
    if (std::ifstream kept(file, std::ios::binary); !m_options.keep.empty() && kept) {
        kept.read(reinterpret_cast<char*>(truth.first.data()), bytes);
        kept.read(reinterpret_cast<char*>(truth.second.data()), bytes);
        if (kept) return truth;
    }
    truth = makeTruth(scene, m_options.size, adaptive.byPaths, passes, m_options.threads);
    if (m_options.keep.empty()) return truth;
    std::ofstream keep(file, std::ios::binary);
    keep.write(reinterpret_cast<const char*>(truth.first.data()), bytes);
    keep.write(reinterpret_cast<const char*>(truth.second.data()), bytes);
    return truth;
}

// The fixed level, the adaptive ways, the same with known spreads, and the oracle by each of its
// thresholds.
std::vector<Rival> AdaptiveBench::rivals(const Scene& scene, const Known& known) const {
    std::vector<Rival> result = {{"fixed", {settings(kFixedLevel, 0, 0.01), {}}, {}}};
    for (const std::string& range : m_options.levels)
        for (const double threshold : m_options.thresholds)
            result.push_back(
                {fmt::format("{}, {}", range, threshold), {settingsOf(range, threshold), {}}, {}});
    for (std::size_t i = 1, adaptives = result.size(); i < adaptives; ++i) {
        const RenderSettings& s = result[i].way.settings;
        const SampleRule rule =
            sampleRule(s.aaLevel, s.aaLevelMost, s.aaThreshold, makePlan(scene, s).tracePhotons);
        result.push_back(
            {result[i].name + ", known", {s, samplesBySpread(rule, known.spread)}, {}});
    }
    const RenderSettings first = result[1].way.settings;
    const SampleRule rule = sampleRule(first.aaLevel, first.aaLevelMost, 0.01);
    for (const double threshold : m_options.oracles)
        result.push_back({fmt::format("oracle, {}", threshold),
                          {settings(kFixedLevel, 0, 0.01),
                           alwaysSamples(oracleSamples(known, rule.least, rule.most, threshold))},
                          {}});
    return result;
}

void AdaptiveBench::tell(const AdaptiveScene& adaptive, const std::vector<Rival>& rivals) {
    const std::size_t adaptives = (rivals.size() - 1 - m_options.oracles.size()) / 2;
    std::vector<std::size_t> all(rivals[0].curves.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    for (std::uint32_t passes = 4; passes <= m_options.passes; passes *= 2) {
        const std::vector<double> gains = gainsOf(rivals, passes, all);
        std::vector<std::vector<double>> resampled;
        std::mt19937_64 random(1);
        for (int k = 0; k < kResamples; ++k) {
            std::vector<std::size_t> some;
            for (std::size_t i = 0; i < all.size(); ++i) some.push_back(random() % all.size());
            resampled.push_back(gainsOf(rivals, passes, some));
        }
        // Of all gains, and of those drawn anew.
        const auto cell = [&](const auto& value) {
            std::vector<double> values;
            for (const std::vector<double>& g : resampled) values.push_back(value(g));
            return interval(value(gains), values);
        };
        const auto best = [&](const std::vector<double>& g) {
            return *std::max_element(g.begin() + static_cast<std::ptrdiff_t>(2 * adaptives),
                                     g.end());
        };
        std::string what;
        for (std::size_t i = 2 * adaptives; i < gains.size(); ++i)
            what += fmt::format(" {}={:.2f}", rivals[i + 1].name, gains[i]);
        fmt::print(stderr, "  {} passes: {}\n", passes, what);
        for (std::size_t i = 0; i < adaptives; ++i) {
            const auto own = [i](const auto& g) { return g[i]; };
            const auto known = [i, adaptives](const auto& g) { return g[adaptives + i]; };
            const auto shareOf = [&](const auto& other) {
                if (other(gains) < kLeastGain) return std::string();
                return cell([&](const auto& g) { return (own(g) - 1) / (other(g) - 1); });
            };
            m_report.row({adaptive.key, rivals[i + 1].name, std::to_string(passes),
                          show(meanCurve(rivals[0], all).errors[passes - 1]), cell(own),
                          cell(known), shareOf(known), cell(best), shareOf(best)});
        }
    }
}

void AdaptiveBench::measure(const AdaptiveScene& adaptive) {
    const std::shared_ptr<const Scene> scene = adaptive.maker.build();
    const double start = processorSeconds();
    const Truth truth = truthOf(adaptive, scene);
    const double truthSeconds = processorSeconds() - start;
    const Known known = measureKnown(scene, settings(kFixedLevel, 0, 0.01), m_options.knownPasses,
                                     m_options.threads);
    const double knownSeconds = processorSeconds() - start - truthSeconds;
    double spread = 0, square = 0;
    for (const double s : known.spread) {
        spread += s / static_cast<double>(known.spread.size());
        square += s * s / static_cast<double>(known.spread.size());
    }
    fmt::print(stderr,
               "{}: truth {:.1f} s, noise {:.2e}; known {:.1f} s: shared {:.2e}, spread {:.3f}, "
               "its square {:.3e}; sample {:.4f} s, pass {:.4f} s\n",
               adaptive.key, truthSeconds, truth.ownNoise(), knownSeconds, known.shared, spread,
               square, known.sampleSeconds, known.passSeconds);
    std::vector<Rival> all = rivals(*scene, known);
    std::vector<Way> ways;
    for (const Rival& rival : all) ways.push_back(rival.way);
    for (int seed = 1; seed <= m_options.seeds; ++seed) {
        const std::vector<TimedErrors> curves =
            takeTurns(scene, truth, ways, static_cast<std::uint64_t>(seed), m_options.threads);
        for (std::size_t i = 0; i < all.size(); ++i) all[i].curves.push_back(curves[i]);
    }
    tell(adaptive, all);
    fmt::print(stderr, "  {:.1f} s in all\n", processorSeconds() - start);
}

// The pictures of the fixed level and of the first range, and white for the most samples of any
// pixel.
void AdaptiveBench::paint(const AdaptiveScene& adaptive) const {
    const std::shared_ptr<const Scene> scene = adaptive.maker.build();
    const auto write = [&](const char* what, std::vector<double> rgb, double exposure) {
        writePng(m_options.pictures / fmt::format("{}_{}.png", adaptive.key, what),
                 {m_options.size, m_options.size, std::move(rgb)}, exposure);
    };
    const auto render = [&](const RenderSettings& s) {
        auto renderer =
            std::make_unique<PassRenderer>(scene, s, makePlan(*scene, s), m_options.threads);
        for (std::uint32_t pass = 0; pass < s.passes; ++pass) renderer->next();
        return renderer;
    };
    write("fixed", render(settings(kFixedLevel, 0, 0.01))->beauty(), 1);
    const auto adapted = render(settingsOf(m_options.levels[0], m_options.thresholds[0]));
    write("adaptive", adapted->beauty(), 1);
    std::vector<double> samples;
    for (std::int32_t y = 0; y < m_options.size; ++y)
        for (std::int32_t x = 0; x < m_options.size; ++x)
            samples.insert(samples.end(), 3, adapted->frame().sampleCount(x, y));
    const double most = *std::ranges::max_element(samples);
    write("samples", std::move(samples), 1 / most);
}

void AdaptiveBench::run() {
    const bool paints = !m_options.pictures.empty();
    if (!paints)
        m_report.table(
            fmt::format(
                "Processor time of fixed level 3 over that of adaptive samples and of the "
                "oracles, to the same true relMSE: {0} x {0} pixels, {1} seeds, 95 % intervals",
                m_options.size, m_options.seeds),
            {"scene", "levels, threshold", "passes of level 3", "relMSE", "fixed / adaptive",
             "fixed / the same, variance known", "share of that gain",
             "fixed / oracle by hindsight", "share of that gain"});
    if (!std::filesystem::exists(m_options.peers / "scenes.json"))
        fmt::print(stderr, "neutral scenes: skipped, no scenes.json in the folder of peers\n");
    for (const AdaptiveScene& scene : adaptiveScenes(m_options.peers)) {
        if (!m_options.scenes.empty() &&
            ("," + m_options.scenes + ",").find("," + scene.key + ",") == std::string::npos)
            continue;
        paints ? paint(scene) : measure(scene);
    }
    if (!paints) m_report.publish(m_options.csvFile, m_options.docsFile);
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Time of adaptive samples to the error of a fixed level");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the tables into this Markdown file");
    app.add_option("--peers", options.peers, "folder of scenes.json");
    app.add_option("--keep", options.keep, "keep the truths in this folder and read those there");
    app.add_option("--pictures", options.pictures,
                   "don't measure: write the pictures of the fixed and the adaptive level, and how "
                   "many samples pixels had, to this folder");
    app.add_option("--scenes", options.scenes, "only these, with commas");
    app.add_option("--levels", options.levels, "ranges of adaptive renders (3:5)");
    app.add_option("--thresholds", options.thresholds, "of adaptive renders (0.01)");
    app.add_option("--oracles", options.oracles,
                   "thresholds of the oracle, whose best counts (0.01 0.005 0.0025)");
    app.add_option("--size", options.size, "pixels, both ways, a multiple of 8 (96)");
    app.add_option("--seeds", options.seeds, "renders of each kind (4)")->check(CLI::Range(1, 999));
    app.add_option("--passes", options.passes, "of the fixed level (16)")
        ->check(CLI::Range(4, 999));
    app.add_option("--path-passes", options.pathPasses, "of 256 samples, of each half of a truth");
    app.add_option("--photon-passes", options.photonPasses, "the same where paths miss light");
    app.add_option("--known-passes", options.knownPasses, "of 16 samples, for the oracle");
    app.add_option("--threads", options.threads, "threads (1)")->check(CLI::Range(1, 256));
    app.add_flag("--quick", options.quick, "64 x 64 pixels, 2 seeds, 8 passes, one oracle");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        options.size = 64;
        options.seeds = 2;
        options.passes = 8;
        options.oracles = {0.005};
        options.pathPasses = 2;
        options.photonPasses = options.knownPasses = 8;
    }
    try {
        AdaptiveBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_adaptive: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
