// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parts of a picture, put together.
#include <memory>
#include <string>

#include "plugin/api/api_functions.h"
#include "plugin/api/context.h"
#include "plugin/api/entry.h"
#include "plugin/api/table_infos.h"
#include "plugin/session/merge.h"

namespace pm::plugin::api {

using MergePointer = std::shared_ptr<Merge>;

PmrStatus PMR_CALL createMerge(PmrContext context, PmrMerge* merge) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>&) {
        clearResult(merge, "merge");
        *merge = publish<PmrMerge>(std::make_shared<Merge>());
    });
}

PmrStatus PMR_CALL addPart(PmrMerge merge, const char* file) noexcept {
    return onObject<Merge>(merge, [&](const MergePointer& object) {
        if (file == nullptr || *file == 0) throw argumentError("file is null or empty");
        object->addPart(file);
    });
}

PmrStatus PMR_CALL mergeMissing(PmrMerge merge, char* buffer, uint64_t capacity,
                                uint64_t* needed) noexcept {
    return onObject<Merge>(merge, [&](const MergePointer& object) {
        writeText(object->missing(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL mergeSettingText(PmrMerge merge, const char* name, char* buffer,
                                    uint64_t capacity, uint64_t* needed) noexcept {
    return onObject<Merge>(merge, [&](const MergePointer& object) {
        if (name == nullptr) throw argumentError("name is null");
        writeText(object->settingText(name), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL mergeLayerCount(PmrMerge merge, uint32_t* count) noexcept {
    return onObject<Merge>(
        merge, [&](const MergePointer& object) { writeLayerCount(object->layers(), count); });
}

PmrStatus PMR_CALL mergeLayerInfo(PmrMerge merge, uint32_t index, PmrLayerInfo* info) noexcept {
    return onObject<Merge>(
        merge, [&](const MergePointer& object) { writeLayerInfo(object->layers(), index, info); });
}

PmrStatus PMR_CALL readMergedPixels(PmrMerge merge, const PmrRectangle* rectangle,
                                    const char* layer, float* destination, int64_t pixelStrideBytes,
                                    int64_t rowStrideBytes) noexcept {
    return onObject<Merge>(merge, [&](const MergePointer& object) {
        if (rectangle == nullptr) throw argumentError("rectangle is null");
        object->readPixels(toRect(*rectangle), layer, destination, pixelStrideBytes,
                           rowStrideBytes);
    });
}

PmrStatus PMR_CALL mergeStatistics(PmrMerge merge, char* buffer, uint64_t capacity,
                                   uint64_t* needed) noexcept {
    return onObject<Merge>(merge, [&](const MergePointer& object) {
        writeText(object->statisticsJson(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL releaseMerge(PmrMerge merge) noexcept {
    return releaseHandle<Merge>(merge);
}

}  // namespace pm::plugin::api
