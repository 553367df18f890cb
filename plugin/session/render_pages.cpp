// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_pages.h"

#include "plugin/session/statistics_json.h"

namespace pm::plugin {

Json RenderPages::statistics() const {
    Json json = cacheJson(m_paging.counts(), m_paging.budget(), "bytesRead");
    json["wholeBytes"] = m_paging.mostWholeBytes();
    json["mostBuildBytes"] = m_paging.mostBuildBytes();
    json["scratchBytesWritten"] = m_disk.bytesWritten();
    json["mostScratchBytes"] = m_disk.mostBytes();
    return json;
}

}  // namespace pm::plugin
