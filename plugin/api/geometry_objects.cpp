// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "integrator/geometry/subdivision.h"
#include "integrator/geometry/triangulate.h"
#include "integrator/values/error.h"
#include "plugin/api/choice_reader.h"
#include "plugin/api/objects.h"
#include "plugin/api/struct_reader.h"
#include "plugin/session/leave_behind.h"
#include "plugin/session/memory_limit.h"
#include "plugin/values/call_error.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

// Indices are 32 bits wide and signed inside.
constexpr std::uint64_t kMaxElements = std::numeric_limits<std::int32_t>::max();
constexpr std::uint64_t kMaxSlots = 65536;
constexpr std::uint64_t kIndicesOfALargeMesh = 1'000'000;
constexpr std::uint64_t kIndicesOfALargeCage = 256;
constexpr std::uint32_t kMaxHostTessellationRate = 64;
constexpr std::uint32_t kDefaultTessellationRate = 4;
// A cage that would make more bytes of triangles than this is cut on demand. A fixed number, as
// what memory there is must not change the picture.
constexpr std::uint64_t kMostCutWhole = std::uint64_t{512} << 20;

void checkArray(const void* array, std::uint64_t count, const char* name) {
    if (count > kMaxElements)
        throw argumentError(
            fmt::format("{}: the count is {}; it must be at most {}", name, count, kMaxElements));
    if (array == nullptr && count > 0)
        throw argumentError(fmt::format("{} is null, but its count is {}", name, count));
}

// The description of a mesh, copied and checked; looks now and then whether to go on.
class MeshReader {
  public:
    explicit MeshReader(const CancelCheck& cancel) : m_cancel(cancel) {}

    PolygonMesh read(const PmrMeshDesc& desc) const;

    template <typename Element, typename Source>
    std::vector<Element> copyArray(const Source* array, std::uint64_t count,
                                   const char* name) const {
        static_assert(sizeof(Element) % sizeof(Source) == 0);
        checkArray(array, count, name);
        std::vector<Element> copy;
        copy.reserve(count);
        for (std::uint64_t done = 0; done < count; done = copy.size()) {
            goOn();
            copy.resize(std::min(count, done + kElementsBetweenLooks));
            std::memcpy(static_cast<void*>(copy.data() + done),
                        array + done * (sizeof(Element) / sizeof(Source)),
                        (copy.size() - done) * sizeof(Element));
        }
        return copy;
    }

  private:
    static constexpr std::uint64_t kElementsBetweenLooks = 1 << 16;

    void goOn() const { m_cancel.throwIfSet("reading a mesh"); }
    std::vector<std::int32_t> cornerIndices(const std::uint32_t* given, const PmrMeshDesc& desc,
                                            std::uint64_t valueCount, const char* name) const;
    std::vector<std::uint32_t> materialSlots(const PmrMeshDesc& desc,
                                             std::uint64_t slotCount) const;

    const CancelCheck m_cancel;
};

// The host's indices; PMR_NO_INDEX becomes -1, as do the numbers beyond 31 bits that no array has.
std::vector<std::int32_t> MeshReader::cornerIndices(const std::uint32_t* given,
                                                    const PmrMeshDesc& desc,
                                                    std::uint64_t valueCount,
                                                    const char* name) const {
    const std::uint32_t* source = given == nullptr ? desc.indices : given;
    std::vector<std::int32_t> indices(desc.indexCount);
    for (std::uint64_t i = 0; i < desc.indexCount; ++i) {
        if (i % kElementsBetweenLooks == 0) goOn();
        if (source[i] == PMR_NO_INDEX && given != nullptr) {
            indices[i] = -1;
            continue;
        }
        if (source[i] >= valueCount)
            throw Error(Status::kInvalidScene, fmt::format("{}[{}] is {}; it must be below {}",
                                                           name, i, source[i], valueCount));
        indices[i] = static_cast<std::int32_t>(source[i]);
    }
    return indices;
}

std::vector<std::uint32_t> MeshReader::materialSlots(const PmrMeshDesc& desc,
                                                     std::uint64_t slotCount) const {
    if (desc.materialSlots == nullptr) return {};
    auto slots = copyArray<std::uint32_t>(desc.materialSlots, desc.faceCount, "materialSlots");
    for (std::size_t face = 0; face < slots.size(); ++face) {
        if (slots[face] >= slotCount)
            throw argumentError(fmt::format("materialSlots[{}] is {}; slotCount is {}", face,
                                            slots[face], slotCount));
    }
    return slots;
}

