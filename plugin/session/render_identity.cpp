// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_identity.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "plugin/parameters/parameter_set.h"
#include "plugin/session/setting_table.h"
#include "plugin/values/call_error.h"
#include "plugin/values/hasher.h"
#include "plugin/values/version.h"

namespace pm::plugin {

namespace {

constexpr std::uint32_t kPassesOfLevel1 = 4;
constexpr const char* kCameraPart = "camera";

void addMesh(Hasher& hasher, const TriangleMesh& mesh) {
    hasher.addArray<Vec3f>(mesh.positions);
    hasher.addArray<TriangleMesh::Corners>(mesh.triangles);
    hasher.addArray<Vec3f>(mesh.normals);
    hasher.addArray<TriangleMesh::Corners>(mesh.normalIndices);
    hasher.addArray<Vec2f>(mesh.texcoords);
    hasher.addArray<TriangleMesh::Corners>(mesh.texcoordIndices);
    hasher.addArray<std::uint32_t>(mesh.materials);
}

void addLimit(Hasher& hasher, const LimitShape& shape) {
    const SubdivisionCage& cage = shape.cage();
    hasher.add("limit");
    hasher.addArray<Vec3f>(cage.mesh.positions);
    hasher.addArray<std::uint32_t>(cage.mesh.faceVertexCounts);
    hasher.addArray<std::uint32_t>(cage.mesh.vertexIndices);
    hasher.addArray<Vec2f>(cage.mesh.texcoords);
    hasher.addArray<std::int32_t>(cage.mesh.texcoordIndices);
    hasher.addArray<std::uint32_t>(cage.mesh.faceMaterials);
    for (const int rule : {static_cast<int>(cage.scheme), static_cast<int>(cage.boundary),
                           static_cast<int>(cage.faceVarying), static_cast<int>(cage.creaseMethod),
                           static_cast<int>(cage.smoothTriangles), shape.rate()})
        hasher.add(rule);
    hasher.add(cage.creases.size());
    for (const Crease& crease : cage.creases) {
        hasher.add(crease.vertices[0]);
        hasher.add(crease.vertices[1]);
        hasher.add(crease.sharpness);
    }
    hasher.add(cage.corners.size());
    for (const SharpCorner& corner : cage.corners) {
        hasher.add(corner.vertex);
        hasher.add(corner.sharpness);
    }
    hasher.addArray<std::uint32_t>(cage.holes);
}

void addInstance(Hasher& hasher, const InstanceDescription& instance, const SceneTables& tables) {
    // As they were numbered before there were limit shapes: scenes keep the checksums that they
    // have had.
    const Shape given = instance.cutOf ? Shape(instance.cutOf) : instance.shape;
    const std::size_t kind = given.index();
    hasher.add(kind > 1 ? kind - 1 : 2 * kind);
    std::visit(
        [&](const auto& shape) {
            using Kind = std::decay_t<decltype(shape)>;
            if constexpr (std::is_same_v<Kind, std::shared_ptr<const TriangleMesh>>)
                addMesh(hasher, *shape);
            else if constexpr (std::is_same_v<Kind, std::shared_ptr<const LimitShape>>)
                addLimit(hasher, *shape);
            else
                hashRows(hasher, rowsOf<Kind>(tables.shapes), shape);
        },
        given);
    hashRows(hasher, tables.instances, instance);
}

// The number of point lights and theirs, then only what is there: scenes without keep the checksums
// that they have had.
void addLights(Hasher& hasher, const SceneDescription& d, const SceneTables& tables) {
    using Point = PointLightDescription;
    hasher.add(static_cast<std::size_t>(std::ranges::count_if(
        d.lights, [](const auto& light) { return std::holds_alternative<Point>(light); })));
    forEachByKind(d.lights, [&](const auto& light) {
        if (!std::is_same_v<std::decay_t<decltype(light)>, Point>) hasher.add(light.kName);
        hashRows(hasher, tables.lights, light);
    });
    if (!d.environment) return;
    hasher.add("environment");
    hashRows(hasher, tables.environments, *d.environment);
}

void addTexture(Hasher& hasher, const TexturePicture& picture, const CancelCheck& cancel) {
    const bool isKnown = picture.texelHash != std::array<std::uint64_t, 2>{};
    hasher.addArray<std::uint64_t>(isKnown ? picture.texelHash
                                           : texelHash(picture.fileName, cancel));
    hasher.add(static_cast<int>(picture.wrapS));
    hasher.add(static_cast<int>(picture.wrapT));
    for (const float v : {picture.uvScale.x, picture.uvScale.y, picture.uvOffset.x,
                          picture.uvOffset.y, picture.gain, picture.base})
        hasher.add(v);
}

// In place of numbers that change when something else comes or goes: 28 bits of a checksum, so that
// it is no kNoTexture.
template <typename Feed>
std::uint32_t numberOf(Feed feed) {
    constexpr std::size_t kDigits = 7;
    return static_cast<std::uint32_t>(std::stoul(checksumOf(feed).substr(0, kDigits), nullptr, 16));
}

void putNumber(std::int32_t& texture, const SceneTextures& textures) {
    if (texture == kNoTexture) return;
    texture = static_cast<std::int32_t>(numberOf([&](Hasher& hasher) {
        for (const TexturePicture* picture : textures.picturesOf(texture))
            addTexture(hasher, *picture, {});
    }));
}

std::uint32_t numberOf(const MaterialDescription& material) {
    return numberOf([&](Hasher& hasher) { hasher.add(std::string_view(material.name)); });
}

MaterialDescription byNames(const MaterialDescription& material, const SceneDescription& d,
                            const SceneTextures& textures) {
    using M = MaterialDescription;
    MaterialDescription named = material;
    for (std::int32_t M::*member :
         {&M::diffuseTexture, &M::glossyTexture, &M::glossyExponentTexture, &M::roughnessTexture,
          &M::transmissionTexture, &M::emissionTexture, &M::opacityTexture, &M::normalTexture,
          &M::bumpTexture, &M::weightTexture, &M::displacementTexture})
        putNumber(named.*member, textures);
    if (material.kind == MaterialKind::kMixture)
        for (std::uint32_t M::*part : {&M::first, &M::second})
            named.*part = numberOf(d.materials.at(material.*part));
    return named;
}

InstanceDescription byNames(const InstanceDescription& instance, const SceneDescription& d) {
    InstanceDescription named = instance;
    for (std::uint32_t& material : named.materials) material = numberOf(d.materials.at(material));
    return named;
}

// Checksums by name, in the order of the names.
class NamedSums {
  public:
    template <typename Feed>
    void add(const char* kind, const std::string& name, Feed feed) {
        std::string& sum = m_sums[name.empty() ? kind : fmt::format("{} {}", kind, name)];
        const std::string own = checksumOf(feed);
        sum = sum.empty() ? own : checksumOf([&](Hasher& hasher) {
            hasher.add(std::string_view(sum));
            hasher.add(std::string_view(own));
        });
    }
    Identity identity() const {
        Identity identity;
        for (const auto& [name, sum] : m_sums) identity.push_back({name, sum});
        return identity;
    }

