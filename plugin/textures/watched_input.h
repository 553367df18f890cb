// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/oiioversion.h>

#include <cstdint>

OIIO_NAMESPACE_BEGIN
class ImageInput;
OIIO_NAMESPACE_END

namespace pm::plugin {

// For OIIO::ImageCache::add_file: a reader that opens a file as the library itself would, and tells
// the reading thread's CacheWatch of every tile, or strip of rows, that is read of it. Each read is
// a miss, of texelCache(). The caller owns it.
OIIO::ImageInput* makeWatchedInput();

// All texture systems' texels, as CacheWatch knows them.
std::uint32_t texelCache();

}  // namespace pm::plugin
