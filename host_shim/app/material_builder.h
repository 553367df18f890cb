// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/app/plugin.h"
#include "host_shim/app/temporary_folder.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/colour/texture_bake.h"
#include "host_shim/ingest/scene_data.h"
#include "host_shim/ingest/warnings.h"

#include <optional>
#include <vector>

namespace pm::host {

// Materials of the plugin from those of a file: numbers converted to the rendering space, pictures
// baked into it. Releases what it made when it ends; scenes keep what they use.
class MaterialBuilder {
  public:
    MaterialBuilder(const PluginContext& context, const ColourPipeline& colour,
                    TemporaryFolder& folder, const WarningSink& warn);
    ~MaterialBuilder();
    MaterialBuilder(const MaterialBuilder&) = delete;
    MaterialBuilder& operator=(const MaterialBuilder&) = delete;

    // A picture that can't be had is warned of and left out. Errors: those of the plugin.
    PmrMaterial build(const MaterialData& material);

  private:
    PmrTexture texture(const std::optional<TextureUse>& use, const std::string& material);
    void convertColours(const MaterialData& material, PmrMaterialDesc& desc) const;

    const PluginContext& m_context;
    const ColourPipeline& m_colour;
    TemporaryFolder& m_folder;
    const WarningSink& m_warn;
    std::optional<TextureBaker> m_baker;
    std::vector<PmrTexture> m_textures;
    std::vector<PmrMaterial> m_materials;
};

}  // namespace pm::host
