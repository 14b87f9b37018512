// The C interface: tables, one run, and many runs on threads.
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <new>

#include "evaluation.hpp"
#include "giveway_batch.h"
#include "gravity.hpp"
#include "lane_group.hpp"
#include "metrics.hpp"
#include "models.hpp"
#include "run.hpp"

using giveway::ModelInfo;
using giveway::VariableInfo;
namespace batch = giveway::batch;

namespace {

using MetricInfos = std::array<gwb_metric_info_t, GWB_METRIC_COUNT>;

// GWB_METRICS by number.
constexpr MetricInfos metric_infos = [] {
    MetricInfos infos{};
    std::uint32_t line = 0;
#define GIVEWAY_INFO(metric, number, name, unit, has_truth, decimals, shown, description) \
    infos[number] = {name, unit, has_truth, decimals, shown, line++, description};
    GWB_METRICS(GIVEWAY_INFO)
#undef GIVEWAY_INFO
    return infos;
}();
static_assert(std::all_of(metric_infos.begin(), metric_infos.end(),
                          [](const auto &info) { return info.name != nullptr; }),
              "each number from 0 to the last stands in GWB_METRICS once");

int describe(std::uint32_t model, const VariableInfo *found, gwb_variable_t *variable) {
    if (found == nullptr || variable == nullptr) {
        return 0;
    }
    *variable = {model,
                 found->reference,
                 static_cast<std::uint32_t>(found->type),
                 static_cast<std::uint32_t>(found->causality),
                 found->minimum,
                 found->maximum,
                 found->name};
    return 1;
}

// Always 0.
template <class Value> [[gnu::format(printf, 2, 0)]] int refuse(char *message, const char *format, Value value) {
    if (message != nullptr) {
        std::snprintf(message, GWB_MESSAGE_SIZE, format, value);
    }
    return 0;
}

constexpr std::size_t largest_portion = 1024;
constexpr double plant_step_min_s = 1e-6;
constexpr double plant_step_max_s = 5e-4;

// 1 if they can be used, else 0 and a message.
int check_options(const gwb_options_t *options, char *message) {
    if (options == nullptr) {
        return refuse(message, "options is a null pointer%s", "");
    }
    const gwb_options_t &o = *options;
    if (o.threads < 1 || o.threads > GWB_THREADS_MAX) {
        return refuse(message, "threads = %u is not allowed: [1, 1024]", o.threads);
    }
    static_assert(GWB_THREADS_MAX == 1024);
    if (o.method != GWB_EVENT_EXACT && o.method != GWB_FIXED_STEP) {
        return refuse(message, "method = %u is not allowed: 0 (event-exact) or 1 (fixed step)", o.method);
    }
    if (o.lanes != 0 && o.lanes != 1 && o.lanes != 4 && o.lanes != 8) {
        return refuse(message, "lanes = %u is not allowed: 0 (as many as the processor has), 1, 4 or 8", o.lanes);
    }
    if (o.lanes > static_cast<std::uint32_t>(batch::widest_lanes())) {
        return refuse(message, "lanes = %u is not allowed: this processor has not so many (gwb_widest_lanes)", o.lanes);
    }
    if (o.plant_step_s != 0.0 && !(o.plant_step_s >= plant_step_min_s && o.plant_step_s <= plant_step_max_s)) {
        return refuse(message, "plant_step_s = %.9g is not allowed: 0, or [1e-6, 5e-4] s", o.plant_step_s);
    }
    return 1;
}

} // namespace

// Workers take the next runs until none is left; each writes only its own runs' results, so the order does not matter.
struct gwb_batch final : batch::RunDone {
    const gwb_spec_t *specs = nullptr;
    std::size_t count = 0;
    gwb_result_t *results = nullptr;
    std::uint64_t steps = 0; // of all runs
    gwb_options_t options{};
    std::size_t portion = 1; // runs that a worker takes at once
    batch::Monitor monitor;
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> runs_done{0};
    std::unique_ptr<pthread_t[]> threads;
    std::uint32_t thread_count = 0;
    pthread_mutex_t mutex;
    pthread_cond_t finished;
    std::uint32_t working = 0; // threads at work, guarded by mutex

    gwb_batch() {
        // Waits by the monotonic clock, which a change of the time of day does not affect.
        pthread_condattr_t attributes;
        pthread_condattr_init(&attributes);
        pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
        pthread_mutex_init(&mutex, nullptr);
        pthread_cond_init(&finished, &attributes);
        pthread_condattr_destroy(&attributes);
    }

