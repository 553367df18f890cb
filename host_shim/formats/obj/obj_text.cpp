// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/obj_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "host_shim/formats/obj/obj_keys.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

// Beyond this the ray tracer can't follow (it multiplies coordinates in single precision).
constexpr double kLargestCoordinate = 1e18;
constexpr std::array<const char*, 3> kKinds{"vertex", "texture coordinate", "normal"};

const std::string kNotUnderstood = "statements that are not understood,";
constexpr std::size_t kShownOfWord = 40;  // characters

// Bytes; what takes some ten milliseconds, so that a thread for it finds a core of its own.
constexpr std::size_t kPieceSize = 1 << 19;

}  // namespace

class ObjTextScan::Scan {
  public:
    Scan(std::string_view text, const std::string& fileName) : m_lines(text), m_file(fileName) {}

    std::string nextPiece() {
        m_piece.clear();
        while (m_piece.size() < kPieceSize && m_lines.next()) statement();
        return std::move(m_piece);
    }

    ObjText finish(const WarningSink& warn) {
        if (m_out.counts[0] == 0 || m_out.faceSizes.empty()) failWithoutGeometry();
        checkForwardReferences();
        settleTagGroups();
        reportLeftOut(warn);
        return std::move(m_out);
    }

  private:
    struct ForwardReference {
        std::size_t kind;
        std::int64_t index;
        std::uint64_t line;
    };

