/* Controller and testbed, coupled by a program of two pages: how to load giveway's FMUs from C, and in which order to
   exchange.

     c_master CONTROLLER TESTBED [--seconds S] [--repeat N] [--profile] [--record NAME]... [controller.NAME=VALUE |
   testbed.NAME=VALUE]...

   CONTROLLER and TESTBED are folders with the unzipped FMI 3.0 FMUs. With --record the variables of the testbed that
   are named come out as CSV, one line each millisecond; without, the runs per second, and with --profile the time
   inside each FMU's steps. */
#define _POSIX_C_SOURCE 200809L
#include "fmu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define STEP_S 1e-3
#define MOST 64

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Variables exchanged between the two; the names are the same in both. */
static const char *const sensed_reals[] = {"sensor.torque[0]",       "sensor.torque[1]",       "sensor.torque[2]",
                                           "sensor.acceleration[0]", "sensor.acceleration[1]", "sensor.yaw_rate"};
static const char *const sensed_integers[] = {"sensor.encoder[0]", "sensor.encoder[1]", "sensor.encoder[2]",
                                              "sensor.counter", "sensor.imu_counter"};
static const char *const sensed_booleans[] = {"sensor.present", "sensor.imu_present"};
static const char *const commanded_reals[] = {"command.wheel_angle[0]", "command.wheel_angle[1]",
                                              "command.wheel_angle[2]", "command.wheel_speed[0]",
                                              "command.wheel_speed[1]", "command.wheel_speed[2]"};
static const char *const commanded_booleans[] = {"command.enable"};

typedef struct {
    fmi3ValueReference reals[8], integers[8], booleans[2];
    size_t real_count, integer_count, boolean_count;
} Bundle;

static void look_up(const Fmu *fmu, const char *const *names, size_t count, fmi3ValueReference *references)
{
    size_t i;
    for (i = 0; i < count; ++i) {
        references[i] = fmu_reference(fmu, names[i]);
    }
}

static Bundle sensors_of(const Fmu *fmu)
{
    Bundle bundle = {{0}, {0}, {0}, COUNT(sensed_reals), COUNT(sensed_integers), COUNT(sensed_booleans)};
    look_up(fmu, sensed_reals, bundle.real_count, bundle.reals);
    look_up(fmu, sensed_integers, bundle.integer_count, bundle.integers);
    look_up(fmu, sensed_booleans, bundle.boolean_count, bundle.booleans);
    return bundle;
}

static Bundle commands_of(const Fmu *fmu)
{
    Bundle bundle = {{0}, {0}, {0}, COUNT(commanded_reals), 0, COUNT(commanded_booleans)};
    look_up(fmu, commanded_reals, bundle.real_count, bundle.reals);
    look_up(fmu, commanded_booleans, bundle.boolean_count, bundle.booleans);
    return bundle;
}

/* Copies a group of outputs of one FMU to the inputs of the other. */
static void pass(const Fmu *from, const Bundle *outputs, const Fmu *to, const Bundle *inputs)
{
    fmi3Float64 reals[8];
    fmi3Int32 integers[8];
    fmi3Boolean booleans[2];
    const size_t n = outputs->real_count, m = outputs->integer_count, k = outputs->boolean_count;
    fmu_check(from, from->get_real(from->instance, outputs->reals, n, reals, n), "fmi3GetFloat64");
    fmu_check(to, to->set_real(to->instance, inputs->reals, n, reals, n), "fmi3SetFloat64");
    if (m > 0) {
        fmu_check(from, from->get_integer(from->instance, outputs->integers, m, integers, m), "fmi3GetInt32");
        fmu_check(to, to->set_integer(to->instance, inputs->integers, m, integers, m), "fmi3SetInt32");
    }
    fmu_check(from, from->get_boolean(from->instance, outputs->booleans, k, booleans, k), "fmi3GetBoolean");
    fmu_check(to, to->set_boolean(to->instance, inputs->booleans, k, booleans, k), "fmi3SetBoolean");
}

typedef struct {
    fmi3ValueReference references[MOST];
    size_t count;
} Recorded;

static void record(const Fmu *testbed, const Recorded *recorded, double time_s)
{
    fmi3Float64 values[MOST];
    size_t i;
    fmu_check(testbed,
              testbed->get_real(testbed->instance, recorded->references, recorded->count, values, recorded->count),
              "fmi3GetFloat64");
    (void)printf("%.17g", time_s);
    for (i = 0; i < recorded->count; ++i) {
        (void)printf(",%.17g", values[i]);
    }
    (void)printf("\n");
}

