// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/render/plugin.h"
#include "host_shim/textures/texture_preparation.h"

namespace pm::host {

// Materials of the plugin from those of a file: numbers converted to the rendering space, pictures
// prepared in it. Releases what it made when it ends; scenes keep what they use.
class MaterialBuilder {
  public:
    // textures: makes what prepares them, called when a material has the first.
    using MakePreparer = std::function<TexturePreparer()>;
    MaterialBuilder(const PluginContext& context, const ColourPipeline& colour,
                    MakePreparer textures, const WarningSink& warn);
    ~MaterialBuilder();
    MaterialBuilder(const MaterialBuilder&) = delete;
    MaterialBuilder& operator=(const MaterialBuilder&) = delete;

    // Prepares all textures of these materials, several at once.
    void prepare(const std::vector<const MaterialData*>& materials);
    // How many textures were found, made and opened; all 0 without any.
    TextureCounts textureCounts() const;
    // Of the textures that were made: the prepared file, and the scene's own as messages name it.
    const std::map<std::string, std::string>& preparedFiles() const { return m_preparedFiles; }
    // What shines by a picture that can't be read gives no light: that is told and the lamp put
    // out.
    void putOutLights(SceneData& data);
    // Those that have a diffuse picture whose alpha is the outline of something, and nothing that
    // cuts them. Prepares these pictures.
    std::vector<const MaterialData*> cutUnasked(const std::vector<const MaterialData*>& materials);
    // A picture that can't be had is warned of; what stands for it is taken. Errors: those of the
    // plugin; HostError kMemory for one that takes more memory than it may.
    PmrMaterial build(const MaterialData& material);
    // One picture; null where there is none. of: what it is of, for messages.
    PmrTexture texture(const Boxed<TextureUse>& use, TextureKind kind, const std::string& of);
    // One that must be there. Errors: HostError where it can't be read.
    PmrTexture wantedTexture(const TextureUse& use, TextureKind kind);
    // One picture, or one that stands for all its tiles; null, with a warning, where none can be
    // read.
    PmrTexture picture(const TextureUse& use, const std::string& shown, TextureKind kind,
                       const std::string& of);
    std::string firstWith(bool TextureFacts::*fact, const TextureUse& use, TextureKind kind);
    void tellNormals(const TextureUse& use, const std::string& of);
    void tellAlpha(const TextureUse& use, const std::string& of);
    PmrTexture tiles(const TextureUse& use, TextureKind kind, const std::string& of);
    PmrTexture make(const PmrTextureDesc& desc, const std::string& shown);
    PmrTexture make(const TextureUse& use, const BakedTexture& baked, const std::string& shown);
    std::optional<BakedTexture> readable(const TextureUse& use, const std::string& shown,
                                         TextureKind kind, const std::string& of);
    static PmrTextureDesc lookedUpAs(const TextureUse& use);

  private:
    void tell(const std::string& file, const BakedTexture& baked);
    TexturePreparer& preparer();
    void setByName(const MaterialData& material, PmrMaterial handle, const std::string& of);
    // One that a sidecar gives. Errors: HostError, with its place.
    void setNamed(const NamedValue& value, PmrMaterial handle);
    // What makes it a mixture of its parts, which are built.
    void setMixture(const MaterialData& material, PmrMaterial handle, const std::string& of);
    void convertColours(const MaterialData& material, PmrMaterialDesc& desc) const;

    const PluginContext& m_context;
    const ColourPipeline& m_colour;
    MakePreparer m_makePreparer;
    const WarningSink& m_warn;
    std::optional<TexturePreparer> m_preparer;
    std::set<std::string> m_told;  // texts about pictures
    std::map<std::string, std::string> m_preparedFiles;
    std::vector<PmrTexture> m_textures;
    std::vector<PmrMaterial> m_materials;
};

}  // namespace pm::host
