// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/log/log.h"
#include "host_shim/look/framing.h"
#include "host_shim/render/material_builder.h"
#include "host_shim/render/plugin.h"

namespace pm::host {

// Those that an instance has: libraries often hold more, with pictures that are not there.
std::vector<const MaterialData*> usedMaterials(const SceneData& data);

// A scene of the plugin; released with this.
class PluginScene {
  public:
    PluginScene(const PluginContext& context, Log& log) : m_context(context), m_log(log) {}
    ~PluginScene();
    PluginScene(const PluginScene&) = delete;
    PluginScene& operator=(const PluginScene&) = delete;

    struct Request {
        const SceneData& data;
        const std::string& sceneName;  // for messages
        Subdivide subdivide{};
        const CameraPose& camera;
    };
    // Hands everything over and commits it. Errors: those of the plugin, as exitCodeOf.
    void build(const Request& request, const ColourPipeline& colour, MaterialBuilder& materials);

    PmrScene handle() const { return m_handle; }
    const PluginContext& context() const { return m_context; }

  private:
    using Materials = std::vector<PmrMaterial>;

    static Materials buildMaterials(const SceneData& data, MaterialBuilder& materials);
    void addInstances(const Request& request, const Materials& materials);
    void addInstance(const InstanceData& instance, const SceneData& data, PmrMesh shape,
                     const Materials& materials, const std::string& where);
    PmrMesh createShape(const InstanceData& instance, const Request& request,
                        const std::string& where);
    PmrMesh createMesh(const MeshData& mesh, Subdivide subdivide, const std::string& where);
    void addLight(const LightData& light, const ColourPipeline& colour);
    void setEnvironment(const EnvironmentData& environment, const ColourPipeline& colour,
                        MaterialBuilder& materials);
    void setCamera(const CameraPose& camera);

    const PluginContext& m_context;
    Log& m_log;
    PmrScene m_handle{};
    uint32_t m_nextId{};
};

}  // namespace pm::host
