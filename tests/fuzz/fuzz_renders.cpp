// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/fuzz/fuzz_renders.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/fuzz/fuzz_support.h"

namespace pm::fuzz {

namespace {

void must(PmrStatus status) {
    if (status != PMR_OK) std::abort();
}

PmrScene makeScene() {
    const float positions[9] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
    const std::uint32_t indices[3] = {0, 1, 2};
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = positions;
    desc.positionCount = 3;
    desc.faceCount = 1;
    desc.indices = indices;
    desc.indexCount = 3;
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    must(api().createMesh(context(), &desc, &instance.mesh));
    PmrMaterialDesc grey = PMR_INIT(PmrMaterialDesc);
    for (float& value : grey.diffuse) value = 0.5f;
    PmrMaterial material = nullptr;
    must(api().createMaterial(context(), &grey, &material));
    instance.materials = &material;
    instance.materialCount = 1;
    PmrScene scene = nullptr;
    must(api().createScene(context(), nullptr, &scene));
    must(api().addInstance(scene, &instance));
    const double above[12] = {1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 2};
    PmrLightDesc light = PMR_INIT(PmrLightDesc);
    light.transforms = above;
    light.transformCount = 1;
    for (float& value : light.emission) value = 5.0f;
    must(api().addLight(scene, &light));
    const double before[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3};
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.transforms = before;
    camera.transformCount = 1;
    camera.fieldOfView = 0.7;
    must(api().setCamera(scene, &camera));
    must(api().commitScene(scene));
    return scene;
}

}  // namespace

const PmrApi& api() {
    static const PmrApi* const table = [] {
        const PmrApi* found = nullptr;
        must(pmrGetApi(PMR_ABI_VERSION, &found));
        return found;
    }();
    return *table;
}

PmrContext context() {
    static const PmrContext context = [] {
        PmrContextDesc desc = PMR_INIT(PmrContextDesc);
        desc.threads = 1;
        PmrContext made = nullptr;
        must(api().createContext(&desc, &made));
        return made;
    }();
    return context;
}

PmrStatus renderTriangle(const Settings& settings) {
    static const PmrScene scene = makeScene();
    PmrRender render = nullptr;
    must(api().createRender(scene, nullptr, &render));
    Settings all = {{"width", "16"},  {"height", "8"},   {"bucketSize", "8"}, {"passes", "1"},
                    {"threads", "1"}, {"photons", "16"}, {"aaLevel", "1"},    {"aaLevelMost", "1"}};
    for (const auto& [name, value] : settings) all[name] = value;
    for (const auto& [name, value] : all)
        must(api().setSettingText(render, name.c_str(), value.c_str()));
    PmrStatus status = api().startRender(render);
    if (status == PMR_OK) status = api().waitRender(render, -1.0);
    must(api().destroyRender(render));
    return status;
}

std::string makeGenuine(const std::string& setting, const Settings& settings, int argc,
                        char** argv) {
    const std::string file = folder() + "/genuine";
    Settings all = settings;
    all[setting] = file;
    must(renderTriangle(all));
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    for (int i = 1; i < argc; ++i)
        if (argv[i][0] != '-' && std::filesystem::is_directory(argv[i])) {
            std::ofstream(std::string(argv[i]) + "/genuine", std::ios::binary) << bytes.str();
            break;
        }
    return bytes.str();
}

}  // namespace pm::fuzz
