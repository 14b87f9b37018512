// One run around its plant: checks and settings, the controller, the exchange with the plant's variables, traces and
// metrics.
#pragma once

#include <array>
#include <memory>
#include <new>

#include "judged.hpp"
#include "run.hpp"

namespace giveway::batch {

// Memory for the samples, reused by successive runs: new pages for each run would cost a twentieth of a fixed-step run.
class SampleRoom {
public:
    // Null when memory is short.
    Sample *of(std::size_t count) {
        if (count > count_) {
            samples_.reset(new (std::nothrow) Sample[count]);
            count_ = samples_ != nullptr ? count : 0;
        }
        return samples_.get();
    }

private:
    std::unique_ptr<Sample[]> samples_;
    std::size_t count_ = 0;
};

class RecordedRun : public Judged {
public:
    RecordedRun(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result);
    ~RecordedRun(); // counts all steps as done
    RecordedRun(const RecordedRun &) = delete;
    RecordedRun &operator=(const RecordedRun &) = delete;

    // In this order. Each is false if the run ended with a message.
    // Checks the spec, makes the controller and applies the settings to it and to the testbed's variables.
    bool prepare(testbed::Variables &testbed);
    bool start_controller();
    // The recorded samples are in `room`, which belongs to this run alone until judge().
    bool begin(SampleRoom &room);
    // At every step 0 .. step_count: sensors, plan, controller, commands, push, record.
    bool exchange(std::uint32_t step);
    // After a step of the plant to `step`.
    void report(std::uint32_t step);
    // After the last exchange: metrics.
    void judge();

    // Another object continues this run and counts its steps.
    void hand_over() { reported_ = spec_.step_count; }
    bool model_failed(std::uint32_t status, std::uint32_t model, Message &message);

    [[nodiscard]] const gwb_spec_t &spec() const { return spec_; }
    [[nodiscard]] double time_s(std::uint32_t step) const { return static_cast<double>(step) * spec_.step_s; }

private:
    struct Recorder {
        const unsigned char *from;
        unsigned char *to;
        std::size_t size;
    };

    bool check_spec();
    template <class Inputs>
    bool check_table(const char *name, const Inputs &inputs, const double *table, std::uint32_t rows);
    bool create();
    bool pass(const class Links &links, std::uint32_t receiver);
    void record(std::uint32_t k, double now_s);

    const gwb_spec_t &spec_;
    Monitor &monitor_;
    std::unique_ptr<Model> controller_;
    Sample *samples_ = nullptr;
    std::unique_ptr<Recorder[]> recorders_;
    std::uint32_t path_row_ = 0;
    std::uint32_t reported_ = 0; // steps counted as done
};

} // namespace giveway::batch