    [[noreturn]] void fail(std::uint64_t line, const std::string& text) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}:{}: {}", m_file, line, text));
    }

    [[noreturn]] void failWithoutGeometry() const {
        const auto unknown = m_leftOut.find(kNotUnderstood);
        const std::string others =
            unknown != m_leftOut.end()
                ? fmt::format(", and {} statements that are not understood, '{}' the first",
                              unknown->second.first, m_unknown)
                : "";
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: no geometry: {} vertices and {} faces{} (an OBJ file in "
                                    "plain text, with v and f lines, is wanted)",
                                    m_file, m_out.counts[0], m_out.faceSizes.size(), others));
    }

    void statement() {
        std::string_view rest = m_lines.line();
        const std::string_view word = takeWord(rest);
        switch (statementOf(word)) {
            case ObjStatement::kVertex:
                vertex(rest);
                break;
            case ObjStatement::kTextureCoordinate:
                attribute(rest, 1, 1);
                break;
            case ObjStatement::kNormal:
                attribute(rest, 2, 3);
                break;
            case ObjStatement::kFace:
                face(rest);
                break;
            case ObjStatement::kGroup:
                ++m_group;
                // One word is enough for the parser; both kinds of group end the one before.
                emit("g", rest.empty() ? std::string_view("unnamed") : rest);
                break;
            case ObjStatement::kMaterial:
                useMaterial(rest);
                break;
            case ObjStatement::kLibrary:
                addLibrary(rest);
                break;
            case ObjStatement::kTag:
                tag(rest);
                break;
            case ObjStatement::kLeftOut:
                leaveOut("lines, points or curves");
                break;
            case ObjStatement::kNoWeight:
                break;
            case ObjStatement::kUnknown:
                leaveOutUnknown(word);
                break;
        }
    }

    void emit(std::string_view word, std::string_view rest) {
        m_piece.append(word).append(" ").append(rest).append("\n");
    }

    void leaveOut(const std::string& what) { leaveOut(what, m_lines.number()); }
    void leaveOut(const std::string& what, std::uint64_t line) {
        auto& entry = m_leftOut[what];
        if (entry.first++ == 0) entry.second = line;
    }

    void leaveOutUnknown(std::string_view word) {
        if (m_unknown.empty()) {
            // The file may be of any kind.
            m_unknown = word.substr(0, kShownOfWord);
            std::ranges::replace_if(
                m_unknown, [](char c) { return c < ' ' || c > '~'; }, '?');
        }
        leaveOut(kNotUnderstood);
    }

    void vertex(std::string_view rest) {
        std::string numbers;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = takeWord(rest);
            double value = 0;
            if (word.empty()) {
                fail(m_lines.number(), fmt::format("a vertex of {} numbers; it needs 3", axis));
            }
            if (!parseNumber(word, value) || !std::isfinite(value) ||
                std::abs(value) > kLargestCoordinate) {
                fail(m_lines.number(),
                     fmt::format("vertex coordinate '{}' is not a finite number within +-{:g}",
                                 word, kLargestCoordinate));
            }
            numbers.append(word).append(" ");
        }
        std::string_view extra = rest;
        takeWord(extra);
        if (!extra.empty() && !rest.starts_with('#')) leaveOut("vertex colours");
        emit("v", numbers);
        ++m_out.counts[0];
    }

    // A texture coordinate or normal. One that is none becomes 0 0 or 0 0 0, which is no normal,
    // with a warning: many exporters write nan or 0 0 0 for the normal of a face without area.
    void attribute(std::string_view rest, std::size_t kind, int needed) {
        std::string numbers;
        const int wanted = kind == 1 ? 2 : 3;
        bool isGood = true, isZero = true;
        for (int i = 0; i < wanted; ++i) {
            const std::string_view word = takeWord(rest);
            double value = 0;
            const bool isNumber = parseNumber(word, value) && std::isfinite(value) &&
                                  std::abs(value) <= kLargestCoordinate;
            if (!isNumber && (i < needed || !word.empty())) isGood = false;
            if (isNumber && value != 0) isZero = false;
            numbers.append(isNumber ? word : std::string_view("0")).append(" ");
        }
        if (!isGood) {
            leaveOut(kind == 1
                         ? "texture coordinates that are not numbers within +-1e18 (taken as 0)"
                         : "normals that are not numbers within +-1e18");
            numbers = kind == 1 ? "0 0" : "0 0 0";
        } else if (kind == 2 && isZero) {
            leaveOut("normals of length 0");
        }
        emit(kind == 1 ? "vt" : "vn", trimmed(numbers));
        ++m_out.counts[kind];
    }

    void face(std::string_view rest) {
        std::string corners;
        std::uint64_t count = 0;
        for (std::string_view word = takeWord(rest); !word.empty() && !word.starts_with('#');
             word = takeWord(rest)) {
            corner(word, corners);
            ++count;
        }
        const bool keep = count >= 3 && count <= kLargestFace;
        if (!keep) leaveOut(count < 3 ? "faces of fewer than 3 corners" : "faces too large");
        m_keptFaces.push_back(keep);
        if (!keep) return;
        emit("f", trimmed(corners));
        m_out.faceSizes.push_back(static_cast<std::uint32_t>(count));
        m_out.faceLines.push_back(m_lines.number());
        m_faceGroups.push_back(m_group);
    }

    void corner(std::string_view word, std::string& corners) {
        const std::string_view whole = word;
        std::array<std::int64_t, 3> indices{};
        std::array<bool, 3> given{};
        for (std::size_t part = 0; part < 3; ++part) {
            const auto end = std::min(word.find('/'), word.size());
            const std::string_view digits = word.substr(0, end);
            const bool last = end == word.size();
            word.remove_prefix(last ? end : end + 1);
            if (!digits.empty()) {
                if (!parseInteger(digits, indices[part])) badCorner(whole);
                checkIndex(part, indices[part]);
                given[part] = true;
            }
            if (last) break;
        }
        if (!given[0] || !word.empty()) badCorner(whole);
        appendNumber(corners, indices[0]);
        if (given[1]) appendNumber(corners += '/', indices[1]);
        if (given[2]) appendNumber(corners += given[1] ? "/" : "//", indices[2]);
        corners += ' ';
    }

    static void appendNumber(std::string& text, std::int64_t number) {
        char digits[24];
        text.append(digits, std::to_chars(digits, std::end(digits), number).ptr);
    }

    [[noreturn]] void badCorner(std::string_view word) const {
        fail(
            m_lines.number(),
            fmt::format("'{}' is not a face corner; allowed are v, v/vt, v//vn and v/vt/vn", word));
    }

    // Positive indices may point forward and are settled at the end; negative ones count back.
    void checkIndex(std::size_t kind, std::int64_t index) {
        const auto count = static_cast<std::int64_t>(m_out.counts[kind]);
        if (index == 0) {
            fail(m_lines.number(), fmt::format("face refers to {} 0; the first is 1 (or -1, "
                                               "counted back)",
                                               kKinds[kind]));
        }
        if (index < -count) {
            fail(m_lines.number(),
                 fmt::format("face refers to {} {} of {} so far", kKinds[kind], index, count));
        }
        if (index > count) m_forward.push_back({kind, index, m_lines.number()});
    }

    // Some exporters number normals or texture coordinates and leave all of them out.
    void checkForwardReferences() {
        for (const ForwardReference& reference : m_forward) {
            const std::uint64_t count = m_out.counts[reference.kind];
            if (count == 0 && reference.kind > 0) {
                leaveOut(
                    fmt::format("corners' {}s, of which there are none,", kKinds[reference.kind]),
                    reference.line);
                continue;
            }
            if (reference.index > static_cast<std::int64_t>(count)) {
                fail(reference.line, fmt::format("face refers to {} {} of {}",
                                                 kKinds[reference.kind], reference.index, count));
            }
        }
    }

    void addLibrary(std::string_view name) {
        if (name.empty()) {
            leaveOut("mtllib lines without a file name");
        } else if (m_libraries.emplace(name).second) {
            m_out.materialFiles.emplace_back(name);
            m_out.materialFileLines.push_back(m_lines.number());
        }
    }

    void useMaterial(std::string_view name) {
        const auto [found, isNew] =
            m_materialNumbers.try_emplace(std::string(name), m_out.materialNames.size());
        if (isNew) {
            m_out.materialNames.emplace_back(name);
            m_out.materialLines.push_back(m_lines.number());
        }
        const std::string number = std::to_string(found->second);
        if (isNew) emit("mtllib", number);
        emit("usemtl", number);
    }

    void tag(std::string_view rest) {
        SubdivisionTag tag;
        tag.name = takeWord(rest);
        tag.line = m_lines.number();
        tag.group = m_group;
        std::string_view sizes = takeWord(rest);
        std::array<std::int64_t, 3> counts{};
        for (std::int64_t& count : counts) {
            const auto end = std::min(sizes.find('/'), sizes.size());
            if (!parseInteger(sizes.substr(0, end), count) || count < 0) badTag();
            sizes.remove_prefix(std::min(end + 1, sizes.size()));
        }
        for (std::int64_t i = 0; i < counts[0]; ++i) {
            if (!parseInteger(takeWord(rest), tag.integers.emplace_back())) badTag();
        }
        for (std::int64_t i = 0; i < counts[1]; ++i) {
            double& value = tag.reals.emplace_back();
            if (!parseNumber(takeWord(rest), value) || std::isnan(value)) badTag();
        }
        tag.text = rest;
        m_out.tags.push_back(std::move(tag));
    }

    [[noreturn]] void badTag() const {
        fail(m_lines.number(),
             "this is not a subdivision tag; it must be t NAME INTS/REALS/STRINGS values...");
    }

    // Tags of a group without faces go with the next group that has some, else with the last.
    void settleTagGroups() {
        std::vector<std::uint64_t> groups = m_faceGroups;
        groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
        const bool hasHoles = std::ranges::any_of(
            m_out.tags, [](const SubdivisionTag& tag) { return tag.name == "hole"; });
        std::vector<std::int64_t> keptBefore(hasHoles ? m_keptFaces.size() : 0);
        std::exclusive_scan(m_keptFaces.begin(), m_keptFaces.begin() + std::ssize(keptBefore),
                            keptBefore.begin(), std::int64_t{0});
        for (SubdivisionTag& tag : m_out.tags) {
            const auto found = std::ranges::lower_bound(groups, tag.group);
            tag.group = static_cast<std::uint64_t>(std::min<std::ptrdiff_t>(
                found - groups.begin(), static_cast<std::ptrdiff_t>(groups.size()) - 1));
            if (tag.name == "hole") countKeptFaces(keptBefore, tag);
        }
    }

    // Holes count every f line; faces that were left out move the numbers of later ones.
    // keptBefore: for each f line, how many before it were kept.
    void countKeptFaces(const std::vector<std::int64_t>& keptBefore, SubdivisionTag& tag) const {
        std::vector<std::int64_t> kept;
        for (const std::int64_t face : tag.integers) {
            if (face < 0 || face >= static_cast<std::int64_t>(m_keptFaces.size())) {
                fail(tag.line,
                     fmt::format("hole refers to face {} of {}", face, m_keptFaces.size()));
            }
            if (!m_keptFaces[static_cast<std::size_t>(face)]) continue;
            kept.push_back(keptBefore[static_cast<std::size_t>(face)]);
        }
        tag.integers = std::move(kept);
    }

    void reportLeftOut(const WarningSink& warn) const {
        for (const auto& [what, entry] : m_leftOut) {
            const std::string example =
                what == kNotUnderstood ? fmt::format(" '{}' the first,", m_unknown) : "";
            warn(Warning::kGeometry, fmt::format("{}:{}: {} {}{} left out", m_file, entry.second,
                                                 entry.first, what, example));
        }
    }

    static constexpr std::uint64_t kLargestFace = 65535;  // what subdivision can take

    TextLines m_lines;
    const std::string& m_file;
    std::string m_piece;
    ObjText m_out;
    std::uint64_t m_group{};
    std::vector<std::uint64_t> m_faceGroups;  // for each face kept
    std::vector<bool> m_keptFaces;            // for each f line
    std::vector<ForwardReference> m_forward;
    std::unordered_map<std::string, std::size_t> m_materialNumbers;
    std::unordered_set<std::string> m_libraries;
    std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> m_leftOut;  // count, first line
    std::string m_unknown;  // the first statement that is not understood
};

ObjTextScan::ObjTextScan(std::string_view text, const std::string& fileName)
    : m_scan(std::make_unique<Scan>(text, fileName)) {}
ObjTextScan::~ObjTextScan() = default;

std::string ObjTextScan::nextPiece() {
    return m_scan->nextPiece();
}
ObjText ObjTextScan::finish(const WarningSink& warn) {
    return m_scan->finish(warn);
}

}  // namespace pm::host
