// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "integrator/scene/scene_description.h"
#include "plugin/api/context.h"
#include "plugin/api/handle_table.h"
#include "plugin/api/objects.h"
#include "plugin/api/parameter_reader.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/session/render_scene.h"
#include "plugin/textures/scene_textures.h"

namespace pm::plugin {

// A host's scene: a list that grows until commit, then a built scene that never changes.
// Threads: any; changes come one after the other. Errors of everything that adds: CallError STATE
// after commit, ARGUMENT, HANDLE, or UNSUPPORTED for a kind that this version does not render.
class SceneObject {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kScene;

    SceneObject(std::shared_ptr<Context> context, const PmrSceneDesc& desc);

    const std::shared_ptr<Context>& context() const { return m_context; }

    void addInstance(const PmrInstanceDesc& desc);
    void addLight(const PmrLightDesc& desc);
    void setEnvironment(const PmrEnvironmentDesc& desc);
    void setCamera(const PmrCameraDesc& desc);
    // Of a light, the environment, the camera or an instance. Errors also: CallError NAME; STATE
    // where there is no environment or camera. Nothing is changed then.
    void setParameter(const PmrParameterDesc& desc);

    // Builds on the context's threads. Errors: those of Scene::build; the scene then stays open.
    void commit();

    // CallError(STATE) before commit.
    std::shared_ptr<const RenderScene> committed() const;
    // World space: min x, y, z, max x, y, z.
    std::array<double, 6> bounds() const;

  private:
    void requireOpen() const;
    void forgetDescription();
    void setInstanceParameter(const PmrParameterDesc& desc);
    SceneDescription describe(SceneTextures& textures) const;
    std::uint32_t materialIndex(const std::shared_ptr<MaterialObject>& material);
    void chooseShapes(SceneDescription& description) const;
    std::vector<std::uint32_t> materialsOf(const PmrInstanceDesc& desc, const MeshObject& mesh);

    std::shared_ptr<Context> m_context;
    mutable std::mutex m_mutex;
    SceneDescription m_description;  // materials and instances; the others are
    std::vector<std::shared_ptr<const CageSource>> m_cages;  // of the instances; null: none
    std::vector<LightSet> m_lights;
    std::optional<EnvironmentSet> m_environment;
    std::optional<CameraSet> m_camera;
    std::shared_ptr<SceneTextures> m_textures;
    std::unordered_map<const MaterialObject*, std::uint32_t> m_materialIndices;
    std::vector<std::shared_ptr<MaterialObject>> m_materials;  // keeps the keys above alive
    std::shared_ptr<const RenderScene> m_committed;            // null before commit
};

}  // namespace pm::plugin
