// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Look-ups in a photon map against nanoflann's kd-tree on the same points. nanoflann knows no
// normals: once it runs as it comes, finding other sets, and once with our test of normal and plane
// in its result set, when both must find the same.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <nanoflann.hpp>

#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "scheduler/buckets/hilbert_order.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/speed/speed_bench.h"

namespace pm::bench {

namespace {

constexpr std::uint32_t kNearest = 50;
constexpr std::size_t kMapPhotons = 1'000'000;
constexpr std::size_t kQueries = 50'000;
constexpr std::int32_t kFrame = 224;  // pixels, both ways: as many

struct Points {
    const PhotonMap& map;

    std::size_t kdtree_get_point_count() const { return map.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const {
        return map.photon(static_cast<std::uint32_t>(index)).position[static_cast<int>(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>,
                                                 Points, 3, std::uint32_t>;

// nanoflann's own result set behind the test that PhotonMap makes.
class FilteredResults {
  public:
    using DistanceType = float;

    FilteredResults(const PhotonMap& map, const PhotonQuery& query, std::uint32_t* indices,
                    float* distances)
        : m_map(map), m_gate(map.gate(query.position, query.normal)), m_results(kNearest) {
        m_results.init(indices, distances);
    }
    std::size_t size() const { return m_results.size(); }
    bool full() const { return m_results.full(); }
    float worstDist() const { return m_results.worstDist(); }
    bool addPoint(float distanceSquared, std::uint32_t index) {
        const Photon photon = m_map.photon(index);
        if (!m_gate.accepts(photon)) return true;
        return m_results.addPoint(distanceSquared, index);
    }

  private:
    const PhotonMap& m_map;
    PhotonGate m_gate;
    nanoflann::KNNResultSet<float, std::uint32_t> m_results;
};

std::uint64_t mortonCode(const Vec3f& p, float extent) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float unit = std::clamp(0.5f + 0.5f * p[axis] / extent, 0.0f, 0.999f);
        const auto cell = static_cast<std::uint64_t>(unit * 0x1p20f);
        for (int bit = 0; bit < 20; ++bit) code |= (cell >> bit & 1) << (3 * bit + axis);
    }
    return code;
}

class QueryBench {
  public:
    QueryBench()
        : m_scene(boxWithSpheres().build()),
          m_lights(*m_scene),
          m_map(photons(PhotonKind::kGlobal, 800'000, kMapPhotons)),
          m_points{m_map},
          m_tree(3, m_points, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
        m_tree.buildIndex();
        m_radius = m_map.typicalRadius(kNearest);
        for (const Photon& p : photons(PhotonKind::kGlobalPilot, 100'000, kQueries))
            m_coherent.push_back({p.position, p.normal.unpack(), kNearest, 10.0f});
        m_random = m_coherent;
        std::sort(m_coherent.begin(), m_coherent.end(), [](const auto& a, const auto& b) {
            return mortonCode(a.position, 1.0f) < mortonCode(b.position, 1.0f);
        });
        for (std::size_t i = m_random.size(); i > 1; --i)
            std::swap(m_random[i - 1], m_random[mixBits(i) % i]);
        const Camera camera(*m_scene, kFrame, kFrame);
        for (const std::uint32_t pixel : hilbertOrder(kFrame, kFrame)) {
            Surface seen;
            const Ray ray = camera.ray({pixel % kFrame + 0.5, pixel / kFrame + 0.5});
            // Photons lie, and are asked for, on diffuse surfaces alone.
            if (!m_scene->intersect(ray, seen) ||
                m_scene->material(seen.material).kind != MaterialKind::kSurface)
                continue;
            const float side = dot(ray.direction, seen.geometricNormal) < 0 ? 1.0f : -1.0f;
            m_hilbert.push_back({seen.position, seen.geometricNormal * side, kNearest, 10.0f});
        }
    }

    void compareWithNanoflann(Report& report, int turns) const {
        report.table(
            fmt::format("The {} nearest of {} photons, thousand queries a second, one thread; {}",
                        kNearest, m_map.size(), sameSets()),
            {"order of queries", "PhotonMap", "nanoflann with our test of photons",
             "nanoflann as it comes", "PhotonMap / nanoflann with test",
             "PhotonMap / nanoflann as it comes"});
        const auto add = [&](const char* name, const std::vector<PhotonQuery>& queries) {
            const auto times =
                takeTurns(turns, {[&] { runOurs(queries); }, [&] { runFiltered(queries); },
                                  [&] { runPlain(queries); }});
            const auto amount = static_cast<double>(queries.size());
            report.row({name, show(rate(amount, times[0]), 1e-3),
                        show(rate(amount, times[1]), 1e-3), show(rate(amount, times[2]), 1e-3),
                        show(speedRatio(times[0], times[1])),
                        show(speedRatio(times[0], times[2]))});
        };
        add("random", m_random);
        add("Morton", m_coherent);
        add("what a frame's pixels show, along a Hilbert curve", m_hilbert);
    }

    void measureOthers(Report& report, int turns) const {
        report.table(
            fmt::format("Other look-ups in the same map, thousand a second, one thread; radius {} "
                        "(half of the estimates would have {} photons)",
                        show(static_cast<double>(m_radius)), kNearest),
            {"what", "random order", "Morton order", "Morton / random"});
        const auto sites = std::make_unique<IrradianceSites>(*m_scene, m_map, m_radius);
        const auto add = [&](const char* name, const auto& look) {
            const auto times = takeTurns(turns, {[&] {
                                                     for (const auto& q : m_random) look(q);
                                                 },
                                                 [&] {
                                                     for (const auto& q : m_coherent) look(q);
                                                 }});
            const auto amount = static_cast<double>(kQueries);
            report.row({name, show(rate(amount, times[0]), 1e-3),
                        show(rate(amount, times[1]), 1e-3), show(speedRatio(times[1], times[0]))});
        };
        add("PhotonMap::fluxWithin", [&](const PhotonQuery& q) {
            benchmark::DoNotOptimize(m_map.fluxWithin(q.position, q.normal, m_radius));
        });
        add("IrradianceSites::at, kept", [&](const PhotonQuery& q) {
            benchmark::DoNotOptimize(sites->at(q.position, q.normal));
        });
        add("IrradianceSites::estimate (what a site costs once)", [&](const PhotonQuery& q) {
            benchmark::DoNotOptimize(sites->estimate(q.position, q.normal, 1));
        });
    }

  private:
    BigVector<Photon> photons(PhotonKind kind, std::uint64_t emitted, std::size_t most) const {
        const std::atomic<bool> cancelled{false};
        auto found = tracePhotons(*m_scene, m_lights, {kind, emitted, 1, 0}, cancelled, {}).photons;
        if (found.size() > most) found.resize(most);
        return found;
    }

    void runOurs(const std::vector<PhotonQuery>& queries) const {
        NearestPhotons nearest;
        for (const PhotonQuery& query : queries) {
            m_map.findNearest(query, nearest);
            benchmark::DoNotOptimize(nearest.found().data());
        }
    }
    void runFiltered(const std::vector<PhotonQuery>& queries) const {
        for (const PhotonQuery& query : queries) benchmark::DoNotOptimize(findFiltered(query));
    }
    void runPlain(const std::vector<PhotonQuery>& queries) const {
        for (const PhotonQuery& query : queries)
            benchmark::DoNotOptimize(m_tree.knnSearch(&query.position.x, kNearest, m_indices.data(),
                                                      m_distances.data()));
    }
    std::size_t findFiltered(const PhotonQuery& query) const {
        FilteredResults results(m_map, query, m_indices.data(), m_distances.data());
        m_tree.findNeighbors(results, &query.position.x, {});
        return results.size();
    }

    // How many of the queries find the same photons both ways. Photons as far as the last may be
    // exchanged for each other by rounding.
    std::string sameSets() const {
        NearestPhotons nearest;
        std::size_t same = 0;
        for (const PhotonQuery& query : m_random) {
            m_map.findNearest(query, nearest);
            std::vector<std::uint32_t> ours, theirs;
            for (const auto& found : nearest.found()) ours.push_back(found.index);
            theirs.assign(m_indices.begin(),
                          m_indices.begin() + static_cast<std::ptrdiff_t>(findFiltered(query)));
            std::sort(ours.begin(), ours.end());
            std::sort(theirs.begin(), theirs.end());
            same += ours == theirs;
        }
        return fmt::format("PhotonMap and nanoflann with our test find the same set in {} of {}",
                           same, m_random.size());
    }

    std::shared_ptr<const Scene> m_scene;
    LightSampler m_lights;
    PhotonMap m_map;
    Points m_points;
    Tree m_tree;
    float m_radius = 0;
    std::vector<PhotonQuery> m_random, m_coherent, m_hilbert;
    mutable std::array<std::uint32_t, kNearest> m_indices{};
    mutable std::array<float, kNearest> m_distances{};
};

}  // namespace

void benchQueries(Report& report, int turns) {
    const QueryBench bench;
    bench.compareWithNanoflann(report, turns);
    bench.measureOthers(report, turns);
}

}  // namespace pm::bench
