// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/colour_config.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "host_shim/colour/built_in_config.h"

namespace pm::host {
namespace {

struct ProfileVersion {
    unsigned major{}, minor{};
    int line{};
};

// The value of the line "ocio_profile_version: 2.1"; none when there is no such line.
std::optional<ProfileVersion> profileVersion(const std::string& path) {
    constexpr std::string_view kKey = "ocio_profile_version:";
    std::ifstream file(path);
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        if (!line.starts_with(kKey)) continue;
        std::string_view text(line);
        text.remove_prefix(kKey.size());
        while (!text.empty() && (text.front() == ' ' || text.front() == '"')) text.remove_prefix(1);
        ProfileVersion version{0, 0, number};
        const char* end = text.data() + text.size();
        auto parsed = std::from_chars(text.data(), end, version.major);
        if (parsed.ec != std::errc{}) return std::nullopt;
        if (parsed.ptr != end && *parsed.ptr == '.') {
            std::from_chars(parsed.ptr + 1, end, version.minor);
        }
        return version;
    }
    return std::nullopt;
}

void checkVersion(const std::string& path) {
    const auto version = profileVersion(path);
    if (!version) return;  // the library itself says what it misses
    const auto libraryMajor = static_cast<unsigned>(OCIO::GetVersionHex()) >> 24;
    const auto libraryMinor = (static_cast<unsigned>(OCIO::GetVersionHex()) >> 16) & 0xffu;
    const bool newer = version->major > libraryMajor ||
                       (version->major == libraryMajor && version->minor > libraryMinor);
    if (!newer) return;
    throw HostError(
        ExitCode::kBadInput,
        fmt::format("{}:{}: ocio_profile_version: {}.{} is newer than OpenColorIO {} reads; "
                    "allowed is up to {}.{}",
                    path, version->line, version->major, version->minor, OCIO::GetVersion(),
                    libraryMajor, libraryMinor));
}

ColourConfig readConfig(const std::string& path, const std::string& option) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: the config {} does not exist", option, path));
    }
    if (!std::filesystem::is_regular_file(path, ignored) || !std::ifstream(path)) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: the config {} can't be read as a file", option, path));
    }
    checkVersion(path);
    ColourConfig chosen;
    chosen.name = path;
    chosen.config = guarded(fmt::format("{}: {}", option, path),
                            [&] { return OCIO::Config::CreateFromFile(path.c_str()); });
    return chosen;
}

bool declaresVariable(const OCIO::ConstConfigRcPtr& config, const std::string& key) {
    const int count = config->getNumEnvironmentVars();
    for (int i = 0; i < count; ++i) {
        if (key == config->getEnvironmentVarNameByIndex(i)) return true;
    }
    return count == 0 && config->getEnvironmentMode() == OCIO::ENV_ENVIRONMENT_LOAD_ALL;
}

void applyContext(ColourConfig& chosen, const ColourOptions& options) {
    const OCIO::ContextRcPtr context = chosen.config->getCurrentContext()->createEditableCopy();
    for (const auto& [key, value] : options.context) {
        context->setStringVar(key.c_str(), value.c_str());
        if (declaresVariable(chosen.config, key)) continue;
        std::vector<std::string> declared;
        for (int i = 0; i < chosen.config->getNumEnvironmentVars(); ++i) {
            declared.emplace_back(chosen.config->getEnvironmentVarNameByIndex(i));
        }
        chosen.warnings.push_back(
            fmt::format("--context {}={}: the config {} declares no such variable; it declares {}",
                        key, value, chosen.name, quotedList(declared)));
    }
    chosen.context = context;
}

}  // namespace

std::pair<std::string, std::string> parseContextVariable(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
        throw HostError(ExitCode::kUsage, fmt::format("--context {}: allowed is KEY=VALUE", text));
    }
    return {text.substr(0, equals), text.substr(equals + 1)};
}

ColourConfig chooseConfig(const ColourOptions& options) {
    const char* variable = std::getenv("OCIO");
    ColourConfig chosen;
    if (!options.ocioFile.empty()) {
        chosen = readConfig(options.ocioFile, "--ocio");
    } else if (variable != nullptr && *variable != '\0') {
        chosen = readConfig(variable, "$OCIO");
    } else {
        chosen = builtInColourConfig();
    }
    applyContext(chosen, options);
    return chosen;
}

ColourConfig builtInColourConfig() {
    ColourConfig built;
    built.config = makeBuiltInConfig();
    built.context = built.config->getCurrentContext();
    built.name = "built-in";
    built.isBuiltIn = true;
    return built;
}

}  // namespace pm::host
