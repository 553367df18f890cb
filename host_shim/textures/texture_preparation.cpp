// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texture_preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "host_shim/colour/asked_work.h"
#include "host_shim/textures/memory_budget.h"
#include "host_shim/textures/picture_kind.h"
#include "host_shim/textures/texture_bake.h"
#include "host_shim/textures/texture_records.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// Of what textures are made and how; another number makes all of them anew.
constexpr int kBakeVersion = 4;

struct Stopped {};

std::string asked(const TextureRequest& request) {
    return fmt::format("{}\n{}\n{}\n{}", fs::absolute(request.file).lexically_normal().string(),
                       static_cast<int>(request.kind),
                       request.kind == TextureKind::kColour ? request.colorspace : "",
                       static_cast<int>(request.channel));
}

// A file that is written to again within the same tick of the system's clock keeps its stamp, so
// one as young as that is no ground to go by yet.
void waitUntilStampTells(const FileStamp& stamp) {
    constexpr std::int64_t kTicks = 50'000'000;  // ns
    const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                         std::chrono::system_clock::now().time_since_epoch())
                         .count();
    const std::int64_t age = now - std::max(stamp.modified, stamp.changed);
    if (age < kTicks)
        std::this_thread::sleep_for(
            std::chrono::nanoseconds(std::min(kTicks, kTicks - std::max<std::int64_t>(age, 0))));
}

}  // namespace

// One texture on its way.
struct TexturePreparer::Work {
    TextureRequest request;
    std::string key;
    Original original;
    SpaceConversion conversion;
    Result result;
    bool wasOpened{}, wasFound{}, wasNotKept{};
    int threads = 1;  // that it may keep busy

    void findOriginal(TextureCache& cache, const std::function<void()>& goOn);
    void makeTexture(TextureCache& cache, MemoryBudget& budget, const std::function<void()>& goOn);
    TextureFacts bake(TextureCache& cache, const std::string& name, MemoryBudget& budget,
                      const std::function<void()>& goOn);
};

// What the threads have in common; outlives this preparer where one is left behind.
struct TexturePreparer::Shared {
    Shared(std::vector<Work> given, std::shared_ptr<TextureCache> from)
        : works(std::move(given)), cache(std::move(from)) {}

    std::vector<Work> works;
    std::shared_ptr<TextureCache> cache;
    std::optional<MemoryBudget> budget;  // of those that are made
    std::atomic<bool> stops{false};

    // step: done for each work that has not failed, by several threads.
    template <typename Step>
    void doAll(std::uint32_t threads, const Step& step) {
        std::atomic<std::size_t> next{0};
        const auto run = [&] {
            for (std::size_t i = next++; i < works.size() && !stops; i = next++) {
                Work& work = works[i];
                if (work.result.error) continue;
                try {
                    step(work);
                } catch (const Stopped&) {
                    return;
                } catch (const NotKept&) {
                    work.wasNotKept = true;
                    work.result.error = std::current_exception();
                } catch (const std::bad_alloc&) {
                    work.result.error = std::make_exception_ptr(HostError(
                        ExitCode::kMemory,
                        fmt::format("texture {}: out of memory", work.request.file.string())));
                } catch (...) {
                    work.result.error = std::current_exception();
                }
            }
        };
        std::vector<std::jthread> helpers;
        try {
            while (helpers.size() + 1 < std::min<std::size_t>(threads, works.size()))
                helpers.emplace_back(run);
        } catch (const std::system_error&) {
            // Those that there are do it.
        }
        run();
    }
};

void TexturePreparer::Work::findOriginal(TextureCache& cache, const std::function<void()>& goOn) {
    for (int tries = 0;; ++tries) {
        const auto stamp = stampOf(request.file);
        if (!stamp) {
            pictureReader(request.file);  // throws what is wrong
            throw HostError(ExitCode::kFile,
                            fmt::format("texture {} can't be read", request.file.string()));
        }
        const std::string at = hashText(fmt::format("{}\n{}\n{}\n{}", kBakeVersion, stamp->text(),
                                                    static_cast<int>(request.kind),
                                                    static_cast<int>(request.channel)));
        if (const auto record = cache.original(at); record && !record->get("size").empty()) {
            original = toOriginal(*record);
            return;
        }
        wasOpened = true;
        waitUntilStampTells(*stamp);
        PictureRows rows(request.file, request.kind, request.channel);
        original = {hashFile(request.file, goOn), rows.isFloatFile(), rows.statement(),
                    TextureBake(rows, request.kind, {}).memoryBytes(),
                    fmt::format("{} x {}", rows.width(), rows.height())};
        // One that is being written to is taken as it is now, and not remembered.
        constexpr int kMostTries = 3;
        const bool isSteady = stampOf(request.file) == stamp;
        if (isSteady) cache.putOriginal(at, toRecord(original, *stamp, request.file));
        if (isSteady || tries == kMostTries) return;
    }
}

