/* SPDX-License-Identifier: Apache-2.0
 * SPDX-FileCopyrightText: The pm authors */
#include <pm_plugin.h>
#include <stddef.h>

int main(void) {
    const PmrApi* api = NULL;
    PmrContext context = NULL;
    if (pmrGetApi(PMR_ABI_VERSION, &api) != PMR_OK) return 1;
    if (pmrGetApi(PMR_ABI_VERSION + 1, &api) != PMR_ERROR_ABI || api != NULL) return 2;
    if (pmrGetApi(PMR_ABI_VERSION, NULL) != PMR_ERROR_ARGUMENT) return 3;
    pmrGetApi(PMR_ABI_VERSION, &api);
    if (api->createContext(NULL, &context) != PMR_OK) return 4;
    return api->releaseContext(context) == PMR_OK ? 0 : 5;
}
