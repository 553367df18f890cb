// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/limit_surface.h"

#include <fmt/format.h>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/surfaceFactoryCache.h>
#include <opensubdiv/bfr/tessellation.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <shared_mutex>
#include <tuple>

#include "integrator/geometry/cage_topology.h"
#include "integrator/values/error.h"

namespace pm {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using SharedCache =
    Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                     std::unique_lock<std::shared_mutex>>;
using SurfaceFactory = Bfr::RefinerSurfaceFactory<SharedCache>;
using Surface = Bfr::Surface<double>;

// Bfr approximates irregular surfaces; at 2, its default, a cube of +-1 is off by 9.4e-3, at 7 no
// further level changes the sixth digit.
constexpr int kApproximationLevel = 7;

Sdc::SchemeType schemeOf(SubdivisionScheme scheme) {
    switch (scheme) {
        case SubdivisionScheme::kCatmullClark:
            return Sdc::SCHEME_CATMARK;
        case SubdivisionScheme::kLoop:
            return Sdc::SCHEME_LOOP;
        case SubdivisionScheme::kBilinear:
            return Sdc::SCHEME_BILINEAR;
    }
    throw Error(Status::kInternal, "unknown subdivision scheme");
}

Sdc::Options optionsOf(const SubdivisionCage& cage) {
    constexpr Sdc::Options::VtxBoundaryInterpolation kBoundary[] = {
        Sdc::Options::VTX_BOUNDARY_NONE, Sdc::Options::VTX_BOUNDARY_EDGE_ONLY,
        Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER};
    constexpr Sdc::Options::FVarLinearInterpolation kFaceVarying[] = {
        Sdc::Options::FVAR_LINEAR_NONE,          Sdc::Options::FVAR_LINEAR_CORNERS_ONLY,
        Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1, Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2,
        Sdc::Options::FVAR_LINEAR_BOUNDARIES,    Sdc::Options::FVAR_LINEAR_ALL};
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(kBoundary[static_cast<int>(cage.boundary)]);
    options.SetFVarLinearInterpolation(kFaceVarying[static_cast<int>(cage.faceVarying)]);
    options.SetCreasingMethod(cage.creaseMethod == CreaseMethod::kChaikin
                                  ? Sdc::Options::CREASE_CHAIKIN
                                  : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(cage.smoothTriangles ? Sdc::Options::TRI_SUB_SMOOTH
                                                        : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

// The cage as OpenSubdiv wants it: its arrays must outlive the descriptor.
class RefinerInput {
  public:
    explicit RefinerInput(const SubdivisionCage& cage);
    std::unique_ptr<Far::TopologyRefiner> makeRefiner() const;
    const CageTopology& topology() const { return m_topology; }
    std::size_t ignoredCreases() const { return m_ignoredCreases; }
    bool hasTexcoords() const { return !m_texcoordIndices.empty(); }
    const std::vector<double>& positions() const { return m_positions; }
    const std::vector<double>& texcoords() const { return m_texcoords; }

  private:
    void addVertices();
    void addTexcoords();
    void addCreases();
    void addCorners();

    const SubdivisionCage& m_cage;
    CageTopology m_topology;
    std::vector<int> m_faceSizes, m_vertexIndices, m_texcoordIndices;
    std::vector<double> m_positions;  // in threes
    std::vector<double> m_texcoords;  // in pairs
    std::vector<int> m_creaseVertices, m_cornerVertices, m_holes;
    std::vector<float> m_creaseSharpness, m_cornerSharpness;
    std::size_t m_ignoredCreases = 0;
};

RefinerInput::RefinerInput(const SubdivisionCage& cage)
    : m_cage(cage),
      m_topology(cage),
      m_faceSizes(cage.mesh.faceVertexCounts.begin(), cage.mesh.faceVertexCounts.end()),
      m_holes(cage.holes.begin(), cage.holes.end()) {
    addVertices();
    addTexcoords();
    addCreases();
    addCorners();
}

void RefinerInput::addVertices() {
    for (std::uint32_t corner = 0; corner < m_cage.mesh.vertexIndices.size(); ++corner) {
        m_vertexIndices.push_back(static_cast<int>(m_topology.copyOf(corner)));
    }
    for (std::uint32_t copy = 0; copy < m_topology.copyCount(); ++copy) {
        const Vec3f& p = m_cage.mesh.positions[m_topology.originOf(copy)];
        m_positions.insert(m_positions.end(), {p.x, p.y, p.z});
    }
}

// Of each texture coordinate the first that has its value: many exporters write a new one for each
// corner, and where two faces have equal ones the coordinates go on over their edge.
std::vector<int> firstOfEqual(const std::vector<Vec2f>& texcoords) {
    std::vector<int> order(texcoords.size()), first(texcoords.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int i) {
        const Vec2f& t = texcoords[static_cast<std::size_t>(i)];
        return std::tuple(t.x, t.y);
    };
    std::ranges::stable_sort(order, {}, key);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool isNew = i == 0 || key(order[i]) != key(order[i - 1]);
        first[static_cast<std::size_t>(order[i])] =
            isNew ? order[i] : first[static_cast<std::size_t>(order[i - 1])];
    }
    return first;
}

// Corners without a texture coordinate share one more value, (0, 0).
void RefinerInput::addTexcoords() {
    for (const Vec2f& texcoord : m_cage.mesh.texcoords) {
        m_texcoords.insert(m_texcoords.end(), {texcoord.x, texcoord.y});
    }
    const auto zero = static_cast<int>(m_cage.mesh.texcoords.size());
    m_texcoords.insert(m_texcoords.end(), {0.0, 0.0});
    const std::vector<int> first = firstOfEqual(m_cage.mesh.texcoords);
    for (const std::int32_t index : m_cage.mesh.texcoordIndices) {
        m_texcoordIndices.push_back(index < 0 ? zero : first[static_cast<std::size_t>(index)]);
    }
}

// Leaves out creases that are no edges: OpenSubdiv would print a warning for each.
void RefinerInput::addCreases() {
    std::vector<float> sharpness(m_topology.edgeCount());
    for (const Crease& crease : m_cage.creases) {
        const std::uint32_t edge = m_topology.findEdge(crease.vertices[0], crease.vertices[1]);
        if (edge == m_topology.edgeCount() || crease.vertices[0] == crease.vertices[1]) {
            ++m_ignoredCreases;
            continue;
        }
        sharpness[edge] = std::min(crease.sharpness, kInfiniteSharpness);
    }
    for (std::uint32_t corner = 0; corner < m_cage.mesh.vertexIndices.size(); ++corner) {
        const std::uint32_t edge = m_topology.edgeOf(corner);
        const float value = m_topology.isCut(edge) ? kInfiniteSharpness : sharpness[edge];
        if (!(value > 0)) continue;
        m_creaseVertices.push_back(static_cast<int>(m_topology.copyOf(corner)));
        m_creaseVertices.push_back(
            static_cast<int>(m_topology.copyOf(m_topology.nextCorner(corner))));
        m_creaseSharpness.push_back(value);
    }
}

void RefinerInput::addCorners() {
    std::vector<float> sharpness(m_cage.mesh.positions.size());
    for (const SharpCorner& corner : m_cage.corners) {
        sharpness[corner.vertex] = std::min(corner.sharpness, kInfiniteSharpness);
    }
    for (std::uint32_t copy = 0; copy < m_topology.copyCount(); ++copy) {
        const std::uint32_t vertex = m_topology.originOf(copy);
        const float value = m_topology.isSharp(vertex) ? kInfiniteSharpness : sharpness[vertex];
        if (!(value > 0)) continue;
        m_cornerVertices.push_back(static_cast<int>(copy));
        m_cornerSharpness.push_back(value);
    }
}

std::unique_ptr<Far::TopologyRefiner> RefinerInput::makeRefiner() const {
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(m_topology.copyCount());
    descriptor.numFaces = static_cast<int>(m_faceSizes.size());
    descriptor.numVertsPerFace = m_faceSizes.data();
    descriptor.vertIndicesPerFace = m_vertexIndices.data();
    descriptor.numCreases = static_cast<int>(m_creaseSharpness.size());
    descriptor.creaseVertexIndexPairs = m_creaseVertices.data();
    descriptor.creaseWeights = m_creaseSharpness.data();
    descriptor.numCorners = static_cast<int>(m_cornerVertices.size());
    descriptor.cornerVertexIndices = m_cornerVertices.data();
    descriptor.cornerWeights = m_cornerSharpness.data();
    descriptor.numHoles = static_cast<int>(m_holes.size());
    descriptor.holeIndices = m_holes.data();
    Far::TopologyDescriptor::FVarChannel channel;
    channel.numValues = static_cast<int>(m_texcoords.size() / 2);
    channel.valueIndices = m_texcoordIndices.data();
    if (hasTexcoords()) {
        descriptor.numFVarChannels = 1;
        descriptor.fvarChannels = &channel;
    }
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(schemeOf(m_cage.scheme), optionsOf(m_cage))));
    if (refiner) return refiner;
    throw Error(Status::kInvalidScene,
                fmt::format("OpenSubdiv can't represent this cage of {} faces and {} vertices",
                            m_cage.mesh.faceCount(), m_cage.mesh.positions.size()));
}

SurfaceFactory::Options surfaceOptions() {
    SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(kApproximationLevel);
    options.SetApproxLevelSharp(static_cast<int>(kInfiniteSharpness));
    return options;
}

void preparePatchPoints(const Surface& surface, const std::vector<double>& meshPoints, int size,
                        std::vector<double>& patchPoints) {
    patchPoints.resize(static_cast<std::size_t>(surface.GetNumPatchPoints()) *
                       static_cast<std::size_t>(size));
    surface.PreparePatchPoints(meshPoints.data(), size, patchPoints.data(), size);
}

}  // namespace

