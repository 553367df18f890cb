// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// lastError tells of the last call of its thread, whatever function that was and however it ended.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

std::string lastError(PmrContext context = nullptr) {
    return textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
        return api().lastError(context, buffer, capacity, needed);
    });
}

// A call that fails, and one that doesn't, of each function that returns a status.
struct Row {
    const char* name;
    std::function<PmrStatus()> fail;
    std::function<PmrStatus()> succeed = {};  // none where it would take a render or a file
};

// What the rows' calls are made on.
struct Things {
    BoxHost host;
    PmrRender render = host.makeRender({});
    PmrScene open = nullptr;
    PmrMesh mesh = nullptr;
    PmrMaterial material = nullptr;
    PmrMerge merge = nullptr;
    std::uint64_t needed = 0;
    std::uint32_t count = 0;
    std::int32_t number = 0;
    std::array<double, 6> bounds{};
    PmrSettingInfo setting = PMR_INIT(PmrSettingInfo);
    PmrLayerInfo layer = PMR_INIT(PmrLayerInfo);
    PmrParameterInfo parameter = PMR_INIT(PmrParameterInfo);
    PmrParameterDesc diffuse = PMR_INIT(PmrParameterDesc);

    Things() {
        PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
        sphere.radius = 1;
        const PmrMaterialDesc grey = PMR_INIT(PmrMaterialDesc);
        EXPECT_EQ(PMR_OK, api().createSphere(host.context(), &sphere, &mesh));
        EXPECT_EQ(PMR_OK, api().createMaterial(host.context(), &grey, &material));
        diffuse.material = material;
        diffuse.name = "diffuse";
        diffuse.text = "1 0.5 1";
        EXPECT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &open));
        EXPECT_EQ(PMR_OK, api().createMerge(host.context(), &merge));
    }
    ~Things() {
        api().releaseMerge(merge);
        api().destroyRender(render);
        api().releaseScene(open);
        api().releaseMaterial(material);
        api().releaseMesh(mesh);
    }
};

std::vector<Row> rowsOfObjects(Things& t) {
    const PmrContext context = t.host.context();
    return {
        {"settingInfo", [] { return api().settingInfo(9999, nullptr); },
         [&t] { return api().settingInfo(0, &t.setting); }},
        {"layerInfo", [] { return api().layerInfo(9999, nullptr); },
         [&t] { return api().layerInfo(0, &t.layer); }},
        {"parameterInfo", [] { return api().parameterInfo(PMR_OBJECT_LIGHT, 9999, nullptr); },
         [&t] { return api().parameterInfo(PMR_OBJECT_LIGHT, 0, &t.parameter); }},
        {"setParameter", [] { return api().setParameter(nullptr); },
         [&t] { return api().setParameter(&t.diffuse); }},
        {"createContext", [] { return api().createContext(nullptr, nullptr); },
         [] {
             PmrContext made = nullptr;
             const PmrStatus status = api().createContext(nullptr, &made);
             api().releaseContext(made);
             return status;
         }},
        {"releaseContext", [] { return api().releaseContext(nullptr); }},
        {"createMesh", [=] { return api().createMesh(context, nullptr, nullptr); }},
        {"createCage", [=] { return api().createCage(context, nullptr, nullptr); }},
        {"createSphere", [=] { return api().createSphere(context, nullptr, nullptr); }},
        {"createShape", [=] { return api().createShape(context, -1, nullptr, 0, nullptr); }},
        {"retainMesh", [] { return api().retainMesh(nullptr); },
         [&t] { return api().retainMesh(t.mesh); }},
        {"releaseMesh", [] { return api().releaseMesh(nullptr); },
         [&t] { return api().releaseMesh(t.mesh); }},
        {"createTexture", [=] { return api().createTexture(context, nullptr, nullptr); }},
        {"retainTexture", [] { return api().retainTexture(nullptr); }},
        {"releaseTexture", [] { return api().releaseTexture(nullptr); }},
        {"createMaterial", [=] { return api().createMaterial(context, nullptr, nullptr); }},
        {"retainMaterial", [] { return api().retainMaterial(nullptr); },
         [&t] { return api().retainMaterial(t.material); }},
        {"releaseMaterial", [] { return api().releaseMaterial(nullptr); },
         [&t] { return api().releaseMaterial(t.material); }},
        {"createScene", [=] { return api().createScene(context, nullptr, nullptr); }},
        {"retainScene", [] { return api().retainScene(nullptr); },
         [&t] { return api().retainScene(t.open); }},
        {"releaseScene", [] { return api().releaseScene(nullptr); },
         [&t] { return api().releaseScene(t.open); }},
        {"addInstance", [&t] { return api().addInstance(t.open, nullptr); }},
        {"addLight", [&t] { return api().addLight(t.open, nullptr); }},
        {"setEnvironment", [&t] { return api().setEnvironment(t.open, nullptr); }},
        {"setCamera", [&t] { return api().setCamera(t.open, nullptr); }},
        {"commitScene", [&t] { return api().commitScene(t.open); }},
        {"sceneBounds", [&t] { return api().sceneBounds(t.open, t.bounds.data()); },
         [&t] { return api().sceneBounds(t.host.scene(), t.bounds.data()); }},
        {"cancelBuilds", [=] { return api().cancelBuilds(context, 7); },
         [=] { return api().cancelBuilds(context, 0); }},
    };
}

