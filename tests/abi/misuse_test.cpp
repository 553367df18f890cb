// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Wrong handles, null pointers and sizes: always a status, never a crash.
#include <cstring>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

template <typename Handle>
Handle made(std::uintptr_t value) {
    return reinterpret_cast<Handle>(value);
}

TEST(Misuse, GetApiAndTexts) {
    EXPECT_EQ(sizeof(PmrApi), api().size);
    EXPECT_EQ(PMR_ABI_VERSION, api().abiVersion);
    EXPECT_NE(nullptr, std::strstr(api().versionText(), "embree 3"));
    for (PmrStatus status = -20; status <= 3; ++status)
        EXPECT_GT(std::strlen(api().statusText(status)), 0u);
}

// Every function with handles that are null, made up, stale, or of another kind.
void expectHandleErrors(std::uintptr_t bad) {
    const auto context = made<PmrContext>(bad);
    const auto scene = made<PmrScene>(bad);
    const auto render = made<PmrRender>(bad);
    PmrMesh mesh = nullptr;
    PmrScene newScene = nullptr;
    PmrRender newRender = nullptr;
    PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    double bounds[6];
    float pixel[4];
    const PmrRectangle one = {0, 0, 1, 1};
    std::uint64_t needed = 0;
    std::uint32_t count = 0;
    const PmrStatus answers[] = {
        api().releaseContext(context),
        api().createSphere(context, &sphere, &mesh),
        api().createScene(context, nullptr, &newScene),
        api().retainMesh(made<PmrMesh>(bad)),
        api().releaseMesh(made<PmrMesh>(bad)),
        api().retainTexture(made<PmrTexture>(bad)),
        api().releaseTexture(made<PmrTexture>(bad)),
        api().retainMaterial(made<PmrMaterial>(bad)),
        api().releaseMaterial(made<PmrMaterial>(bad)),
        api().retainScene(scene),
        api().releaseScene(scene),
        api().addInstance(scene, &instance),
        api().addLight(scene, nullptr),
        api().setEnvironment(scene, nullptr),
        api().setCamera(scene, nullptr),
        api().commitScene(scene),
        api().sceneBounds(scene, bounds),
        api().createRender(scene, nullptr, &newRender),
        api().setSettingInteger(render, "width", 1),
        api().setSettingNumber(render, "width", 1),
        api().setSettingText(render, "width", "1"),
        api().settingText(render, "width", nullptr, 0, &needed),
        api().explainRender(render, nullptr, 0, &needed),
        api().startRender(render),
        api().pollRender(render, 0),
        api().waitRender(render, 0),
        api().cancelRender(render),
        api().renderState(render, nullptr, nullptr),
        api().destroyRender(render),
        api().renderLayerCount(render, &count),
        api().renderLayerInfo(render, 0, nullptr),
        api().readPixels(render, &one, "beauty", pixel, 0, 0),
        api().renderStatistics(render, nullptr, 0, &needed),
    };
    for (const PmrStatus answer : answers) EXPECT_EQ(PMR_ERROR_HANDLE, answer);
}

TEST(Misuse, NullAndInventedHandles) {
    for (const std::uintptr_t bad :
         {std::uintptr_t{0}, std::uintptr_t{1}, std::uintptr_t{0xdeadbeef}, ~std::uintptr_t{0}})
        expectHandleErrors(bad);
}

TEST(Misuse, StaleAndWrongKind) {
    PmrContext context = nullptr;
    ASSERT_EQ(PMR_OK, api().createContext(nullptr, &context));
    PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
    desc.radius = 1;
    PmrMesh mesh = nullptr;
    ASSERT_EQ(PMR_OK, api().createSphere(context, &desc, &mesh));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().releaseMaterial(reinterpret_cast<PmrMaterial>(mesh)));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().releaseContext(reinterpret_cast<PmrContext>(mesh)));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().commitScene(reinterpret_cast<PmrScene>(context)));
    EXPECT_EQ(PMR_OK, api().retainMesh(mesh));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
    expectHandleErrors(reinterpret_cast<std::uintptr_t>(mesh));
    PmrMesh again = nullptr;  // a released handle is not given out again
    ASSERT_EQ(PMR_OK, api().createSphere(context, &desc, &again));
    EXPECT_NE(mesh, again);
    EXPECT_EQ(PMR_OK, api().releaseMesh(again));
    EXPECT_EQ(PMR_OK, api().releaseContext(context));
    expectHandleErrors(reinterpret_cast<std::uintptr_t>(context));
}

