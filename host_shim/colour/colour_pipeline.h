// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_shim/colour/display_transform.h"
#include "host_shim/colour/picture_statement.h"
#include "host_shim/colour/space_conversion.h"
#include "host_shim/colour/transfer_curve.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

using Rgb3 = std::array<float, 3>;
// Row-major 3 x 3.
using Matrix3 = std::array<double, 9>;

// What the command line says about colour. An empty string means "not given".
struct ColourOptions {
    std::string ocioFile{};                                      // --ocio
    std::string renderingSpace{};                                // --rendering-space
    std::string materialSpace{};                                 // --material-space
    std::string textureSpace{};                                  // --texture-space
    std::string display{};                                       // --display
    std::string view{};                                          // --view
    std::string look{};                                          // --look
    std::vector<std::pair<std::string, std::string>> context{};  // --context KEY=VALUE, in order
};

// Splits KEY=VALUE at the first '='. Errors: kUsage without '=' or with an empty key.
std::pair<std::string, std::string> parseContextVariable(const std::string& text);

// One line of --list views or --list spaces.
struct ViewEntry {
    std::string display;
    std::string view;
    bool isDefault{};  // this display and view are taken when none is named
};
// One line of --list looks.
struct LookEntry {
    std::string name;
    std::string description;  // one line, may be empty
};
struct SpaceEntry {
    std::string name;
    std::vector<std::string> aliases;
    bool isData{};
    bool canRender{};  // scene-referred and linear, so --rendering-space takes it
    bool isRenderingSpace{};
    bool isBuiltIn{};  // pm's own, reached through the interchange role beside a user's config
};

// The space a texture's texels are in.
struct TextureSpace {
    std::string name;    // canonical, empty for data that is never converted
    bool isData{};       // texels are taken as they are
    bool fromBuiltIn{};  // name belongs to pm's own config, not to the user's
    // "-colorspace", "--texture-space", "file rules", "the file" or "default"
    std::string decidedBy;
    // Row-major, linear RGB to CIE XYZ (D65), where the file names primaries that no space has;
    // name is then empty.
    std::optional<Matrix3> toXyz{};
    // Where the file says how its codes stand for light: name and toXyz are that light's.
    std::optional<TransferCurve> curve{};
};

// The colour management of one render: a config, a rendering space in it, and what converts
// material colours, textures and display pixels. Immutable once made, so any thread may call the
// const functions at once. Touches no global state of OpenColorIO and none of the environment
// beyond reading OCIO and the variables that the config itself names.
class ColourPipeline {
  public:
    struct State;  // hides OpenColorIO

    // The config is options.ocioFile, else $OCIO when that is set and not empty, else the one built
    // in. All names in options are checked here, before any conversion is built.
    // Errors: kBadInput when the config is missing, broken or newer than the library, a name is
    // unknown (the text lists what is allowed and the option), the rendering space is data or not
    // linear, or the material space can't be reached for want of the role aces_interchange.
    explicit ColourPipeline(const ColourOptions& options);
    ~ColourPipeline();
    ColourPipeline(ColourPipeline&&) noexcept;
    ColourPipeline& operator=(ColourPipeline&&) noexcept;

    // Path of the config, or "built-in".
    const std::string& configName() const;
    bool hasBuiltInConfig() const;  // neither --ocio nor $OCIO gave one
    // Identifies config and context variables; part of the hash of a render.
    std::string cacheId() const;
    // Canonical name in the config.
    const std::string& renderingSpace() const;
    // ID of the colour-interop forum (lin_rec709_scene, lin_ap1_scene, ...), empty where unknown.
    const std::string& colorInteropId() const;

    // Rendering space to CIE XYZ adapted to a D65 white (Bradford): grey 1,1,1 has
    // XYZ 0.9505, 1, 1.0891. The second row holds the luminance weights. Found through the role
    // aces_interchange; without it there is none and warnings() says so.
    std::optional<Matrix3> renderingToXyzD65() const;
    // Luminance of rendering-space (1,0,0), (0,1,0), (0,0,1); Rec.709's where the matrix is
    // unknown.
    std::array<double, 3> luminanceWeights() const;
    // x,y of red, green, blue and white for the EXR attribute: the published figures of a known
    // space, else derived from the matrix; none where the matrix is unknown.
    std::optional<std::array<float, 8>> chromaticities() const;

    // A colour of a material or light, from --material-space (linear Rec.709 when not given).
    Rgb3 materialToRendering(const Rgb3& colour) const;

    // Decides the space of a colour texture: colorspaceOfMapLine (the -colorspace of its map line,
    // may be empty), else --texture-space, else a file rule of a config the user gave, other than
    // the Default rule, else what the file states of itself, else that Default rule unless the
    // config asks for strict parsing, else linear Rec.709 for float files and sRGB for integer
    // files. Errors: kBadInput for an unknown name in an option.
    TextureSpace textureSpace(const std::filesystem::path& file, bool isFloatFile,
                              const std::string& colorspaceOfMapLine,
                              const PictureStatement& statement = {}) const;
    // Errors: kBadInput when the space can't be reached for want of the role aces_interchange.
    SpaceConversion textureToRendering(const TextureSpace& space) const;

    // Canonical names of the display and view in use.
    const std::string& display() const;
    const std::string& view() const;
    // Errors: kBadInput when OpenColorIO can't build it; make it before the first ray when a
    // display-referred output is asked for.
    DisplayTransform displayTransform() const;

    // One-line texts for the log, found while the pipeline was made.
    const std::vector<std::string>& warnings() const;
    std::vector<ViewEntry> listViews() const;
    std::vector<LookEntry> listLooks() const;  // those that --look takes
    std::vector<SpaceEntry> listSpaces() const;

  private:
    std::unique_ptr<State> m_state;
};

}  // namespace pm::host