    void work() {
        for (;;) {
            const std::size_t first = next.fetch_add(portion, std::memory_order_relaxed);
            if (first >= count) {
                break;
            }
            do_portion(first, std::min(first + portion, count));
        }
        pthread_mutex_lock(&mutex);
        if (--working == 0) {
            pthread_cond_broadcast(&finished);
        }
        pthread_mutex_unlock(&mutex);
    }

    void do_portion(std::size_t first, std::size_t last) {
        if (monitor.cancelled.load(std::memory_order_relaxed)) {
            for (std::size_t i = first; i < last; ++i) {
                batch::never_started(results[i]);
                monitor.steps_done.fetch_add(specs[i].step_count, std::memory_order_relaxed);
                done();
            }
        } else if (options.method == GWB_FIXED_STEP) {
            const batch::FixedStep how{static_cast<int>(options.lanes), options.plant_step_s};
            batch::run_fixed_step(specs + first, last - first, how, monitor, results + first, *this);
        } else {
            for (std::size_t i = first; i < last; ++i) {
                batch::run(specs[i], monitor, results[i]);
                done();
            }
        }
    }

    void done() override { runs_done.fetch_add(1, std::memory_order_release); }

    static void *thread(void *self) {
        static_cast<gwb_batch *>(self)->work();
        return nullptr;
    }

    // Fewer threads than wanted are enough; false if there is none.
    bool start(std::uint32_t wanted) {
#ifdef __wasi__ // has no threads: the calling one does the work
        thread_count = 0;
        working = std::min(wanted, 1U);
        if (working > 0) {
            work();
        }
        return true;
#endif
        pthread_mutex_lock(&mutex);
        while (thread_count < wanted && pthread_create(&threads[thread_count], nullptr, thread, this) == 0) {
            ++thread_count;
        }
        working = thread_count;
        pthread_mutex_unlock(&mutex);
        return thread_count > 0 || wanted == 0;
    }

    void wait_until(const timespec &deadline) {
        pthread_mutex_lock(&mutex);
        while (working > 0 && pthread_cond_timedwait(&finished, &mutex, &deadline) == 0) {
        }
        pthread_mutex_unlock(&mutex);
    }

    ~gwb_batch() override {
        for (std::uint32_t i = 0; i < thread_count; ++i) {
            pthread_join(threads[i], nullptr);
        }
        pthread_cond_destroy(&finished);
        pthread_mutex_destroy(&mutex);
    }
};

