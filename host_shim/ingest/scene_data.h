// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pm::host {

// What is read from a scene file, as plain arrays: no file format and no renderer in it.

// A picture on a material as the file asks for it; value = base + gain * texel.
struct TextureUse {
    std::string file;         // as it can be opened
    std::string place;        // FILE:LINE of the statement that asks for it
    std::string colourSpace;  // of -colorspace; empty = decided by the rules for files
    bool isData{};            // never colour-converted
    bool clamp{};             // else repeated
    char channel{};           // of -imfchan: r g b m l z, or 0 where nothing is asked for
    std::array<float, 2> scale{1.0f, 1.0f};
    std::array<float, 2> offset{};
    float base{0.0f};
    float gain{1.0f};
};

enum class MaterialKind { kSurface, kMirror, kDielectric };

// A material in the numbers of the file: reflectances in [0,1] in the material space, checked.
struct MaterialData {
    std::string name;
    MaterialKind kind{MaterialKind::kSurface};
    bool fresnel{};
    std::array<float, 3> diffuse{0.8f, 0.8f, 0.8f};
    std::array<float, 3> glossy{};
    float glossyExponent{};
    float ior{1.5f};
    std::array<float, 3> transmission{1.0f, 1.0f, 1.0f};
    std::array<float, 3> emission{};  // radiance, W m^-2 sr^-1
    bool emitsFromBothSides{};        // see addBackSides
    float transparency{};
    std::optional<TextureUse> diffuseTexture, glossyTexture, glossyExponentTexture,
        transmissionTexture, emissionTexture, opacityTexture;

    bool emits() const { return emission[0] > 0 || emission[1] > 0 || emission[2] > 0; }
};

// How a cage is subdivided, from OpenSubdiv's t tags. Vertices and faces count inside the mesh.
struct CageTags {
    std::vector<std::uint32_t> creases;  // pairs of vertices
    std::vector<float> creaseSharpness;
    std::vector<std::uint32_t> corners;
    std::vector<float> cornerSharpness;
    std::vector<std::uint32_t> holes;
    int boundary{1};  // RenderMan's numbers: 0 none, 1 edge and corner, 2 edge only
    // Texture coordinates, OpenSubdiv's numbers: 0 smooth, 1 corners stay, 2 and 3 also where
    // charts meet, 4 linear along the edges of charts, 5 linear everywhere.
    int faceVarying{4};
};

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

// The faces of one o or g group. Positions are relative to SceneData::centre.
struct MeshData {
    std::string name;
    std::vector<float> positions;
    std::vector<float> normals;
    std::vector<float> uvs;
    std::vector<std::uint32_t> faceSizes;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> normalIndices;  // kNoIndex where a corner has none; may be empty
    std::vector<std::uint32_t> uvIndices;
    std::vector<std::uint32_t> faceSlots;      // a slot for each face
    std::vector<std::uint32_t> slotMaterials;  // slot -> index into SceneData::materials
    std::optional<CageTags> tags;
};

// An axis-aligned box in world space, scene units.
struct Bounds {
    std::array<double, 3> low{}, high{};

    std::array<double, 3> centre() const {
        return {low[0] + (high[0] - low[0]) / 2, low[1] + (high[1] - low[1]) / 2,
                low[2] + (high[2] - low[2]) / 2};
    }
};

// A material library that was read, and the dialect that was taken for it.
struct MaterialFile {
    std::string file;
    std::string dialect;  // as --mtl-dialect names it
    std::string reason;
};

struct SceneData {
    std::array<double, 3> centre{};  // what was subtracted from every position
    Bounds bounds;                   // of what faces refer to
    std::vector<MaterialData> materials;
    std::vector<MeshData> meshes;
    std::uint64_t faceCount{};
    std::vector<MaterialFile> materialFiles;

    // Whether any face has a material that emits.
    bool hasLight() const;
};

}  // namespace pm::host
