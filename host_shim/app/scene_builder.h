// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/app/log.h"
#include "host_shim/app/material_builder.h"
#include "host_shim/app/plugin.h"
#include "host_shim/cli/options.h"
#include "host_shim/ingest/framing.h"
#include "host_shim/ingest/scene_data.h"

namespace pm::host {

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
        bool cameraLight{};  // with a point light at the camera, besides the scene's own
    };
    // Hands everything over and commits it. Errors: those of the plugin, as exitCodeOf.
    void build(const Request& request, const ColourPipeline& colour, MaterialBuilder& materials);

    PmrScene handle() const { return m_handle; }
    const PluginContext& context() const { return m_context; }

  private:
    void addMesh(const MeshData& mesh, const SceneData& data, const std::string& sceneName,
                 Subdivide subdivide, const std::vector<PmrMaterial>& materials);
    PmrMesh createMesh(const MeshData& mesh, Subdivide subdivide, const std::string& where);
    void addCameraLight(const CameraPose& camera, const Bounds& bounds);

    const PluginContext& m_context;
    Log& m_log;
    PmrScene m_handle{};
    uint32_t m_nextId{};
};

}  // namespace pm::host
