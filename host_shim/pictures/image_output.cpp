// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/image_output.h"

namespace pm::host {

void writeImage(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                const std::function<bool(OIIO::ImageOutput&)>& write) {
    FinishedFile finished(path);
    CheckedFile file(finished, path);
    const std::string name = finished.temporaryPath().string();
    const auto output = OIIO::ImageOutput::create(name);
    if (!output) failWriting(path, 0, OIIO::geterror());
    output->set_ioproxy(&file);
    bool good = output->open(name, spec) && write(*output);
    good = output->close() && good;
    const std::string text = output->geterror();
    if (const int error = file.finish()) failWriting(path, error, text);
    if (!good || !text.empty()) failWriting(path, 0, text);
    finished.commit();
}

}  // namespace pm::host
