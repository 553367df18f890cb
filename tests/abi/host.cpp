// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/abi/host.h"

#include <dlfcn.h>

#include <stdexcept>

#include "tests/abi/box_scene.h"

#ifdef PM_SANITIZED
// OpenImageIO 2.4.7 deletes its texture system under another type than it was made with.
extern "C" __attribute__((visibility("default"), used)) const char* __asan_default_options() {
    return "new_delete_type_mismatch=0";
}
#endif

namespace pm::test {

const PmrApi& api() {
    static const PmrApi& table = []() -> const PmrApi& {
        void* module = dlopen(PM_PLUGIN_FILE, RTLD_NOW | RTLD_LOCAL);
        if (module == nullptr) throw std::runtime_error(dlerror());
        const auto getApi = reinterpret_cast<PmrGetApiFunction>(dlsym(module, "pmrGetApi"));
        const PmrApi* found = nullptr;
        if (getApi == nullptr || getApi(PMR_ABI_VERSION, &found) != PMR_OK)
            throw std::runtime_error("pmrGetApi");
        return *found;
    }();
    return table;
}

BoxHost::BoxHost(PmrMessageFunction message, void* user) {
    PmrContextDesc desc = PMR_INIT(PmrContextDesc);
    desc.message = message;
    desc.user = user;
    EXPECT_EQ(PMR_OK, api().createContext(&desc, &m_context));
    EXPECT_EQ(PMR_OK, makeBoxScene(&api(), m_context, &m_scene)) << lastError();
}

BoxHost::~BoxHost() {
    EXPECT_EQ(PMR_OK, api().releaseScene(m_scene));
    EXPECT_EQ(PMR_OK, api().releaseContext(m_context));
}

std::string BoxHost::lastError() const {
    return textOf([this](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
        return api().lastError(m_context, buffer, capacity, needed);
    });
}

PmrRender BoxHost::makeRender(const std::map<std::string, std::string>& settings,
                              const PmrRenderDesc* desc) const {
    PmrRender render = nullptr;
    EXPECT_EQ(PMR_OK, api().createRender(m_scene, desc, &render)) << lastError();
    std::map<std::string, std::string> all = {{"width", std::to_string(kWidth)},
                                              {"height", std::to_string(kHeight)},
                                              {"passes", "2"},
                                              {"photons", "4000"},
                                              {"bucketSize", "16"}};
    for (const auto& [name, value] : settings) all[name] = value;
    for (const auto& [name, value] : all)
        EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str())) << lastError();
    return render;
}

void addGreyBall(PmrContext context, PmrScene scene) {
    PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
    sphere.radius = 1;
    PmrMaterialDesc grey = PMR_INIT(PmrMaterialDesc);
    for (float& value : grey.diffuse) value = 0.5f;
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    PmrMaterial material = nullptr;
    EXPECT_EQ(PMR_OK, api().createSphere(context, &sphere, &instance.mesh));
    EXPECT_EQ(PMR_OK, api().createMaterial(context, &grey, &material));
    instance.materials = &material;
    instance.materialCount = 1;
    EXPECT_EQ(PMR_OK, api().addInstance(scene, &instance));
    EXPECT_EQ(PMR_OK, api().releaseMesh(instance.mesh));
    EXPECT_EQ(PMR_OK, api().releaseMaterial(material));
}

std::vector<float> readLayer(PmrRender render, const char* layer, std::uint32_t channels,
                             PmrRectangle r) {
    const auto width = static_cast<std::size_t>(r.x1 - r.x0);
    const auto height = static_cast<std::size_t>(r.y1 - r.y0);
    std::vector<float> pixels(width * height * channels, -7.0f);
    EXPECT_EQ(PMR_OK, api().readPixels(render, &r, layer, pixels.data(), 0, 0));
    return pixels;
}

std::vector<float> renderBox(const BoxHost& host,
                             const std::map<std::string, std::string>& settings,
                             PmrRectangle rectangle) {
    const PmrRender render = host.makeRender(settings);
    EXPECT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0)) << host.lastError();
    std::vector<float> pixels = readLayer(render, "beauty", 4, rectangle);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    return pixels;
}

}  // namespace pm::test