SamplePattern makeSamplePattern(SubdivisionScheme scheme, std::uint32_t faceSize, int rate) {
    // Bfr counts in int; no mesh could hold more triangles than this anyway.
    constexpr std::uint64_t kMostTriangles = 0xffffffffu / 3;
    const auto segments = static_cast<std::uint64_t>(rate);
    if (faceSize * segments * segments > kMostTriangles) {
        throw Error(
            Status::kInvalidScene,
            fmt::format("a face of {} corners at tessellation rate {} makes too many triangles",
                        faceSize, rate));
    }
    const Bfr::Parameterization parameters(schemeOf(scheme), static_cast<int>(faceSize));
    const Bfr::Tessellation tessellation(parameters, rate);
    if (!tessellation.IsValid()) {
        throw Error(
            Status::kInvalidScene,
            fmt::format("a face of {} corners can't be subdivided at rate {}", faceSize, rate));
    }
    SamplePattern pattern;
    pattern.boundaryPoints = static_cast<std::uint32_t>(tessellation.GetNumBoundaryCoords());
    pattern.coords.resize(2 * static_cast<std::size_t>(tessellation.GetNumCoords()));
    tessellation.GetCoords(pattern.coords.data());
    std::vector<int> facets(3 * static_cast<std::size_t>(tessellation.GetNumFacets()));
    tessellation.GetFacets(facets.data());
    for (std::size_t i = 0; i < facets.size(); i += 3) {
        pattern.facets.push_back({static_cast<std::uint32_t>(facets[i]),
                                  static_cast<std::uint32_t>(facets[i + 1]),
                                  static_cast<std::uint32_t>(facets[i + 2])});
    }
    return pattern;
}

