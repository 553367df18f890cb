// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A disc of striped dust below a light that falls by the cosine, seen by an orthographic camera, by
// an integrator of direct light and by photons: all of it by its closed form. usage: probe LIBRARY
#include <dlfcn.h>
#include <pm_plugin.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace {

constexpr std::int32_t kSize = 32;        // pixels
constexpr double kSeen = 3, kRadius = 1;  // scene units
constexpr double kHeight = 2, kIntensity = 100, kDust = 0.8, kStripe = 0.5;

const PmrApi* g_api = nullptr;
PmrContext g_context = nullptr;

void check(PmrStatus status, const char* what) {
    if (status == PMR_OK) return;
    char text[400] = "";
    std::uint64_t needed = 0;
    if (g_api != nullptr) g_api->lastError(g_context, text, sizeof text, &needed);
    std::printf("%s: status %d: %s\n", what, status, text);
    std::exit(1);
}

void load(const char* library) {
    void* handle = dlopen(library, RTLD_NOW);
    auto* get = handle == nullptr ? nullptr
                                  : reinterpret_cast<PmrGetApiFunction>(dlsym(handle, "pmrGetApi"));
    if (get == nullptr) {
        std::printf("%s: not loaded\n", library);
        std::exit(1);
    }
    check(get(PMR_ABI_VERSION, &g_api), "pmrGetApi");
}

PmrScene makeScene() {
    PmrMaterialDesc surface = PMR_INIT(PmrMaterialDesc);
    for (float& channel : surface.diffuse) channel = static_cast<float>(kDust);
    PmrTextureDesc stripes = PMR_INIT(PmrTextureDesc);
    stripes.fileName = "stripes:0.5";
    check(g_api->createTexture(g_context, &stripes, &surface.diffuseTexture), "createTexture");
    PmrMaterial material = nullptr;
    check(g_api->createMaterial(g_context, &surface, &material), "createMaterial");
    PmrParameterDesc dust = PMR_INIT(PmrParameterDesc);
    dust.object = PMR_OBJECT_MATERIAL;
    dust.material = material;
    dust.name = "dust";
    dust.text = "1";
    check(g_api->setParameter(&dust), "dust");

    PmrParameterDesc radius = PMR_INIT(PmrParameterDesc);
    radius.object = PMR_OBJECT_DISC;
    radius.name = "radius";
    radius.numbers = &kRadius;
    radius.numberCount = 1;
    const PmrParameterDesc* const parameters[] = {&radius};
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    check(g_api->createShape(g_context, PMR_OBJECT_DISC, parameters, 1, &instance.mesh), "disc");
    instance.materials = &material;
    instance.materialCount = 1;
    PmrScene scene = nullptr;
    check(g_api->createScene(g_context, nullptr, &scene), "createScene");
    check(g_api->addInstance(scene, &instance), "addInstance");

    const double above[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, kHeight};
    PmrLightDesc light = PMR_INIT(PmrLightDesc);
    light.kind = PMR_LIGHT_COSINE;
    light.transforms = above;
    light.transformCount = 1;
    for (float& channel : light.emission) channel = static_cast<float>(kIntensity);
    check(g_api->addLight(scene, &light), "addLight");
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.kind = PMR_CAMERA_ORTHOGRAPHIC;
    camera.height = kSeen;
    camera.transforms = above;
    camera.transformCount = 1;
    check(g_api->setCamera(scene, &camera), "setCamera");
    check(g_api->commitScene(scene), "commitScene");
    return scene;
}

std::vector<float> render(PmrScene scene, const char* integrator) {
    PmrRender render = nullptr;
    check(g_api->createRender(scene, nullptr, &render), "createRender");
    for (const char* side : {"width", "height"})
        check(g_api->setSettingInteger(render, side, kSize), side);
    check(g_api->setSettingInteger(render, "passes", 4), "passes");
    check(g_api->setSettingText(render, "integrator", integrator), "integrator");
    check(g_api->startRender(render), "startRender");
    check(g_api->waitRender(render, -1.0), "waitRender");
    std::vector<float> pixels(4 * kSize * kSize);
    const PmrRectangle all = {0, 0, kSize, kSize};
    check(g_api->readPixels(render, &all, "beauty", pixels.data(), 16, 16 * kSize), "readPixels");
    return pixels;
}

// Radiance along the normal: reflectance / (4 pi (cos + 1)) of the intensity's cos^2 / d^2.
double radiance(double fromAxis) {
    const double d2 = kHeight * kHeight + fromAxis * fromAxis, cosine = kHeight / std::sqrt(d2);
    return kDust / (4 * std::numbers::pi * (cosine + 1)) * kIntensity * cosine * cosine / d2;
}

// The number of pixels that are wrong.
int look(PmrScene scene, const char* integrator) {
    const std::vector<float> pixels = render(scene, integrator);
    const double pixel = kSeen / kSize;
    int wrong = 0, inside = 0;
    for (std::int32_t y = 0; y < kSize; ++y) {
        for (std::int32_t x = 0; x < kSize; ++x) {
            const double r = pixel * std::hypot(x + 0.5 - kSize / 2, y + 0.5 - kSize / 2);
            if (std::abs(r - kRadius) < 2 * pixel) continue;  // the rim, which the filter blurs
            const double stripe = pixel * (x + 0.5 - kSize / 2) / kStripe;
            if (std::abs(stripe - std::round(stripe)) * kStripe < 2 * pixel) continue;
            const double value = static_cast<int>(std::floor(stripe)) % 2 == 0 ? 1 : 0.5;
            const double found = pixels[static_cast<std::size_t>(4 * (y * kSize + x))];
            // By the largest that it can change within the filter's reach.
            const double change = radiance(std::max(0.0, r - 2 * pixel)) - radiance(r + 2 * pixel);
            const double expected = r < kRadius ? value * radiance(r) : 0,
                         allowed = r < kRadius ? change : 0;
            inside += r < kRadius;
            if (std::abs(found - expected) <= allowed) continue;
            ++wrong;
            std::printf("%s: pixel %d,%d is %g; it must be %g +- %g\n", integrator, x, y, found,
                        expected, allowed);
        }
    }
    std::printf("%s: %d pixels on the disc, %d pixels wrong\n", integrator, inside, wrong);
    return inside > 80 ? wrong : 1;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return 2;
    load(arguments[1]);
    check(g_api->createContext(nullptr, &g_context), "createContext");
    PmrScene scene = makeScene();
    return look(scene, "photon") + look(scene, "direct") == 0 ? 0 : 1;
}
