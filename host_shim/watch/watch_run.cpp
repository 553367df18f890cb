// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/watch/watch_run.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <thread>

#include "host_shim/log/progress.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/render/merge_run.h"
#include "host_shim/render/plugin.h"
#include "host_shim/render/render_run.h"
#include "host_shim/session/session.h"
#include "host_shim/session/session_files.h"
#include "host_shim/watch/watch_page.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kGlance = std::chrono::milliseconds(20);

// What tells a file from one that was looked at before.
using Stamp = std::array<std::int64_t, 4>;

std::optional<Stamp> stampOf(const fs::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    return Stamp{static_cast<std::int64_t>(status.st_ino), status.st_size, status.st_mtim.tv_sec,
                 status.st_mtim.tv_nsec};
}

PmrContextDesc descOf(Log& log) {
    auto desc = PMR_INIT(PmrContextDesc);
    desc.message = logPluginMessage;
    desc.user = &log;
    return desc;
}

// Buckets of lines "A:B".
std::vector<bool> bucketsIn(const std::string& ranges, std::size_t count) {
    std::vector<bool> buckets(count);
    std::istringstream lines(ranges);
    std::size_t first = 0, last = 0;
    for (char colon = 0; lines >> first >> colon >> last;)
        for (std::size_t i = first; i < std::min(last, count); ++i) buckets[i] = true;
    return buckets;
}

// Parts as they come in, and which buckets came with which.
class Collection {
  public:
    Collection(const Options& options, Log& log)
        : m_log(log),
          m_plugin(options.plugin),
          m_context(m_plugin, descOf(log)),
          m_merge(m_context) {}

    const MergeRun& merged() const { return m_merge; }
    const std::vector<fs::path>& files() const { return m_in; }  // that are in

    // Whether one came in.
    bool takeAll(const std::vector<ListedPart>& listed) {
        bool isAnyNew = false;
        for (const ListedPart& part : listed) {
            throwIfInterrupted();
            if (take(part.file)) isAnyNew = true;
        }
        return isAnyNew;
    }
    void describe(std::vector<ListedPart> listed, WatchState& state) const {
        state.parts.clear();
        std::map<fs::path, int> places;
        const auto add = [&](ListedPart part) {
            places.emplace(part.file, static_cast<int>(state.parts.size()));
            const Known& known = m_known.at(part.file);
            state.parts.push_back({std::move(part), known.isIn, known.refusal, known.buckets});
        };
        for (ListedPart& part : listed) add(std::move(part));
        // One that is listed no more still counts.
        for (const fs::path& file : m_in)
            if (!places.contains(file)) add({file, {}, {}, false, 0});
        state.owners.clear();
        for (const int owner : m_owners)
            state.owners.push_back(owner < 0 ? -1
                                             : places.at(m_in.at(static_cast<std::size_t>(owner))));
    }

  private:
    struct Known {
        Stamp stamp{};  // of the last look
        bool isIn{};
        std::string refusal;
        std::uint32_t buckets{};
    };

    bool take(const fs::path& file) {
        Known& known = m_known[file];
        const auto stamp = stampOf(file);
        if (known.isIn || !stamp || *stamp == known.stamp) return false;
        known.stamp = *stamp;
        known.refusal = m_merge.tryAdd(file).value_or("");
        known.isIn = known.refusal.empty();
        if (known.isIn)
            own(file, known);
        else
            m_log.message(Level::kWarning, known.refusal + "; left out till it changes");
        return known.isIn;
    }
    void own(const fs::path& file, Known& known) {
        const std::size_t count = m_merge.bucketCount();
        m_owners.resize(count, -1);
        const std::vector<bool> missing = bucketsIn(m_merge.missing(), count);
        for (std::size_t i = 0; i < count; ++i) {
            if (missing[i] || m_owners[i] >= 0) continue;
            m_owners[i] = static_cast<int>(m_in.size());
            ++known.buckets;
        }
        m_in.push_back(file);
    }

    Log& m_log;
    Plugin m_plugin;
    PluginContext m_context;
    MergeRun m_merge;
    std::map<fs::path, Known> m_known;
    std::vector<fs::path> m_in;  // in the order in which they came
    std::vector<int> m_owners;   // of each bucket: index into m_in, -1: none yet
};

class Watch {
  public:
    Watch(const Options& options, Log& log)
        : m_options(options),
          m_log(log),
          m_collection(options, log),
          m_progress(options.progress, options.quiet, log) {
        m_state.name = options.outputs.front().filename().string();
    }

    int run() {
        checkFiles();
        if (!m_options.log.empty()) m_log.openFile(m_options.log);
        while (true) {
            look();
            const bool isWhole = m_state.isWhole();
            const int code = isWhole ? merge() : 0;
            writePage(isWhole);
            if (isWhole) return code;
            m_progress.update(m_state.share(), std::numeric_limits<double>::quiet_NaN());
            wait();
        }
    }

  private:
    void checkFiles() const {
        std::vector<fs::path> others = otherOutputs(m_options), parts;
        if (!m_options.watch->page.empty()) others.push_back(m_options.watch->page);
        std::vector<fs::path> all = m_options.outputs;
        all.insert(all.end(), others.begin(), others.end());
        std::error_code ignored;
        for (const fs::path& part : m_options.merge)
            if (!fs::is_directory(part, ignored)) parts.push_back(part);
        checkNotInputs(all, parts);
        checkOutputs(m_options.outputs, others, m_options.makeOutputPath);
    }
    void look() {
        std::vector<ListedPart> listed = listParts(m_options);
        const bool isAnyNew = m_collection.takeAll(listed);
        m_collection.describe(std::move(listed), m_state);
        if (!isAnyNew) return;
        m_state.picture =
            Session(m_options, m_log)
                .writeIncomplete(m_collection.merged(), !m_options.watch->page.empty());
        m_log.info(
            fmt::format("{} of {} buckets are there", m_state.bucketsIn(), m_state.owners.size()));
    }
    int merge() {
        Options options = m_options;
        options.log.clear();  // is open
        options.merge = m_collection.files();
        return Session(options, m_log).run();
    }
    void writePage(bool isLast) const {
        const WatchOptions& watch = *m_options.watch;
        if (watch.page.empty()) return;
        const int refresh = isLast ? 0 : static_cast<int>(std::ceil(watch.intervalSeconds));
        writeFinishedFile(watch.page, watchPage(m_state, refresh));
    }
    void wait() const {
        const auto interval = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(m_options.watch->intervalSeconds));
        for (const auto end = Clock::now() + interval; Clock::now() < end;
             std::this_thread::sleep_for(kGlance))
            throwIfInterrupted();
    }

    const Options& m_options;
    Log& m_log;
    Collection m_collection;
    Progress m_progress;
    WatchState m_state;
};

}  // namespace

int runWatch(const Options& options, Log& log) {
    return Watch(options, log).run();
}

}  // namespace pm::host
