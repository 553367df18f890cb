// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What renders of twelve unlike scenes say of their own error, beside the truth, and what they
// cost.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "integrator/values/error.h"
#include "tests/bench/error/estimate_run.h"
#include "tests/bench/error/unlike_scenes.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/bench_lists.h"
#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/pictures.h"

namespace pm::bench {
namespace {

struct Options {
    std::filesystem::path references, keep, pictures;
    std::string csvFile, docsFile, scenes;
    std::int32_t size = 48;
    int seeds = 20, firstSeed = 1, threads = 1;
    std::uint32_t passes = 16, pathPasses = 12, photonPasses = 24;
    bool quick = false;
};

constexpr std::uint64_t kReferenceSeed = 1001;
constexpr std::uint32_t kPathLevel = 6;  // 256 samples a pass
// Narrow estimates have little bias; many photons make them narrow.
constexpr std::uint32_t kNarrow = 12;
constexpr std::uint64_t kReferencePhotons = 1'000'000;
constexpr double kWithin = 2;
constexpr std::uint32_t kFewest = 4;  // passes that a row of the table is for

using Renders = std::vector<std::vector<Judged>>;  // by seed, by step of passes

// Mean over pixels and channels of (a - r)(b - s) / (r^2 + 0.01).
double commonError(std::span<const double> a, std::span<const double> b, const Halves& r) {
    std::vector<double> moved(b.begin(), b.end());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += r.even[i] - r.odd[i];
    return relativeError(a, moved, r.even, 0);
}

// The mean picture of every second render.
std::vector<double> meanPicture(const Renders& renders, std::size_t first, std::size_t step) {
    std::vector<double> mean(renders.front()[step].rgb.size());
    double count = 0;
    for (std::size_t i = first; i < renders.size(); i += 2, ++count)
        for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += renders[i][step].rgb[k];
    for (double& value : mean) value /= count;
    return mean;
}

// What the seeds of one scene come to after some passes.
struct Verdict {
    std::vector<double> truths, told, noise, bias, unresolved, seconds;

    double ratio() const { return meanOf(told) / meanOf(truths); }
    // Of the ratio of two means, to first order.
    double standardError() const {
        double squares = 0;
        for (std::size_t i = 0; i < told.size(); ++i)
            squares += std::pow(told[i] - ratio() * truths[i], 2);
        const auto n = static_cast<double>(told.size());
        return n < 2 ? 0.0 : std::sqrt(squares / (n * (n - 1))) / meanOf(truths);
    }
    double shareWithin() const {
        double within = 0;
        for (std::size_t i = 0; i < told.size(); ++i)
            within += told[i] < kWithin * truths[i] && told[i] > truths[i] / kWithin;
        return within / static_cast<double>(told.size());
    }
};

class UnlikeBench {
  public:
    explicit UnlikeBench(const Options& options) : m_options(options) {}
    void run();

  private:
    RenderSettings settingsFor(std::uint32_t passes, std::uint64_t seed) const;
    Halves reference(const UnlikeScene& scene, const std::shared_ptr<const Scene>& built) const;
    void judge(const UnlikeScene& scene);
    void tell(const UnlikeScene& scene, const Renders& renders, const Halves& reference);