static double now_s(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Adds the duration of the step to *spent_s, unless that is null. */
static void step(Fmu *fmu, double time_s, double *spent_s)
{
    const double started_s = spent_s == NULL ? 0.0 : now_s();
    fmu_step(fmu, time_s, STEP_S);
    if (spent_s != NULL) {
        *spent_s += now_s() - started_s;
    }
}

/* One run from new instances; the order of exchange is that of fmu/README.md. `spent_s`: of controller and testbed, or
 * null. */
static void run(Fmu *controller, Fmu *testbed, const char *const *assignments, size_t assignment_count, long steps,
                const Recorded *recorded, double *spent_s)
{
    const Bundle sensors_out = sensors_of(testbed), sensors_in = sensors_of(controller);
    const Bundle commands_out = commands_of(controller), commands_in = commands_of(testbed);
    size_t i;
    long k;
    fmu_instantiate(controller);
    fmu_instantiate(testbed);
    for (i = 0; i < assignment_count; ++i) {
        const char *dot = strchr(assignments[i], '.');
        fmu_assign(strncmp(assignments[i], "testbed.", 8) == 0 ? testbed : controller, dot + 1);
    }
    fmu_initialise(controller);
    fmu_initialise(testbed);
    for (k = 0; k < steps; ++k) {
        const double time_s = (double)k * STEP_S;
        if (recorded->count > 0) {
            record(testbed, recorded, time_s);
        }
        pass(testbed, &sensors_out, controller, &sensors_in);
        step(controller, time_s, spent_s);
        pass(controller, &commands_out, testbed, &commands_in);
        step(testbed, time_s, spent_s == NULL ? NULL : spent_s + 1);
    }
    if (recorded->count > 0) {
        record(testbed, recorded, (double)steps * STEP_S);
    }
    fmu_free(testbed);
    fmu_free(controller);
}

static int usage(const char *what)
{
    (void)fprintf(
        stderr,
        "c_master: %s\nusage: c_master CONTROLLER TESTBED [--seconds S] [--repeat N] [--profile] [--record NAME]... "
        "[controller.NAME=VALUE | testbed.NAME=VALUE]...\n",
        what);
    return 2;
}

int main(int count, char **arguments)
{
    const char *assignments[MOST], *names[MOST];
    size_t assignment_count = 0;
    Recorded recorded = {{0}, 0};
    Fmu controller, testbed;
    double seconds = 1.0, best_s = 0.0, best_spent_s[2] = {0.0, 0.0};
    long repeats = 1, r;
    int profiled = 0;
    size_t j;
    int i;
    if (count < 3) {
        return usage("two folders are needed");
    }
    for (i = 3; i < count; ++i) {
        const char *value = i + 1 < count ? arguments[i + 1] : "";
        if (strcmp(arguments[i], "--seconds") == 0) {
            seconds = strtod(value, NULL);
            ++i;
        } else if (strcmp(arguments[i], "--repeat") == 0) {
            repeats = strtol(value, NULL, 10);
            ++i;
        } else if (strcmp(arguments[i], "--profile") == 0) {
            profiled = 1;
        } else if (strcmp(arguments[i], "--record") == 0 && recorded.count < MOST) {
            names[recorded.count++] = value;
            ++i;
        } else if ((strncmp(arguments[i], "controller.", 11) == 0 || strncmp(arguments[i], "testbed.", 8) == 0) &&
                   strchr(arguments[i], '=') != NULL && assignment_count < MOST) {
            assignments[assignment_count++] = arguments[i];
        } else {
            return usage(arguments[i]);
        }
    }
    if (!(seconds > 0.0 && seconds <= 3600.0)) {
        return usage("--seconds must be above 0, at most 3600");
    }
    if (repeats < 1 || repeats > 1000000) {
        return usage("--repeat must be from 1 to 1000000");
    }
    fmu_load(&controller, "controller", arguments[1]);
    fmu_load(&testbed, "testbed", arguments[2]);
    for (j = 0; j < recorded.count; ++j) {
        const char *unit;
        recorded.references[j] = fmu_reference(&testbed, names[j]);
        unit = fmu_unit(&testbed, names[j]);
        (void)printf(strcmp(unit, "1") == 0 ? "%s%s" : "%s%s [%s]", j == 0 ? "time [s]," : ",", names[j], unit);
    }
    if (recorded.count > 0) {
        (void)printf("\n");
    }
    for (r = 0; r < repeats; ++r) {
        double spent_s[2] = {0.0, 0.0};
        const double started_s = now_s();
        double took_s;
        run(&controller, &testbed, assignments, assignment_count, (long)(seconds / STEP_S + 0.5), &recorded,
            profiled ? spent_s : NULL);
        took_s = now_s() - started_s;
        best_s = r == 0 || took_s < best_s ? took_s : best_s;
        for (j = 0; j < COUNT(spent_s); ++j) {
            best_spent_s[j] = r == 0 || spent_s[j] < best_spent_s[j] ? spent_s[j] : best_spent_s[j];
        }
    }
    if (recorded.count == 0) {
        (void)printf("%.3f ms for a run of %g s, the best of %ld: %.1f runs per second\n", 1e3 * best_s, seconds,
                     repeats, 1.0 / best_s);
        if (profiled) {
            (void)printf("%.3f ms in the controller's steps, %.3f ms in the testbed's, the best of each\n",
                         1e3 * best_spent_s[0], 1e3 * best_spent_s[1]);
        }
    }
    fmu_unload(&controller);
    fmu_unload(&testbed);
    return 0;
}
