// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/identity.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>

#include "plugin/src/call_error.h"
#include "plugin/src/setting_table.h"
#include "plugin/src/version.h"

namespace pm::plugin {

namespace {

// Feeds values to one checksum. Only types without padding are taken as bytes, and every array goes
// in with its length, so that no two different inputs feed the same bytes.
class Hasher {
  public:
    Hasher() : m_state(XXH3_createState()) { XXH3_128bits_reset(m_state.get()); }

    template <typename T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void add(T value) { XXH3_128bits_update(m_state.get(), &value, sizeof value); }
    void add(std::string_view text) {
        add(text.size());
        XXH3_128bits_update(m_state.get(), text.data(), text.size());
    }
    template <typename T>
    void addArray(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
        add(values.size());
        XXH3_128bits_update(m_state.get(), values.data(), values.size_bytes());
    }
    void add(const Rgb& c) {
        add(c.r);
        add(c.g);
        add(c.b);
    }
    void add(const Vec3d& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    }
    std::string text() const {
        const XXH128_hash_t hash = XXH3_128bits_digest(m_state.get());
        return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    }

  private:
    struct Free {
        void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
    };
    std::unique_ptr<XXH3_state_t, Free> m_state;
};

void addMesh(Hasher& hasher, const TriangleMesh& mesh) {
    hasher.addArray<Vec3f>(mesh.positions);
    hasher.addArray<TriangleMesh::Corners>(mesh.triangles);
    hasher.addArray<Vec3f>(mesh.normals);
    hasher.addArray<TriangleMesh::Corners>(mesh.normalIndices);
    hasher.addArray<Vec2f>(mesh.texcoords);
    hasher.addArray<TriangleMesh::Corners>(mesh.texcoordIndices);
    hasher.addArray<std::uint32_t>(mesh.materials);
}

void addMaterial(Hasher& hasher, const MaterialDescription& m) {
    hasher.add(m.kind);
    hasher.add(m.fresnelMirror);
    hasher.add(m.diffuse);
    hasher.add(m.glossy);
    hasher.add(m.glossyExponent);
    hasher.add(m.ior);
    hasher.add(m.transmission);
    hasher.add(m.emission);
    hasher.add(m.transparency);
    for (const std::int32_t texture : {m.diffuseTexture, m.glossyTexture, m.glossyExponentTexture,
                                       m.transmissionTexture, m.emissionTexture, m.opacityTexture})
        hasher.add(texture);
}

void addInstance(Hasher& hasher, const InstanceDescription& instance) {
    hasher.add(instance.shape.index());
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
        addMesh(hasher, **mesh);
    } else {
        const auto& sphere = std::get<SphereShape>(instance.shape);
        hasher.add(sphere.centre);
        hasher.add(sphere.radius);
    }
    hasher.addArray<double>(instance.transform);
    hasher.addArray<std::uint32_t>(instance.materials);
}

}  // namespace

std::string sceneHash(const Scene& scene, const SceneTextures& textures) {
    const SceneDescription& d = scene.description();
    Hasher hasher;
    hasher.add(std::string_view(scene.isa()));
    hasher.add(std::string_view(d.renderingSpace));
    hasher.addArray<double>(d.rgbToXyz);
    hasher.add(d.instances.size());
    for (const InstanceDescription& instance : d.instances) addInstance(hasher, instance);
    hasher.add(d.materials.size());
    for (const MaterialDescription& material : d.materials) addMaterial(hasher, material);
    hasher.add(d.pointLights.size());
    for (const PointLightDescription& light : d.pointLights) {
        hasher.add(light.position);
        hasher.add(light.intensity);
    }
    hasher.add(d.camera.has_value());
    if (d.camera) {
        hasher.addArray<double>(d.camera->cameraToWorld);
        hasher.add(d.camera->verticalFieldOfView);
        hasher.add(d.camera->pixelAspect);
    }
    for (const TexturePicture* picture : textures.pictures()) {
        hasher.addArray<std::uint64_t>(texelHash(picture->fileName));
        hasher.add(static_cast<int>(picture->wrapS));
        hasher.add(static_cast<int>(picture->wrapT));
        for (const float v : {picture->uvScale.x, picture->uvScale.y, picture->uvOffset.x,
                              picture->uvOffset.y, picture->gain, picture->base})
            hasher.add(v);
    }
    return hasher.text();
}

std::string settingsHash(const SettingValues& settings) {
    Hasher hasher;
    hasher.add(std::string_view(versionText()));
    for (const SettingSpec& spec : settingSpecs()) {
        if (!spec.changesPixels || spec.id == Setting::kPasses) continue;
        hasher.add(std::string_view(spec.name));
        hasher.add(std::string_view(settings.text(spec.id)));
    }
    return hasher.text();
}

}  // namespace pm::plugin
