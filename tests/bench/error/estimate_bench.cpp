// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far what a render says of its own error is from the truth, over many seeds.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include "tests/bench/error/estimate_run.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/pictures.h"

namespace pm::bench {
namespace {

struct Options {
    std::filesystem::path peers = PM_SHARED_PEERS;
    std::filesystem::path keep;
    std::string csvFile, docsFile, scenes = "ABC";
    std::int32_t size = 96;
    int seeds = 50, firstSeed = 1, threads = 2, referencePasses = 200, pathPasses = 16,
        peerSeeds = 3;
    std::uint32_t passes = 16, aaLevel = 3, aaLevelMost = 5;
    bool quick = false;
};

// As the tiny light's scene is judged: pixels that see the lamp by chance have no bounded variance.
constexpr double kTrimmedShare = 0.001;
constexpr double kFactor = 1.5;
// Photons to an estimate of the reference; a narrow one has little bias.
constexpr std::uint32_t kNarrow = 12;
constexpr std::uint64_t kReferenceSeed = 1001;
constexpr std::uint32_t kPathLevel = 6;  // 256 samples a pass

// Mean over pixels and channels of (a - r)(b - s) / (r^2 + 0.01), without the worst pixels.
double commonError(std::span<const double> a, std::span<const double> b, std::span<const double> r,
                   std::span<const double> s, double dropped) {
    std::vector<double> moved(b.begin(), b.end());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += r[i] - s[i];
    return relativeError(a, moved, r, dropped);
}

double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(values.size() - 1)))];
}

std::vector<double> meanOf(const std::vector<const std::vector<double>*>& pictures) {
    std::vector<double> mean(pictures.front()->size());
    for (const std::vector<double>* const picture : pictures)
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean[i] += (*picture)[i] / static_cast<double>(pictures.size());
    return mean;
}

struct Reference {
    std::string name;
    Halves halves;
    // Renders that the reference is the mean of, 0: none of those it is held against. Each is then
    // held against the mean of the others.
    double members = 0;
    // Where not empty: the mean over the renders of the lamps that are seen, which takes the place
    // of the reference's own; so many renders.
    std::vector<double> lamps = {};
    double lampMembers = 0;
};

double withoutMember(double mean, double members, double member) {
    return (mean * members - member) / (members - 1);
}

Halves without(const Reference& reference, const Judged& member) {
    Halves halves = reference.halves;
    for (std::size_t i = 0; i < reference.lamps.size(); ++i) {
        const double lamps =
            withoutMember(reference.lamps[i], reference.lampMembers, member.emission[i]);
        halves.even[i] += lamps - halves.evenEmission[i];
        halves.odd[i] += lamps - halves.oddEmission[i];
    }
    if (reference.members == 0) return halves;
    for (std::size_t i = 0; i < member.rgb.size(); ++i)
        halves.even[i] = halves.odd[i] =
            withoutMember(halves.even[i], reference.members, member.rgb[i]);
    return halves;
}

using Renders = std::vector<std::vector<Judged>>;  // by seed, by step of passes

class EstimateBench {
  public:
    explicit EstimateBench(const Options& options) : m_options(options) {}
    void run();

  private:
    RenderSettings settingsFor(std::int32_t size, std::uint32_t passes, std::uint64_t seed) const;
    void judgeScene(const NeutralScene& neutral);
    void judgePeers(const NeutralScene& neutral);
    std::vector<Reference> references(const PassSource& source, const NeutralScene& neutral,
                                      const Renders& renders) const;
    void tell(const NeutralScene& neutral, const Renders& renders, const Reference& reference);
    void tellBias(const NeutralScene& neutral, const Renders& renders, const Reference& reference);

    Options m_options;
    Report m_report{"pm_bench_estimate"};
    std::vector<std::vector<std::string>> m_biasRows;
};

RenderSettings EstimateBench::settingsFor(std::int32_t size, std::uint32_t passes,
                                          std::uint64_t seed) const {
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.window = {0, 0, size, size};
    settings.passes = passes;
    settings.aaLevel = m_options.aaLevel;
    settings.aaLevelMost = m_options.aaLevelMost;
    settings.seed = seed;
    return settings;
}

