// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/scene_builder.h"

#include "host_shim/app/scene_memory.h"
#include "host_shim/process/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pm::host {
namespace {

PmrMeshDesc describe(const MeshData& mesh) {
    auto desc = PMR_INIT(PmrMeshDesc);
    desc.positions = mesh.positions.data();
    desc.positionCount = mesh.positions.size() / 3;
    desc.faceSizes = mesh.faceSizes.data();
    desc.faceCount = mesh.faceSizes.size();
    desc.indices = mesh.indices.data();
    desc.indexCount = mesh.indices.size();
    if (!mesh.normals.empty()) {
        desc.normals = mesh.normals.data();
        desc.normalCount = mesh.normals.size() / 3;
        desc.normalIndices = mesh.normalIndices.data();
    }
    if (!mesh.uvs.empty()) {
        desc.uvs = mesh.uvs.data();
        desc.uvCount = mesh.uvs.size() / 2;
        desc.uvIndices = mesh.uvIndices.data();
    }
    desc.materialSlots = mesh.faceSlots.data();
    desc.slotCount = mesh.slotMaterials.size();
    return desc;
}

// From RenderMan's numbers.
int32_t boundaryOf(int interpolateBoundary) {
    if (interpolateBoundary == 0) return PMR_BOUNDARY_NONE;
    return interpolateBoundary == 2 ? PMR_BOUNDARY_EDGE_ONLY : PMR_BOUNDARY_EDGE_AND_CORNER;
}

// From OpenSubdiv's numbers.
int32_t faceVaryingOf(int number) {
    constexpr std::array<int32_t, 6> kOf = {
        PMR_FACE_VARYING_SMOOTH,        PMR_FACE_VARYING_CORNERS_ONLY,
        PMR_FACE_VARYING_CORNERS_PLUS1, PMR_FACE_VARYING_CORNERS_PLUS2,
        PMR_FACE_VARYING_BOUNDARIES,    PMR_FACE_VARYING_ALL};
    return kOf.at(static_cast<std::size_t>(number));
}

PmrCageDesc describeCage(const PmrMeshDesc& mesh, const CageTags& tags) {
    auto desc = PMR_INIT(PmrCageDesc);
    desc.mesh = &mesh;
    desc.scheme = PMR_SCHEME_CATMULL_CLARK;
    desc.boundary = boundaryOf(tags.boundary);
    desc.faceVarying = faceVaryingOf(tags.faceVarying);
    desc.creases = tags.creases.data();
    desc.creaseSharpness = tags.creaseSharpness.data();
    desc.creaseCount = tags.creaseSharpness.size();
    desc.corners = tags.corners.data();
    desc.cornerSharpness = tags.cornerSharpness.data();
    desc.cornerCount = tags.corners.size();
    desc.holes = tags.holes.data();
    desc.holeCount = tags.holes.size();
    desc.tessellationRate = kTessellationRate;
    return desc;
}

std::array<double, 12> translation(const std::array<double, 3>& by) {
    return {1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2]};
}

}  // namespace

PluginScene::~PluginScene() {
    if (m_handle != nullptr) m_context.api().releaseScene(m_handle);
}

void PluginScene::build(const Request& request, const ColourPipeline& colour,
                        MaterialBuilder& materials) {
    const SceneData& data = request.data;
    const std::string& sceneName = request.sceneName;
    const CameraPose& camera = request.camera;
    const PmrApi& api = m_context.api();
    auto desc = PMR_INIT(PmrSceneDesc);
    desc.renderingSpace = colour.renderingSpace().c_str();
    if (const auto matrix = colour.renderingToXyzD65()) std::ranges::copy(*matrix, desc.rgbToXyz);
    m_context.check(api.createScene(m_context.handle(), &desc, &m_handle), sceneName);

    // Only what faces use is built: libraries often hold more, with pictures that are not there.
    std::vector<bool> isUsed(data.materials.size());
    for (const MeshData& mesh : data.meshes)
        for (const uint32_t material : mesh.slotMaterials) isUsed[material] = true;
    std::vector<const MaterialData*> used;
    for (std::size_t i = 0; i < isUsed.size(); ++i)
        if (isUsed[i]) used.push_back(&data.materials[i]);
    materials.prepare(used);
    std::vector<PmrMaterial> built(data.materials.size());
    for (const MeshData& mesh : data.meshes) {
        for (const uint32_t material : mesh.slotMaterials) {
            if (built[material] == nullptr) {
                built[material] = materials.build(data.materials[material]);
            }
        }
    }
    for (const MeshData& mesh : data.meshes) {
        throwIfInterrupted();
        addMesh(mesh, data, sceneName, request.subdivide, built);
    }
    if (request.cameraLight) addCameraLight(camera, data.bounds);
    auto view = PMR_INIT(PmrCameraDesc);
    view.kind = PMR_CAMERA_PERSPECTIVE;
    view.transforms = camera.transform.data();
    view.transformCount = 1;
    view.fieldOfView = camera.verticalFov;
    m_context.check(api.setCamera(m_handle, &view), "camera");
    m_context.check(api.commitScene(m_handle), sceneName);
}

