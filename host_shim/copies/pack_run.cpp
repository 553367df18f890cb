// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/pack_run.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <string_view>

#include "host_shim/colour/config_files.h"
#include "host_shim/copies/manifest.h"
#include "host_shim/copies/pack_check.h"
#include "host_shim/copies/pack_places.h"
#include "host_shim/copies/sha256.h"
#include "host_shim/folders/own_folder.h"
#include "host_shim/formats/scene_reader.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/session/read_rules.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr double kMib = 1024.0 * 1024.0;
constexpr mode_t kReadOnly = 0444;

bool isPack(const fs::path& folder) {
    return beginsWith(folder / "manifest.json", Manifest::beginning());
}

constexpr FolderKind kPackKind{"pack", "a folder", "pack -o", nullptr, isPack};

class Packing {
  public:
    Packing(const Options& options, Log& log)
        : m_options(options), m_log(log), m_folder(options.outputs.front()) {}

    int run() {
        OwnFolder::check(m_folder, kPackKind);
        collect();
        const OwnFolder own(m_folder, kPackKind);
        Manifest manifest = describe();
        for (const auto& [place, file] : m_places.files()) {
            throwIfInterrupted();
            manifest.files.push_back(store(place, file));
        }
        std::vector<std::string> read;
        for (const fs::path& file : m_read) read.push_back(m_places.placeOf(file));
        checkReadsTheSame(manifest, m_folder, m_options, read);
        const fs::path file = m_folder / "manifest.json";
        writeFinishedFile(file, manifest.toJson());
        m_log.info(fmt::format("wrote {}: {} files, {:.1f} MiB, of which {:.1f} MiB are new",
                               file.string(), manifest.files.size(),
                               static_cast<double>(manifest.bytes()) / kMib,
                               static_cast<double>(m_newBytes) / kMib));
        return 0;
    }

  private:
    void collect() {
        checkSceneFile(m_options.scene, "a scene");
        const WarningSink warn = [this](Warning code, const std::string& text) {
            m_log.warning(static_cast<int>(code), text);
        };
        m_places.addFile(m_options.scene);
        const SceneData scene = readScene(m_options, warn, m_options.camera.eye);
        std::error_code ignored;
        for (const fs::path& file : filesOf(scene))
            // Of what is missing the reader has warned, and a render will again.
            if (fs::exists(file, ignored)) {
                m_places.addFile(file);
                m_read.push_back(file);
            }
        m_config = filesOfConfig(m_options.colour);
        for (const fs::path& file : m_config) m_places.addFile(file);
        for (const fs::path& folder : m_options.reading.files.searchPaths)
            m_places.addSearchPath(folder);
    }
    Manifest describe() const {
        Manifest manifest;
        manifest.scene = m_places.placeOf(m_options.scene);
        manifest.base = m_places.base().string();
        manifest.folders = m_places.folders();
        for (const fs::path& folder : m_options.reading.files.searchPaths)
            manifest.searchPaths.push_back(m_places.placeOf(folder));
        if (!m_config.empty())
            manifest.ocio = {m_options.colour.ocioFile, m_places.placeOf(m_config.front())};
        if (const fs::path& sky = m_options.sky.environment; !sky.empty())
            manifest.environment = {sky.string(), m_places.placeOf(sky)};
        return manifest;
    }
    PackedFile store(const std::string& place, const fs::path& file) {
        PackedFile packed;
        packed.place = place;
        packed.sha256 = sha256OfFile(file, [&](std::string_view bytes) {
            throwIfInterrupted();
            packed.bytes += bytes.size();
        });
        const fs::path object = m_folder / objectPath(packed.sha256);
        std::error_code ignored;
        if (fs::is_regular_file(object, ignored) && fs::file_size(object, ignored) == packed.bytes)
            return packed;
        fs::create_directories(object.parent_path(), ignored);
        FinishedFile copy(object);
        const std::string copied = sha256OfFile(file, [&](std::string_view bytes) {
            throwIfInterrupted();
            copy.write(bytes);
        });
        if (copied != packed.sha256)
            throw HostError(ExitCode::kFile,
                            fmt::format("{}: was changed while it was packed", file.string()));
        ::fchmod(copy.descriptor(), kReadOnly);
        copy.commit();
        m_newBytes += packed.bytes;
        return packed;
    }

    const Options& m_options;
    Log& m_log;
    fs::path m_folder;
    PackPlaces m_places;
    std::vector<fs::path> m_read;    // for the scene, in the order in which it lists them
    std::vector<fs::path> m_config;  // and what it names; empty: the one that is built in
    std::uint64_t m_newBytes{};
};

}  // namespace

int runPack(const Options& options, Log& log) {
    return Packing(options, log).run();
}

}  // namespace pm::host