std::vector<Reference> EstimateBench::references(const PassSource& source,
                                                 const NeutralScene& neutral,
                                                 const Renders& renders) const {
    std::vector<Reference> result;
    std::vector<const std::vector<double>*> all, lamps;
    for (const std::vector<Judged>& render : renders) {
        all.push_back(&render.back().rgb);
        lamps.push_back(&render.back().emission);
    }
    const std::vector<double> mean = meanOf(all);
    const auto members = static_cast<double>(renders.size());
    result.push_back({"other seeds", {mean, mean, {}, {}}, members});
    RenderSettings settings = settingsFor(
        m_options.size, static_cast<std::uint32_t>(m_options.referencePasses), kReferenceSeed);
    settings.estimatePhotons = kNarrow;
    // Its own noise at lamps' rims is more than that of the renders, which have no bias there.
    if (m_options.referencePasses > 0)
        result.push_back({"photons, narrow", source.halves(settings), 0, meanOf(lamps), members});
    // Paths don't find the tiny light behind glass.
    if (m_options.pathPasses == 0 || neutral.name == "sds") return result;
    settings = settingsFor(m_options.size, static_cast<std::uint32_t>(m_options.pathPasses),
                           kReferenceSeed);
    settings.integrator = IntegratorKind::kPath;
    settings.aaLevel = kPathLevel;
    settings.aaLevelMost = 0;
    result.push_back({"path", source.halves(settings), 0});
    return result;
}

// Estimated over true errors of one step of passes.
struct Ratios {
    std::vector<double> truths, ratios;

    void add(double estimate, double truth) {
        truths.push_back(truth);
        ratios.push_back(estimate / truth);
    }
    std::vector<std::string> shown() const {
        const auto within = std::count_if(ratios.begin(), ratios.end(),
                                          [](double r) { return r < kFactor && r > 1 / kFactor; });
        return {show(quantile(truths, 0.5)),
                fmt::format("{:.0f} %", 100.0 * static_cast<double>(within) /
                                            static_cast<double>(ratios.size())),
                fmt::format("{:.2f} ({:.2f} to {:.2f})", quantile(ratios, 0.5),
                            quantile(ratios, 0.05), quantile(ratios, 0.95))};
    }
};

void EstimateBench::tell(const NeutralScene& neutral, const Renders& renders,
                         const Reference& reference) {
    for (std::size_t step = 0; step < renders.front().size(); ++step) {
        Ratios all, trimmed;
        for (const std::vector<Judged>& render : renders) {
            const Judged& now = render[step];
            const Halves r = without(reference, render.back());
            all.add(now.estimate.total(), commonError(now.rgb, now.rgb, r.even, r.odd, 0));
            trimmed.add(now.estimate.totalTrimmed(),
                        commonError(now.rgb, now.rgb, r.even, r.odd, kTrimmedShare));
        }
        std::vector<std::string> row = {neutral.name, reference.name,
                                        std::to_string(renders.front()[step].passes)};
        for (const Ratios* const ratios : {&all, &trimmed})
            for (std::string& cell : ratios->shown()) row.push_back(std::move(cell));
        m_report.row(std::move(row));
    }
}

// The mean of a picture's renders with the lamps that are seen as in the reference: they are noisy
// and not biased.
std::vector<double> meanOfBiased(const Renders& renders, std::size_t first, std::size_t step,
                                 std::span<const double> lamps) {
    std::vector<double> mean(lamps.begin(), lamps.end());
    const double share = 1 / std::ceil(static_cast<double>(renders.size() - first) / 2);
    for (std::size_t i = first; i < renders.size(); i += 2) {
        const Judged& now = renders[i][step];
        for (std::size_t k = 0; k < mean.size(); ++k)
            mean[k] += share * (now.rgb[k] - now.emission[k]);
    }
    return mean;
}

// The bias of the mean over the seeds, and what the renders make of it.
void EstimateBench::tellBias(const NeutralScene& neutral, const Renders& renders,
                             const Reference& reference) {
    const Halves& r = reference.halves;
    for (std::size_t step = 0; step < renders.front().size(); ++step) {
        double estimated = 0, squares = 0;
        const auto count = static_cast<double>(renders.size());
        for (const std::vector<Judged>& render : renders)
            estimated += render[step].estimate.bias / count;
        for (const std::vector<Judged>& render : renders)
            squares += std::pow(render[step].estimate.bias - estimated, 2) / (count * (count - 1));
        const std::vector<double> a = meanOfBiased(renders, 0, step, r.evenEmission);
        const std::vector<double> b = meanOfBiased(renders, 1, step, r.oddEmission);
        m_biasRows.push_back({neutral.name, reference.name,
                              std::to_string(renders.front()[step].passes),
                              show(commonError(a, b, r.even, r.odd, 0)),
                              show(commonError(a, b, r.even, r.odd, kTrimmedShare)),
                              show(estimated), show(std::sqrt(squares))});
    }
}

