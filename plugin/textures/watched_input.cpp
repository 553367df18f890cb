// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/watched_input.h"

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

#include "integrator/caches/cache_watch.h"

namespace pm::plugin {

namespace {

// The library asks a reader for tiles or rows in the calling thread, and for nothing else that
// costs time. A format may do more in the calls that convert than in the native ones (TIFF
// multiplies by alpha there), so both kinds go on to it.
class WatchedInput final : public OIIO::ImageInput {
  public:
    const char* format_name() const override { return m_file ? m_file->format_name() : "unopened"; }
    int supports(OIIO::string_view feature) const override {
        return m_file ? m_file->supports(feature) : 0;
    }

    bool open(const std::string& name, OIIO::ImageSpec& spec) override {
        return open(name, spec, OIIO::ImageSpec());
    }
    bool open(const std::string& name, OIIO::ImageSpec& spec,
              const OIIO::ImageSpec& config) override {
        m_file = OIIO::ImageInput::create(name);
        if (!m_file) {
            errorfmt("{}", OIIO::geterror());
            return false;
        }
        const bool good = told(m_file->open(name, spec, config));
        m_spec = m_file->spec();
        return good;
    }
    bool close() override { return !m_file || told(m_file->close()); }

    int current_subimage() const override { return m_file ? m_file->current_subimage() : 0; }
    int current_miplevel() const override { return m_file ? m_file->current_miplevel() : 0; }
    bool seek_subimage(int subimage, int level) override {
        if (!m_file || !told(m_file->seek_subimage(subimage, level))) return false;
        m_spec = m_file->spec();
        return true;
    }
    OIIO::ImageSpec spec(int subimage, int level) override { return m_file->spec(subimage, level); }
    OIIO::ImageSpec spec_dimensions(int subimage, int level) override {
        return m_file->spec_dimensions(subimage, level);
    }

    bool read_scanlines(int subimage, int level, int y0, int y1, int z, int c0, int c1,
                        OIIO::TypeDesc format, void* data, OIIO::stride_t xStride,
                        OIIO::stride_t yStride) override {
        noteRows(subimage, level, y0, y1);
        return told(m_file->read_scanlines(subimage, level, y0, y1, z, c0, c1, format, data,
                                           xStride, yStride));
    }
    bool read_tiles(int subimage, int level, int x0, int x1, int y0, int y1, int z0, int z1, int c0,
                    int c1, OIIO::TypeDesc format, void* data, OIIO::stride_t xStride,
                    OIIO::stride_t yStride, OIIO::stride_t zStride) override {
        noteTiles(subimage, level, x0, x1, y0, y1);
        return told(m_file->read_tiles(subimage, level, x0, x1, y0, y1, z0, z1, c0, c1, format,
                                       data, xStride, yStride, zStride));
    }
    bool read_native_scanline(int subimage, int level, int y, int z, void* data) override {
        noteRows(subimage, level, y, y + 1);
        return told(m_file->read_native_scanline(subimage, level, y, z, data));
    }
    bool read_native_tile(int subimage, int level, int x, int y, int z, void* data) override {
        noteTiles(subimage, level, x, x + m_spec.tile_width, y, y + m_spec.tile_height);
        return told(m_file->read_native_tile(subimage, level, x, y, z, data));
    }

  private:
    // What failed there failed here.
    bool told(bool isGood) {
        if (!isGood) errorfmt("{}", m_file->geterror());
        return isGood;
    }
    void noteRows(int subimage, int level, int y0, int y1) const {
        note(subimage, level, 0, y0, m_file->spec_dimensions(subimage, level).width, y1 - y0);
    }
    void noteTiles(int subimage, int level, int x0, int x1, int y0, int y1) const {
        note(subimage, level, x0, y0, x1 - x0, y1 - y0);
    }
    void note(int subimage, int level, int x, int y, int width, int height) const {
        CacheWatch* const watch = CacheWatch::current();
        if (!watch) return;
        const auto bits = [](int number, int count) {
            return static_cast<std::uint64_t>(number) & ((std::uint64_t{1} << count) - 1);
        };
        const std::uint64_t key =
            bits(subimage, 6) << 54 | bits(level, 6) << 48 | bits(y, 24) << 24 | bits(x, 24);
        const auto texels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
        watch->asked(
            {texelCache(), key, texels * m_spec.pixel_bytes(true), true, CacheWatch::user()});
    }

    std::unique_ptr<OIIO::ImageInput> m_file;
};

}  // namespace

OIIO::ImageInput* makeWatchedInput() {
    return new WatchedInput;
}

std::uint32_t texelCache() {
    static const std::uint32_t number = CacheWatch::newCache();
    return number;
}

}  // namespace pm::plugin
