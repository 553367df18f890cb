// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/values/boxed.h"

namespace pm::host {

// The one description of a scene: what readers of files fill and what PluginScene hands to the
// renderer. Plain arrays, no file format and no renderer in it.

// One picture of several that each fill a square of texture coordinates (UDIM).
struct TileUse {
    std::uint32_t number{};  // 1001 + column + 10 row
    std::string file;
};

// A picture on a material as the file asks for it; value = base + gain * texel.
struct TextureUse {
    std::string file;            // as it can be opened; of tiles with <UDIM> in its name
    std::vector<TileUse> tiles;  // those that there are
    std::string place;           // FILE:LINE of the statement that asks for it
    std::string colourSpace;     // of -colorspace; empty = decided by the rules for files
    bool isData{};               // never colour-converted
    bool clamp{};                // else repeated
    char channel{};              // of -imfchan: r g b m l z, or 0 where nothing is asked for
    std::array<float, 2> scale{1.0f, 1.0f};
    std::array<float, 2> offset{};
    float base{0.0f};
    float gain{1.0f};
    float strength{1.0f};  // of a normal map; of heights: scene units of a height of 1
    float missing{1.0f};   // what stands for it where it can't be read, times the number beside it
};

// "; " and this is told of a picture that can't be read: what stands for it.
std::string withoutPicture(float missing);

// A parameter of a material by its name, as docs/parameters.md lists them: numbers, or a text.
struct NamedValue {
    std::string name;
    std::vector<double> numbers;
    std::string text;
    std::string place;  // for messages
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
    // In [0, 1]; 0: by the exponent, or smooth. A surface's glossy part then is a coat that
    // reflects its colour at normal incidence and all at grazing angles, and takes that from what
    // is below.
    float roughness{};
    float coat{};  // clear, over all else: the share that it covers, in [0, 1]
    float coatRoughness{};
    std::array<float, 3> sheen{};  // of cloth, over a surface
    float sheenRoughness{0.3f};
    float anisotropy{};          // of the roughness, in [0, 1]
    float anisotropyRotation{};  // turns
    float ior{1.5f};
    std::array<float, 3> transmission{1.0f, 1.0f, 1.0f};
    std::array<float, 3> emission{};  // radiance, W m^-2 sr^-1
    bool emitsFromBothSides{};        // see addBackSides
    float transparency{};
    Boxed<TextureUse> diffuseTexture, glossyTexture, glossyExponentTexture, roughnessTexture,
        transmissionTexture, emissionTexture, opacityTexture,
        normalTexture,        // in tangent space
        bumpTexture,          // heights
        displacementTexture,  // heights of a cage's limit surface
        weightTexture;        // of a mixture: the share of its second part

    std::vector<NamedValue> byName;  // in place of what else is here
    // None, or the two of a mixture: then of the numbers above it has its own opacity, emission and
    // maps of normals, bumps and displacement alone.
    std::vector<MaterialData> parts;
    float weight{};  // of the second, times the texture

    bool emits() const { return emission[0] > 0 || emission[1] > 0 || emission[2] > 0; }
    // All that there may be, in the order above, then those of the parts.
    std::vector<const Boxed<TextureUse>*> textures() const {
        std::vector<const Boxed<TextureUse>*> all{
            &diffuseTexture,      &glossyTexture,       &glossyExponentTexture, &roughnessTexture,
            &transmissionTexture, &emissionTexture,     &opacityTexture,        &normalTexture,
            &bumpTexture,         &displacementTexture, &weightTexture};
        for (const MaterialData& part : parts)
            for (const Boxed<TextureUse>* use : part.textures()) all.push_back(use);
        return all;
    }
    // The materials that it is to be a mixture of, by name; empty of one that is none by name.
    std::vector<std::string> partNames() const {
        std::vector<std::string> names;
        for (const NamedValue& value : byName)
            if (value.name == "first" || value.name == "second") names.push_back(value.text);
        return names;
    }
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

// Faces that belong together, as of one o or g group. Positions are relative to SceneData::centre.
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

    // Of a vertex as indices name it; object space.
    std::array<double, 3> position(std::size_t vertex) const {
        return {positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]};
    }
};

// An axis-aligned box in world space, scene units.
struct Bounds {
    std::array<double, 3> low{}, high{};