void EstimateBench::judgeScene(const NeutralScene& neutral) {
    const PassSource source(makeNeutralScene(neutral).build(), neutral.key, m_options.keep,
                            m_options.threads);
    Renders renders;
    for (int i = 0; i < m_options.seeds; ++i) {
        const int seed = m_options.firstSeed + i;
        renders.push_back(source.judged(
            settingsFor(m_options.size, m_options.passes, static_cast<std::uint64_t>(seed))));
        fmt::print(stderr, "{} seed {}\n", neutral.name, seed);
    }
    for (const Reference& reference : references(source, neutral, renders)) {
        tell(neutral, renders, reference);
        if (reference.members == 0) tellBias(neutral, renders, reference);
    }
}

// Against pictures of other renderers, at their size.
void EstimateBench::judgePeers(const NeutralScene& neutral) {
    const Picture peer = readPicture(m_options.peers / (neutral.name + ".exr"));
    const PassSource source(makeNeutralScene(neutral).build(), neutral.key, m_options.keep,
                            m_options.threads);
    Renders renders;
    for (int seed = 1; seed <= m_options.peerSeeds; ++seed)
        renders.push_back(source.judged(
            settingsFor(peer.width, m_options.passes, static_cast<std::uint64_t>(seed))));
    tell(neutral, renders, {"other renderers, 256 x 256", {peer.rgb, peer.rgb, {}, {}}});
}

void EstimateBench::run() {
    m_report.table(
        fmt::format("Estimated over true relMSE, {0} x {0} pixels, {1} seeds, {2:.0f} samples a "
                    "pixel and pass",
                    m_options.size, m_options.seeds, std::pow(4.0, m_options.aaLevel - 2.0)),
        {"scene", "reference", "passes", "true relMSE", "within a factor of 1.5",
         "estimated / true", "true, trimmed", "within, trimmed", "estimated / true, trimmed"});
    std::vector<NeutralScene> scenes;
    for (const char key : m_options.scenes)
        scenes.push_back(readNeutralScene(m_options.peers / "scenes.json", std::string(1, key)));
    for (const NeutralScene& scene : scenes) judgeScene(scene);
    if (m_options.peerSeeds > 0)
        for (const NeutralScene& scene : scenes) judgePeers(scene);
    m_report.table("Bias: of the mean over the seeds, and as the renders estimate it",
                   {"scene", "reference", "passes", "true", "true, without the worst 0.1 %",
                    "estimated, mean", "its standard error"});
    for (const std::vector<std::string>& row : m_biasRows) m_report.row(row);
    m_report.publish(m_options.csvFile, m_options.docsFile);
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Estimated against true error, over many seeds");
    app.add_option("--peers", options.peers, "folder of scenes.json and the references");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the tables into this Markdown file");
    app.add_option("--scenes", options.scenes, "of A, B, C (ABC)");
    app.add_option("--size", options.size, "pixels, both ways (96)");
    app.add_option("--seeds", options.seeds, "renders of a scene (50)")->check(CLI::Range(2, 9999));
    app.add_option("--first-seed", options.firstSeed, "the others follow it (1)");
    app.add_option("--passes", options.passes, "of each (16)")->check(CLI::Range(2, 9999));
    app.add_option("--aa", options.aaLevel, "least level of anti-aliasing (3)")
        ->check(CLI::Range(1, 6));
    app.add_option("--aa-most", options.aaLevelMost, "the most; no more than the least: fixed (5)")
        ->check(CLI::Range(0, 6));
    app.add_option("--reference-passes", options.referencePasses,
                   "of the reference with narrow estimates (200), 0: none");
    app.add_option("--path-passes", options.pathPasses,
                   "of 256 samples of the path-traced reference (16), 0: none");
    app.add_option("--peer-seeds", options.peerSeeds,
                   "renders to hold against other renderers' pictures (3), 0: none");
    app.add_option("--threads", options.threads, "threads (2)");
    app.add_option("--keep", options.keep,
                   "keep all passes in this folder (gigabytes) and read those that are there");
    app.add_flag("--quick", options.quick, "6 seeds, one reference");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        options.seeds = 6;
        options.referencePasses = options.pathPasses = options.peerSeeds = 0;
    }
    if (!std::filesystem::exists(options.peers / "scenes.json")) {
        fmt::print(stderr, "pm_bench_estimate: skipped, no scenes.json in the folder of peers\n");
        return 0;
    }
    try {
        EstimateBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_estimate: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
