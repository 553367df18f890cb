// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/texture_bake.h"
#include "tests/colour/bake_support.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {
namespace {

class BakeRefusal : public ScratchTest {
  protected:
    std::string refused(const TextureRequest& request, const std::string& into = ".") const {
        return refusal([&] { TextureBaker(m_colour, file(into)).bake(request); });
    }
    void writeNoise(const std::string& name) const {
        std::vector<float> values;
        std::uint32_t state = 1;
        for (int i = 0; i < 64 * 64 * 3; ++i) {
            state = state * 1664525u + 1013904223u;
            values.push_back(static_cast<float>(state >> 24) / 255.0f);
        }
        writeTexture(file(name), 64, 64, 3, OIIO::TypeDesc::UINT8, values);
    }

    ColourPipeline m_colour{ColourOptions{}};
};

TEST_F(BakeRefusal, MissingFilesAndFolders) {
    EXPECT_TRUE(refusesWith(refused({file("none.png")}), 4, {"none.png", "does not exist"}));
    EXPECT_TRUE(refusesWith(refused({folder()}), 4, {"is not a file"}));
    writeNoise("a.png");
    EXPECT_TRUE(refusesWith(refused({file("a.png")}, "nowhere"), 4, {"nowhere", "a."}));
    EXPECT_TRUE(refusesWith(refused({file("a.png"), TextureKind::kColour, "xyz"}), 3,
                            {"-colorspace", "'xyz'"}));
}

TEST_F(BakeRefusal, BrokenFiles) {
    writeBytes(file("text.png"), "no picture at all");
    EXPECT_TRUE(refusesWith(refused({file("text.png")}), 3, {"text.png"}));
    writeBytes(file("empty.jpg"), "");
    EXPECT_TRUE(refusesWith(refused({file("empty.jpg")}), 3, {"empty.jpg"}));
    std::vector<std::string> names{"a.jpg", "a.tif", "a.exr"};
#ifndef __SANITIZE_ADDRESS__
    // OpenImageIO 2.4.7's PNG reader leaks its message when libpng jumps out of a cut file.
    names.emplace_back("a.png");
#endif
    for (const std::string& name : names) {
        writeNoise(name);
        const std::string bytes = readBytes(file(name));
        writeBytes(file(name), bytes.substr(0, bytes.size() / 2));
        EXPECT_TRUE(refusesWith(refused({file(name)}), 3, {name})) << name;
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder())) {
        EXPECT_NE(entry.path().extension(), ".tx");
    }
}

}  // namespace
}  // namespace pm::host::test
