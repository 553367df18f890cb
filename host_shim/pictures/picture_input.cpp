// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/picture_input.h"

#include <fmt/format.h>

#include "host_shim/values/host_error.h"

namespace pm::host {

void refusePicture(const std::filesystem::path& path, const std::string& text) {
    throw HostError(ExitCode::kBadInput, fmt::format("{}: {}", path.string(), text));
}

std::unique_ptr<OIIO::ImageInput> openPicture(const std::filesystem::path& path,
                                              const OIIO::ImageSpec& config) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) {
        const char* reason =
            std::filesystem::exists(path, failed) ? "is not a file" : "does not exist";
        throw HostError(ExitCode::kFile, fmt::format("{}: {}", path.string(), reason));
    }
    auto input = OIIO::ImageInput::open(path.string(), &config);
    if (!input) refusePicture(path, "can't be read as a picture: " + OIIO::geterror());
    return input;
}

std::vector<float> readValues(const std::filesystem::path& path, OIIO::ImageInput& input) {
    const OIIO::ImageSpec& spec = input.spec();
    std::vector<float> values(static_cast<std::size_t>(spec.width) *
                              static_cast<std::size_t>(spec.height) *
                              static_cast<std::size_t>(spec.nchannels));
    const bool good =
        input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data());
    const std::string text = input.geterror();
    if (!good || !text.empty()) refusePicture(path, "is broken or cut short: " + text);
    return values;
}

}  // namespace pm::host