    Options m_options;
    Report m_report{"pm_bench_unlike"};
};

RenderSettings UnlikeBench::settingsFor(std::uint32_t passes, std::uint64_t seed) const {
    return judgedSettings(m_options.size, m_options.size, passes, seed);
}

Halves UnlikeBench::reference(const UnlikeScene& scene,
                              const std::shared_ptr<const Scene>& built) const {
    const PassSource source(built, scene.key, m_options.references, m_options.threads);
    RenderSettings settings = settingsFor(m_options.photonPasses, kReferenceSeed);
    settings.estimatePhotons = kNarrow;
    settings.photons = kReferencePhotons;
    if (!scene.byPaths) return source.halves(settings);
    settings = settingsFor(m_options.pathPasses, kReferenceSeed);
    settings.integrator = IntegratorKind::kPath;
    settings.aaLevel = kPathLevel;
    settings.aaLevelMost = 0;
    return source.halves(settings);
}

void UnlikeBench::tell(const UnlikeScene& scene, const Renders& renders, const Halves& reference) {
    for (std::size_t step = 0; step < renders.front().size(); ++step) {
        Verdict verdict;
        for (const std::vector<Judged>& render : renders) {
            const Judged& now = render[step];
            verdict.truths.push_back(commonError(now.rgb, now.rgb, reference));
            verdict.told.push_back(now.estimate.total());
            verdict.noise.push_back(now.estimate.noise);
            verdict.bias.push_back(now.estimate.bias);
            verdict.unresolved.push_back(now.estimate.unresolvedShare);
            verdict.seconds.push_back(now.processorSeconds);
        }
        const std::uint32_t passes = renders.front()[step].passes;
        if (passes != kFewest && passes != m_options.passes) continue;
        const std::vector<double> a = meanPicture(renders, 0, step);
        const std::vector<double> b = meanPicture(renders, renders.size() > 1 ? 1 : 0, step);
        m_report.row({scene.key, std::to_string(passes), show(meanOf(verdict.truths)),
                      show(meanOf(verdict.told)),
                      fmt::format("{:.2f} +- {:.2f}", verdict.ratio(), verdict.standardError()),
                      fmt::format("{:.0f} %", 100 * verdict.shareWithin()),
                      show(meanOf(verdict.noise)), show(commonError(a, b, reference)),
                      show(meanOf(verdict.bias)),
                      fmt::format("{:.2f} %", 100 * meanOf(verdict.unresolved)),
                      show(meanOf(verdict.seconds)),
                      show(meanOf(verdict.truths) * meanOf(verdict.seconds))});
    }
}

void UnlikeBench::judge(const UnlikeScene& scene) {
    const std::shared_ptr<const Scene> built = scene.maker.build();
    const Halves truth = reference(scene, built);
    const PassSource source(built, scene.key, m_options.keep, m_options.threads);
    Renders renders;
    for (int i = 0; i < m_options.seeds; ++i) {
        const auto seed = static_cast<std::uint64_t>(m_options.firstSeed + i);
        renders.push_back(source.judged(settingsFor(m_options.passes, seed)));
    }
    tell(scene, renders, truth);
    if (m_options.pictures.empty()) return;
    Picture all{m_options.size, m_options.size, truth.even};
    for (std::size_t i = 0; i < all.rgb.size(); ++i) all.rgb[i] = 0.5 * (all.rgb[i] + truth.odd[i]);
    const Picture one{m_options.size, m_options.size, renders.front().back().rgb};
    const std::filesystem::path& folder = m_options.pictures;
    writePng(folder / (scene.key + "_render.png"), one, 1);
    writePng(folder / (scene.key + "_reference.png"), all, 1);
    writePng(folder / (scene.key + "_difference.png"), differencePicture(one, all, 1, 2), 1);
}

void UnlikeBench::run() {
    std::string what;
    const std::vector<UnlikeScene> scenes = unlikeScenes();
    for (const UnlikeScene& scene : scenes)
        what += fmt::format("{}{}: {}", what.empty() ? "" : "; ", scene.key, scene.what);
    m_report.paragraph(what + ".");
    m_report.table(
        fmt::format("Told and true relMSE, {0} x {0} pixels, {1} seeds; processor "
                    "seconds of a render to there, kept ones not timed",
                    m_options.size, m_options.seeds),
        {"scene", "passes", "true", "told", "told / true", "seeds within 2", "told noise",
         "true bias", "told bias", "pixels unresolved", "seconds", "true x seconds"});
    for (const UnlikeScene& scene : scenes)
        if (isAskedFor(m_options.scenes, scene.key)) judge(scene);
    m_report.publish(m_options.csvFile, m_options.docsFile);
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Told against true error on twelve unlike scenes, over many seeds");
    app.add_option("--scenes", options.scenes, "keys with commas between (all)");
    app.add_option("--size", options.size, "pixels, both ways, a multiple of 8 (48)");
    app.add_option("--seeds", options.seeds, "renders of a scene (20)")->check(CLI::Range(1, 9999));
    app.add_option("--first-seed", options.firstSeed, "the others follow it (1)");
    app.add_option("--passes", options.passes, "of each, a power of two (16)")
        ->check(CLI::Range(2, 9999));
    app.add_option("--path-passes", options.pathPasses, "of 256 samples of a reference (12)");
    app.add_option("--photon-passes", options.photonPasses,
                   "of narrow estimates of a reference, where paths find too little (24)");
    app.add_option("--threads", options.threads, "threads (1)");
    app.add_option("--references", options.references, "folder to keep references in");
    app.add_option("--keep", options.keep, "folder to keep all renders' passes in");
    app.add_option("--pictures", options.pictures, "write render and reference to this folder");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the tables into this Markdown file");
    app.add_flag("--quick", options.quick, "3 seeds, 4 passes, short references");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        options.seeds = 3;
        options.passes = 4;
        options.pathPasses = options.photonPasses = 2;
    }
    try {
        UnlikeBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_unlike: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