extern "C" {

const char *gwb_version(void) { return GWB_VERSION; }

double gwb_gravity(void) { return giveway::plant::gravity_mps2; }

const char *gwb_token(uint32_t model) { return model < GWB_MODEL_COUNT ? batch::info_of(model).token : nullptr; }

size_t gwb_variable_count(uint32_t model) { return model < GWB_MODEL_COUNT ? batch::info_of(model).variable_count : 0; }

int gwb_variable_at(uint32_t model, size_t index, gwb_variable_t *variable) {
    const bool exists = index < gwb_variable_count(model);
    return describe(model, exists ? &batch::info_of(model).variables[index] : nullptr, variable);
}

int gwb_find_variable(uint32_t model, const char *name, gwb_variable_t *variable) {
    const bool possible = model < GWB_MODEL_COUNT && name != nullptr;
    return describe(model, possible ? batch::find(batch::info_of(model), name) : nullptr, variable);
}

uint32_t gwb_metric_count(void) { return GWB_METRIC_COUNT; }

int gwb_metric_info(uint32_t metric, gwb_metric_info_t *info) {
    if (metric >= GWB_METRIC_COUNT || info == nullptr) {
        return 0;
    }
    *info = metric_infos[metric];
    return 1;
}

gwb_windows_t gwb_windows(void) {
    return {GWB_CAUSE_WINDOW_S, GWB_TRANSIENT_WINDOW_S, GWB_CONTACT_GAP_S, GWB_PEAK_TORQUE_WINDOW_S};
}

uint32_t gwb_evaluate(const gwb_traces_t *traces, gwb_result_t *result) {
    if (traces == nullptr || result == nullptr) {
        return GWB_WRONG_SPEC;
    }
    batch::evaluate_traces(*traces, *result);
    return result->status;
}

int gwb_judge_force(const double *time_s, const double *force_n, size_t rows, double touch_n, gwb_force_t *judged) {
    if (time_s == nullptr || force_n == nullptr || judged == nullptr) {
        return 0;
    }
    for (std::size_t i = 0; i < rows; ++i) {
        const bool later = i == 0 || time_s[i] > time_s[i - 1];
        if (!later || !std::isfinite(time_s[i]) || !std::isfinite(force_n[i]) || force_n[i] < 0.0) {
            return 0;
        }
    }
    *judged = batch::judge_force(
        rows, [=](std::size_t i) { return time_s[i]; }, [=](std::size_t i) { return force_n[i]; }, touch_n);
    return 1;
}

uint32_t gwb_run(const gwb_spec_t *spec, gwb_result_t *result) {
    if (spec == nullptr || result == nullptr) {
        return GWB_WRONG_SPEC;
    }
    batch::Monitor alone;
    batch::run(*spec, alone, *result);
    return result->status;
}

uint32_t gwb_widest_lanes(void) { return static_cast<std::uint32_t>(batch::widest_lanes()); }

int gwb_start(const gwb_spec_t *specs, size_t count, const gwb_options_t *options, gwb_result_t *results,
              gwb_batch_t **started, char *message) {
    if (message != nullptr) {
        message[0] = '\0';
    }
    if (started == nullptr) {
        return refuse(message, "batch is a null pointer (for %zu runs)", count);
    }
    *started = nullptr;
    if ((specs == nullptr || results == nullptr) && count > 0) {
        return refuse(message, "specs or results is a null pointer, but count is %zu", count);
    }
    if (check_options(options, message) == 0) {
        return 0;
    }
    std::unique_ptr<gwb_batch> made(new (std::nothrow) gwb_batch);
    const auto wanted = static_cast<std::uint32_t>(std::min<std::size_t>(options->threads, count));
    if (made != nullptr) {
        made->threads.reset(new (std::nothrow) pthread_t[wanted]);
    }
    if (made == nullptr || made->threads == nullptr) {
        return refuse(message, "no memory for a batch of %zu runs", count);
    }
    made->specs = specs;
    made->count = count;
    made->results = results;
    made->options = *options;
    if (options->method == GWB_FIXED_STEP) {
        if (options->lanes == 0) {
            made->options.lanes = gwb_widest_lanes();
        }
        // Large enough that a portion has several designs of one kind, and small enough for some portions per thread.
        const std::size_t lanes = made->options.lanes;
        const std::size_t fair = count / (2U * std::size_t{options->threads}) / lanes * lanes;
        made->portion = std::clamp<std::size_t>(fair, lanes, largest_portion);
    }
    for (std::size_t i = 0; i < count; ++i) {
        made->steps += specs[i].step_count;
    }
    if (!made->start(wanted)) {
        return refuse(message, "none of %u threads could be started", wanted);
    }
    *started = made.release();
    return 1;
}

int gwb_wait(gwb_batch_t *running, double timeout_s, gwb_progress_t *progress) {
    if (running == nullptr) {
        return 1;
    }
    constexpr double day_s = 86400.0; // keeps the sum in range; the caller can wait again
    const double wait_s = timeout_s > 0.0 ? std::min(timeout_s, day_s) : 0.0;
    timespec deadline{};
    clock_gettime(CLOCK_MONOTONIC, &deadline);
    const double nanoseconds = static_cast<double>(deadline.tv_nsec) + 1e9 * (wait_s - std::floor(wait_s));
    const bool carry = nanoseconds >= 1e9;
    deadline.tv_sec += static_cast<std::time_t>(std::floor(wait_s)) + (carry ? 1 : 0);
    deadline.tv_nsec = static_cast<long>(carry ? nanoseconds - 1e9 : nanoseconds);
    running->wait_until(deadline);
    const std::uint64_t done = running->runs_done.load(std::memory_order_acquire);
    if (progress != nullptr) {
        *progress = {done, running->count, running->monitor.steps_done.load(std::memory_order_relaxed), running->steps};
    }
    return done == running->count ? 1 : 0;
}

void gwb_cancel(gwb_batch_t *running) {
    if (running != nullptr) {
        running->monitor.cancelled.store(true, std::memory_order_relaxed);
    }
}

void gwb_finish(gwb_batch_t *running) {
    gwb_cancel(running);
    delete running;
}

} // extern "C"
