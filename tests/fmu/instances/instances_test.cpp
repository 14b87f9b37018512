// Many instances of one FMU in one process: they do not influence each other, also not in threads, and free all memory.
//
// Built once per FMU with the address sanitiser's allocator, whose leak check at exit fails the test if a single block
// is left (Leaks.AreSeen plants one to see that it would).
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include <fmi2Functions.h>
#include <fmi3Functions.h>
#include <gtest/gtest.h>
#include <sanitizer/lsan_interface.h>

#include "model.hpp"

// Of the sanitiser's allocator; gcc has no header for it.
extern "C" size_t __sanitizer_get_current_allocated_bytes();

namespace {

using giveway::Causality;
using giveway::ModelInfo;
using giveway::VariableInfo;
using giveway::VariableType;

std::string last_message;

void log3(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String text) { last_message = text; }
void log2(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String text, ...) { last_message = text; }

fmi3Instance instantiate3() {
    return fmi3InstantiateCoSimulation("test", giveway::model_info().token, nullptr, fmi3False, fmi3False, fmi3False,
                                       fmi3False, nullptr, 0, nullptr, log3, nullptr);
}

std::vector<fmi3ValueReference> references(Causality causality, VariableType type) {
    const ModelInfo &info = giveway::model_info();
    std::vector<fmi3ValueReference> found;
    for (std::size_t i = 0; i < info.variable_count; ++i) {
        const VariableInfo &variable = info.variables[i];
        if (variable.causality == causality && variable.type == type) {
            found.push_back(variable.reference);
        }
    }
    return found;
}

fmi3ValueReference reference_of(const char *name) {
    const ModelInfo &info = giveway::model_info();
    for (std::size_t i = 0; i < info.variable_count; ++i) {
        if (std::strcmp(info.variables[i].name, name) == 0) {
            return info.variables[i].reference;
        }
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
}

constexpr const char *parameter = GIVEWAY_PARAMETER;
constexpr double values[2] = {GIVEWAY_VALUES};

// All real outputs after each of `steps` steps. The controller is fed a push that it detects.
std::vector<double> run(double value, int steps) {
    fmi3Instance fmu = instantiate3();
    EXPECT_NE(fmu, nullptr) << last_message;
    const fmi3ValueReference changed = reference_of(parameter);
    EXPECT_EQ(fmi3SetFloat64(fmu, &changed, 1, &value, 1), fmi3OK);
    EXPECT_EQ(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), fmi3OK);
    EXPECT_EQ(fmi3ExitInitializationMode(fmu), fmi3OK);
    const auto outputs = references(Causality::output, VariableType::real);
    std::vector<double> trace;
    std::vector<double> row(outputs.size());
    for (int k = 0; k < steps; ++k) {
#ifdef GIVEWAY_CONTROLLER
        const fmi3ValueReference torques[2] = {reference_of("sensor.torque[1]"), reference_of("sensor.torque[2]")};
        const double push[2] = {k < 150 ? 0.0 : 2.0, k < 150 ? 0.0 : -2.0};
        const fmi3ValueReference counter = reference_of("sensor.counter");
        const fmi3ValueReference present = reference_of("sensor.present");
        const fmi3Int32 count = k;
        const fmi3Boolean arrived = fmi3True;
        EXPECT_EQ(fmi3SetFloat64(fmu, torques, 2, push, 2), fmi3OK);
        EXPECT_EQ(fmi3SetInt32(fmu, &counter, 1, &count, 1), fmi3OK);
        EXPECT_EQ(fmi3SetBoolean(fmu, &present, 1, &arrived, 1), fmi3OK);
#endif
        fmi3Boolean ignored = fmi3False;
        fmi3Float64 reached = 0.0;
        EXPECT_EQ(fmi3DoStep(fmu, k * 1e-3, 1e-3, fmi3True, &ignored, &ignored, &ignored, &reached), fmi3OK);
        EXPECT_EQ(fmi3GetFloat64(fmu, outputs.data(), outputs.size(), row.data(), row.size()), fmi3OK);
        trace.insert(trace.end(), row.begin(), row.end());
    }
    fmi3FreeInstance(fmu);
    return trace;
}

bool same_bits(const std::vector<double> &a, const std::vector<double> &b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

} // namespace

TEST(Instances, DoNotInfluenceEachOtherInThreads) {
    constexpr int steps = 400;
    const std::vector<double> alone[2] = {run(values[0], steps), run(values[1], steps)};
    ASSERT_FALSE(same_bits(alone[0], alone[1])) << "the parameter must matter, or this test could not fail";
    for (int repeat = 0; repeat < 5; ++repeat) {
        std::vector<double> together[4];
        std::vector<std::thread> threads;
        for (int i = 0; i < 4; ++i) {
            threads.emplace_back([&together, i] { together[i] = run(values[i % 2], steps); });
        }
        for (auto &thread : threads) {
            thread.join();
        }
        for (int i = 0; i < 4; ++i) {
            EXPECT_TRUE(same_bits(together[i], alone[i % 2])) << "thread " << i;
        }
    }
}

// For Model Exchange: into continuous time, one evaluation, and sometimes back to the start.
static void live_through_exchange(const fmi2CallbackFunctions &callbacks, bool reset) {
    const std::size_t count = giveway::model_info().state_count;
    std::vector<double> rates(count);
    fmi3Instance fmu =
        fmi3InstantiateModelExchange("test", giveway::model_info().token, nullptr, fmi3False, fmi3False, nullptr, log3);
    ASSERT_NE(fmu, nullptr) << last_message;
    ASSERT_EQ(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), fmi3OK);
    ASSERT_EQ(fmi3ExitInitializationMode(fmu), fmi3OK);
    ASSERT_EQ(fmi3UpdateDiscreteStates(fmu, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr), fmi3OK);
    ASSERT_EQ(fmi3EnterContinuousTimeMode(fmu), fmi3OK);
    ASSERT_EQ(fmi3GetContinuousStateDerivatives(fmu, rates.data(), count), fmi3OK);
    ASSERT_EQ(reset ? fmi3Reset(fmu) : fmi3Terminate(fmu), fmi3OK);
    fmi3FreeInstance(fmu);

