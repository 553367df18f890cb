// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/cage_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

class TagReader {
  public:
    TagReader(const MeshAssembly& assembly, FaceRange faces, const std::string& fileName,
              const WarningSink& warn)
        : m_assembly(assembly), m_faces(faces), m_file(fileName), m_warn(warn) {}

    void read(const SubdivisionTag& tag) {
        const auto known = std::ranges::find(kTags, tag.name, &Tag::name);
        if (known != kTags.end()) {
            (this->*known->read)(tag);
        } else {
            m_warn(Warning::kSubdivision, fmt::format("{}:{}: subdivision tag '{}' is not obeyed",
                                                      m_file, tag.line, tag.name));
        }
    }

    static std::vector<std::string> names() {
        std::vector<std::string> all;
        for (const Tag& tag : kTags) all.emplace_back(tag.name);
        return all;
    }

    CageTags take() { return std::move(m_tags); }

  private:
    [[noreturn]] void fail(const SubdivisionTag& tag, const std::string& text) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}:{}: {}", m_file, tag.line, text));
    }

    std::uint32_t vertex(const SubdivisionTag& tag, std::int64_t index) const {
        const std::uint32_t local = m_assembly.localVertex(index);
        if (local == kNoIndex) {
            fail(tag, fmt::format("{} refers to vertex {} (from 0), which no face of its group has",
                                  tag.name, index));
        }
        return local;
    }

    // One sharpness for all, or one for each.
    float sharpness(const SubdivisionTag& tag, std::size_t item, std::size_t items) const {
        if (tag.reals.size() != 1 && tag.reals.size() != items) {
            fail(tag, fmt::format("{} has {} sharpness values; allowed are 1 and {}", tag.name,
                                  tag.reals.size(), items));
        }
        // OpenSubdiv's infinite sharpness is 10; beyond it nothing changes.
        return static_cast<float>(
            std::clamp(tag.reals[tag.reals.size() == 1 ? 0 : item], 0.0, 10.0));
    }

    void crease(const SubdivisionTag& tag) {
        if (tag.integers.size() < 2) fail(tag, "a crease needs 2 vertices or more");
        for (std::size_t i = 0; i + 1 < tag.integers.size(); ++i) {
            m_tags.creases.push_back(vertex(tag, tag.integers[i]));
            m_tags.creases.push_back(vertex(tag, tag.integers[i + 1]));
            m_tags.creaseSharpness.push_back(sharpness(tag, i, tag.integers.size() - 1));
        }
    }

    void corner(const SubdivisionTag& tag) {
        for (std::size_t i = 0; i < tag.integers.size(); ++i) {
            m_tags.corners.push_back(vertex(tag, tag.integers[i]));
            m_tags.cornerSharpness.push_back(sharpness(tag, i, tag.integers.size()));
        }
    }

    void hole(const SubdivisionTag& tag) {
        for (const std::int64_t face : tag.integers) {
            const auto index = static_cast<std::uint64_t>(face);
            if (index < m_faces.first || index >= m_faces.first + m_faces.count) {
                fail(tag, fmt::format("hole refers to face {} (from 0), which is not in its group",
                                      face));
            }
            m_tags.holes.push_back(static_cast<std::uint32_t>(index - m_faces.first));
        }
    }

    void boundary(const SubdivisionTag& tag) {
        if (tag.integers.empty() || tag.integers[0] < 0 || tag.integers[0] > 2) {
            fail(tag, "interpolateboundary must be 0 (none), 1 (edge and corner) or 2 (edge only)");
        }
        m_tags.boundary = static_cast<int>(tag.integers[0]);
    }

    void faceVarying(const SubdivisionTag& tag) {
        if (tag.integers.empty() || tag.integers[0] < 0 || tag.integers[0] > 5) {
            fail(tag,
                 "facevaryinginterpolateboundary must be 0 (smooth), 1 to 3 (corners of charts "
                 "stay), 4 (linear along the edges of charts) or 5 (linear everywhere)");
        }
        m_tags.faceVarying = static_cast<int>(tag.integers[0]);
    }

    struct Tag {
        std::string_view name;
        void (TagReader::*read)(const SubdivisionTag&);
    };
    static const std::array<Tag, 5> kTags;

    const MeshAssembly& m_assembly;
    FaceRange m_faces;
    const std::string& m_file;
    const WarningSink& m_warn;
    CageTags m_tags;
};

const std::array<TagReader::Tag, 5> TagReader::kTags{{
    {"crease", &TagReader::crease},
    {"corner", &TagReader::corner},
    {"hole", &TagReader::hole},
    {"interpolateboundary", &TagReader::boundary},
    {"facevaryinginterpolateboundary", &TagReader::faceVarying},
}};

}  // namespace

std::vector<std::string> cageTagNames() {
    return TagReader::names();
}

CageTags readCageTags(std::span<const SubdivisionTag> tags, const MeshAssembly& assembly,
                      FaceRange faces, const std::string& fileName, const WarningSink& warn) {
    TagReader reader(assembly, faces, fileName, warn);
    for (const SubdivisionTag& tag : tags) reader.read(tag);
    return reader.take();
}

}  // namespace pm::host
