// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/alloc/small_host.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <utility>

namespace pm::test {

namespace {

constexpr std::int32_t kSide = 8;

// A name in a folder, without taking memory.
struct FileName {
    std::array<char, 512> text{};

    FileName(const char* folder, const char* name) {
        std::snprintf(text.data(), text.size(), "%s/%s", folder, name);
    }
    operator const char*() const { return text.data(); }
};

// The handles of one walk, let go in the end whatever came of it.
class SmallHost {
  public:
    SmallHost(const PmrApi& api, const char* folder, WalkResult& result)
        : m_api(api), m_folder(folder), m_result(result) {
        PmrContextDesc desc = PMR_INIT(PmrContextDesc);
        desc.threads = 1;
        desc.message = [](void*, PmrRender, std::int32_t, std::int32_t, const char*) {};
        must(m_api.createContext(&desc, &m_context), "createContext");
    }
    SmallHost(const SmallHost&) = delete;
    SmallHost& operator=(const SmallHost&) = delete;
    ~SmallHost() {
        if (m_render != nullptr) must(m_api.destroyRender(m_render), "destroyRender");
        if (m_merge != nullptr) must(m_api.releaseMerge(m_merge), "releaseMerge");
        if (m_scene != nullptr) must(m_api.releaseScene(m_scene), "releaseScene");
        if (m_material != nullptr) must(m_api.releaseMaterial(m_material), "releaseMaterial");
        if (m_texture != nullptr) must(m_api.releaseTexture(m_texture), "releaseTexture");
        for (const PmrMesh mesh : m_meshes)
            if (mesh != nullptr) must(m_api.releaseMesh(mesh), "releaseMesh");
        if (m_context != nullptr) must(m_api.releaseContext(m_context), "releaseContext");
    }

    // Whether the walk goes on.
    bool must(PmrStatus status, const char* call) {
        if (status == PMR_OK || m_result.firstFailure != PMR_OK) return status == PMR_OK;
        m_result.firstFailure = status;
        m_result.failedCall = call;
        std::array<char, 8> text{};
        m_api.lastError(nullptr, text.data(), text.size(), nullptr);
        m_result.hasText = text[0] != 0;
        return false;
    }
    // Of a call that can't be right: with this status, or for lack of memory.
    void mustFail(PmrStatus found, PmrStatus wanted, const char* call) {
        if (found == wanted) return;
        must(found, call);
        if (found == PMR_OK) m_result.isRefused = false;
    }

    bool makeTriangle();
    bool makeSolids();
    bool makeTexture(const char* name);
    bool makeMaterial();
    bool openScene() {
        return must(m_api.createScene(m_context, nullptr, &m_scene), "createScene");
    }
    bool addMesh(std::size_t index);
    bool addLights();
    bool setCamera();
    bool commit() { return must(m_api.commitScene(m_scene), "commitScene"); }
    bool makeTriangleScene() {
        return makeTriangle() && makeMaterial() && openScene() && addMesh(0) && addLights() &&
               setCamera() && commit();
    }

    bool makeRender(std::int32_t callbackMode = PMR_CALLBACKS_THREAD);
    bool set(const char* name, const char* value) {
        return must(m_api.setSettingText(m_render, name, value), name);
    }
    bool run() {
        return must(m_api.startRender(m_render), "startRender") &&
               must(m_api.waitRender(m_render, -1.0), "waitRender");
    }
    bool poll();
    bool endRender() {
        const PmrRender render = std::exchange(m_render, nullptr);
        return must(m_api.destroyRender(render), "destroyRender");
    }
    bool readPixels();
    bool readTexts();
    bool renderPart(const char* part, const char* buckets);
    bool merge();

    const PmrApi& api() const { return m_api; }
    const char* folder() const { return m_folder; }
    PmrContext context() const { return m_context; }
    PmrScene scene() const { return m_scene; }
    PmrRender render() const { return m_render; }
    PmrMerge mergeHandle() const { return m_merge; }

  private:
    void addToSum(const float* values, std::size_t count);

