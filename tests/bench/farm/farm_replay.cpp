// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/farm/farm_replay.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <stdexcept>

#include "host_shim/farm/job/run_cut.h"

namespace pm::bench {

namespace {

enum class Kind { kWait, kCompute, kTransfer };

// A stretch of a task: seconds to wait or compute, or bytes.
struct Step {
    Kind kind;
    double amount;
};
using Task = std::deque<Step>;

// Workers with a queue of tasks. What computes shares the cores, what is sent shares the server.
class Shop {
  public:
    explicit Shop(const FarmRules& rules) : m_rules(rules), m_workers(rules.workers) {}

    // Seconds until all are done; the ends of the workers' last tasks are in ends.
    double run(std::deque<Task> queue, std::vector<double>& ends) {
        std::vector<Task> tasks(m_workers);
        double now = 0;
        ends.assign(m_workers, 0);
        for (;;) {
            for (std::size_t w = 0; w < m_workers; ++w)
                if (goOn(tasks[w], queue)) ends[w] = now;
            const double step = nextEnd(tasks);
            if (step < 0) return now;
            for (std::size_t w = 0; w < m_workers; ++w)
                if (!tasks[w].empty()) advance(tasks[w].front(), w, step);
            now += step;
        }
    }

  private:
    struct Load {
        double computing = 0, sending = 0;
    };
    // Leaves what is done and draws the next task; whether one has ended.
    static bool goOn(Task& task, std::deque<Task>& queue) {
        bool hasEnded = false;
        for (;;) {
            while (!task.empty() && task.front().amount <= 0) {
                task.pop_front();
                hasEnded = hasEnded || task.empty();
            }
            if (!task.empty() || queue.empty()) return hasEnded;
            task = std::move(queue.front());
            queue.pop_front();
        }
    }
    static Load loadOf(const std::vector<Task>& tasks) {
        Load load;
        for (const Task& task : tasks) {
            if (task.empty()) continue;
            load.computing += task.front().kind == Kind::kCompute;
            load.sending += task.front().kind == Kind::kTransfer;
        }
        return load;
    }
    bool isSlow(std::size_t worker) const {
        const double share = m_rules.slowShare;
        const auto place = static_cast<double>(worker);
        return static_cast<long>((place + 1) * share + 1e-9) >
               static_cast<long>(place * share + 1e-9);
    }
    // Between one thread alone and as many as cores linearly, beyond that by turns.
    double speed(std::size_t worker) const {
        const double n = m_load.computing, cores = m_rules.cores;
        const double busy = cores > 1 ? std::clamp((n - 1) / (cores - 1), 0.0, 1.0) : 1.0;
        const double shared = 1 + (m_rules.sharedSpeed - 1) * busy;
        return shared * std::min(1.0, cores / n) * (isSlow(worker) ? m_rules.slowSpeed : 1.0);
    }
    double rate(const Step& step, std::size_t worker) const {
        if (step.kind == Kind::kWait) return 1;
        if (step.kind == Kind::kCompute) return speed(worker);
        return std::min(m_rules.linkRate, m_rules.serverRate / m_load.sending);
    }
    double nextEnd(const std::vector<Task>& tasks) {
        m_load = loadOf(tasks);
        double least = -1;
        for (std::size_t w = 0; w < m_workers; ++w) {
            if (tasks[w].empty()) continue;
            const double end = tasks[w].front().amount / rate(tasks[w].front(), w);
            if (least < 0 || end < least) least = end;
        }
        return least;
    }
    void advance(Step& step, std::size_t worker, double seconds) const {
        const double done = seconds * rate(step, worker);
        // What ends at this moment is not left over by rounding.
        step.amount = step.amount - done <= 1e-9 * (step.amount + 1e-3) ? 0 : step.amount - done;
    }

    const FarmRules& m_rules;
    std::size_t m_workers;
    Load m_load;
};

double sumOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

// A run that is ended now and then: each time it begins anew, makes the maps of the pass that it
// was at, and half of what it was at is lost.
void addPreempted(Task& task, double work, double again, const FarmRules& rules) {
    const double useful = rules.preemptedEvery - again;
    if (useful <= 0) throw std::logic_error("preempted before anything is done");
    for (; work > rules.preemptedEvery; work -= useful) {
        task.push_back({Kind::kCompute, rules.preemptedEvery});
        task.push_back({Kind::kWait, rules.dispatchSeconds});
    }
    task.push_back({Kind::kCompute, work});
}

class Farm {
  public:
    Farm(const FarmCosts& costs, const FarmRules& rules) : m_costs(costs), m_rules(rules) {
        if (costs.buckets.empty()) throw std::logic_error("a farm without a bucket");
        if (rules.workers < 1) throw std::logic_error("a farm without a worker");
    }

