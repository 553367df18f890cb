// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_pages.h"

namespace pm::plugin {

Json RenderPages::statistics() const {
    const CacheCounts counts = m_paging.counts();
    return {{"budgetBytes", m_paging.budget()},
            {"wholeBytes", m_paging.mostWholeBytes()},
            {"misses", counts.misses},
            {"madeAgain", counts.madeAgain},
            {"waits", counts.waits},
            {"bytesRead", counts.bytesMade},
            {"bytesHeld", counts.bytesHeld},
            {"mostBytesHeld", counts.mostBytesHeld},
            {"mostBuildBytes", m_paging.mostBuildBytes()},
            {"scratchBytesWritten", m_disk.bytesWritten()},
            {"mostScratchBytes", m_disk.mostBytes()}};
}

}  // namespace pm::plugin
