// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/render/picture_source.h"

namespace pm::host {

// All layers of a source as one picture, with the attributes that an EXR of ours carries.
// complete: every pixel is done; recorded as pm:complete. Errors: those of the plugin.
Picture assemblePicture(const PictureSource& source, const Options& options,
                        const ColourPipeline& colour, bool complete);

// The same without pixels: windows, the channels' names and kinds, attributes.
Picture assembleHead(const PictureSource& source, const Options& options,
                     const ColourPipeline& colour, bool complete);

// What of the host decides on a picture, as the library's setting hostIdentity.
std::string colourIdentity(const ColourPipeline& colour);

// The pipeline that parts with this identity were rendered with; options may leave the rendering
// space to them. Errors: those of ColourPipeline; kBadInput where options give another one.
ColourPipeline colourOfParts(const std::string& identity, ColourOptions options);

// The window that a render with these options fills.
PixelRect dataWindowOf(const Options& options);

// The space that an EXR of ours names; null where none is named.
const std::string* renderingSpaceOf(const Picture& picture);

// Whether something is covered (A above 0) and, but for one pixel in a hundred, exactly black.
bool isBlackThoughHit(const Picture& picture);

// How much of the picture nothing covers, in [0,1]; 0 where there is no A.
double emptyShare(const Picture& picture);

}  // namespace pm::host
