// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/scene_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrator/values/stopwatch.h"
#include "plugin/api/entry.h"
#include "plugin/api/light_reader.h"
#include "plugin/api/parameter_reader.h"
#include "plugin/api/parameter_tables.h"
#include "plugin/api/transform_reader.h"
#include "plugin/session/leave_behind.h"
#include "plugin/session/render_identity.h"
#include "plugin/values/call_error.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

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

// What a commit makes, by so many threads; it needs nothing but what it is given.
void build(SceneDescription description, int threads, const std::string& isa,
           const CancelCheck& cancel, RenderScene& made) {
    const Stopwatch watch;
    WorkerArena arena(threads);
    made.scene = arena.execute([&] { return Scene::build(std::move(description), isa, cancel); });
    made.tables = sceneTables();
    made.identity = sceneIdentity(*made.scene, *made.textures, made.tables, cancel);
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
    m_description.materials.emplace_back();
    m_materials.push_back(material);
    MaterialDescription description;
    material->use().putInto(description, [this](const std::shared_ptr<const Texture>& texture) {
        return m_textures->add(texture);
    });
    if (description.kind == MaterialKind::kMixture) {
        const MaterialObject::Parts parts = material->parts();
        if (!parts[0] || !parts[1])
            throw argumentError(
                fmt::format("material '{}' is a mixture; its first and second have to be set",
                            description.name));
        description.first = materialIndex(parts[0]);
        description.second = materialIndex(parts[1]);
    }
    m_description.materials[index] = std::move(description);
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
    InstanceSet values(instanceParameters());
    readStructInto(values, &desc, *m_context, "PmrInstanceDesc");
    values.check(0, "PmrInstanceDesc");
    InstanceDescription instance;
    instance.shape = mesh->shape();
    values.putInto(instance);
    instance.materials = materialsOf(desc, *mesh);
    m_description.instances.push_back(std::move(instance));
    m_cages.push_back(mesh->cage());
}

void SceneObject::addLight(const PmrLightDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    LightSet light(lightParameters());
    readStructInto(light, &desc, *m_context, "PmrLightDesc");
    checkLight(light, "PmrLightDesc");
    m_lights.push_back(std::move(light));
}

void SceneObject::setEnvironment(const PmrEnvironmentDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    if (desc.reserved != 0.0f) throw argumentError("PmrEnvironmentDesc: reserved must be 0");
    EnvironmentSet environment(environmentParameters());
    readStructInto(environment, &desc, *m_context, "PmrEnvironmentDesc");
    checkEnvironment(environment, "PmrEnvironmentDesc");
    m_environment = std::move(environment);
}

void SceneObject::setCamera(const PmrCameraDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    if (desc.reserved != 0) throw argumentError("PmrCameraDesc: reserved must be 0");
    CameraSet camera(cameraParameters());
    readStructInto(camera, &desc, *m_context, "PmrCameraDesc");
    checkCamera(camera, "PmrCameraDesc");
    m_camera = std::move(camera);
}

void SceneObject::setInstanceParameter(const PmrParameterDesc& desc) {
    checkIndex(desc.index, m_description.instances.size());
    InstanceDescription& instance = m_description.instances[desc.index];
    const std::string owner = fmt::format("instance {}", desc.index);
    InstanceSet values(instanceParameters());
    setByName(values, desc, *m_context, owner);
    const std::size_t row = indexOf(values.rows(), desc.name, owner);
    if (values.rows()[row].inStruct.kind == StructPlace::Kind::kTransform)
        readTransform(values.value(row).numbers.data(), 1, owner.c_str());
    const auto& place = std::get<Place<InstanceDescription>>(values.rows()[row].places);
    place.put(instance, values.value(row), kNoTexture);
}