std::uint64_t slotCountOf(const PmrMeshDesc& desc) {
    if (desc.slotCount > kMaxSlots)
        throw argumentError(
            fmt::format("slotCount is {}; it must be 0 to {}", desc.slotCount, kMaxSlots));
    return desc.slotCount == 0 ? 1 : desc.slotCount;
}

PolygonMesh MeshReader::read(const PmrMeshDesc& desc) const {
    PolygonMesh mesh;
    mesh.positions = copyArray<Vec3f>(desc.positions, desc.positionCount, "positions");
    checkArray(&desc, desc.faceCount, "faceCount");
    if (desc.faceSizes != nullptr)
        mesh.faceVertexCounts =
            copyArray<std::uint32_t>(desc.faceSizes, desc.faceCount, "faceSizes");
    else if (desc.indexCount == 3 * desc.faceCount)
        mesh.faceVertexCounts.assign(desc.faceCount, 3);
    else
        throw argumentError(fmt::format("indexCount is {}; {} triangles need {}", desc.indexCount,
                                        desc.faceCount, 3 * desc.faceCount));
    mesh.vertexIndices = copyArray<std::uint32_t>(desc.indices, desc.indexCount, "indices");
    mesh.normals = copyArray<Vec3f>(desc.normals, desc.normalCount, "normals");
    if (desc.normalCount > 0)
        mesh.normalIndices =
            cornerIndices(desc.normalIndices, desc, desc.normalCount, "normalIndices");
    mesh.texcoords = copyArray<Vec2f>(desc.uvs, desc.uvCount, "uvs");
    if (desc.uvCount > 0)
        mesh.texcoordIndices = cornerIndices(desc.uvIndices, desc, desc.uvCount, "uvIndices");
    mesh.faceMaterials = materialSlots(desc, slotCountOf(desc));
    return mesh;
}

void reportRepairs(const Context& context, const MeshRepairs& repairs) {
    const auto report = [&context](std::size_t count, const char* what) {
        if (count > 0)
            context.sendNotice(
                {NoticeCode::kDegenerateGeometry, fmt::format("{} {}", count, what)});
    };
    report(repairs.droppedTriangles, "triangles without area were left out");
    report(repairs.replacedNormals, "unusable normals were replaced by their face's own");
    report(repairs.fannedFaces, "faces cross themselves and were cut into fans");
    report(repairs.ignoredCreases, "creases lie on no edge and were ignored");
}

// A cage, cut whole or, where limit is not null, not at all.
struct CutCage {
    BuiltMesh built;
    std::shared_ptr<const CageSource> source;
    std::shared_ptr<const LimitShape> limit;
};

std::shared_ptr<MeshObject> finishMesh(std::shared_ptr<Context> context, CutCage cut,
                                       std::uint64_t slotCount) {
    if (cut.limit) cut.built.repairs.ignoredCreases = cut.limit->surface().ignoredCreases();
    reportRepairs(*context, cut.built.repairs);
    Shape shape = std::make_shared<const TriangleMesh>(std::move(cut.built.mesh));
    if (cut.limit) shape = std::move(cut.limit);
    return std::make_shared<MeshObject>(std::move(context), std::move(shape), slotCount,
                                        std::move(cut.source));
}

std::uint32_t checkedRate(std::uint32_t rate) {
    if (rate > kMaxHostTessellationRate)
        throw argumentError(
            fmt::format("tessellationRate is {}; it must be 0 (the default, {}) to {}", rate,
                        kDefaultTessellationRate, kMaxHostTessellationRate));
    return rate == 0 ? kDefaultTessellationRate : rate;
}

// By PMR_SCHEME_*, PMR_BOUNDARY_* and PMR_FACE_VARYING_*.
constexpr std::array kSchemes{SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop,
                              SubdivisionScheme::kBilinear};
constexpr std::array kBoundaries{BoundaryInterpolation::kEdgeAndCorner,
                                 BoundaryInterpolation::kEdgeOnly, BoundaryInterpolation::kNone};
constexpr std::array kFaceVaryings{
    FaceVaryingInterpolation::kBoundaries,   FaceVaryingInterpolation::kSmooth,
    FaceVaryingInterpolation::kCornersOnly,  FaceVaryingInterpolation::kCornersPlus1,
    FaceVaryingInterpolation::kCornersPlus2, FaceVaryingInterpolation::kAllLinear};

