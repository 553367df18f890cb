// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

// What a scene's options may not say, as the suite says it.
constexpr std::string_view kOwnOptions[] = {"-o",     "--output", "--reference", "--stats",
                                            "--seed", "--report", "--log",       "--progress"};

constexpr std::size_t kMostNameLength = 100;
// Each scene has all that are common, so that both have to be bounded.
constexpr std::size_t kMostScenes = 10000, kMostOptions = 1000;

class SuiteReader {
  public:
    explicit SuiteReader(const fs::path& file) { m_suite.file = file; }

    Suite read() {
        const json text = parseJsonFile(m_suite.file, throwIfInterrupted);
        m_suite.folder = fs::absolute(m_suite.file).parent_path();
        readAll(text);
        return std::move(m_suite);
    }

  private:
    [[noreturn]] void fail(const std::string& text) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}: {}", m_suite.file.string(), text));
    }

    void checkKeys(const json& object, const std::string& where,
                   std::initializer_list<std::string_view> allowed) const {
        if (!object.is_object()) fail(where + " must be an object");
        for (const auto& [key, value] : object.items())
            if (std::ranges::find(allowed, key) == allowed.end())
                fail(fmt::format("{} has no '{}'; allowed are {}", where, key,
                                 fmt::join(allowed, ", ")));
    }

    std::string text(const json& object, const char* key, const std::string& where) const {
        if (!object.contains(key) || !object[key].is_string() ||
            object[key].get_ref<const std::string&>().empty())
            fail(fmt::format("{}: '{}' must be a text that is not empty", where, key));
        return object[key];
    }

    std::vector<std::string> options(const json& object, const std::string& where) const {
        std::vector<std::string> result;
        if (!object.contains("options")) return result;
        const json& list = object["options"];
        if (!list.is_array() || list.size() > kMostOptions)
            fail(fmt::format("{}: 'options' must be a list of at most {} texts", where,
                             kMostOptions));
        for (const json& entry : list) {
            if (!entry.is_string()) fail(where + ": 'options' must be a list of texts");
            const std::string option = entry;
            const std::string name = option.substr(0, option.find('='));
            if (std::ranges::find(kOwnOptions, name) != std::end(kOwnOptions))
                fail(fmt::format("{}: {} is for the check itself to say", where, name));
            result.push_back(option);
        }
        return result;
    }

    void readScene(const json& entry, const std::string& where,
                   const std::vector<std::string>& common) {
        checkKeys(entry, where, {"name", "scene", "options", "display", "codeLimit"});
        SuiteScene scene;
        scene.name = text(entry, "name", where);
        const bool isPlain = std::ranges::all_of(scene.name, [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                   c == '_' || c == '-';
        });
        if (!isPlain) fail(fmt::format("{}: 'name' is of letters, digits, _ and - only", where));
        if (scene.name.size() > kMostNameLength)
            fail(fmt::format("{}: 'name' has at most {} letters", where, kMostNameLength));
        // References of both have to find room on any file system.
        if (!m_names.insert(lowerCase(scene.name)).second)
            fail(fmt::format("{}: the name '{}' is there twice", where, scene.name));
        scene.scene = m_suite.folder / text(entry, "scene", where);
        scene.options = common;
        for (std::string& option : options(entry, where))
            scene.options.push_back(std::move(option));
        // One that is measured would hide what makes the picture darker.
        const auto isExposure = [](const std::string& option) {
            return option == "--exposure" || option.starts_with("--exposure=");
        };
        if (std::ranges::none_of(scene.options, isExposure))
            scene.options.insert(scene.options.end(), {"--exposure", "0"});
        if (entry.contains("display")) {
            if (!entry["display"].is_boolean()) fail(where + ": 'display' must be true or false");
            scene.hasDisplay = entry["display"];
        }
        if (entry.contains("codeLimit")) {
            const json& limit = entry["codeLimit"];
            if (!limit.is_number() || !(limit >= 0) || !(limit <= 255))
                fail(where + ": 'codeLimit' must be a number from 0 to 255");
            scene.codeLimit = limit;
        }
        m_suite.scenes.push_back(std::move(scene));
    }

    void readAll(const json& all) {
        checkKeys(all, "the suite", {"$schema", "schema", "references", "options", "scenes"});
        if (text(all, "schema", "the suite") != "pm-suite/1")
            fail("'schema' must be \"pm-suite/1\"");
        const bool isNamed = all.contains("references");
        m_suite.references =
            m_suite.folder / (isNamed ? text(all, "references", "the suite") : "references");
        const std::vector<std::string> common = options(all, "the suite");
        const auto scenes = all.find("scenes");
        if (scenes == all.end() || !scenes->is_array() || scenes->empty() ||
            scenes->size() > kMostScenes)
            fail(fmt::format("'scenes' must be a list of at least one scene and at most {}",
                             kMostScenes));
        for (std::size_t i = 0; i < scenes->size(); ++i) {
            throwIfInterrupted();
            readScene((*scenes)[i], fmt::format("scene {}", i + 1), common);
        }
    }

    Suite m_suite;
    std::set<std::string> m_names;  // in small letters
};

}  // namespace

Suite readSuite(const fs::path& file) {
    return SuiteReader(file).read();
}

std::string namesOf(const Suite& suite) {
    std::string names;
    for (const SuiteScene& scene : suite.scenes) names += (names.empty() ? "" : ", ") + scene.name;
    return names;
}

}  // namespace pm::host
