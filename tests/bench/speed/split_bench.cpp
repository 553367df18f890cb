// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where the time of a camera sample goes: the calls of one pass are recorded, and each kind is made
// again and timed alone; what is left of the pass is shading and bookkeeping. Rays are traced by
// bare Embree, too, one by one and eight at once, which bounds what batches could save.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <functional>
#include <memory>

#include "integrator/sampling/sampler.h"
#include "integrator/transport/frame_renderer.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/speed/bare_embree.h"
#include "tests/bench/speed/call_recorder.h"
#include "tests/bench/speed/speed_bench.h"

namespace pm::bench {

namespace {

constexpr std::int32_t kSize = 256, kBucket = 32;

double timeOf(const std::function<void()>& work) {
    const double start = threadSeconds();
    work();
    return threadSeconds() - start;
}

// The second pass of a render, on one thread.
class SecondPass {
  public:
    explicit SecondPass(std::shared_ptr<const Scene> scene)
        : m_settings(test::smallFrame(kSize, kSize, IntegratorKind::kPhoton, 4, 3)),
          m_renderer(std::move(scene), m_settings) {
        m_renderer.beginPass(0, m_cancelled, {});
    }
    void begin() { m_renderer.beginPass(1, m_cancelled, {}); }
    void renderBuckets() {
        constexpr auto kArea = static_cast<std::size_t>(kBucket * kBucket);
        std::vector<float> weights(kArea);
        std::vector<float> pixels(kArea * static_cast<std::size_t>(m_renderer.layout().count));
        for (std::int32_t y = 0; y < kSize; y += kBucket)
            for (std::int32_t x = 0; x < kSize; x += kBucket)
                m_renderer.renderRegion({x, y, x + kBucket, y + kBucket}, pixels, weights,
                                        m_cancelled);
    }
    double samples() const { return kSize * kSize * 4.0; }

  private:
    RenderSettings m_settings;
    FrameRenderer m_renderer;
    const std::atomic<bool> m_cancelled{false};
};

// Work that takes its turn with others.
struct Timed {
    std::function<void()> work;
    std::vector<double> seconds{};  // of each turn

    void takeTurn() {
        if (work) seconds.push_back(timeOf(work));
    }
    // Nanoseconds a sample; 0 when there is no work.
    double median(double samples) const {
        return seconds.empty() ? 0 : 1e9 * spreadOf(seconds).median / samples;
    }
};

// A kind of calls, made again; rays by bare Embree, too.
struct Part {
    std::string name;
    std::size_t calls = 0;
    Timed own, bare{}, bareByEight{};
};

// The recorded calls, kind by kind. What they refer to must outlive the parts.
class Replay {
  public:
    Replay(const Scene& scene, const RecordedCalls& calls)
        : m_scene(scene), m_calls(calls), m_bare(scene, true) {}

    std::vector<Part> parts() const;

  private:
    Part nearest(const char* name, const std::vector<Ray>& rays) const;
    Part shadow(const char* name) const;
    template <typename Call, typename Ask>
    static Part lookUps(const char* name, const std::vector<Call>& calls, const Ask& ask) {
        return {name, calls.size(), {[&calls, ask] {
                    for (const Call& call : calls) benchmark::DoNotOptimize(ask(call));
                }}};
    }
    void drawNumbers() const;

