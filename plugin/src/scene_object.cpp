// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/scene_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "plugin/src/call_error.h"
#include "plugin/src/entry.h"
#include "plugin/src/identity.h"
#include "plugin/src/leave_behind.h"
#include "plugin/src/light_reader.h"
#include "plugin/src/transform_reader.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

CallError unsupported(const std::string& text) {
    return {PMR_ERROR_UNSUPPORTED, text};
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
std::pair<std::shared_ptr<const Scene>, Identity> build(SceneDescription description,
                                                        const SceneTextures& textures, int threads,
                                                        const std::string& isa,
                                                        const CancelCheck& cancel) {
    WorkerArena arena(threads);
    auto scene = arena.execute([&] { return Scene::build(std::move(description), isa, cancel); });
    Identity identity = sceneIdentity(*scene, textures, cancel);
    return {std::move(scene), std::move(identity)};
}

}  // namespace

SceneObject::SceneObject(std::shared_ptr<Context> context, const PmrSceneDesc& desc)
    : m_context(std::move(context)), m_textures(std::make_shared<SceneTextures>()) {
    if (desc.renderingSpace != nullptr) m_description.renderingSpace = desc.renderingSpace;
    m_description.rgbToXyz = checkedRgbToXyz(desc.rgbToXyz);
}

void SceneObject::requireOpen() const {
    if (m_scene)
        throw CallError(PMR_ERROR_STATE,
                        "the scene is committed and can't change; an edit makes a new scene");
}

std::uint32_t SceneObject::materialIndex(const std::shared_ptr<MaterialObject>& material) {
    const auto index = static_cast<std::uint32_t>(m_materials.size());
    const auto [found, isNew] = m_materialIndices.try_emplace(material.get(), index);
    if (!isNew) return found->second;
    MaterialDescription description = material->description();
    const auto textureIndex = [&](TextureUse use) {
        return m_textures->add(material->textures()[static_cast<std::size_t>(use)]);
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
                PMR_ERROR_HANDLE,
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
    if (!mesh) throw CallError(PMR_ERROR_HANDLE, "PmrInstanceDesc: mesh is not a live mesh");
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
            throw CallError(PMR_ERROR_HANDLE, "PmrEnvironmentDesc: texture is not a live texture");
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
        description.environment->texture = textures->add(m_environmentTexture);
    description.textures = textures;
    const auto start = std::chrono::steady_clock::now();
    auto [built, identity] =
        runLeavable(m_context->buildCheck(), "building the scene",
                    [description = std::move(description), textures, threads = m_context->threads(),
                     isa = m_context->isa()](const CancelCheck& cancel) mutable {
                        return build(std::move(description), *textures, threads, isa, cancel);
                    });
    m_identity = std::move(identity);
    m_scene = std::move(built);
    m_textures = textures;
    m_buildSeconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    m_description = {};
    const std::shared_ptr<const Scene> scene = m_scene;
    lock.unlock();  // the host's function may ask for the bounds
    for (const Notice& notice : scene->notices()) m_context->sendNotice(notice);
}

Identity SceneObject::identity() const {
    const std::lock_guard lock(m_mutex);
    if (!m_scene) throw CallError(PMR_ERROR_STATE, "the scene is not committed yet");
    return m_identity;
}

std::shared_ptr<const Scene> SceneObject::built() const {
    const std::lock_guard lock(m_mutex);
    if (!m_scene) throw CallError(PMR_ERROR_STATE, "the scene is not committed yet");
    return m_scene;
}

std::array<double, 6> SceneObject::bounds() const {
    return built()->bounds();
}

double SceneObject::buildSeconds() const {
    const std::lock_guard lock(m_mutex);
    return m_buildSeconds;
}

std::uint64_t SceneObject::texelBytes() const {
    const std::lock_guard lock(m_mutex);
    return m_textures->texelBytes();
}

std::uint64_t SceneObject::textureFailures() const {
    return m_textures->failureCount();
}

}  // namespace pm::plugin
