/* SPDX-License-Identifier: Apache-2.0
 * SPDX-FileCopyrightText: The pm authors */
/* A host in plain C: loads the library, renders the box, prints the hash of the pixels' bytes, and
 * unloads it; that several times. Usage: box_host LIBRARY TIMES */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/abi/box_scene.h"

enum { kWidth = 40, kHeight = 24 };

static int fail(const char* what, PmrStatus status) {
    fprintf(stderr, "box_host: %s: %d\n", what, (int)status);
    return 1;
}

static int renderBox(const PmrApi* api, PmrScene scene) {
    static float pixels[kWidth * kHeight * 4];
    const PmrRectangle whole = {0, 0, kWidth, kHeight};
    PmrRender render = NULL;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = PMR_CALLBACKS_POLL;
    PmrStatus status = api->createRender(scene, &desc, &render);
    if (status != PMR_OK) return fail("createRender", status);
    api->setSettingInteger(render, "width", kWidth);
    api->setSettingInteger(render, "height", kHeight);
    api->setSettingInteger(render, "passes", 2);
    api->setSettingText(render, "photons", "5000");
    status = api->startRender(render);
    if (status == PMR_OK) status = api->waitRender(render, -1.0);
    if (status != PMR_OK) return fail("render", status);
    memset(pixels, 0xff, sizeof pixels);
    status = api->readPixels(render, &whole, "beauty", pixels, 0, 0);
    if (status != PMR_OK) return fail("readPixels", status);
    printf("%016llx\n", (unsigned long long)hashBytes(pixels, sizeof pixels));
    status = api->destroyRender(render);
    return status == PMR_OK ? 0 : fail("destroyRender", status);
}

static int renderOnce(const char* library) {
    void* module = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (module == NULL) {
        fprintf(stderr, "box_host: %s\n", dlerror());
        return 1;
    }
    PmrGetApiFunction getApi;
    void* symbol = dlsym(module, "pmrGetApi");
    memcpy(&getApi, &symbol, sizeof getApi);
    const PmrApi* api = NULL;
    PmrContext context = NULL;
    PmrScene scene = NULL;
    if (getApi == NULL || getApi(PMR_ABI_VERSION, &api) != PMR_OK) return fail("pmrGetApi", 0);
    PmrStatus status = api->createContext(NULL, &context);
    if (status != PMR_OK) return fail("createContext", status);
    status = makeBoxScene(api, context, &scene);
    if (status != PMR_OK) {
        char text[512] = "";
        api->lastError(context, text, sizeof text, NULL);
        fprintf(stderr, "%s\n", text);
        return fail("makeBoxScene", status);
    }
    const int result = renderBox(api, scene);
    api->releaseScene(scene);
    api->releaseContext(context);
    dlclose(module);
    return result;
}

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    const int times = atoi(argv[2]);
    for (int i = 0; i < times; ++i)
        if (renderOnce(argv[1]) != 0) return 1;
    return 0;
}