    const PmrApi& m_api;
    const char* m_folder;
    WalkResult& m_result;
    PmrContext m_context = nullptr;
    std::array<PmrMesh, 3> m_meshes{};
    PmrTexture m_texture = nullptr;
    PmrMaterial m_material = nullptr;
    PmrScene m_scene = nullptr;
    PmrRender m_render = nullptr;
    PmrMerge m_merge = nullptr;
};

constexpr float kSquare[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
constexpr std::uint32_t kCorners[4] = {0, 1, 2, 3};

bool SmallHost::makeTriangle() {
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = kSquare;
    desc.positionCount = 3;
    desc.faceCount = 1;
    desc.indices = kCorners;
    desc.indexCount = 3;
    return must(m_api.createMesh(m_context, &desc, &m_meshes[0]), "createMesh");
}

// A triangle, a cage of one face and a sphere.
bool SmallHost::makeSolids() {
    const std::uint32_t size = 4;
    const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    PmrMeshDesc square = PMR_INIT(PmrMeshDesc);
    square.positions = kSquare;
    square.positionCount = 4;
    square.faceSizes = &size;
    square.faceCount = 1;
    square.indices = kCorners;
    square.indexCount = 4;
    square.uvs = uvs;
    square.uvCount = 4;
    PmrCageDesc cage = PMR_INIT(PmrCageDesc);
    cage.mesh = &square;
    cage.tessellationRate = 1;
    PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
    sphere.radius = 0.5;
    return makeTriangle() && must(m_api.createCage(m_context, &cage, &m_meshes[1]), "createCage") &&
           must(m_api.createSphere(m_context, &sphere, &m_meshes[2]), "createSphere");
}

bool SmallHost::makeTexture(const char* name) {
    const FileName file(m_folder, name);
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.fileName = file;
    return must(m_api.createTexture(m_context, &desc, &m_texture), "createTexture");
}

bool SmallHost::makeMaterial() {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.name = "a surface with a name that needs memory of its own";
    for (float& value : desc.diffuse) value = 0.5f;
    desc.diffuseTexture = m_texture;
    return must(m_api.createMaterial(m_context, &desc, &m_material), "createMaterial");
}

bool SmallHost::addMesh(std::size_t index) {
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    instance.mesh = m_meshes[index];
    instance.materials = &m_material;
    instance.materialCount = 1;
    instance.name = "an instance with a name that needs memory of its own";
    return must(m_api.addInstance(m_scene, &instance), "addInstance");
}

bool SmallHost::addLights() {
    const double above[12] = {1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 2};
    PmrLightDesc light = PMR_INIT(PmrLightDesc);
    light.transforms = above;
    light.transformCount = 1;
    for (float& value : light.emission) value = 5.0f;
    return must(m_api.addLight(m_scene, &light), "addLight");
}

bool SmallHost::setCamera() {
    const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3};
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.transforms = transform;
    camera.transformCount = 1;
    camera.fieldOfView = 0.7;
    return must(m_api.setCamera(m_scene, &camera), "setCamera");
}

bool SmallHost::makeRender(std::int32_t callbackMode) {
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = callbackMode;
    desc.message = [](void*, PmrRender, std::int32_t, std::int32_t, const char*) {};
    desc.progress = [](void*, PmrRender, double, double) {};
    desc.bucketStarted = desc.bucketFinished = [](void*, PmrRender, const PmrBucketInfo*) {};
    return must(m_api.createRender(m_scene, &desc, &m_render), "createRender") &&
           set("width", "8") && set("height", "8") && set("bucketSize", "8") &&
           set("passes", "1") && set("photons", "16") && set("threads", "1");
}

bool SmallHost::poll() {
    if (!must(m_api.startRender(m_render), "startRender")) return false;
    PmrStatus status = PMR_OK;
    while (status == PMR_OK || status == PMR_ERROR_TIMEOUT) status = m_api.pollRender(m_render, -1);
    mustFail(status, PMR_ERROR_STATE, "pollRender");
    return must(m_api.waitRender(m_render, 0), "waitRender");
}

void SmallHost::addToSum(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &values[i], sizeof bits);
        m_result.pixels = (m_result.pixels ^ bits) * 1099511628211u;  // FNV-1a
    }
}

bool SmallHost::readPixels() {
    std::array<float, 4 * kSide * kSide> pixels{};
    const PmrRectangle frame{0, 0, kSide, kSide};
    if (!must(m_api.readPixels(m_render, &frame, "beauty", pixels.data(), 0, 0), "readPixels"))
        return false;
    addToSum(pixels.data(), pixels.size());
    return true;
}

bool SmallHost::readTexts() {
    static std::array<char, 1 << 16> text;
    std::uint32_t count = 0;
    PmrLayerInfo layer = PMR_INIT(PmrLayerInfo);
    return must(m_api.explainRender(m_render, text.data(), text.size(), nullptr),
                "explainRender") &&
           must(m_api.settingText(m_render, "photonMap", text.data(), text.size(), nullptr),
                "settingText") &&
           must(m_api.renderLayerCount(m_render, &count), "renderLayerCount") &&
           must(m_api.renderLayerInfo(m_render, 0, &layer), "renderLayerInfo") &&
           must(m_api.renderStatistics(m_render, text.data(), text.size(), nullptr),
                "renderStatistics");
}

bool SmallHost::renderPart(const char* part, const char* buckets) {
    const FileName file(m_folder, part);
    return makeRender() && set("width", "16") && set("buckets", buckets) && set("part", file) &&
           run() && endRender();
}

