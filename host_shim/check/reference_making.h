// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/check/reference.h"
#include "host_shim/check/scene_check.h"

namespace pm::host {

// What a reference is made of.
struct MadeReference {
    Reference reference;
    Picture noise;                      // see pixelNoiseOf
    std::vector<DisplayPicture> views;  // of the picture that is kept, as the scene has them
};

// seeds: renders that differ in the seed alone, the one that is kept first; twins: of its seed, see
// makeTwin. The reasons of a reference that is there are kept. Errors: kBadInput where a value is
// not finite or what is there is no reference.
MadeReference makeReference(const Suite& suite, const SuiteScene& scene,
                            const std::vector<RenderedFiles>& seeds,
                            const std::vector<RenderedFiles>& twins, const std::string& because);

// Errors: kFile.
void storeReference(const RenderedFiles& kept, const MadeReference& made,
                    const ReferenceFiles& files);

}  // namespace pm::host