// bake: writes the texture, and returns its record. Errors: NotKept where it is the cache that
// fails; those of bake.
template <typename Bake>
void keep(TextureCache& cache, const std::string& name, const Bake& bake) {
    bool isOfCache = true;
    try {
        FinishedFile finished(cache.nameForNew());
        cache.noteUnderway(finished.temporaryPath());
        CheckedFile file(finished, cache.textureFile(name));
        std::optional<Record> record;
        try {
            record = bake(file, finished.temporaryPath());
        } catch (const HostError&) {
            isOfCache = file.finish() != 0;
            throw;
        }
        cache.commit(name, finished, std::move(*record));
    } catch (const HostError& error) {
        if (isOfCache) throw NotKept(error.code(), error.what());
        throw;
    }
}

TextureFacts TexturePreparer::Work::bake(TextureCache& cache, const std::string& name,
                                         MemoryBudget& budget, const std::function<void()>& goOn) {
    wasOpened = true;
    auto rows = std::make_unique<PictureRows>(request.file, request.kind, request.channel);
    auto baking = std::make_unique<TextureBake>(*rows, request.kind, conversion);
    const std::uint64_t need = baking->memoryBytes();
    const auto share = budget.take(std::min(need, budget.total()), goOn);
    TextureFacts facts;
    if (baking->needsNoConversion()) {
        if (baking->inspect(goOn, facts)) {
            result.texture.file = fs::absolute(request.file);
            cache.commitAsItIs(name, toRecord(facts, request.file));
            return facts;
        }
        rows = std::make_unique<PictureRows>(request.file, request.kind, request.channel);
        baking = std::make_unique<TextureBake>(*rows, request.kind, conversion);
    }
    keep(cache, name, [&](CheckedFile& file, const fs::path& temporary) {
        facts = baking->bake(file, temporary, cache.textureFile(name), threads, goOn);
        return toRecord(facts, request.file);
    });
    result.texture.file = cache.textureFile(name);
    return facts;
}

void TexturePreparer::Work::makeTexture(TextureCache& cache, MemoryBudget& budget,
                                        const std::function<void()>& goOn) {
    const std::string hash =
        hashText(fmt::format("{}\n{}\n{}\n{}\n{}", kBakeVersion, original.content,
                             static_cast<int>(request.kind), static_cast<int>(request.channel),
                             request.kind == TextureKind::kColour ? conversion.cacheId() : ""));
    constexpr std::size_t kLongestStem = 100;
    const std::string name = request.file.stem().string().substr(0, kLongestStem) + "." + hash;
    BakedTexture& texture = result.texture;
    if (const auto record = cache.find(name)) {
        wasFound = true;
        texture.facts = toFacts(*record);
        texture.file =
            record->get("asItIs") == "1" ? fs::absolute(request.file) : cache.textureFile(name);
        return;
    }
    texture.facts = bake(cache, name, budget, goOn);
}

TexturePreparer::TexturePreparer(const ColourPipeline& colour, std::shared_ptr<TextureCache> cache,
                                 const TextureSettings& settings, std::function<void()> goOn)
    : m_colour(colour), m_cache(std::move(cache)), m_settings(settings), m_goOn(std::move(goOn)) {}

void TexturePreparer::decideSpaces(std::vector<Work>& works) const {
    for (Work& work : works) {
        BakedTexture& texture = work.result.texture;
        texture.space.isData = work.request.kind != TextureKind::kColour;
        if (work.result.error || texture.space.isData) continue;
        try {
            texture.space = m_colour.textureSpace(work.request.file, work.original.isFloatFile,
                                                  work.request.colorspace, work.original.statement);
            work.conversion = m_colour.textureToRendering(texture.space);
            if (texture.space.decidedBy == "default")
                texture.profile = work.original.statement.profile;
        } catch (const HostError&) {
            work.result.error = std::current_exception();
        }
    }
}