    const Scene& m_scene;
    const RecordedCalls& m_calls;
    BareEmbree m_bare;
};

Part Replay::nearest(const char* name, const std::vector<Ray>& rays) const {
    return {name,
            rays.size(),
            {[&] {
                Surface surface;
                for (const Ray& ray : rays)
                    benchmark::DoNotOptimize(m_scene.intersect(ray, surface));
            }},
            {[&] { benchmark::DoNotOptimize(m_bare.countHits(rays)); }},
            {[&] { benchmark::DoNotOptimize(m_bare.countHitsByEight(rays)); }}};
}

Part Replay::shadow(const char* name) const {
    const std::vector<Ray>& rays = m_calls.shadow;
    return {name,
            rays.size(),
            {[&] {
                for (const Ray& ray : rays) benchmark::DoNotOptimize(m_scene.occluded(ray));
            }},
            {[&] { benchmark::DoNotOptimize(m_bare.countOccluded(rays)); }},
            {[&] { benchmark::DoNotOptimize(m_bare.countOccludedByEight(rays)); }}};
}

// As many as the render drew, from as many samplers.
void Replay::drawNumbers() const {
    std::uint64_t pairs = 0, singles = 0;
    for (std::uint64_t i = 0; i < m_calls.samplers; ++i) {
        Sampler sampler(1, 0, i / 16, static_cast<std::uint32_t>(i % 16));
        for (; pairs * m_calls.samplers < m_calls.pairs * (i + 1); ++pairs, sampler.nextEvent())
            benchmark::DoNotOptimize(sampler.get2D(Purpose::kDirection));
        for (; singles * m_calls.samplers < m_calls.singles * (i + 1);
             ++singles, sampler.nextEvent())
            benchmark::DoNotOptimize(sampler.get1D(Purpose::kLobe));
    }
}

std::vector<Part> Replay::parts() const {
    const auto scratch = std::make_shared<NearestPhotons>();
    return {
        nearest("camera rays", m_calls.camera),
        shadow("shadow rays"),
        nearest("rays on: mirror, glass, lamps sought along a lobe", m_calls.onward),
        nearest("gather rays of the points", m_calls.gather),
        {"random numbers", m_calls.pairs + m_calls.singles, {[this] { drawNumbers(); }}},
        lookUps("gather points, kept", m_calls.points,
                [](const RecordedCalls::Point& c) {
                    GatherPoints::Estimate found;
                    return c.points->estimate(c.place, found);
                }),
        lookUps("caustic map", m_calls.caustics,
                [scratch](const RecordedCalls::Caustic& c) {
                    return c.map->irradiance(c.position, c.normal, *scratch, c.pixelWidth);
                }),
        lookUps("irradiance sites, kept", m_calls.sites,
                [](const RecordedCalls::Site& c) { return c.sites->at(c.position, c.normal); }),
        lookUps("irradiance estimated, at a site once or at a point", m_calls.estimates,
                [](const RecordedCalls::Estimate& c) {
                    return c.estimate.at(c.position, c.normal, c.pattern);
                }),
    };
}

RecordedCalls record(SecondPass& pass) {
    pass.begin();
    const CallRecorder recorder;
    pass.renderBuckets();
    return recorder.calls();
}

// Takes turns of the parts and of the whole pass, and adds what these tell: the last part is all.
void takeTurns(SecondPass& pass, int turns, std::vector<Part>& parts) {
    Timed photons{[&] { pass.begin(); }}, buckets{[&] { pass.renderBuckets(); }}, rest, all;
    for (int turn = 0; turn < turns; ++turn) {
        photons.takeTurn();
        buckets.takeTurn();
        double known = 0;
        for (Part& part : parts) {
            for (Timed* timed : {&part.own, &part.bare, &part.bareByEight}) timed->takeTurn();
            known += part.own.seconds.back();
        }
        rest.seconds.push_back(buckets.seconds.back() - known);
        all.seconds.push_back(photons.seconds.back() + buckets.seconds.back());
    }
    parts.push_back({"shading and all else", 0, rest});
    parts.push_back({"photons, maps, the points' places", 0, photons});
    parts.push_back({"all", 0, all});
}

void addTable(Report& report, const std::string& scene, const std::vector<Part>& parts,
              double samples) {
    report.table(
        fmt::format("Where a camera sample's time goes, {}: {} x {} pixels, second pass, 4 samples "
                    "a pixel, one thread",
                    scene, kSize, kSize),
        {"part", "calls a sample", "ns a call", "ns a sample", "% of all",
         "bare Embree, ns a sample", "eight at once, ns a sample"});
    const double whole = parts.back().own.median(samples);
    const auto shown = [](bool known, double value) { return known ? show(value) : ""; };
    for (const Part& part : parts) {
        const double ns = part.own.median(samples);
        if (ns < 0.1) continue;  // the scene has no need of it
        const double calls = static_cast<double>(part.calls) / samples;
        const bool isCall = part.calls > 0, isRay = part.bare.work != nullptr;
        report.row({part.name, shown(isCall, calls), shown(isCall, ns / calls), show(ns),
                    show(100 * ns / whole), shown(isRay, part.bare.median(samples)),
                    shown(isRay, part.bareByEight.median(samples))});
    }
    const Part &camera = parts[0], &shadow = parts[1];
    const auto share = [&](double ns) { return 100 * ns / whole; };
    report.paragraph(fmt::format(
        "Camera and shadow rays take {:.0f} % of the time; traced eight at once they would save at "
        "most {:.0f} % of it.",
        share(camera.own.median(samples) + shadow.own.median(samples)),
        share(camera.bare.median(samples) + shadow.bare.median(samples) -
              camera.bareByEight.median(samples) - shadow.bareByEight.median(samples))));
}

void split(Report& report, int turns, const std::string& name, const test::SceneMaker& maker) {
    const auto scene = maker.build();
    // The recorded one stays as it is, since its calls are made again.
    SecondPass recorded(scene), pass(scene);
    const RecordedCalls calls = record(recorded);
    const Replay replay(*scene, calls);
    std::vector<Part> parts = replay.parts();
    takeTurns(pass, turns, parts);
    addTable(report, name, parts, pass.samples());
}

}  // namespace

void benchSplit(Report& report, int turns) {
    tbb::task_arena one(1);
    one.execute([&] {
        split(report, turns, "box of 32 triangles", plainBox());
        split(report, turns, "the same with 2 spheres", boxWithSpheres());
        split(report, turns, "room with 1 M triangles", roomWithMesh());
    });
}

}  // namespace pm::bench
