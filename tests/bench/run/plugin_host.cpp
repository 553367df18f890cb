// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/plugin_host.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <numbers>

#include "integrator/values/error.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

// The handles of one scene and one render, let go in the right order.
class Session {
  public:
    explicit Session(const PmrApi& api) : m_api(api) {
        const PmrContextDesc desc = PMR_INIT(PmrContextDesc);
        check(m_api.createContext(&desc, &m_context));
        const PmrSceneDesc sceneDesc = PMR_INIT(PmrSceneDesc);  // linear Rec.709
        check(m_api.createScene(m_context, &sceneDesc, &m_scene));
    }
    ~Session() {
        if (m_render != nullptr) m_api.destroyRender(m_render);
        for (const PmrMaterial material : m_materials) m_api.releaseMaterial(material);
        if (m_scene != nullptr) m_api.releaseScene(m_scene);
        m_api.releaseContext(m_context);
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void build(const NeutralScene& scene);
    void render(const Settings& settings);
    std::vector<float> pixels(std::int32_t size) const;
    std::string statistics() const;

  private:
    void check(PmrStatus status) const;
    PmrMaterial material(const PmrMaterialDesc& desc);
    void add(PmrMesh mesh, PmrMaterial material);
    void addQuad(const NeutralQuad& quad, PmrMaterial material);
    void addSphere(const NeutralSphere& sphere, PmrMaterial material);
    void addMesh(const NeutralMesh& mesh, PmrMaterial material);
    void setCamera(const NeutralCamera& camera);

    const PmrApi& m_api;
    PmrContext m_context = nullptr;
    PmrScene m_scene = nullptr;
    PmrRender m_render = nullptr;
    std::vector<PmrMaterial> m_materials;
};

void Session::check(PmrStatus status) const {
    if (status == PMR_OK) return;
    std::array<char, 1024> text{};
    if (m_context != nullptr) m_api.lastError(m_context, text.data(), text.size(), nullptr);
    throw Error(Status::kInternal,
                std::string(m_api.statusText(status)) + ": " + std::string(text.data()));
}

PmrMaterial Session::material(const PmrMaterialDesc& desc) {
    PmrMaterial made = nullptr;
    check(m_api.createMaterial(m_context, &desc, &made));
    m_materials.push_back(made);
    return made;
}

void Session::add(PmrMesh mesh, PmrMaterial material) {
    PmrInstanceDesc desc = PMR_INIT(PmrInstanceDesc);
    desc.mesh = mesh;
    desc.materials = &material;
    desc.materialCount = 1;
    const PmrStatus status = m_api.addInstance(m_scene, &desc);
    m_api.releaseMesh(mesh);
    check(status);
}

void Session::addQuad(const NeutralQuad& quad, PmrMaterial material) {
    std::array<float, 12> positions{};
    const std::array<Vec3d, 4> corners = {quad.p, quad.p + quad.e0, quad.p + quad.e0 + quad.e1,
                                          quad.p + quad.e1};
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] = static_cast<float>(corners[i / 3][static_cast<int>(i % 3)]);
    static constexpr std::array<std::uint32_t, 4> kIndices = {0, 1, 2, 3};
    static constexpr std::uint32_t kFaceSize = 4;
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = positions.data();
    desc.positionCount = 4;
    desc.faceSizes = &kFaceSize;
    desc.faceCount = 1;
    desc.indices = kIndices.data();
    desc.indexCount = 4;
    PmrMesh mesh = nullptr;
    check(m_api.createMesh(m_context, &desc, &mesh));
    add(mesh, material);
}

void Session::addSphere(const NeutralSphere& sphere, PmrMaterial material) {
    PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
    for (int axis = 0; axis < 3; ++axis) desc.centre[axis] = sphere.centre[axis];
    desc.radius = sphere.radius;
    PmrMesh mesh = nullptr;
    check(m_api.createSphere(m_context, &desc, &mesh));
    add(mesh, material);
}

void Session::addMesh(const NeutralMesh& mesh, PmrMaterial material) {
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = &mesh.positions.data()->x;
    desc.positionCount = mesh.positions.size();
    desc.faceCount = mesh.triangles.size();
    desc.indices = mesh.triangles.data()->data();
    desc.indexCount = 3 * mesh.triangles.size();
    PmrMesh made = nullptr;
    check(m_api.createMesh(m_context, &desc, &made));
    add(made, material);
}