// What those share that are made at once: as much as the largest takes, at least.
std::uint64_t TexturePreparer::memoryFor(const std::vector<Work>& works) const {
    const auto bytesOf = [](const Work& work) {
        return work.result.error ? 0 : work.original.bytes;
    };
    const Work& largest = *std::ranges::max_element(works, {}, bytesOf);
    const std::uint64_t bytes = bytesOf(largest);
    const std::string what = fmt::format("texture {} of {} texels takes",
                                         largest.request.file.string(), largest.original.size);
    if (m_settings.takes)
        m_settings.takes(bytes, what);
    else if (bytes > m_settings.memoryBytes)
        throw HostError(ExitCode::kMemory, fmt::format("{} {} bytes; {} are left", what, bytes,
                                                       m_settings.memoryBytes));
    return std::max(bytes, m_settings.memoryBytes);
}

void TexturePreparer::each(
    const std::shared_ptr<Shared>& shared,
    const std::function<void(Shared&, Work&, const std::function<void()>&)>& step) {
    const std::uint32_t threads = std::max(1u, m_settings.threads);
    try {
        callAsking(m_goOn, [shared, threads, step] {
            const std::function<void()> goOn = [shared] {
                if (shared->stops) throw Stopped();
            };
            shared->doAll(threads, [&](Work& work) { step(*shared, work, goOn); });
        });
    } catch (...) {
        shared->stops = true;
        m_cache->abandon();
        throw;
    }
}

// Without its texture a material would look otherwise for the sake of a disk, so what can't be kept
// in one cache is made once more in another.
void TexturePreparer::makeTextures(const std::shared_ptr<Shared>& shared) {
    each(shared, [](Shared& all, Work& work, const std::function<void()>& goOn) {
        work.makeTexture(*all.cache, *all.budget, goOn);
    });
    const auto failed = std::ranges::find_if(shared->works, &Work::wasNotKept);
    if (failed == shared->works.end() || !m_settings.otherCache || m_fullCache) return;
    std::string why;
    try {
        std::rethrow_exception(failed->result.error);
    } catch (const NotKept& error) {
        why = error.what();
    }
    m_fullCache = std::exchange(m_cache, m_settings.otherCache(why));
    shared->cache = m_cache;
    for (Work& work : shared->works)
        if (work.wasNotKept) work.result.error = nullptr;
    each(shared, [](Shared& all, Work& work, const std::function<void()>& goOn) {
        if (std::exchange(work.wasNotKept, false)) work.makeTexture(*all.cache, *all.budget, goOn);
    });
}

void TexturePreparer::prepare(const std::vector<TextureRequest>& requests) {
    std::vector<Work> works;
    for (const TextureRequest& request : requests) {
        std::string key = asked(request);
        if (m_results.contains(key) ||
            std::ranges::any_of(works, [&](const Work& work) { return work.key == key; }))
            continue;
        Work work;
        work.request = request;
        work.key = std::move(key);
        works.push_back(std::move(work));
    }
    if (works.empty()) return;
    const auto shared = std::make_shared<Shared>(std::move(works), m_cache);
    const std::uint32_t threads = std::max(1u, m_settings.threads);
    for (Work& work : shared->works) work.threads = shared->works.size() < threads ? 2 : 1;
    each(shared, [](Shared& all, Work& work, const std::function<void()>& goOn) {
        work.findOriginal(*all.cache, goOn);
    });
    decideSpaces(shared->works);
    shared->budget.emplace(memoryFor(shared->works));
    makeTextures(shared);
    bool hasNew = false;
    for (Work& work : shared->works) {
        m_counts.originalsOpened += work.wasOpened ? 1 : 0;
        m_counts.found += work.wasFound ? 1 : 0;
        const bool isNew = !work.wasFound && !work.result.error;
        m_counts.converted += isNew ? 1 : 0;
        hasNew = hasNew || isNew;
        m_results.emplace(work.key, std::move(work.result));
    }
    if (hasNew) m_cache->makeRoom();
}

const BakedTexture& TexturePreparer::texture(const TextureRequest& request) {
    prepare({request});
    const Result& result = m_results.at(asked(request));
    if (result.error) std::rethrow_exception(result.error);
    return result.texture;
}

}  // namespace pm::host