    FarmReplay replay() const {
        const auto workers = static_cast<std::size_t>(m_rules.workers);
        const auto count = static_cast<std::uint32_t>(m_costs.buckets.size());
        const std::uint32_t wanted =
            m_rules.runs > 0 ? static_cast<std::uint32_t>(m_rules.runs)
                             : host::runCount({sumOf(m_costs.buckets), eachRun()}, 1, workers);
        const auto runs = host::cutRuns(m_costs.pilot, count, wanted);
        FarmReplay result;
        result.runs = static_cast<std::uint32_t>(runs.size());
        std::vector<double> ends;
        Shop shop(m_rules);
        const double begin = m_costs.pilotSeconds + m_rules.submitSeconds;
        const bool hasPhotons = m_costs.photonSeconds > 0 && m_rules.photonsOnce;
        if (hasPhotons)
            result.photonSeconds = shop.run({photonTask()}, ends) + m_rules.afterPhotons;
        std::deque<Task> queue;
        for (std::size_t i = 0; i < runs.size(); ++i)
            queue.push_back(runTask(runs[i], i < workers, hasPhotons));
        result.runSeconds = shop.run(std::move(queue), ends);
        for (const double end : ends)
            result.lastWaits += (result.runSeconds - end) / m_rules.workers;
        result.mergeSeconds = m_rules.noticeSeconds + m_costs.mergeSeconds +
                              m_costs.partBytes / std::min(m_rules.serverRate, m_rules.linkRate);
        result.seconds = begin + result.photonSeconds + result.runSeconds + result.mergeSeconds;
        return result;
    }

  private:
    Task photonTask() const {
        return {{Kind::kWait, m_rules.latencySeconds},
                {Kind::kTransfer, m_costs.sceneBytes},
                {Kind::kCompute, m_costs.startSeconds + m_costs.photonSeconds},
                {Kind::kTransfer, m_costs.photonBytes}};
    }
    // What a worker has fetched once stays in its memory.
    Task runTask(const host::BucketRun& run, bool isFirst, bool readsPhotons) const {
        const auto begin = m_costs.buckets.begin();
        const double work = std::accumulate(begin + run.first, begin + run.last, 0.0);
        const double share =
            static_cast<double>(run.last - run.first) / static_cast<double>(m_costs.buckets.size());
        const double before = eachRun();
        Task task{{Kind::kWait, isFirst ? 0 : m_rules.dispatchSeconds}};
        if (isFirst) {
            task.push_back({Kind::kWait, m_rules.latencySeconds});
            task.push_back(
                {Kind::kTransfer, m_costs.sceneBytes + (readsPhotons ? m_costs.photonBytes : 0)});
        }
        if (m_rules.preemptedEvery > 0)
            addPreempted(task, before + work, costOfARestart(work / (run.last - run.first)),
                         m_rules);
        else
            task.push_back({Kind::kCompute, before + work});
        task.push_back({Kind::kTransfer, share * m_costs.partBytes});
        return task;
    }

    double eachRun() const {
        return m_costs.startSeconds + m_costs.mapSeconds +
               (m_rules.photonsOnce ? 0 : m_costs.photonSeconds);
    }
    double costOfARestart(double bucket) const {
        return m_costs.startSeconds + (m_costs.mapSeconds + bucket / 2) / m_costs.passes;
    }

    const FarmCosts& m_costs;
    const FarmRules& m_rules;
};

}  // namespace

double FarmCosts::localSeconds() const {
    return startSeconds + photonSeconds + mapSeconds + sumOf(buckets);
}

FarmReplay replayFarm(const FarmCosts& costs, const FarmRules& rules) {
    return Farm(costs, rules).replay();
}

double efficiencyOf(const FarmCosts& costs, const FarmReplay& replay, int workers) {
    return costs.localSeconds() / (workers * replay.seconds);
}

}  // namespace pm::bench
