// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Textures through the interface: a square in front of the camera that emits its picture.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

// 2 x 2 texels, top row first: red, green / blue, white.
std::string writePicture() {
    const std::string name =
        ::testing::TempDir() + "pm_four_texels." + std::to_string(getpid()) + ".ppm";
    const unsigned char texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
    FILE* file = std::fopen(name.c_str(), "wb");
    std::fputs("P6\n2 2\n255\n", file);
    std::fwrite(texels, 1, sizeof texels, file);
    std::fclose(file);
    return name;
}

// The middle pixels of the four quarters: top left, top right, bottom left, bottom right; and one
// in the middle of the top row.
std::vector<std::vector<float>> renderQuarters(PmrTextureDesc texture) {
    const BoxHost host;
    const std::string name = writePicture();
    texture.fileName = name.c_str();
    const float positions[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    const std::uint32_t size = 4, indices[4] = {0, 1, 2, 3};
    PmrMeshDesc square = PMR_INIT(PmrMeshDesc);
    square.positions = positions;
    square.positionCount = 4;
    square.faceSizes = &size;
    square.faceCount = 1;
    square.indices = indices;
    square.indexCount = 4;
    square.uvs = uvs;
    square.uvCount = 4;
    PmrMesh mesh = nullptr;
    PmrTexture picture = nullptr;
    PmrMaterial material = nullptr;
    PmrScene scene = nullptr;
    EXPECT_EQ(PMR_OK, api().createMesh(host.context(), &square, &mesh)) << host.lastError();
    EXPECT_EQ(PMR_OK, api().createTexture(host.context(), &texture, &picture)) << host.lastError();
    PmrMaterialDesc surface = PMR_INIT(PmrMaterialDesc);
    for (float& value : surface.emission) value = 2.0f;
    surface.emissionTexture = picture;
    EXPECT_EQ(PMR_OK, api().createMaterial(host.context(), &surface, &material));
    EXPECT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &scene));
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    instance.mesh = mesh;
    instance.materials = &material;
    instance.materialCount = 1;
    EXPECT_EQ(PMR_OK, api().addInstance(scene, &instance)) << host.lastError();
    // The square fills the frame: half its height over the distance is the tangent of half the
    // angle.
    const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1};
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.transforms = transform;
    camera.transformCount = 1;
    camera.fieldOfView = 1.5707963267948966;
    EXPECT_EQ(PMR_OK, api().setCamera(scene, &camera));
    EXPECT_EQ(PMR_OK, api().commitScene(scene)) << host.lastError();
    PmrRender render = nullptr;
    EXPECT_EQ(PMR_OK, api().createRender(scene, nullptr, &render));
    api().setSettingInteger(render, "width", 32);
    api().setSettingInteger(render, "height", 32);
    api().setSettingInteger(render, "photons", 1000);
    EXPECT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0)) << host.lastError();
    std::vector<std::vector<float>> quarters;
    for (const PmrRectangle corner :
         {PmrRectangle{2, 2, 3, 3}, PmrRectangle{29, 2, 30, 3}, PmrRectangle{2, 29, 3, 30},
          PmrRectangle{29, 29, 30, 30}, PmrRectangle{16, 2, 17, 3}})
        quarters.push_back(readLayer(render, "emission", 3, corner));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().releaseMaterial(material));
    EXPECT_EQ(PMR_OK, api().releaseTexture(picture));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
    std::remove(name.c_str());
    return quarters;
}

void expectColour(const std::vector<float>& found, float r, float g, float b) {
    EXPECT_NEAR(r, found[0], 0.02f);
    EXPECT_NEAR(g, found[1], 0.02f);
    EXPECT_NEAR(b, found[2], 0.02f);
}

TEST(Textures, OriginIsBottomLeft) {
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.wrapS = desc.wrapT = PMR_WRAP_CLAMP;
    const auto quarters = renderQuarters(desc);
    expectColour(quarters[0], 2, 0, 0);
    expectColour(quarters[1], 0, 2, 0);
    expectColour(quarters[2], 0, 0, 2);
    expectColour(quarters[3], 2, 2, 2);
}

TEST(Textures, OffsetGainAndBase) {
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.wrapS = desc.wrapT = PMR_WRAP_CLAMP;
    desc.uvOffset[0] = 5.0f;  // beyond the right edge: its column everywhere
    desc.gain = 0.5f;
    desc.base = 0.25f;
    const auto quarters = renderQuarters(desc);
    expectColour(quarters[0], 0.5f, 1.5f, 0.5f);
    expectColour(quarters[2], 1.5f, 1.5f, 1.5f);
}

