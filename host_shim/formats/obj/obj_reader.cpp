// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/obj_reader.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <future>
#include <istream>
#include <limits>
#include <span>
#include <streambuf>
#include <utility>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/obj/cage_tags.h"
#include "host_shim/formats/obj/material_library.h"
#include "host_shim/formats/obj/mesh_assembly.h"
#include "host_shim/formats/obj/obj_text.h"
#include "host_shim/formats/scene_centre.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/process/side_work.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

static_assert(sizeof(tinyobj::real_t) == sizeof(double), "the double-precision library is wanted");

// Materials are read by us; the parser only hands their numbers through.
class NumberedMaterials : public tinyobj::MaterialReader {
  public:
    bool operator()(const std::string& number, std::vector<tinyobj::material_t>*,
                    std::map<std::string, int>* names, std::string*, std::string*) override {
        names->emplace(number, std::stoi(number));
        return true;
    }
};

struct Parsed {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    ObjText text;
};

// Text for the parser, a part at a time, with a question before each whether to go on; the piece
// that comes after is made while the parser reads one. The parser takes a stop for the end of the
// text, so who asked throws once it has returned.
class TextInPieces : public std::streambuf {
  public:
    TextInPieces(ObjTextScan& scan, const GoOn& goOn, bool inThread)
        : m_scan(scan), m_goOn(goOn), m_inThread(inThread) {
        makeNext();
    }

    void throwIfStopped() const {
        if (m_stop) std::rethrow_exception(m_stop);
    }

  protected:
    int_type underflow() override {
        if (m_stop) return traits_type::eof();
        try {
            if (m_goOn) m_goOn();
            if (m_read == m_piece.size()) takeNext();
        } catch (...) {
            m_stop = std::current_exception();
        }
        if (m_stop || m_piece.empty()) return traits_type::eof();
        constexpr std::size_t kBetweenQuestions = 1 << 16;  // bytes
        char* const part = m_piece.data() + m_read;
        const std::size_t size = std::min(kBetweenQuestions, m_piece.size() - m_read);
        m_read += size;
        setg(part, part, part + size);
        return traits_type::to_int_type(*part);
    }

  private:
    void makeNext() {
        m_next = doBeside(m_inThread, [&scan = m_scan] { return scan.nextPiece(); });
    }
    void takeNext() {
        m_piece = m_next.get();
        m_read = 0;
        makeNext();
    }

    ObjTextScan& m_scan;
    const GoOn& m_goOn;
    bool m_inThread;
    std::string m_piece;
    std::size_t m_read = 0;  // of m_piece
    std::exception_ptr m_stop;
    std::future<std::string> m_next;
};

// What tinyobjloader reads of the text, and what the text says beside.
Parsed parse(std::string_view text, const std::string& fileName, const WarningSink& warn,
             const GoOn& goOn, bool inThread) {
    ObjTextScan scan(text, fileName);
    Parsed parsed;
    std::vector<tinyobj::material_t> materials;
    NumberedMaterials reader;
    std::string warning, error;
    TextInPieces pieces(scan, goOn, inThread);
    std::istream stream(&pieces);
    const bool good = tinyobj::LoadObj(&parsed.attributes, &parsed.shapes, &materials, &warning,
                                       &error, &stream, &reader, false, false);
    pieces.throwIfStopped();
    parsed.text = scan.finish(warn);
    if (!good) {
        std::ranges::replace(error, '\n', ' ');
        throw HostError(ExitCode::kBadInput, fmt::format("{}: {}", fileName, error));
    }
    return parsed;
}

// The text was checked; this holds the parser to it, since a bad index would be read out of bounds.
// Numbers of normals or texture coordinates of which there are none become -1.
void checkParsed(Parsed& parsed, const std::string& fileName) {
    const ObjText& text = parsed.text;
    const std::array<std::size_t, 3> counts{parsed.attributes.vertices.size() / 3,
                                            parsed.attributes.texcoords.size() / 2,
                                            parsed.attributes.normals.size() / 3};
    std::size_t face = 0, corner = 0;
    for (tinyobj::shape_t& shape : parsed.shapes) {
        for (tinyobj::index_t& index : shape.mesh.indices) {
            if (counts[1] == 0) index.texcoord_index = -1;
            if (counts[2] == 0) index.normal_index = -1;
            const std::array<int, 3> indices{index.vertex_index, index.texcoord_index,
                                             index.normal_index};
            for (std::size_t kind = 0; kind < 3; ++kind) {
                const bool missing = kind > 0 && indices[kind] == -1;
                if (missing || (indices[kind] >= 0 &&
                                static_cast<std::size_t>(indices[kind]) < counts[kind])) {
                    continue;
                }
                throw HostError(ExitCode::kBadInput,
                                fmt::format("{}:{}: face refers to index {} of {}", fileName,
                                            text.faceLines[face], indices[kind], counts[kind]));
            }
            if (++corner == text.faceSizes[face]) {
                corner = 0;
                ++face;
            }
        }
    }
    if (face != text.faceSizes.size() || corner != 0) {
        throw HostError(ExitCode::kInternal, fmt::format("{}: {} of {} faces were parsed", fileName,
                                                         face, text.faceSizes.size()));
    }
}

