// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/scene_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "integrator/values/stopwatch.h"
#include "plugin/api/entry.h"
#include "plugin/api/light_reader.h"
#include "plugin/api/transform_reader.h"
#include "plugin/session/leave_behind.h"
#include "plugin/session/render_identity.h"
#include "plugin/values/call_error.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

CallError unsupported(const std::string& text) {
    return {CallStatus::kUnsupported, text};
}

std::array<double, 9> checkedRgbToXyz(const double (&given)[9]) {
    // Linear Rec.709 with white D65 (IEC 61966-2-1).
    constexpr std::array<double, 9> kRec709 = {0.4124564, 0.3575761, 0.1804375,
                                               0.2126729, 0.7151522, 0.0721750,
                                               0.0193339, 0.1191920, 0.9503041};
    if (std::all_of(std::begin(given), std::end(given), [](double v) { return v == 0.0; }))
        return kRec709;
    std::array<double, 9> matrix{};
    std::copy(std::begin(given), std::end(given), matrix.begin());
    for (const double value : matrix)
        if (!std::isfinite(value))
            throw argumentError(
                fmt::format("PmrSceneDesc: rgbToXyz holds {}; all must be finite", value));
    const Transform padded = {matrix[0], matrix[1], matrix[2], 0,         matrix[3], matrix[4],
                              matrix[5], 0,         matrix[6], matrix[7], matrix[8], 0};
    if (determinant(padded) == 0.0) throw argumentError("PmrSceneDesc: rgbToXyz has no inverse");
    return matrix;
}

void refuseOtherCameras(const PmrCameraDesc& desc) {
    if (desc.kind == PMR_CAMERA_ORTHOGRAPHIC || desc.kind == PMR_CAMERA_PANORAMA)
        throw unsupported(
            fmt::format("PmrCameraDesc: this version renders perspective cameras only, not {} ones",
                        desc.kind == PMR_CAMERA_ORTHOGRAPHIC ? "orthographic" : "panorama"));
    if (desc.kind != PMR_CAMERA_PERSPECTIVE)
        throw argumentError(
            fmt::format("PmrCameraDesc: kind is {}; it must be 0 to 2 (PMR_CAMERA_*)", desc.kind));
    if (!(desc.lensRadius >= 0.0) || !std::isfinite(desc.lensRadius))
        throw argumentError(fmt::format(
            "PmrCameraDesc: lensRadius is {}; it must be 0 or more and finite", desc.lensRadius));
    if (desc.lensRadius > 0.0)
        throw unsupported(
            "PmrCameraDesc: this version renders pinhole cameras only (lensRadius 0)");
    if (desc.reserved != 0) throw argumentError("PmrCameraDesc: reserved must be 0");
}

// What a commit makes, by so many threads; it needs nothing but what it is given.
void build(SceneDescription description, int threads, const std::string& isa,
           const CancelCheck& cancel, RenderScene& made) {
    const Stopwatch watch;
    WorkerArena arena(threads);
    made.scene = arena.execute([&] { return Scene::build(std::move(description), isa, cancel); });
    made.identity = sceneIdentity(*made.scene, *made.textures, cancel);
    made.buildSeconds = watch.seconds();
}

}  // namespace

SceneObject::SceneObject(std::shared_ptr<Context> context, const PmrSceneDesc& desc)
    : m_context(std::move(context)), m_textures(std::make_shared<SceneTextures>()) {
    if (desc.renderingSpace != nullptr) m_description.renderingSpace = desc.renderingSpace;
    m_description.rgbToXyz = checkedRgbToXyz(desc.rgbToXyz);
}

void SceneObject::requireOpen() const {
    if (m_committed)
        throw CallError(CallStatus::kState,
                        "the scene is committed and can't change; an edit makes a new scene");
}

std::uint32_t SceneObject::materialIndex(const std::shared_ptr<MaterialObject>& material) {
    const auto index = static_cast<std::uint32_t>(m_materials.size());
    const auto [found, isNew] = m_materialIndices.try_emplace(material.get(), index);
    if (!isNew) return found->second;
    MaterialDescription description = material->description();
    const auto textureIndex = [&](TextureUse use) {
        const auto& texture = material->textures()[static_cast<std::size_t>(use)];
        return texture ? m_textures->add(texture->texture()) : kNoTexture;
    };
    description.diffuseTexture = textureIndex(TextureUse::kDiffuse);
    description.glossyTexture = textureIndex(TextureUse::kGlossy);
    description.glossyExponentTexture = textureIndex(TextureUse::kGlossyExponent);
    description.transmissionTexture = textureIndex(TextureUse::kTransmission);
    description.emissionTexture = textureIndex(TextureUse::kEmission);
    description.opacityTexture = textureIndex(TextureUse::kOpacity);
    m_description.materials.push_back(std::move(description));
    m_materials.push_back(material);
    return index;
}