void SceneObject::setParameter(const PmrParameterDesc& desc) {
    const std::lock_guard lock(m_mutex);
    requireOpen();
    // A copy, so that nothing has changed where it is refused.
    const auto change = [&](auto& object, const std::string& owner, auto check) {
        auto changed = object;
        setByName(changed, desc, *m_context, owner);
        check(changed, owner);
        object = std::move(changed);
    };
    switch (desc.object) {
        case PMR_OBJECT_LIGHT:
            checkIndex(desc.index, m_lights.size());
            return change(m_lights[desc.index], fmt::format("light {}", desc.index), checkLight);
        case PMR_OBJECT_ENVIRONMENT:
            if (!m_environment) throw CallError(CallStatus::kState, "there is no environment yet");
            return change(*m_environment, "environment", checkEnvironment);
        case PMR_OBJECT_CAMERA:
            if (!m_camera) throw CallError(CallStatus::kState, "there is no camera yet");
            return change(*m_camera, "camera", checkCamera);
        case PMR_OBJECT_INSTANCE:
            return setInstanceParameter(desc);
        default:
            throw argumentError(fmt::format(
                "PmrParameterDesc: object is {}; it must be 0 to 4 (PMR_OBJECT_*)", desc.object));
    }
}

// Of the instances that are cages: what is to be cut on demand.
void SceneObject::chooseShapes(SceneDescription& description) const {
    for (std::size_t i = 0; i < m_cages.size(); ++i) {
        InstanceDescription& instance = description.instances[i];
        const bool isDisplaced =
            std::ranges::any_of(instance.materials, [&](std::uint32_t material) {
                return description.materials[material].displacementTexture != kNoTexture;
            });
        const bool isOnDemand = instance.tessellation == TessellationTime::kOnDemand ||
                                (instance.tessellation == TessellationTime::kAuto && isDisplaced);
        if (m_cages[i] && isOnDemand) instance.shape = m_cages[i]->limit();
    }
}

// The description, whose textures go to their list.
SceneDescription SceneObject::describe(SceneTextures& textures) const {
    SceneDescription description = m_description;
    chooseShapes(description);
    for (const LightSet& light : m_lights) addLightTo(light, description);
    if (m_environment) {
        description.environment.emplace();
        m_environment->putInto(
            *description.environment,
            [&](const std::shared_ptr<const Texture>& texture) { return textures.add(texture); });
    }
    if (m_camera) {
        description.camera.emplace();
        m_camera->putInto(*description.camera);
    }
    return description;
}

void SceneObject::commit() {
    std::unique_lock lock(m_mutex);
    requireOpen();
    // Their own list: what a cancel leaves behind may still read it when more are added to this.
    const auto textures = std::make_shared<SceneTextures>(*m_textures);
    SceneDescription description = describe(*textures);
    description.textures = textures;
    const std::shared_ptr<const std::atomic<bool>> cancelPlans(m_context,
                                                               &m_context->buildsAreCancelled());
    m_committed = runLeavable(m_context->buildCheck(), "building the scene",
                              [description = std::move(description), textures, cancelPlans,
                               system = m_context->textures(), threads = m_context->threads(),
                               isa = m_context->isa()](const CancelCheck& cancel) mutable {
                                  RenderScene made;
                                  made.textures = textures;
                                  made.cancelPlans = cancelPlans;
                                  made.textureSystem = system;
                                  build(std::move(description), threads, isa, cancel, made);
                                  return std::make_shared<const RenderScene>(std::move(made));
                              });
    m_textures = textures;
    forgetDescription();
    const std::shared_ptr<const RenderScene> committed = m_committed;
    lock.unlock();  // the host's function may ask for the bounds
    for (const Notice& notice : committed->scene->notices()) m_context->sendNotice(notice);
}

// The built scene has all that renders need of it.
void SceneObject::forgetDescription() {
    m_description = {};
    m_cages = {};
    m_lights = {};
    m_environment.reset();
    m_camera.reset();
    m_materialIndices = {};
    m_materials = {};
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