struct LimitSurface::Impl {
    explicit Impl(const SubdivisionCage& cage_)
        : cage(cage_),
          input(cage_),
          refiner(input.makeRefiner()),
          factory(*refiner, surfaceOptions()) {}

    const SubdivisionCage& cage;
    RefinerInput input;
    std::unique_ptr<Far::TopologyRefiner> refiner;
    SurfaceFactory factory;
};

LimitSurface::LimitSurface(const SubdivisionCage& cage) : m_impl(std::make_unique<Impl>(cage)) {}
LimitSurface::~LimitSurface() = default;

std::size_t LimitSurface::edgeCount() const {
    return m_impl->input.topology().edgeCount();
}

std::pair<std::uint32_t, std::uint32_t> LimitSurface::edge(std::uint32_t index) const {
    return m_impl->input.topology().edge(index);
}

bool LimitSurface::hasSurface(std::uint32_t face) const {
    return m_impl->factory.FaceHasLimitSurface(static_cast<Far::Index>(face));
}

bool LimitSurface::hasTexcoords() const {
    return m_impl->input.hasTexcoords();
}

std::size_t LimitSurface::ignoredCreases() const {
    return m_impl->input.ignoredCreases();
}

std::size_t LimitSurface::openedVertices() const {
    return m_impl->input.topology().openedVertices();
}

