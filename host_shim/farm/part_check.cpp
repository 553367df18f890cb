// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/part_check.h"

#include <fmt/format.h>

#include "host_shim/formats/warnings.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/render/plugin.h"
#include "host_shim/render/render_run.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

// Handles of the C interface that end with it.
class Merge {
  public:
    explicit Merge(const PluginContext& context) : m_context(context) {
        m_context.check(m_context.api().createMerge(m_context.handle(), &m_handle), "merge");
    }
    ~Merge() { m_context.api().releaseMerge(m_handle); }
    Merge(const Merge&) = delete;
    Merge& operator=(const Merge&) = delete;
    PmrStatus add(const std::filesystem::path& part) {
        return m_context.api().addPart(m_handle, part.c_str());
    }

  private:
    const PluginContext& m_context;
    PmrMerge m_handle{};
};

}  // namespace

std::set<int> runsWithoutPart(const FarmPlan& plan, std::size_t frame,
                              const std::filesystem::path& pluginFile, Log& log) {
    const Plugin plugin(pluginFile);
    auto desc = PMR_INIT(PmrContextDesc);
    desc.message = logPluginMessage;
    desc.user = &log;
    const PluginContext context(plugin, desc);
    Merge merge(context);
    std::set<int> missing;
    std::error_code ignored;
    for (int number = 1; number <= static_cast<int>(plan.tasks.size()); ++number) {
        const FarmTask& task = plan.task(number);
        if (task.kind != FarmTask::Kind::kRun || task.frame != frame) continue;
        throwIfInterrupted();
        if (!std::filesystem::exists(task.product, ignored)) {
            missing.insert(number);
            continue;
        }
        const PmrStatus status = merge.add(task.product);
        if (status == PMR_ERROR_FILE || status == PMR_ERROR_IO) {
            log.warning(static_cast<int>(Warning::kFarm),
                        fmt::format("{}; it is made again", context.lastError()));
            std::filesystem::remove(task.product, ignored);
            missing.insert(number);
        } else {
            context.check(status, "part");
        }
    }
    return missing;
}

}  // namespace pm::host