TEST(Misuse, NullPointers) {
    const BoxHost host;
    const PmrContext context = host.context();
    PmrMesh mesh = nullptr;
    PmrTexture texture = nullptr;
    PmrMaterial material = nullptr;
    PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
    sphere.radius = 1;
    const PmrStatus answers[] = {
        api().createContext(nullptr, nullptr),
        api().createMesh(context, nullptr, &mesh),
        api().createCage(context, nullptr, &mesh),
        api().createSphere(context, nullptr, &mesh),
        api().createSphere(context, &sphere, nullptr),
        api().createTexture(context, nullptr, &texture),
        api().createMaterial(context, nullptr, &material),
        api().createScene(context, nullptr, nullptr),
        api().createRender(host.scene(), nullptr, nullptr),
        api().sceneBounds(host.scene(), nullptr),
        api().settingInfo(0, nullptr),
        api().settingInfo(100000, nullptr),
        api().layerInfo(0, nullptr),
        api().lastError(context, nullptr, 0, nullptr),
    };
    for (const PmrStatus answer : answers) EXPECT_EQ(PMR_ERROR_ARGUMENT, answer);
}

// A struct of any size: shorter, longer with zeros, longer with something, none, absurd.
TEST(Misuse, StructSizes) {
    const BoxHost host;
    struct {
        PmrSphereDesc known;
        unsigned char tail[24];
    } longer{};
    longer.known.radius = 1;
    PmrMesh mesh = nullptr;
    const auto create = [&](std::uint64_t size) {
        longer.known.size = size;
        const PmrStatus status = api().createSphere(host.context(), &longer.known, &mesh);
        if (status == PMR_OK) {
            EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
        }
        EXPECT_EQ(status == PMR_OK, mesh != nullptr);
        return status;
    };
    EXPECT_EQ(PMR_OK, create(sizeof(PmrSphereDesc)));
    EXPECT_EQ(PMR_OK, create(sizeof longer));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, create(offsetof(PmrSphereDesc, radius)));  // radius reads as 0
    EXPECT_NE(std::string::npos, host.lastError().find("radius is 0"));
    for (const std::uint64_t size :
         {std::uint64_t{0}, std::uint64_t{7}, std::uint64_t{1} << 20, ~std::uint64_t{0}}) {
        EXPECT_EQ(PMR_ERROR_ARGUMENT, create(size));
        EXPECT_NE(std::string::npos, host.lastError().find("size is")) << host.lastError();
    }
    longer.tail[23] = 1;
    EXPECT_EQ(PMR_OK, create(sizeof(PmrSphereDesc)));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, create(sizeof longer));
    EXPECT_NE(std::string::npos, host.lastError().find("not zero")) << host.lastError();
}

TEST(Misuse, InfoStructsOfOlderHosts) {
    unsigned char bytes[sizeof(PmrLayerInfo)];
    std::memset(bytes, 0xab, sizeof bytes);
    const std::uint64_t oldSize = offsetof(PmrLayerInfo, help);
    std::memcpy(bytes, &oldSize, sizeof oldSize);
    PmrLayerInfo* info = reinterpret_cast<PmrLayerInfo*>(bytes);
    ASSERT_EQ(PMR_OK, api().layerInfo(0, info));
    const char* name = nullptr;
    std::memcpy(&name, bytes + offsetof(PmrLayerInfo, name), sizeof name);
    EXPECT_STREQ("beauty", name);
    for (std::size_t i = oldSize; i < sizeof bytes; ++i) EXPECT_EQ(0xab, bytes[i]);
}

TEST(Misuse, Contexts) {
    PmrContext context = nullptr;
    PmrContextDesc desc = PMR_INIT(PmrContextDesc);
    desc.isa = "mmx";
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createContext(&desc, &context));
    desc.isa = "sse2";
    desc.threads = 1000000;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createContext(&desc, &context));
    desc.threads = 2;
    ASSERT_EQ(PMR_OK, api().createContext(&desc, &context));
    EXPECT_EQ(PMR_OK, api().releaseContext(context));
}

TEST(Misuse, TextBuffers) {
    const BoxHost host;
    PmrMesh mesh = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createMesh(host.context(), nullptr, &mesh));
    std::uint64_t needed = 0;
    char small[5] = {'x', 'x', 'x', 'x', 'x'};
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().lastError(host.context(), small, 4, &needed));
    EXPECT_EQ(std::string("Pmr"), small);
    EXPECT_EQ('x', small[4]);
    EXPECT_EQ(host.lastError().size() + 1, needed);
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().lastError(host.context(), small, 0, nullptr));
    EXPECT_EQ('P', small[0]);
}

}  // namespace

}  // namespace pm::test
