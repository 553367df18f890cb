// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

namespace pm {

// A task arena of our own, so that neither our threads nor our limits mix with the host's use of
// the same TBB; no process-wide control is touched. All parallel work of a render runs in one.
//
// At most threads() threads work at once, the calling one included. They are fewer where TBB lends
// none: its pool is shared by the process and holds one thread less than the machine has
// processors, unless the host raised that. No result may depend on how many there are.
class WorkerArena {
  public:
    // threads: 0 = availableThreads(), else 1 to 4096.
    // Errors: kInvalidArgument outside of that.
    explicit WorkerArena(int threads);
    ~WorkerArena();
    WorkerArena(const WorkerArena&) = delete;
    WorkerArena& operator=(const WorkerArena&) = delete;

    // What was asked for, or availableThreads(); so also the number of workers that a run is cut
    // for.
    int threads() const { return m_threads; }

    // Runs f in the arena, waits for it and returns its result; f sees FpEnvironment's modes
    // whatever the caller has set, and so do TBB tasks that it starts. Exceptions of f pass
    // through. Threads: any; several at once share the arena's threads.
    template <typename F>
    auto execute(F&& f) {
        using Result = std::invoke_result_t<F&>;
        if constexpr (std::is_void_v<Result>) {
            run(&f, [](void* task) { (*static_cast<std::remove_reference_t<F>*>(task))(); });
        } else {
            std::optional<Result> result;
            auto task = [&] { result.emplace(f()); };
            run(&task, [](void* its) { (*static_cast<decltype(task)*>(its))(); });
            return std::move(*result);
        }
    }

  private:
    // Calls call(task) in the arena.
    void run(void* task, void (*call)(void*));

    int m_threads;
    struct Tbb;  // TBB's headers bring all of the processor's intrinsics
    std::unique_ptr<Tbb> m_tbb;
};

}  // namespace pm