    // Holds nothing; what is added begins it.
    static Bounds nothing();
    void add(const std::array<double, 3>& point);
    void add(const Bounds& other);
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

// Row-major 3 x 4, object to world: p' = M[:, 0:3] p + M[:, 3].
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

struct SphereData {
    std::string name;
    std::array<double, 3> centre{};  // object space
    double radius{};                 // scene units, > 0
};

// What an instance may be hidden from; bits of InstanceData::hiddenFrom.
inline constexpr std::uint32_t kHiddenFromCamera = 1, kHiddenFromShadow = 2,
                               kHiddenFromReflection = 4;

// A mesh or a sphere in its place.
struct InstanceData {
    enum class Shape { kMesh, kSphere };

    std::string name;
    Shape shape{Shape::kMesh};
    std::uint32_t index{};                 // into SceneData::meshes or SceneData::spheres
    std::optional<Transform> transform;    // none: as the file has it
    std::vector<std::uint32_t> materials;  // one for each slot; empty: those of the mesh
    std::uint32_t hiddenFrom{};            // kHiddenFrom..., added up; 0 = seen by all
};

// A light without area. Spots and directional lights shine along -z of their transform.
struct LightData {
    enum class Kind { kPoint, kSpot, kDirectional };

    std::string name;
    Kind kind{Kind::kPoint};
    Transform transform{kIdentity};
    // Point and spot: intensity, W/sr; directional: irradiance, W/m^2.
    std::array<float, 3> emission{};
    bool isInRenderingSpace{};  // the colour of emission; else the material space
    float coneAngle{};          // spot: half angle, radians, in (0, pi]
    float coneFalloff{};        // spot: radians, in [0, coneAngle]
    float angularRadius{};      // directional: half angle of the disc, radians, in [0, pi/2]
};

// Light from infinitely far all around; of the texture the middle lies towards -z, up is +y.
struct EnvironmentData {
    std::array<float, 3> radiance{};     // W m^-2 sr^-1, material space; times the texture
    Boxed<TextureUse> texture;           // latitude-longitude
    std::optional<Transform> transform;  // a rotation
};

// A clear sky by day, with the sun in it.
struct SkyData {
    double azimuth{};      // degrees: 0 is -z, 90 is +x; where z is up 0 is +y
    double elevation{45};  // degrees above the horizon, in (0, 90]
    double turbidity{3};   // in [1.7, 10]
    double strength{1};    // 0 or more
    bool isZUp{};
};

// What of a camera is not its place.
struct CameraLens {
    enum class Kind { kPerspective, kOrthographic, kPanorama };

    Kind kind{Kind::kPerspective};
    double height{};         // orthographic: scene units
    double lensRadius{};     // scene units; 0 = pinhole
    double focusDistance{};  // scene units
    double pixelAspect{};    // 0 = 1
};

// A camera that a file describes. What is left out is found as if nobody had said anything of it.
struct CameraData {
    std::string name;
    std::optional<Transform> transform;  // looks along -z, +y up; in place of the next three
    std::optional<std::array<double, 3>> eye, lookAt, up;
    std::optional<double> verticalFovDegrees;  // perspective, in (0,180)
    CameraLens lens;
};

struct SceneData {
    std::array<double, 3> centre{};  // what was subtracted from every position of a mesh
    Bounds bounds;                   // of what faces refer to and of spheres, in world space
    std::vector<MaterialData> materials;
    std::vector<MeshData> meshes;
    std::vector<SphereData> spheres;
    std::vector<InstanceData> instances;
    std::vector<LightData> lights;
    std::optional<EnvironmentData> environment;
    std::optional<SkyData> sky;  // in place of it
    std::vector<CameraData> cameras;
    std::uint64_t faceCount{};  // of all meshes
    std::vector<MaterialFile> materialFiles;
    std::vector<std::string> files;  // others that were read beside the scene's own
    std::string sidecar;             // the one of them that stands beside it; empty: none
    std::string explanation;         // lines that --explain prints before the plan; may be empty

    // One instance for each mesh, in its place.
    void placeEachMesh();
    // A material for each slot.
    const std::vector<std::uint32_t>& materialsOf(const InstanceData& instance) const;
    // From the positions of a mesh or sphere, which are relative to the centre, to world space.
    Transform toWorld(const InstanceData& instance) const;
    // Whether anything gives light.
    bool hasLight() const;
};

// a after b, as columns are transformed.
Transform product(const Transform& a, const Transform& b);
std::array<double, 3> transformed(const Transform& by, const std::array<double, 3>& point);
// By how much a transform changes volume; below 0 where it mirrors.
double determinant(const Transform& of);
// The box around a box that was transformed.
Bounds transformed(const Transform& by, const Bounds& box);

}  // namespace pm::host
