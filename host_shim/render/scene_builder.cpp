// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "host_shim/process/interrupt.h"
#include "host_shim/render/scene_memory.h"

namespace pm::host {
namespace {

static_assert(kHiddenFromCamera == PMR_HIDDEN_FROM_CAMERA &&
              kHiddenFromShadow == PMR_HIDDEN_FROM_SHADOW &&
              kHiddenFromReflection == PMR_HIDDEN_FROM_REFLECTION);

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

// Shapes of a context, released at the end; scenes keep what they use.
class Shapes {
  public:
    explicit Shapes(const PmrApi& api) : m_api(api) {}
    ~Shapes() {
        for (const auto& [key, shape] : m_shapes) m_api.releaseMesh(shape);
    }
    Shapes(const Shapes&) = delete;
    Shapes& operator=(const Shapes&) = delete;

    // That of an instance; make is asked for it the first time.
    template <typename Make>
    PmrMesh of(const InstanceData& instance, const Make& make) {
        const std::pair key{instance.shape, instance.index};
        const auto found = m_shapes.find(key);
        if (found != m_shapes.end()) return found->second;
        return m_shapes.emplace(key, make()).first->second;
    }

  private:
    const PmrApi& m_api;
    std::map<std::pair<InstanceData::Shape, std::uint32_t>, PmrMesh> m_shapes;
};

int32_t kindOf(LightData::Kind kind) {
    if (kind == LightData::Kind::kSpot) return PMR_LIGHT_SPOT;
    return kind == LightData::Kind::kDirectional ? PMR_LIGHT_DIRECTIONAL : PMR_LIGHT_POINT;
}

int32_t kindOf(CameraLens::Kind kind) {
    if (kind == CameraLens::Kind::kOrthographic) return PMR_CAMERA_ORTHOGRAPHIC;
    return kind == CameraLens::Kind::kPanorama ? PMR_CAMERA_PANORAMA : PMR_CAMERA_PERSPECTIVE;
}

// Light in the rendering space; there a saturated colour may leave the numbers that are allowed.
void storeLight(const std::array<float, 3>& given, const ColourPipeline& colour,
                float (&target)[3]) {
    const auto converted = colour.materialToRendering(given);
    for (std::size_t i = 0; i < 3; ++i)
        target[i] = std::clamp(converted[i], 0.0f, std::numeric_limits<float>::max());
}

}  // namespace

PluginScene::~PluginScene() {
    if (m_handle != nullptr) m_context.api().releaseScene(m_handle);
}

void PluginScene::build(const Request& request, const ColourPipeline& colour,
                        MaterialBuilder& materials) {
    const SceneData& data = request.data;
    const PmrApi& api = m_context.api();
    auto desc = PMR_INIT(PmrSceneDesc);
    desc.renderingSpace = colour.renderingSpace().c_str();
    if (const auto matrix = colour.renderingToXyzD65()) std::ranges::copy(*matrix, desc.rgbToXyz);
    m_context.check(api.createScene(m_context.handle(), &desc, &m_handle), request.sceneName);
    addInstances(request, buildMaterials(data, materials));
    for (const LightData& light : data.lights) {
        throwIfInterrupted();
        addLight(light, colour);
    }
    if (data.environment) setEnvironment(*data.environment, colour, materials);
    setCamera(request.camera);
    m_context.check(api.commitScene(m_handle), request.sceneName);
}

std::vector<const MaterialData*> usedMaterials(const SceneData& data) {
    std::vector<const MaterialData*> order;
    std::vector<bool> isTaken(data.materials.size());
    const auto take = [&](const auto& self, std::size_t index) -> void {
        if (isTaken[index]) return;
        isTaken[index] = true;  // one that names itself is refused where it is built
        for (const std::string& name : data.materials[index].partNames()) {
            const auto part = std::ranges::find(data.materials, name, &MaterialData::name);
            if (part != data.materials.end())
                self(self, static_cast<std::size_t>(part - data.materials.begin()));
        }
        order.push_back(&data.materials[index]);
    };
    for (const InstanceData& instance : data.instances)
        for (const uint32_t material : data.materialsOf(instance)) take(take, material);
    return order;
}

PluginScene::Materials PluginScene::buildMaterials(const SceneData& data,
                                                   MaterialBuilder& materials) {
    const std::vector<const MaterialData*> used = usedMaterials(data);
    materials.prepare(used);
    Materials built(data.materials.size());
    for (const MaterialData* const material : used) {
        throwIfInterrupted();
        built[static_cast<std::size_t>(material - data.materials.data())] =
            materials.build(*material);
    }
    return built;
}

void PluginScene::addInstances(const Request& request, const Materials& materials) {
    Shapes shapes(m_context.api());
    for (const InstanceData& instance : request.data.instances) {
        throwIfInterrupted();
        const bool isMesh = instance.shape == InstanceData::Shape::kMesh;
        const std::string where = instance.name.empty()
                                      ? request.sceneName
                                      : fmt::format("{}: {} {}", request.sceneName,
                                                    isMesh ? "group" : "sphere", instance.name);
        const PmrMesh shape =
            shapes.of(instance, [&] { return createShape(instance, request, where); });
        addInstance(instance, request.data, shape, materials, where);
    }
}

PmrMesh PluginScene::createShape(const InstanceData& instance, const Request& request,
                                 const std::string& where) {
    if (instance.shape == InstanceData::Shape::kMesh)
        return createMesh(request.data.meshes[instance.index], request.subdivide, where);
    const SphereData& sphere = request.data.spheres[instance.index];
    auto desc = PMR_INIT(PmrSphereDesc);
    std::ranges::copy(sphere.centre, desc.centre);
    desc.radius = sphere.radius;
    PmrMesh handle = nullptr;
    m_context.check(m_context.api().createSphere(m_context.handle(), &desc, &handle), where);
    return handle;
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

void PluginScene::addInstance(const InstanceData& instance, const SceneData& data, PmrMesh shape,
                              const Materials& materials, const std::string& where) {
    std::vector<PmrMaterial> slots;
    for (const uint32_t material : data.materialsOf(instance)) slots.push_back(materials[material]);
    const Transform transform = data.toWorld(instance);
    auto desc = PMR_INIT(PmrInstanceDesc);
    desc.mesh = shape;
    desc.transforms = transform.data();
    desc.transformCount = 1;
    desc.materials = slots.data();
    desc.materialCount = slots.size();
    desc.name = instance.name.c_str();
    desc.id = m_nextId++;
    desc.hiddenFrom = instance.hiddenFrom;
    m_context.check(m_context.api().addInstance(m_handle, &desc), where);
}

void PluginScene::addLight(const LightData& light, const ColourPipeline& colour) {
    auto desc = PMR_INIT(PmrLightDesc);
    desc.kind = kindOf(light.kind);
    desc.transforms = light.transform.data();
    desc.transformCount = 1;
    if (light.isInRenderingSpace)
        std::ranges::copy(light.emission, desc.emission);
    else
        storeLight(light.emission, colour, desc.emission);
    desc.coneAngle = light.coneAngle;
    desc.coneFalloff = light.coneFalloff;
    desc.angularRadius = light.angularRadius;
    desc.name = light.name.c_str();
    m_context.check(m_context.api().addLight(m_handle, &desc), light.name);
}

void PluginScene::setEnvironment(const EnvironmentData& environment, const ColourPipeline& colour,
                                 MaterialBuilder& materials) {
    auto desc = PMR_INIT(PmrEnvironmentDesc);
    storeLight(environment.radiance, colour, desc.radiance);
    if (environment.texture)
        desc.texture = materials.wantedTexture(*environment.texture, TextureKind::kColour);
    if (environment.transform) {
        desc.transforms = environment.transform->data();
        desc.transformCount = 1;
    }
    m_context.check(m_context.api().setEnvironment(m_handle, &desc), "environment");
}

void PluginScene::setCamera(const CameraPose& camera) {
    auto desc = PMR_INIT(PmrCameraDesc);
    desc.kind = kindOf(camera.lens.kind);
    desc.transforms = camera.transform.data();
    desc.transformCount = 1;
    desc.fieldOfView = camera.verticalFov;
    desc.height = camera.lens.height;
    desc.lensRadius = camera.lens.lensRadius;
    desc.focusDistance = camera.lens.focusDistance;
    desc.pixelAspect = camera.lens.pixelAspect;
    m_context.check(m_context.api().setCamera(m_handle, &desc), "camera");
}

}  // namespace pm::host