void LimitSurface::listCorners(std::uint32_t face, std::vector<FaceCorner>& corners) const {
    const CageTopology& topology = m_impl->input.topology();
    const std::vector<std::uint32_t>& vertices = m_impl->cage.mesh.vertexIndices;
    const std::uint32_t first = topology.firstCorner(face);
    corners.clear();
    for (std::uint32_t i = 0; i < m_impl->cage.mesh.faceVertexCounts[face]; ++i) {
        const std::uint32_t vertex = vertices[first + i], edge = topology.edgeOf(first + i);
        corners.push_back({vertex, edge, topology.edge(edge).first == vertex});
    }
}

struct LimitSurface::Evaluator::State {
    const Impl* limit = nullptr;
    Surface surface, texcoordSurface;
    std::vector<double> patchPoints, texcoordPatchPoints;
};

LimitSurface::Evaluator::Evaluator(const LimitSurface& surface)
    : m_state(std::make_unique<State>()) {
    m_state->limit = surface.m_impl.get();
}
LimitSurface::Evaluator::~Evaluator() = default;
LimitSurface::Evaluator::Evaluator(Evaluator&&) noexcept = default;

void LimitSurface::Evaluator::select(std::uint32_t face) {
    State& state = *m_state;
    const auto index = static_cast<Far::Index>(face);
    const SurfaceFactory& factory = state.limit->factory;
    const bool hasTexcoords = state.limit->input.hasTexcoords();
    const SurfaceFactory::FVarID channel = 0;
    const bool good = hasTexcoords ? factory.InitSurfaces(index, &state.surface,
                                                          &state.texcoordSurface, &channel, 1)
                                   : factory.InitVertexSurface(index, &state.surface);
    if (!good || !state.surface.IsValid()) {
        throw Error(Status::kInvalidScene,
                    fmt::format("OpenSubdiv finds no limit surface for face {}", face));
    }
    preparePatchPoints(state.surface, state.limit->input.positions(), 3, state.patchPoints);
    if (hasTexcoords) {
        preparePatchPoints(state.texcoordSurface, state.limit->input.texcoords(), 2,
                           state.texcoordPatchPoints);
    }
}

LimitSurface::Sample LimitSurface::Evaluator::evaluate(const double* uv) const {
    const State& state = *m_state;
    double p[3], du[3], dv[3];
    state.surface.Evaluate(uv, state.patchPoints.data(), 3, p, du, dv);
    Sample sample{{p[0], p[1], p[2]}, {du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}, {}};
    if (state.limit->input.hasTexcoords()) {
        double t[2];
        state.texcoordSurface.Evaluate(uv, state.texcoordPatchPoints.data(), 2, t);
        sample.texcoord = {static_cast<float>(t[0]), static_cast<float>(t[1])};
    }
    return sample;
}

LimitSurface::ChartSample LimitSurface::Evaluator::evaluateChart(
    const std::array<double, 2>& uv) const {
    const State& state = *m_state;
    double p[3], du[3], dv[3];
    state.surface.Evaluate(uv.data(), state.patchPoints.data(), 3, p, du, dv);
    ChartSample sample{
        {p[0], p[1], p[2]}, {du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}, {}, {}, {}};
    if (state.limit->input.hasTexcoords())
        state.texcoordSurface.Evaluate(uv.data(), state.texcoordPatchPoints.data(), 2,
                                       sample.texcoord.data(), sample.alongU.data(),
                                       sample.alongV.data());
    return sample;
}

bool LimitSurface::Evaluator::isBicubic() const {
    return m_state->surface.IsRegular() && m_state->surface.GetFaceSize() == 4;
}

// Every patch of the surface is a mean of its points with weights that are not negative.
Box3d LimitSurface::Evaluator::hull() const {
    Box3d box;
    const std::vector<double>& points = m_state->patchPoints;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
        const Vec3d point{points[i], points[i + 1], points[i + 2]};
        box.grow({point, point});
    }
    return box;
}

}  // namespace pm