  private:
    std::map<std::string, std::string> m_sums;
};

}  // namespace

Identity sceneInputs(const Scene& scene, const SceneTextures& textures, const SceneTables& tables) {
    const SceneDescription& d = scene.description();
    NamedSums sums;
    for (const InstanceDescription& instance : d.instances)
        sums.add("object", instance.name,
                 [&](Hasher& hasher) { addInstance(hasher, byNames(instance, d), tables); });
    for (const MaterialDescription& material : d.materials)
        sums.add("material", material.name, [&](Hasher& hasher) {
            hashRows(hasher, tables.materials, byNames(material, d, textures));
        });
    forEachByKind(d.lights, [&](const auto& light) {
        sums.add("light", light.name,
                 [&](Hasher& hasher) { hashRows(hasher, tables.lights, light); });
    });
    if (d.environment)
        sums.add("environment", "", [&](Hasher& hasher) {
            EnvironmentDescription named = *d.environment;
            putNumber(named.texture, textures);
            hashRows(hasher, tables.environments, named);
        });
    if (d.camera)
        sums.add("camera", "",
                 [&](Hasher& hasher) { hashRows(hasher, tables.cameras, *d.camera); });
    for (const TexturePicture* picture : textures.pictures())
        sums.add("texture", picture->fileName,
                 [&](Hasher& hasher) { addTexture(hasher, *picture, {}); });
    return sums.identity();
}

Identity sceneIdentity(const Scene& scene, const SceneTextures& textures, const SceneTables& tables,
                       const CancelCheck& cancel) {
    const SceneDescription& d = scene.description();
    Identity identity = {{"instruction set", scene.isa()}, {"rendering space", d.renderingSpace}};
    const auto part = [&](const char* name, auto feed) {
        identity.push_back({name, checksumOf(feed)});
    };
    part("colour matrix", [&](Hasher& hasher) { hasher.addArray<double>(d.rgbToXyz); });
    part("geometry", [&](Hasher& hasher) {
        hasher.add(d.instances.size());
        for (const InstanceDescription& instance : d.instances) {
            cancel.throwIfSet("hashing the scene");
            addInstance(hasher, instance, tables);
        }
    });
    part("materials", [&](Hasher& hasher) {
        hasher.add(d.materials.size());
        for (const MaterialDescription& material : d.materials)
            hashRows(hasher, tables.materials, material);
    });
    part("lights", [&](Hasher& hasher) { addLights(hasher, d, tables); });
    part(kCameraPart, [&](Hasher& hasher) {
        hasher.add(d.camera.has_value());
        if (d.camera) hashRows(hasher, tables.cameras, *d.camera);
    });
    part("textures", [&](Hasher& hasher) {
        for (const TexturePicture* picture : textures.pictures())
            addTexture(hasher, *picture, cancel);
    });
    return identity;
}

Identity settingsIdentity(const SettingValues& settings) {
    Identity identity = {{"version", versionText()}};
    for (const SettingSpec& spec : settingSpecs()) {
        if (!spec.changesPixels || spec.id == Setting::kPasses) continue;
        identity.push_back({fmt::format("setting {}", spec.name), settings.text(spec.id)});
    }
    // Of the one sample of levels 0 and 1, the number of passes says in which of them it comes.
    const RenderSettings render = settings.toRenderSettings();
    const bool beginsWithGroups = render.hasGroups() && render.isAdaptive();
    if (render.aaLevel <= 1 && !beginsWithGroups && render.passes < kPassesOfLevel1)
        identity.push_back({"passes below level 2", fmt::format("{}", render.passes)});
    return identity;
}

Identity photonIdentity(const Identity& scene, const SettingValues& settings, const Plan& plan) {
    Identity identity = {{"version", versionText()}};
    std::ranges::copy_if(scene, std::back_inserter(identity),
                         [](const IdentityPart& part) { return part.name != kCameraPart; });
    identity.push_back({"setting seed", settings.text(Setting::kSeed)});
    // Not the setting, which may be left to the plan, and the plan to the size of the frame.
    identity.push_back({"photons a pass", fmt::format("{} global, {} caustic", plan.globalPhotons,
                                                      plan.causticPhotons)});
    identity.push_back({"share of caustic photons followed on", fmt::format("{}", plan.descent)});
    return identity;
}

Identity frameIdentity(const SettingValues& settings) {
    const Rect window = settings.window();
    Identity identity = {
        {"window", fmt::format("{},{},{},{}", window.x0, window.y0, window.x1, window.y1)}};
    std::string layers;
    for (const char* layer : {"albedo", "N", "Z"})
        if (settings.wantsLayer(layer)) layers += fmt::format("{} ", layer);
    identity.push_back({"layers", layers});
    std::string_view lines = settings.word(Setting::kHostIdentity);
    while (!lines.empty()) {
        const std::string_view line = lines.substr(0, lines.find('\n'));
        lines.remove_prefix(std::min(lines.size(), line.size() + 1));
        const std::size_t colon = std::min(line.find(": "), line.size());
        if (line.empty()) continue;
        identity.push_back({std::string(line.substr(0, colon)),
                            std::string(line.substr(std::min(colon + 2, line.size())))});
    }
    return identity;
}

}  // namespace pm::plugin