    fmi2Component component =
        fmi2Instantiate("test", fmi2ModelExchange, giveway::model_info().token, "", &callbacks, fmi2False, fmi2False);
    ASSERT_NE(component, nullptr) << last_message;
    if (reset) {
        ASSERT_EQ(fmi2SetupExperiment(component, fmi2False, 0.0, 0.0, fmi2False, 0.0), fmi2OK);
        ASSERT_EQ(fmi2EnterInitializationMode(component), fmi2OK);
        ASSERT_EQ(fmi2GetDerivatives(component, rates.data(), count), fmi2OK);
    }
    fmi2FreeInstance(component);
}

// Takes, carries, puts back and frees states; one is filled twice.
static void live_with_states(fmi3Instance fmu) {
    fmi3FMUState state = nullptr;
    ASSERT_EQ(fmi3GetFMUState(fmu, &state), fmi3OK);
    ASSERT_EQ(fmi3GetFMUState(fmu, &state), fmi3OK);
    size_t size = 0;
    ASSERT_EQ(fmi3SerializedFMUStateSize(fmu, state, &size), fmi3OK);
    std::vector<fmi3Byte> bytes(size);
    ASSERT_EQ(fmi3SerializeFMUState(fmu, state, bytes.data(), size), fmi3OK);
    fmi3FMUState carried = nullptr;
    ASSERT_EQ(fmi3DeserializeFMUState(fmu, bytes.data(), size, &carried), fmi3OK);
    ASSERT_EQ(fmi3SetFMUState(fmu, carried), fmi3OK);
    bytes.back() ^= 1;
    fmi3FMUState refused = nullptr;
    ASSERT_EQ(fmi3DeserializeFMUState(fmu, bytes.data(), size, &refused), fmi3Error);
    ASSERT_EQ(fmi3FreeFMUState(fmu, &state), fmi3OK);
    ASSERT_EQ(fmi3FreeFMUState(fmu, &carried), fmi3OK);
}

