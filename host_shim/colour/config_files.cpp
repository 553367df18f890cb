// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/config_files.h"

#include <fmt/format.h>

#include <set>

#include "host_shim/colour/colour_config.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// The names that FileTransforms give.
class NamedFiles {
  public:
    explicit NamedFiles(const OCIO::ConstConfigRcPtr& config) {
        addSpaces(config);
        for (int i = 0; i < config->getNumLooks(); ++i) {
            const auto look = config->getLook(config->getLookNameByIndex(i));
            add(look->getTransform());
            add(look->getInverseTransform());
        }
        for (int i = 0; i < config->getNumViewTransforms(); ++i) {
            const auto view = config->getViewTransform(config->getViewTransformNameByIndex(i));
            add(view->getTransform(OCIO::VIEWTRANSFORM_DIR_TO_REFERENCE));
            add(view->getTransform(OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE));
        }
        for (int i = 0; i < config->getNumNamedTransforms(OCIO::NAMEDTRANSFORM_ALL); ++i) {
            const auto named = config->getNamedTransform(
                config->getNamedTransformNameByIndex(OCIO::NAMEDTRANSFORM_ALL, i));
            add(named->getTransform(OCIO::TRANSFORM_DIR_FORWARD));
            add(named->getTransform(OCIO::TRANSFORM_DIR_INVERSE));
        }
    }
    const std::set<std::string>& names() const { return m_names; }

  private:
    void addSpaces(const OCIO::ConstConfigRcPtr& config) {
        constexpr auto kKind = OCIO::SEARCH_REFERENCE_SPACE_ALL;
        const int count = config->getNumColorSpaces(kKind, OCIO::COLORSPACE_ALL);
        for (int i = 0; i < count; ++i) {
            const auto space = config->getColorSpace(
                config->getColorSpaceNameByIndex(kKind, OCIO::COLORSPACE_ALL, i));
            add(space->getTransform(OCIO::COLORSPACE_DIR_TO_REFERENCE));
            add(space->getTransform(OCIO::COLORSPACE_DIR_FROM_REFERENCE));
        }
    }
    void add(const OCIO::ConstTransformRcPtr& transform) {
        if (!transform) return;
        if (const auto group = OCIO_DYNAMIC_POINTER_CAST<const OCIO::GroupTransform>(transform)) {
            for (int i = 0; i < group->getNumTransforms(); ++i) add(group->getTransform(i));
        } else if (const auto file =
                       OCIO_DYNAMIC_POINTER_CAST<const OCIO::FileTransform>(transform)) {
            m_names.insert(file->getSrc());
        }
    }

    std::set<std::string> m_names;
};

// The config's own search path in the context, without what is absolute.
OCIO::ContextRcPtr relativeOnly(const OCIO::ConstContextRcPtr& context) {
    const OCIO::ContextRcPtr relative = context->createEditableCopy();
    relative->clearSearchPaths();
    for (int i = 0; i < context->getNumSearchPaths(); ++i) {
        const std::string path = context->resolveStringVar(context->getSearchPath(i));
        if (!fs::path(path).is_absolute()) relative->addSearchPath(path.c_str());
    }
    return relative;
}

// None where there is no such file.
fs::path found(const OCIO::ConstContextRcPtr& context, const std::string& name) {
    try {
        return context->resolveFileLocation(name.c_str());
    } catch (const OCIO::Exception&) {
        return {};
    }
}

}  // namespace

std::vector<fs::path> filesOfConfig(const ColourOptions& options) {
    const ColourConfig chosen = chooseConfig(options);
    if (chosen.isBuiltIn) return {};
    std::vector<fs::path> files{chosen.name};
    const OCIO::ContextRcPtr relative = relativeOnly(chosen.context);
    const NamedFiles named(chosen.config);
    for (const std::string& name : named.names()) {
        const fs::path file = found(chosen.context, name);
        if (file.empty()) continue;
        const bool isAbsolute =
            fs::path(chosen.context->resolveStringVar(name.c_str())).is_absolute();
        if (isAbsolute || found(relative, name) != file)
            throw HostError(
                ExitCode::kBadInput,
                fmt::format("{}: '{}' is found by an absolute path, {}; what is to be copied wants "
                            "a search_path that begins where the config is",
                            chosen.name, name, file.string()));
        files.push_back(file);
    }
    return files;
}

}  // namespace pm::host