// Of a light, and before anything is interpolated: halfway from red to green there is some of both.
TEST(Textures, TexelsBelowNothingShineNot) {
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.wrapS = desc.wrapT = PMR_WRAP_CLAMP;
    desc.base = -0.5f;
    const auto quarters = renderQuarters(desc);
    expectColour(quarters[0], 1, 0, 0);
    expectColour(quarters[1], 0, 1, 0);
    expectColour(quarters[3], 1, 1, 1);
    expectColour(quarters[4], 0.47f, 0.53f, 0);
}

TEST(Textures, WrapModes) {
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.uvOffset[0] = 1.0f;
    desc.wrapT = PMR_WRAP_CLAMP;
    desc.wrapS = PMR_WRAP_BLACK;
    expectColour(renderQuarters(desc)[3], 0, 0, 0);
    desc.wrapS = PMR_WRAP_MIRROR;  // the second copy runs backwards
    expectColour(renderQuarters(desc)[0], 0, 2, 0);
}

// What is no regular file never reaches the picture library, which would read it for ever.
TEST(Textures, AreRegularFiles) {
    const BoxHost host;
    std::string folder = ::testing::TempDir() + "pm_odd.XXXXXX";
    ASSERT_NE(nullptr, mkdtemp(folder.data()));
    const std::string pipe = folder + "/pipe.png", empty = folder + "/empty.png",
                      link = folder + "/link.png", lost = folder + "/lost.png";
    ASSERT_EQ(0, mkfifo(pipe.c_str(), 0600));
    std::fclose(std::fopen(empty.c_str(), "wb"));
    ASSERT_EQ(0, symlink("/dev/zero", link.c_str()));
    ASSERT_EQ(0, symlink(lost.c_str(), lost.c_str()));
    const std::vector<std::pair<std::string, std::string>> rows = {
        {"/dev/zero", "is a device"},
        {link, "is a device"},
        {pipe, "is a pipe"},
        {folder, "is a folder"},
        {empty, "is empty"},
        {"/proc/self/maps", "is made by the kernel"},
        {"/proc/kcore", "is made by the kernel"},
        {"/sys/kernel/mm/transparent_hugepage/enabled", "is made by the kernel"},
        {lost, "symbolic links"},
        {folder + "/none.png", "No such file"},
        {folder + "/none.null", "No such file"}};  // a name that the library makes up a picture for
    for (const auto& [file, why] : rows) {
        if (file.starts_with("/") && !file.starts_with(folder) && access(file.c_str(), F_OK) != 0)
            continue;
        PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
        desc.fileName = file.c_str();
        PmrTexture texture = nullptr;
        EXPECT_EQ(PMR_ERROR_IO, api().createTexture(host.context(), &desc, &texture)) << file;
        EXPECT_NE(std::string::npos, host.lastError().find(file)) << host.lastError();
        EXPECT_NE(std::string::npos, host.lastError().find(why)) << host.lastError();
    }
    std::filesystem::remove_all(folder);
}

TEST(Textures, TilesAreChecked) {
    const BoxHost host;
    const std::string name = writePicture();
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    desc.fileName = name.c_str();
    PmrTexture picture = nullptr;
    ASSERT_EQ(PMR_OK, api().createTexture(host.context(), &desc, &picture)) << host.lastError();
    const PmrTexture both[2] = {picture, picture}, none[2] = {nullptr, picture};
    const std::uint32_t good[2] = {1002, 1011}, same[2] = {1002, 1002}, low[2] = {1000, 1001};
    const auto made = [&](const PmrTexture* tiles, const std::uint32_t* numbers) {
        desc.tiles = tiles;
        desc.tileNumbers = numbers;
        desc.tileCount = 2;
        PmrTexture texture = nullptr;
        const PmrStatus status = api().createTexture(host.context(), &desc, &texture);
        if (texture != nullptr) api().releaseTexture(texture);
        return status;
    };
    EXPECT_EQ(PMR_OK, made(both, good)) << host.lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, made(both, same));
    EXPECT_NE(std::string::npos, host.lastError().find("twice")) << host.lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, made(both, low));
    EXPECT_NE(std::string::npos, host.lastError().find("1001 to 9999")) << host.lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, made(none, good));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, made(both, nullptr));
    api().releaseTexture(picture);
    std::remove(name.c_str());
}

}  // namespace

}  // namespace pm::test