// Ten thousand lives: with and without initialisation, steps, reset and terminate; FMI 3 and FMI 2; both interfaces.
TEST(Instances, LeaveNoMemoryBehind) {
    fmi2CallbackFunctions callbacks{};
    callbacks.logger = log2;
    callbacks.allocateMemory = std::calloc;
    callbacks.freeMemory = std::free;
    for (int life = 0; life < 5000; ++life) {
        fmi3Instance fmu = instantiate3();
        ASSERT_NE(fmu, nullptr);
        if (life % 2 == 0) {
            ASSERT_EQ(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), fmi3OK);
            ASSERT_EQ(fmi3ExitInitializationMode(fmu), fmi3OK);
            fmi3Boolean ignored = fmi3False;
            fmi3Float64 reached = 0.0;
            ASSERT_EQ(fmi3DoStep(fmu, 0.0, 1e-3, fmi3True, &ignored, &ignored, &ignored, &reached), fmi3OK);
            if (life % 10 == 0) {
                live_with_states(fmu);
            }
            if (life % 4 == 0) {
                ASSERT_EQ(fmi3Reset(fmu), fmi3OK);
            } else {
                ASSERT_EQ(fmi3Terminate(fmu), fmi3OK);
            }
        }
        fmi3FreeInstance(fmu);

        fmi2Component component = fmi2Instantiate("test", fmi2CoSimulation, giveway::model_info().token, "", &callbacks,
                                                  fmi2False, fmi2False);
        ASSERT_NE(component, nullptr) << last_message;
        if (life % 2 == 1) {
            ASSERT_EQ(fmi2SetupExperiment(component, fmi2False, 0.0, 0.0, fmi2False, 0.0), fmi2OK);
            ASSERT_EQ(fmi2EnterInitializationMode(component), fmi2OK);
            ASSERT_EQ(fmi2ExitInitializationMode(component), fmi2OK);
            ASSERT_EQ(fmi2DoStep(component, 0.0, 1e-3, fmi2True), fmi2OK);
        }
        fmi2FreeInstance(component);

        if (giveway::model_info().state_count > 0 && life % 5 == 0) {
            live_through_exchange(callbacks, life % 2 == 0);
        }
    }
    EXPECT_EQ(__lsan_do_recoverable_leak_check(), 0);
}

// More saved states than the built-in table of handles holds: each is found again, and a freed one is never used again.
// When all are freed the table uses no heap memory, which nobody would free when the library is unloaded.
TEST(Instances, KeepManyStatesAndGiveTheirMemoryBack) {
    fmi3Instance fmu = instantiate3();
    ASSERT_NE(fmu, nullptr);
    std::vector<fmi3FMUState> states(3000), freed;
    states.shrink_to_fit();
    freed.reserve(2 * states.size());
    const std::size_t before = __sanitizer_get_current_allocated_bytes();
    for (int repeat = 0; repeat < 2; ++repeat) {
        for (fmi3FMUState &state : states) {
            state = nullptr;
            ASSERT_EQ(fmi3GetFMUState(fmu, &state), fmi3OK);
        }
        for (const fmi3FMUState state : freed) {
            EXPECT_EQ(fmi3SetFMUState(fmu, state), fmi3Error);
        }
        for (fmi3FMUState &state : states) {
            EXPECT_EQ(fmi3SetFMUState(fmu, state), fmi3OK);
            freed.push_back(state);
            EXPECT_EQ(fmi3FreeFMUState(fmu, &state), fmi3OK);
        }
        last_message.clear();
        last_message.shrink_to_fit();
        EXPECT_EQ(__sanitizer_get_current_allocated_bytes(), before);
    }
    fmi3FreeInstance(fmu);
}

TEST(Leaks, AreSeen) {
    fmi3Instance forgotten = instantiate3();
    ASSERT_NE(forgotten, nullptr);
    // Hidden from the leak checker: only the complement is stored.
    volatile std::uintptr_t hidden = ~reinterpret_cast<std::uintptr_t>(forgotten);
    forgotten = nullptr;
    std::thread([] { std::vector<double>(1000, 1.0); }).join(); // overwrites copies in registers and on the stack
    const int leaks = __lsan_do_recoverable_leak_check();
    fmi3FreeInstance(reinterpret_cast<fmi3Instance>(~hidden));
    EXPECT_NE(leaks, 0);
}