void Session::setCamera(const NeutralCamera& camera) {
    const CameraAxes axes = axesOf(camera);
    std::array<double, 12> transform{};
    for (int row = 0; row < 3; ++row) {
        double* const at = transform.data() + 4 * row;
        at[0] = axes.right[row];
        at[1] = axes.up[row];
        at[2] = axes.back[row];
        at[3] = camera.position[row];
    }
    PmrCameraDesc desc = PMR_INIT(PmrCameraDesc);
    desc.transforms = transform.data();
    desc.transformCount = 1;
    desc.fieldOfView = camera.verticalDegrees * std::numbers::pi / 180;
    check(m_api.setCamera(m_scene, &desc));
}

void Session::build(const NeutralScene& scene) {
    std::map<std::string, PmrMaterial> materials;
    for (const auto& [name, rgb] : scene.reflectances) {
        PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
        for (int c = 0; c < 3; ++c) desc.diffuse[c] = rgb[c];
        materials[name] = material(desc);
    }
    PmrMaterialDesc lamp = PMR_INIT(PmrMaterialDesc), mirror = lamp, glass = lamp;
    mirror.kind = PMR_MATERIAL_MIRROR;
    glass.kind = PMR_MATERIAL_DIELECTRIC;
    glass.ior = 1.5f;
    for (int c = 0; c < 3; ++c) {
        lamp.emission[c] = scene.radiance[c];
        mirror.glossy[c] = glass.transmission[c] = 1;
    }
    materials["mirror"] = material(mirror);
    materials["glass"] = material(glass);
    for (const NeutralQuad& quad : scene.quads) addQuad(quad, materials.at(quad.material));
    for (const NeutralSphere& sphere : scene.spheres)
        addSphere(sphere, materials.at(sphere.material));
    for (const NeutralMesh& mesh : scene.meshes) addMesh(mesh, materials.at(mesh.material));
    addQuad(scene.lamp, material(lamp));
    setCamera(scene.camera);
    check(m_api.commitScene(m_scene));
}

void Session::render(const Settings& settings) {
    check(m_api.createRender(m_scene, nullptr, &m_render));
    for (const auto& [name, value] : settings)
        check(m_api.setSettingText(m_render, name.c_str(), value.c_str()));
    check(m_api.startRender(m_render));
    check(m_api.waitRender(m_render, -1.0));
}

std::vector<float> Session::pixels(std::int32_t size) const {
    const PmrRectangle whole = {0, 0, size, size};
    const auto side = static_cast<std::size_t>(size);
    std::vector<float> rgba(4 * side * side);
    check(m_api.readPixels(m_render, &whole, "beauty", rgba.data(), 0, 0));
    return rgba;
}

std::string Session::statistics() const {
    std::uint64_t needed = 0;
    check(m_api.renderStatistics(m_render, nullptr, 0, &needed));
    std::string text(needed, '\0');
    check(m_api.renderStatistics(m_render, text.data(), text.size(), &needed));
    text.resize(needed - 1);
    return text;
}

}  // namespace

PluginHost::PluginHost(const std::filesystem::path& library) {
    void* const module = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) throw Error(Status::kIo, dlerror());
    const auto getApi = reinterpret_cast<PmrGetApiFunction>(dlsym(module, "pmrGetApi"));
    if (getApi == nullptr || getApi(PMR_ABI_VERSION, &m_api) != PMR_OK)
        throw Error(Status::kIo, library.string() + ": does not offer this version's interface");
}

bool PluginHost::offers(const std::string& setting, const std::string& choice) const {
    for (std::uint32_t i = 0; i < m_api->settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        if (m_api->settingInfo(i, &info) != PMR_OK || setting != info.name) continue;
        const std::string choices = fmt::format(",{},", info.choices);
        return choices.find(fmt::format(",{},", choice)) != std::string::npos;
    }
    return false;
}

double PluginHost::least(const std::string& setting) const {
    for (std::uint32_t i = 0; i < m_api->settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        if (m_api->settingInfo(i, &info) == PMR_OK && setting == info.name) return info.minimum;
    }
    throw Error(Status::kInternal, "the library has no setting " + setting);
}

HostedRender PluginHost::render(const NeutralScene& scene, const Settings& settings) const {
    const double processorStart = processorSeconds();
    const auto start = std::chrono::steady_clock::now();
    Session session(*m_api);
    session.build(scene);
    Settings all = settings;
    all["width"] = all["height"] = std::to_string(scene.size);
    session.render(all);
    const std::vector<float> rgba = session.pixels(scene.size);
    HostedRender result;
    result.seconds = secondsSince(start);
    result.processorSeconds = processorSeconds() - processorStart;
    for (std::size_t i = 0; i < rgba.size(); ++i)
        if (i % 4 != 3) result.rgb.push_back(static_cast<double>(rgba[i]));
    result.statistics = session.statistics();
    return result;
}

}  // namespace pm::bench
