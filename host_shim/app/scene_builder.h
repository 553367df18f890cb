// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/app/material_builder.h"
#include "host_shim/app/plugin.h"
#include "host_shim/cli/options.h"
#include "host_shim/ingest/framing.h"
#include "host_shim/ingest/scene_data.h"

namespace pm::host {

// A scene of the plugin; released with this.
class PluginScene {
  public:
    explicit PluginScene(const PluginContext& context) : m_context(context) {}
    ~PluginScene();
    PluginScene(const PluginScene&) = delete;
    PluginScene& operator=(const PluginScene&) = delete;

    // Hands everything over and commits it. sceneName is for messages. A scene without any light
    // gets one at the camera, with a warning. Errors: those of the plugin, as exitCodeOf.
    void build(const SceneData& data, const std::string& sceneName, Subdivide subdivide,
               const CameraPose& camera, const ColourPipeline& colour, MaterialBuilder& materials,
               const WarningSink& warn);

    PmrScene handle() const { return m_handle; }
    const PluginContext& context() const { return m_context; }

  private:
    void addMesh(const MeshData& mesh, const SceneData& data, const std::string& sceneName,
                 Subdivide subdivide, const std::vector<PmrMaterial>& materials);
    void addDefaultLight(const CameraPose& camera, const Bounds& bounds);

    const PluginContext& m_context;
    PmrScene m_handle{};
    uint32_t m_nextId{};
};

}  // namespace pm::host