bool SmallHost::merge() {
    static std::array<char, 1 << 16> text;
    std::array<float, 8 * kSide * kSide> pixels{};
    const PmrRectangle frame{0, 0, 2 * kSide, kSide};
    const FileName first(m_folder, "first.part"), second(m_folder, "second.part");
    if (!must(m_api.createMerge(m_context, &m_merge), "createMerge") ||
        !must(m_api.addPart(m_merge, first), "addPart") ||
        !must(m_api.addPart(m_merge, second), "addPart") ||
        !must(m_api.mergeMissing(m_merge, text.data(), text.size(), nullptr), "mergeMissing") ||
        !must(m_api.mergeStatistics(m_merge, text.data(), text.size(), nullptr),
              "mergeStatistics") ||
        !must(m_api.readMergedPixels(m_merge, &frame, "beauty", pixels.data(), 0, 0),
              "readMergedPixels"))
        return false;
    addToSum(pixels.data(), pixels.size());
    return true;
}

void walkRender(const PmrApi& api, const char* folder, WalkResult& result) {
    SmallHost host(api, folder, result);
    if (host.makeTriangleScene() && host.makeRender() && host.run() && host.readPixels())
        host.readTexts();
}

void walkPoll(const PmrApi& api, const char* folder, WalkResult& result) {
    SmallHost host(api, folder, result);
    if (host.makeTriangleScene() && host.makeRender(PMR_CALLBACKS_POLL) && host.poll())
        host.readPixels();
}

void walkObjects(const PmrApi& api, const char* folder, WalkResult& result) {
    SmallHost host(api, folder, result);
    if (host.makeSolids() && host.makeTexture("four.ppm") && host.makeMaterial() &&
        host.openScene() && host.addMesh(0) && host.addMesh(1) && host.addMesh(2) &&
        host.addLights() && host.setCamera())
        host.commit();
}

void walkErrors(const PmrApi& api, const char* folder, WalkResult& result) {
    PmrContextDesc badIsa = PMR_INIT(PmrContextDesc);
    badIsa.isa = "an instruction set of no processor";
    PmrContext none = nullptr;
    SmallHost host(api, folder, result);
    host.mustFail(api.createContext(&badIsa, &none), PMR_ERROR_ARGUMENT, "createContext");
    if (host.context() == nullptr) return;
    host.mustFail(api.commitScene(nullptr), PMR_ERROR_HANDLE, "commitScene");
    const FileName missing(folder, "missing.ppm");
    PmrTextureDesc texture = PMR_INIT(PmrTextureDesc);
    texture.fileName = missing;
    PmrTexture noTexture = nullptr;
    host.mustFail(api.createTexture(host.context(), &texture, &noTexture), PMR_ERROR_IO,
                  "createTexture");
    const FileName noPicture(folder, "text.ppm");
    texture.fileName = noPicture;
    host.mustFail(api.createTexture(host.context(), &texture, &noTexture), PMR_ERROR_IO,
                  "createTexture");
    if (!host.openScene()) return;
    host.mustFail(api.commitScene(host.scene()), PMR_ERROR_SCENE, "commitScene");
    if (!host.makeTriangle() || !host.makeMaterial() || !host.addMesh(0) || !host.commit() ||
        !host.makeRender())
        return;
    host.mustFail(api.startRender(host.render()), PMR_ERROR_SCENE, "startRender");
    host.mustFail(api.setSettingText(host.render(), "photons", "many"), PMR_ERROR_ARGUMENT,
                  "setSettingText");
    host.mustFail(api.setSettingText(host.render(), "bokeh", "1"), PMR_ERROR_NAME,
                  "setSettingText");
}

void walkPieces(const PmrApi& api, const char* folder, WalkResult& result) {
    SmallHost host(api, folder, result);
    for (const char* file : {"first.part", "second.part", "checkpoint", "photons"})
        std::remove(FileName(folder, file));
    const FileName checkpoint(folder, "checkpoint"), photons(folder, "photons");
    if (!host.makeTriangleScene() || !host.renderPart("first.part", "0:1") ||
        !host.renderPart("second.part", "1:2") || !host.merge())
        return;
    if (!host.makeRender() || !host.set("photonMap", photons) || !host.set("photonsOnly", "1") ||
        !host.run() || !host.endRender())
        return;
    if (host.makeRender() && host.set("photonMap", photons) && host.set("checkpoint", checkpoint) &&
        host.set("resume", "1") && host.run())
        host.readPixels();
}

}  // namespace

const std::vector<Walk>& walks() {
    static const std::vector<Walk> walks = {{"render", walkRender},
                                            {"poll", walkPoll},
                                            {"objects", walkObjects},
                                            {"errors", walkErrors},
                                            {"pieces", walkPieces}};
    return walks;
}

}  // namespace pm::test
