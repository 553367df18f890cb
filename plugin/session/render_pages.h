// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/photons/map/photon_pages.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/setting_values.h"
#include "plugin/storage/scratch_disk.h"
#include "plugin/values/json.h"

namespace pm::plugin {

// The photon maps of a render that are kept in pages, and where those are. Threads: all functions
// from any, at once.
class RenderPages {
  public:
    // plan: one with pages. Errors: CallError(IO) where the scratch folder takes no files.
    RenderPages(const SettingValues& values, const MemoryPlan& plan)
        : m_disk(values.word(Setting::kScratchFolder)), m_paging(m_disk, plan.pages) {
        m_disk.make();
    }

    PhotonPaging& paging() { return m_paging; }
    // For the statistics.
    Json statistics() const;

  private:
    ScratchDisk m_disk;
    PhotonPaging m_paging;
};

}  // namespace pm::plugin
