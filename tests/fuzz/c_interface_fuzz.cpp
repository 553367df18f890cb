// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input are calls of the C interface, one after the other, with structs, arrays and handles as
// it has them. Pointers are those that a host could give: null, or to what is there.
#include <array>
#include <vector>

#include "tests/fuzz/fuzz_renders.h"
#include "tests/fuzz/fuzz_support.h"

using namespace pm::fuzz;

namespace {

template <typename Handle>
Handle pick(Bytes& bytes, const std::vector<Handle>& handles) {
    const std::uint8_t index = bytes.take<std::uint8_t>();
    if (index >= 250) return reinterpret_cast<Handle>(bytes.take<std::uintptr_t>());
    return handles.empty() ? nullptr : handles[index % handles.size()];
}

template <typename Value>
std::vector<Value> some(Bytes& bytes, std::size_t count, Value (*one)(Bytes&)) {
    std::vector<Value> values(count);
    for (Value& value : values) value = one(bytes);
    return values;
}

std::uint32_t takeIndex(Bytes& bytes) {
    const std::uint8_t index = bytes.take<std::uint8_t>();
    return index < 240 ? index % 10 : bytes.take<std::uint32_t>();
}
float takeFloat(Bytes& bytes) {
    return bytes.single();
}
double takeDouble(Bytes& bytes) {
    return bytes.number();
}

// One run's handles, let go at its end.
class Session {
  public:
    explicit Session(Bytes& bytes) : m_bytes(bytes) {
        PmrContextDesc desc = PMR_INIT(PmrContextDesc);
        desc.threads = 1;
        api().createContext(&desc, &m_context);
    }
    ~Session() {
        for (const PmrRender render : m_renders) api().destroyRender(render);
        for (const PmrScene scene : m_scenes) api().releaseScene(scene);
        for (const PmrMaterial material : m_materials) api().releaseMaterial(material);
        for (const PmrMesh mesh : m_meshes) api().releaseMesh(mesh);
        api().releaseContext(m_context);
    }

    void call() {
        switch (m_bytes.below(16)) {
            case 0:
            case 1:
                return mesh(false);
            case 2:
                return mesh(true);
            case 3:
                return sphere();
            case 4:
            case 5:
                return material();
            case 6:
                return keep(m_scenes, [&](PmrScene* made) {
                    return api().createScene(m_context, nullptr, made);
                });
            case 7:
            case 8:
                return instance();
            case 9:
                return light();
            case 10:
                return camera();
            case 11:
                api().commitScene(pick(m_bytes, m_scenes));
                return;
            case 12:
                return makeRender();
            case 13:
                return setting();
            case 14:
                return render();
            case 15:
                return odd();
        }
    }

  private:
    template <typename Handle, typename Make>
    void keep(std::vector<Handle>& handles, const Make& make) {
        Handle made = nullptr;
        if (handles.size() < 8 && make(&made) == PMR_OK) handles.push_back(made);
    }

    void mesh(bool isCage) {
        const std::size_t points = m_bytes.below(9), faces = m_bytes.below(7);
        const auto positions = some(m_bytes, 3 * points, takeFloat);
        std::vector<std::uint32_t> sizes, slots;
        std::size_t corners = 0;
        for (std::size_t i = 0; i < faces; ++i) {
            sizes.push_back(m_bytes.below(7));
            corners += sizes.back();
            slots.push_back(m_bytes.below(3));
        }
        const auto indices = some(m_bytes, corners, takeIndex);
        const auto uvs = some(m_bytes, 2 * points, takeFloat);
        const auto normals = some(m_bytes, 3 * points, takeFloat);
        PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
        desc.positions = positions.data();
        desc.positionCount = points;
        desc.faceSizes = sizes.data();
        desc.faceCount = faces;
        desc.indices = indices.data();
        desc.indexCount = corners;
        desc.slotCount = m_bytes.below(4);
        if (m_bytes.below(2) == 1) desc.materialSlots = slots.data();
        if (m_bytes.below(2) == 1) desc.uvs = uvs.data(), desc.uvCount = points;
        if (m_bytes.below(2) == 1) desc.normals = normals.data(), desc.normalCount = points;
        if (!isCage)
            return keep(m_meshes,
                        [&](PmrMesh* made) { return api().createMesh(m_context, &desc, made); });
        const std::size_t creases = m_bytes.below(4);
        const auto edges = some(m_bytes, 2 * creases, takeIndex);
        const auto sharpness = some(m_bytes, creases, takeFloat);
        PmrCageDesc cage = PMR_INIT(PmrCageDesc);
        cage.mesh = &desc;
        cage.scheme = static_cast<std::int32_t>(m_bytes.below(4));
        cage.boundary = static_cast<std::int32_t>(m_bytes.below(4));
        cage.creases = cage.corners = cage.holes = edges.data();
        cage.creaseSharpness = cage.cornerSharpness = sharpness.data();
        cage.creaseCount = creases;
        cage.cornerCount = m_bytes.below(static_cast<std::uint32_t>(creases) + 1);
        cage.holeCount = m_bytes.below(static_cast<std::uint32_t>(creases) + 1);
        cage.tessellationRate = m_bytes.below(5);
        keep(m_meshes, [&](PmrMesh* made) { return api().createCage(m_context, &cage, made); });
    }

    void sphere() {
        PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
        for (double& value : desc.centre) value = m_bytes.number();
        desc.radius = m_bytes.number();
        keep(m_meshes, [&](PmrMesh* made) { return api().createSphere(m_context, &desc, made); });
    }

