// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parts of a picture, put together.
#include <memory>
#include <string>

#include "plugin/src/api_functions.h"
#include "plugin/src/entry.h"
#include "plugin/src/layer_table.h"
#include "plugin/src/merge_object.h"

namespace pm::plugin::api {

using MergePointer = std::shared_ptr<MergeObject>;

PmrStatus PMR_CALL createMerge(PmrContext context, PmrMerge* merge) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>& owner) {
        clearResult(merge, "merge");
        *merge = publish<PmrMerge>(std::make_shared<MergeObject>(owner));
    });
}

PmrStatus PMR_CALL addPart(PmrMerge merge, const char* file) noexcept {
    return onObject<MergeObject>(merge, [&](const MergePointer& object) {
        if (file == nullptr || *file == 0) throw argumentError("file is null or empty");
        object->addPart(file);
    });
}

PmrStatus PMR_CALL mergeMissing(PmrMerge merge, char* buffer, uint64_t capacity,
                                uint64_t* needed) noexcept {
    return onObject<MergeObject>(merge, [&](const MergePointer& object) {
        writeText(object->missing(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL mergeSettingText(PmrMerge merge, const char* name, char* buffer,
                                    uint64_t capacity, uint64_t* needed) noexcept {
    return onObject<MergeObject>(merge, [&](const MergePointer& object) {
        if (name == nullptr) throw argumentError("name is null");
        writeText(object->settingText(name), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL mergeLayerCount(PmrMerge merge, uint32_t* count) noexcept {
    return onObject<MergeObject>(
        merge, [&](const MergePointer& object) { writeLayerCount(object->layers(), count); });
}

PmrStatus PMR_CALL mergeLayerInfo(PmrMerge merge, uint32_t index, PmrLayerInfo* info) noexcept {
    return onObject<MergeObject>(
        merge, [&](const MergePointer& object) { writeLayerInfo(object->layers(), index, info); });
}

PmrStatus PMR_CALL readMergedPixels(PmrMerge merge, const PmrRectangle* rectangle,
                                    const char* layer, float* destination, int64_t pixelStrideBytes,
                                    int64_t rowStrideBytes) noexcept {
    return onObject<MergeObject>(merge, [&](const MergePointer& object) {
        if (rectangle == nullptr) throw argumentError("rectangle is null");
        object->readPixels(*rectangle, layer, destination, pixelStrideBytes, rowStrideBytes);
    });
}

PmrStatus PMR_CALL mergeStatistics(PmrMerge merge, char* buffer, uint64_t capacity,
                                   uint64_t* needed) noexcept {
    return onObject<MergeObject>(merge, [&](const MergePointer& object) {
        writeText(object->statisticsJson(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL releaseMerge(PmrMerge merge) noexcept {
    return releaseHandle<MergeObject>(merge);
}

}  // namespace pm::plugin::api