std::vector<std::uint32_t> SceneObject::materialsOf(const PmrInstanceDesc& desc,
                                                    const MeshObject& mesh) {
    if (desc.materialCount != mesh.slotCount())
        throw argumentError(
            fmt::format("PmrInstanceDesc: materialCount is {}; the mesh has {} slots",
                        desc.materialCount, mesh.slotCount()));
    if (desc.materials == nullptr) throw argumentError("PmrInstanceDesc: materials is null");
    std::vector<std::shared_ptr<MaterialObject>> materials;
    for (std::uint64_t i = 0; i < desc.materialCount; ++i) {
        auto material = findObject<MaterialObject>(desc.materials[i]);
        if (!material)
            throw CallError(
                CallStatus::kHandle,
                fmt::format("PmrInstanceDesc: materials[{}] is not a live material", i));
        if (material->context() != m_context)
            throw argumentError(
                fmt::format("PmrInstanceDesc: materials[{}] belongs to another context", i));
        materials.push_back(std::move(material));
    }
    std::vector<std::uint32_t> indices;
    for (const auto& material : materials) indices.push_back(materialIndex(material));
    return indices;
}

void SceneObject::addInstance(const PmrInstanceDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    const auto mesh = findObject<MeshObject>(desc.mesh);
    if (!mesh) throw CallError(CallStatus::kHandle, "PmrInstanceDesc: mesh is not a live mesh");
    if (mesh->context() != m_context)
        throw argumentError("PmrInstanceDesc: mesh belongs to another context");
    constexpr std::uint32_t kAll =
        PMR_HIDDEN_FROM_CAMERA | PMR_HIDDEN_FROM_SHADOW | PMR_HIDDEN_FROM_REFLECTION;
    if ((desc.hiddenFrom & ~kAll) != 0)
        throw argumentError(
            fmt::format("PmrInstanceDesc: hiddenFrom is {}; it must be a sum of "
                        "PMR_HIDDEN_FROM_..., at most {}",
                        desc.hiddenFrom, kAll));
    InstanceDescription instance;
    instance.shape = mesh->shape();
    instance.transform = readTransform(desc.transforms, desc.transformCount, "PmrInstanceDesc");
    instance.name = desc.name == nullptr ? "" : desc.name;
    instance.id = desc.id;
    instance.hiddenFrom = desc.hiddenFrom;
    instance.materials = materialsOf(desc, *mesh);
    m_description.instances.push_back(std::move(instance));
}

void SceneObject::addLight(const PmrLightDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    readLight(desc, m_description);
}

void SceneObject::setEnvironment(const PmrEnvironmentDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    EnvironmentDescription environment = readEnvironment(desc);
    std::shared_ptr<TextureObject> texture;
    if (desc.texture != nullptr) {
        texture = findObject<TextureObject>(desc.texture);
        if (!texture)
            throw CallError(CallStatus::kHandle,
                            "PmrEnvironmentDesc: texture is not a live texture");
        if (texture->context() != m_context)
            throw argumentError("PmrEnvironmentDesc: texture belongs to another context");
    }
    m_description.environment = environment;
    m_environmentTexture = std::move(texture);
}

void SceneObject::setCamera(const PmrCameraDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    refuseOtherCameras(desc);
    if (!(desc.fieldOfView > 0.0 && desc.fieldOfView < std::numbers::pi))
        throw argumentError(fmt::format(
            "PmrCameraDesc: fieldOfView is {}; it must be between 0 and pi (radians, vertical)",
            desc.fieldOfView));
    if (!(desc.pixelAspect >= 0.0) || !std::isfinite(desc.pixelAspect))
        throw argumentError(
            fmt::format("PmrCameraDesc: pixelAspect is {}; it must be above 0 and finite (0 = 1)",
                        desc.pixelAspect));
    CameraDescription camera;
    camera.cameraToWorld = readTransform(desc.transforms, desc.transformCount, "PmrCameraDesc");
    camera.verticalFieldOfView = desc.fieldOfView;
    camera.pixelAspect = desc.pixelAspect == 0.0 ? 1.0 : desc.pixelAspect;
    m_description.camera = camera;
}

void SceneObject::commit() {
    std::unique_lock lock(m_mutex);
    requireOpen();
    SceneDescription description = m_description;
    // Their own list: what a cancel leaves behind may still read it when more are added to this.
    const auto textures = std::make_shared<SceneTextures>(*m_textures);
    if (description.environment)
        description.environment->texture =
            m_environmentTexture ? textures->add(m_environmentTexture->texture()) : kNoTexture;
    description.textures = textures;
    m_committed = runLeavable(m_context->buildCheck(), "building the scene",
                              [description = std::move(description), textures,
                               system = m_context->textures(), threads = m_context->threads(),
                               isa = m_context->isa()](const CancelCheck& cancel) mutable {
                                  RenderScene made;
                                  made.textures = textures;
                                  made.textureSystem = system;
                                  build(std::move(description), threads, isa, cancel, made);
                                  return std::make_shared<const RenderScene>(std::move(made));
                              });
    m_textures = textures;
    m_description = {};
    const std::shared_ptr<const RenderScene> committed = m_committed;
    lock.unlock();  // the host's function may ask for the bounds
    for (const Notice& notice : committed->scene->notices()) m_context->sendNotice(notice);
}

std::shared_ptr<const RenderScene> SceneObject::committed() const {
    const std::lock_guard lock(m_mutex);
    if (!m_committed) throw CallError(CallStatus::kState, "the scene is not committed yet");
    return m_committed;
}

std::array<double, 6> SceneObject::bounds() const {
    return committed()->scene->bounds();
}

}  // namespace pm::plugin