std::vector<Row> rowsOfRenders(Things& t) {
    return {
        {"createRender", [&t] { return api().createRender(t.open, nullptr, nullptr); }},
        {"setSettingInteger", [&t] { return api().setSettingInteger(t.render, "bokeh", 1); },
         [&t] { return api().setSettingInteger(t.render, "seed", 1); }},
        {"setSettingNumber", [&t] { return api().setSettingNumber(t.render, "bokeh", 1); },
         [&t] { return api().setSettingNumber(t.render, "errorTarget", 0); }},
        {"setSettingText", [&t] { return api().setSettingText(t.render, "bokeh", "1"); },
         [&t] { return api().setSettingText(t.render, "seed", "1"); }},
        {"settingText", [&t] { return api().settingText(t.render, "x", nullptr, 0, &t.needed); },
         [&t] { return api().settingText(t.render, "seed", nullptr, 0, &t.needed); }},
        {"explainRender", [] { return api().explainRender(nullptr, nullptr, 0, nullptr); },
         [&t] { return api().explainRender(t.render, nullptr, 0, &t.needed); }},
        {"startRender", [] { return api().startRender(nullptr); }},
        {"pollRender", [&t] { return api().pollRender(t.render, 0); }},
        {"waitRender", [&t] { return api().waitRender(t.render, 0); }},
        {"cancelRender", [] { return api().cancelRender(nullptr); }},
        {"renderState", [] { return api().renderState(nullptr, nullptr, nullptr); },
         [&t] { return api().renderState(t.render, &t.number, nullptr); }},
        {"destroyRender", [] { return api().destroyRender(nullptr); }},
        {"renderLayerCount", [&t] { return api().renderLayerCount(t.render, nullptr); },
         [&t] { return api().renderLayerCount(t.render, &t.count); }},
        {"renderLayerInfo", [&t] { return api().renderLayerInfo(t.render, 999, &t.layer); },
         [&t] { return api().renderLayerInfo(t.render, 0, &t.layer); }},
        {"readPixels",
         [&t] { return api().readPixels(t.render, nullptr, "beauty", nullptr, 0, 0); }},
        {"renderStatistics",
         [&t] { return api().renderStatistics(t.render, nullptr, 0, &t.needed); }},
        {"renderStopReason", [&t] { return api().renderStopReason(t.render, nullptr); },
         [&t] { return api().renderStopReason(t.render, &t.number); }},
        {"renderDelivery", [&t] { return api().renderDelivery(t.render, nullptr); },
         [&t] { return api().renderDelivery(t.render, &t.number); }},
        {"createMerge", [&t] { return api().createMerge(t.host.context(), nullptr); }},
        {"addPart", [&t] { return api().addPart(t.merge, "/nowhere/a.part"); }},
        {"mergeMissing", [&t] { return api().mergeMissing(t.merge, nullptr, 0, &t.needed); }},
        {"mergeSettingText",
         [&t] { return api().mergeSettingText(t.merge, "seed", nullptr, 0, &t.needed); }},
        {"mergeLayerCount", [&t] { return api().mergeLayerCount(t.merge, &t.count); }},
        {"mergeLayerInfo", [&t] { return api().mergeLayerInfo(t.merge, 0, &t.layer); }},
        {"readMergedPixels",
         [&t] { return api().readMergedPixels(t.merge, nullptr, "beauty", nullptr, 0, 0); }},
        {"mergeStatistics", [&t] { return api().mergeStatistics(t.merge, nullptr, 0, &t.needed); }},
        {"releaseMerge", [] { return api().releaseMerge(nullptr); }},
    };
}

TEST(LastError, IsOfTheLastCallWhateverItWas) {
    Things things;
    std::vector<Row> rows = rowsOfObjects(things);
    for (Row& row : rowsOfRenders(things)) rows.push_back(std::move(row));
    // All functions of the table but those without a status (7) and lastError.
    EXPECT_EQ((sizeof(PmrApi) - offsetof(PmrApi, versionText)) / sizeof(void*) - 8, rows.size());
    constexpr const char* kStale = "setting seed is -1";
    for (const Row& row : rows) {
        ASSERT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(things.render, "seed", -1));
        ASSERT_NE(std::string::npos, lastError().find(kStale)) << lastError();
        EXPECT_NE(PMR_OK, row.fail()) << row.name;
        EXPECT_NE("", lastError()) << row.name;
        EXPECT_EQ(std::string::npos, lastError().find(kStale)) << row.name;
        if (!row.succeed) continue;
        EXPECT_EQ(PMR_OK, row.succeed()) << row.name << ": " << lastError();
        EXPECT_EQ("", lastError()) << row.name;
    }
}

TEST(LastError, NamesWhatIsWrong) {
    PmrContextDesc badIsa = PMR_INIT(PmrContextDesc);
    badIsa.isa = "mmx";
    PmrContext none = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createContext(&badIsa, &none));
    EXPECT_NE(std::string::npos, lastError().find("isa is 'mmx'")) << lastError();
    EXPECT_EQ(PMR_ERROR_HANDLE, api().releaseMesh(reinterpret_cast<PmrMesh>(0x1230)));
    EXPECT_EQ("0x1230 is not a live PmrMesh", lastError());
    EXPECT_EQ(PMR_ERROR_HANDLE,
              api().lastError(reinterpret_cast<PmrContext>(0x1230), nullptr, 0, nullptr));
    EXPECT_EQ("0x1230 is not a live PmrMesh", lastError()) << "lastError leaves it as it is";
}

TEST(LastError, EachThreadHasItsOwn) {
    EXPECT_EQ(PMR_ERROR_HANDLE, api().releaseMesh(nullptr));
    std::string ofOther = "?", ofOtherFailed;
    std::thread([&] {
        ofOther = lastError();
        api().releaseScene(nullptr);
        ofOtherFailed = lastError();
    }).join();
    EXPECT_EQ("", ofOther);
    EXPECT_NE(std::string::npos, ofOtherFailed.find("PmrScene")) << ofOtherFailed;
    EXPECT_NE(std::string::npos, lastError().find("PmrMesh")) << lastError();
}

}  // namespace

}  // namespace pm::test