// Groups of tags only grow through the file.
std::span<const SubdivisionTag> tagsOfGroup(const ObjText& text, std::size_t group) {
    const auto first = std::ranges::lower_bound(text.tags, group, {}, &SubdivisionTag::group);
    const auto last = std::ranges::upper_bound(text.tags, group, {}, &SubdivisionTag::group);
    return {first, last};
}

void visitFaces(const tinyobj::attrib_t& attributes, const std::vector<tinyobj::shape_t>& shapes,
                const std::uint32_t* size, const std::function<void(const Bounds&)>& visit) {
    for (const tinyobj::shape_t& shape : shapes) {
        std::size_t corner = 0;
        for (std::size_t face = 0; face < shape.mesh.num_face_vertices.size(); ++face, ++size) {
            constexpr double kInfinity = std::numeric_limits<double>::infinity();
            Bounds bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
            for (std::uint32_t i = 0; i < *size; ++i, ++corner)
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const auto vertex =
                        static_cast<std::size_t>(shape.mesh.indices[corner].vertex_index);
                    const double value = attributes.vertices[vertex * 3 + axis];
                    bounds.low[axis] = std::min(bounds.low[axis], value);
                    bounds.high[axis] = std::max(bounds.high[axis], value);
                }
            visit(bounds);
        }
    }
}

MaterialLibrary readLibraries(std::string_view text, const ObjText& objText, LibrarySource source,
                              const ReadRules& rules, const WarningSink& warn, const GoOn& goOn) {
    if (const auto dialect = dialectByName(rules.mtlDialect))
        source.asked = DialectChoice{*dialect, "--mtl-dialect asks for it"};
    source.ofScene = dialectOfHeader(text, source.sceneName);
    SceneFiles files(source.folder, rules.files);
    return loadMaterials(objText, source, files, warn, goOn);
}

}  // namespace

SceneData readObj(std::string_view text, const std::string& fileName, const fs::path& folder,
                  const WarningSink& warn, const GoOn& goOn,
                  const std::optional<std::array<double, 3>>& eye, const ReadRules& rules) {
    const auto ask = [&goOn] {
        if (goOn) goOn();
    };
    Parsed parsed = parse(text, fileName, warn, goOn, rules.threads != 1);
    ask();
    checkParsed(parsed, fileName);
    const ObjText& objText = parsed.text;
    ask();
    SceneData scene;
    MaterialLibrary library = readLibraries(
        text, objText, {fileName, folder, {}, {}, rules.materials, rules.takes}, rules, warn, goOn);
    scene.materials = std::move(library.materials);
    scene.materialFiles = std::move(library.files);
    scene.bounds = boundsOfFaces(parsed.attributes, parsed.shapes);
    const EachFace forEachFace = [&](const auto& visit) {
        visitFaces(parsed.attributes, parsed.shapes, objText.faceSizes.data(), visit);
    };
    scene.centre = centreFor(forEachFace, scene.bounds, eye);
    MeshAssembly assembly(parsed.attributes, scene.centre);
    const auto defaultMaterial = static_cast<std::uint32_t>(scene.materials.size() - 1);
    for (const tinyobj::shape_t& shape : parsed.shapes) {
        const std::size_t faces = shape.mesh.num_face_vertices.size();
        if (faces == 0) continue;
        ask();
        MeshData& mesh = scene.meshes.emplace_back(assembly.assemble(
            shape, objText.faceSizes.data() + scene.faceCount, faces, defaultMaterial));
        const std::span<const SubdivisionTag> tags = tagsOfGroup(objText, scene.meshes.size() - 1);
        if (!tags.empty()) {
            mesh.tags = readCageTags(tags, assembly, {scene.faceCount, faces}, fileName, warn);
        }
        scene.faceCount += faces;
    }
    scene.placeEachMesh();
    return scene;
}

SceneData readObjFile(const fs::path& file, const WarningSink& warn, const GoOn& goOn,
                      const std::optional<std::array<double, 3>>& eye, const ReadRules& rules) {
    checkSceneFile(file, ObjReader().name());
    return readObj(readWholeFile(file), file.string(), file.parent_path(), warn, goOn, eye, rules);
}

std::span<const std::string_view> ObjReader::endings() const {
    static constexpr std::string_view kEndings[] = {".obj"};
    return kEndings;
}

SceneData ObjReader::read(const ReadRequest& request) const {
    return readObjFile(request.file, request.warn, request.goOn, request.eye, request.rules);
}

}  // namespace pm::host
