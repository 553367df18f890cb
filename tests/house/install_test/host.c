// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <pm_plugin.h>
#include <stdio.h>
#ifdef LOAD
#include <dlfcn.h>
#endif

static PmrGetApiFunction findGetApi(void) {
#ifdef LOAD
    void* library = dlopen(LOAD, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        return NULL;
    }
    PmrGetApiFunction function;
    *(void**)&function = dlsym(library, "pmrGetApi");
    return function;
#else
    return pmrGetApi;
#endif
}

int main(void) {
    const PmrGetApiFunction getApi = findGetApi();
    const PmrApi* api = NULL;
    if (getApi == NULL || getApi(PMR_ABI_VERSION, &api) != PMR_OK) return 1;
    PmrContextDesc desc = PMR_INIT(PmrContextDesc);
    PmrContext context = NULL;
    if (api->createContext(&desc, &context) != PMR_OK) return 2;
    if (api->releaseContext(context) != PMR_OK) return 3;
    printf("pm %s\n", api->versionText());
    return 0;
}