PmrMesh PluginScene::createMesh(const MeshData& mesh, Subdivide subdivide,
                                const std::string& where) {
    const PmrApi& api = m_context.api();
    const PmrMeshDesc desc = describe(mesh);
    const bool isCage =
        subdivide == Subdivide::kAll || (subdivide == Subdivide::kTagged && mesh.tags.has_value());
    PmrMesh handle = nullptr;
    PmrStatus status = PMR_OK;
    m_log.setSubject(where);
    if (isCage) {
        const CageTags tags = mesh.tags.value_or(CageTags{});
        const PmrCageDesc cage = describeCage(desc, tags);
        status = api.createCage(m_context.handle(), &cage, &handle);
    } else {
        status = api.createMesh(m_context.handle(), &desc, &handle);
    }
    m_log.setSubject({});
    m_context.check(status, where);
    return handle;
}

void PluginScene::addMesh(const MeshData& mesh, const SceneData& data, const std::string& sceneName,
                          Subdivide subdivide, const std::vector<PmrMaterial>& materials) {
    const PmrApi& api = m_context.api();
    const std::string where =
        mesh.name.empty() ? sceneName : fmt::format("{}: group {}", sceneName, mesh.name);
    const PmrMesh handle = createMesh(mesh, subdivide, where);
    std::vector<PmrMaterial> slots;
    for (const uint32_t material : mesh.slotMaterials) slots.push_back(materials[material]);
    const auto transform = translation(data.centre);
    auto instance = PMR_INIT(PmrInstanceDesc);
    instance.mesh = handle;
    instance.transforms = transform.data();
    instance.transformCount = 1;
    instance.materials = slots.data();
    instance.materialCount = slots.size();
    instance.name = mesh.name.c_str();
    instance.id = m_nextId++;
    const PmrStatus status = api.addInstance(m_handle, &instance);
    const std::string error = status == PMR_OK ? "" : m_context.lastError();
    api.releaseMesh(handle);
    if (status != PMR_OK) {
        throw HostError(static_cast<ExitCode>(exitCodeOf(status)),
                        fmt::format("{}: {}", where, error));
    }
}

// Irradiance 2 on what faces the camera at the middle of the scene: a white wall there reflects a
// radiance of 2/pi, and light from wall to wall adds to that.
void PluginScene::addCameraLight(const CameraPose& camera, const Bounds& bounds) {
    double squaredDistance = 0;
    const auto centre = bounds.centre();
    for (std::size_t i = 0; i < 3; ++i) {
        squaredDistance += (camera.eye[i] - centre[i]) * (camera.eye[i] - centre[i]);
    }
    const auto transform = translation(camera.eye);
    auto light = PMR_INIT(PmrLightDesc);
    light.kind = PMR_LIGHT_POINT;
    light.transforms = transform.data();
    light.transformCount = 1;
    const double intensity = 2 * (squaredDistance > 0 ? squaredDistance : 1.0);  // W/sr
    std::ranges::fill(light.emission, static_cast<float>(intensity));
    light.name = "camera light";
    m_context.check(m_context.api().addLight(m_handle, &light), "camera light");
}

}  // namespace pm::host