SubdivisionCage toCage(const PmrCageDesc& desc, const PmrMeshDesc& meshDesc,
                       const CancelCheck& cancel) {
    const MeshReader reader(cancel);
    SubdivisionCage cage;
    cage.mesh = reader.read(meshDesc);
    cage.scheme = readChoice(desc.scheme, kSchemes, "scheme", "PMR_SCHEME_*");
    cage.boundary = readChoice(desc.boundary, kBoundaries, "boundary", "PMR_BOUNDARY_*");
    cage.faceVarying =
        readChoice(desc.faceVarying, kFaceVaryings, "faceVarying", "PMR_FACE_VARYING_*");
    checkArray(desc.creases, desc.creaseCount, "creases");
    checkArray(desc.creaseSharpness, desc.creaseCount, "creaseSharpness");
    for (std::uint64_t i = 0; i < desc.creaseCount; ++i)
        cage.creases.push_back(
            {{desc.creases[2 * i], desc.creases[2 * i + 1]}, desc.creaseSharpness[i]});
    checkArray(desc.corners, desc.cornerCount, "corners");
    checkArray(desc.cornerSharpness, desc.cornerCount, "cornerSharpness");
    for (std::uint64_t i = 0; i < desc.cornerCount; ++i)
        cage.corners.push_back({desc.corners[i], desc.cornerSharpness[i]});
    cage.holes = reader.copyArray<std::uint32_t>(desc.holes, desc.holeCount, "holes");
    return cage;
}

bool isTooLargeToCut(const SubdivisionCage& cage, int rate) {
    return tessellationSize(cage, rate).bytes > kMostCutWhole;
}

void refuseTooLarge(const SubdivisionCage& cage, int rate) {
    constexpr std::uint64_t kFitsAnywhere = 16 << 20;  // asking the system takes longer than that
    const TessellationSize size = tessellationSize(cage, rate);
    if (size.bytes <= kFitsAnywhere) return;
    const std::uint64_t limit = memoryLimitBytes(0.0);
    if (size.bytes > limit)
        throw CallError(CallStatus::kMemory,
                        fmt::format("tessellationRate {} makes {} triangles of {:.1f} GiB; the "
                                    "memory limit is {:.1f} GiB",
                                    rate, size.triangles, toGib(size.bytes), toGib(limit)));
}

}  // namespace

std::shared_ptr<MeshObject> makeMesh(std::shared_ptr<Context> context, const PmrMeshDesc& desc) {
    const std::uint64_t slotCount = slotCountOf(desc);
    const CancelCheck cancel = context->buildCheck();
    auto cut = [mesh = MeshReader(cancel).read(desc)](const CancelCheck& own) {
        return triangulate(mesh, own);
    };
    // Of a large one the arrays alone take long to get and to give back; of many small ones threads
    // would.
    BuiltMesh built = desc.indexCount < kIndicesOfALargeMesh
                          ? cut(cancel)
                          : runLeavable(cancel, "cutting faces into triangles", std::move(cut));
    return finishMesh(std::move(context), {std::move(built), nullptr, nullptr}, slotCount);
}

std::shared_ptr<MeshObject> makeCage(std::shared_ptr<Context> context, const PmrCageDesc& desc) {
    PmrMeshDesc meshDesc = readStruct(desc.mesh, "PmrCageDesc.mesh");
    meshDesc.normals = nullptr;
    meshDesc.normalCount = 0;
    meshDesc.normalIndices = nullptr;
    const std::uint64_t slotCount = slotCountOf(meshDesc);
    const int rate = static_cast<int>(checkedRate(desc.tessellationRate));
    // Of many small ones threads would take longer than the work.
    const bool isSmall = meshDesc.indexCount < kIndicesOfALargeCage;
    const CancelCheck check = context->buildCheck();
    auto cut = [cage = toCage(desc, meshDesc, check), rate,
                threads = isSmall ? 1 : context->threads()](const CancelCheck& cancel) mutable {
        CutCage result;
        if (isTooLargeToCut(cage, rate)) {
            result.source = std::make_shared<const CageSource>(std::move(cage), rate);
            result.limit = result.source->limit();
            return result;
        }
        refuseTooLarge(cage, rate);
        WorkerArena arena(threads);
        result.built = arena.execute([&] { return tessellate(cage, rate, cancel); });
        result.source = std::make_shared<const CageSource>(std::move(cage), rate);
        return result;
    };
    CutCage result = isSmall ? cut(check) : runLeavable(check, "tessellating", std::move(cut));
    return finishMesh(std::move(context), std::move(result), slotCount);
}
}  // namespace pm::plugin