    void material() {
        PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
        const std::string name = m_bytes.text(8);
        desc.name = name.c_str();
        desc.kind = static_cast<std::int32_t>(m_bytes.below(4));
        desc.fresnel = static_cast<std::int32_t>(m_bytes.below(3));
        for (float* values : {desc.diffuse, desc.glossy, desc.transmission, desc.emission})
            for (int i = 0; i < 3; ++i) values[i] = m_bytes.single();
        desc.glossyExponent = m_bytes.single();
        desc.ior = m_bytes.single();
        desc.transparency = m_bytes.single();
        keep(m_materials,
             [&](PmrMaterial* made) { return api().createMaterial(m_context, &desc, made); });
    }

    void instance() {
        const auto transform = some(m_bytes, 12, takeDouble);
        std::array<PmrMaterial, 3> materials{};
        for (PmrMaterial& material : materials) material = pick(m_bytes, m_materials);
        PmrInstanceDesc desc = PMR_INIT(PmrInstanceDesc);
        desc.mesh = pick(m_bytes, m_meshes);
        desc.materials = materials.data();
        desc.materialCount = m_bytes.below(4);
        if (m_bytes.below(2) == 1) desc.transforms = transform.data(), desc.transformCount = 1;
        api().addInstance(pick(m_bytes, m_scenes), &desc);
    }

    void light() {
        const auto transform = some(m_bytes, 12, takeDouble);
        PmrLightDesc desc = PMR_INIT(PmrLightDesc);
        desc.kind = static_cast<std::int32_t>(m_bytes.below(4));
        for (float& value : desc.emission) value = m_bytes.single();
        desc.coneAngle = m_bytes.single();
        desc.coneFalloff = m_bytes.single();
        desc.angularRadius = m_bytes.single();
        if (m_bytes.below(2) == 1) desc.transforms = transform.data(), desc.transformCount = 1;
        const PmrScene scene = pick(m_bytes, m_scenes);
        api().addLight(scene, &desc);
        PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
        for (float& value : sky.radiance) value = m_bytes.single();
        if (m_bytes.below(3) == 1) api().setEnvironment(scene, &sky);
    }

    void camera() {
        const auto transform = some(m_bytes, 12, takeDouble);
        PmrCameraDesc desc = PMR_INIT(PmrCameraDesc);
        desc.kind = static_cast<std::int32_t>(m_bytes.below(4));
        desc.fieldOfView = m_bytes.number();
        desc.lensRadius = m_bytes.below(4) == 1 ? m_bytes.number() : 0.0;
        desc.pixelAspect = m_bytes.below(4) == 1 ? m_bytes.number() : 0.0;
        desc.transforms = transform.data();
        desc.transformCount = m_bytes.below(3);
        if (desc.transformCount > 1) desc.transformCount = 0;
        api().setCamera(pick(m_bytes, m_scenes), &desc);
    }

    void makeRender() {
        keep(m_renders, [&](PmrRender* made) {
            return api().createRender(pick(m_bytes, m_scenes), nullptr, made);
        });
        if (m_renders.empty()) return;
        for (const auto& [name, value] : {std::pair{"width", "8"},
                                          {"height", "8"},
                                          {"bucketSize", "8"},
                                          {"passes", "1"},
                                          {"threads", "1"},
                                          {"photons", "16"},
                                          {"aaLevelMost", "1"}})
            api().setSettingText(m_renders.back(), name, value);
    }

    // Not those that take long or write files by the input's names.
    void setting() {
        static constexpr std::array<const char*, 12> kNames = {
            "crop", "bucketOrder", "aaLevel", "filter",  "integrator", "estimatePhotons",
            "seed", "layers",      "plan",    "buckets", "delivery",   "none of this name"};
        const PmrRender render = pick(m_bytes, m_renders);
        const char* name = kNames[m_bytes.below(static_cast<std::uint32_t>(kNames.size()))];
        if (m_bytes.below(2) == 1) {
            api().setSettingText(render, name, m_bytes.text(12).c_str());
        } else {
            api().setSettingInteger(render, name, m_bytes.take<std::int8_t>());
            api().setSettingNumber(render, name, m_bytes.number());
        }
    }

    void render() {
        const PmrRender render = pick(m_bytes, m_renders);
        static char text[1 << 16];
        api().explainRender(render, text, sizeof text, nullptr);
        if (api().startRender(render) == PMR_OK) api().waitRender(render, 1.0);
        std::array<float, 16 * 16 * 4> pixels{};
        const PmrRectangle area{-4, -4, 12, 12};
        api().readPixels(render, &area, "beauty", pixels.data(), 0, 0);
        api().renderStatistics(render, text, sizeof text, nullptr);
    }

    void odd() {
        const PmrScene scene = pick(m_bytes, m_scenes);
        const PmrRender render = pick(m_bytes, m_renders);
        std::array<double, 6> bounds{};
        std::array<char, 7> text{};
        std::uint64_t needed = 0;
        std::int32_t state = 0;
        api().sceneBounds(scene, bounds.data());
        api().lastError(m_context, text.data(), m_bytes.below(8), &needed);
        api().renderState(render, &state, nullptr);
        api().pollRender(render, 0.0);
        if (m_bytes.below(4) == 0) api().cancelRender(render);
        api().renderDelivery(render, &state);
        api().mergeMissing(reinterpret_cast<PmrMerge>(render), text.data(), text.size(), &needed);
    }

    Bytes& m_bytes;
    PmrContext m_context = nullptr;
    std::vector<PmrMesh> m_meshes;
    std::vector<PmrMaterial> m_materials;
    std::vector<PmrScene> m_scenes;
    std::vector<PmrRender> m_renders;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes bytes(data, size);
    Session session(bytes);
    for (int calls = 0; !bytes.isEmpty() && calls < 64; ++calls) session.call();
    return 0;
}
