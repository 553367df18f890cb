/* SPDX-License-Identifier: Apache-2.0
 * SPDX-FileCopyrightText: The pm authors */
#pragma once

#include "plugin/include/pm_plugin.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A box like Cornell's with a mirror sphere, a glass sphere and a glossy block, lit from its
 * ceiling, made through the interface and committed. box_host.py makes the same one. Returns the
 * first status that is not PMR_OK; *scene is null then. */
PmrStatus makeBoxScene(const PmrApi* api, PmrContext context, PmrScene* scene);

/* FNV-1a, 64 bits. */
uint64_t hashBytes(const void* bytes, uint64_t count);

#ifdef __cplusplus
}
#endif
