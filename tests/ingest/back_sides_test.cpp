// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Backs of lamps that shine from both sides.
#include <gtest/gtest.h>

#include "host_shim/formats/lamps.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

// Of group a the first face shines, the second not; vertices of a quad of side 2 in z = 0.
SceneData scene(const std::string& faces) {
    Heard heard;
    SceneData data = readObj(
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\no a\n"
        "usemtl lamp\n" +
            faces,
        "s.obj", ".", heard.sink);
    data.materials[0].emission = {1, 2, 3};
    data.materials[0].emitsFromBothSides = true;
    return data;
}

TEST(BackSides, AreTheSameFacesTurnedRoundAndSetBack) {
    SceneData data = scene("f 1/1/1 2/2/1 3/3/1\nusemtl wall\nf 1/1/1 3/3/1 4/1/1\nf 1 2 5\n");
    addBackSides(data);
    ASSERT_EQ(data.meshes.size(), 2u);
    const MeshData& front = data.meshes[0];
    const MeshData& back = data.meshes[1];
    EXPECT_EQ(back.faceSizes, std::vector<std::uint32_t>{3});
    EXPECT_EQ(back.slotMaterials, std::vector<std::uint32_t>{0});
    EXPECT_EQ(back.faceSlots, std::vector<std::uint32_t>{0});
    ASSERT_EQ(back.positions.size(), 9u);
    const double distance = 2e-5 * 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t ours = back.indices[i], theirs = front.indices[2 - i];
        for (std::size_t axis = 0; axis < 2; ++axis)
            EXPECT_EQ(back.positions[3 * ours + axis], front.positions[3 * theirs + axis]);
        EXPECT_NEAR(back.positions[3 * ours + 2] - front.positions[3 * theirs + 2], -distance,
                    1e-6);
        EXPECT_EQ(back.uvIndices[i], front.uvIndices[2 - i]);
        EXPECT_EQ(back.normals[3 * back.normalIndices[i] + 2], -1.0f);
    }
}

TEST(BackSides, AreNotForWhatIsClosedOrTaggedOrShinesOnce) {
    SceneData bulb = scene("f 1 2 5\nf 2 3 5\nf 3 1 5\nf 3 2 1\n");
    addBackSides(bulb);
    EXPECT_EQ(bulb.meshes.size(), 1u);
    SceneData tagged = scene("f 1 2 3 4\nt interpolateboundary 1/0/0 1\n");
    addBackSides(tagged);
    EXPECT_EQ(tagged.meshes.size(), 1u);
    SceneData dark = scene("f 1 2 3 4\n");
    dark.materials[0].emission = {};
    addBackSides(dark);
    EXPECT_EQ(dark.meshes.size(), 1u);
    SceneData usual = scene("f 1 2 3 4\n");
    usual.materials[0].emitsFromBothSides = false;
    addBackSides(usual);
    EXPECT_EQ(usual.meshes.size(), 1u);
    SceneData open = scene("f 1 2 3 4\n");
    addBackSides(open);
    EXPECT_EQ(open.meshes.size(), 2u);
}

}  // namespace
}  // namespace pm::host::test
