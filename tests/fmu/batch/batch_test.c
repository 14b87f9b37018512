/* The library from C: the header's promises, above all those about wrong input. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "giveway_batch.h"

static int failures = 0;

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            (void)printf("%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            ++failures; \
        } \
    } while (0)

#define STEPS 300

static gwb_spec_t rest_spec(void) {
    const gwb_spec_t spec = {.step_s = 0.001, .step_count = STEPS};
    return spec;
}

static gwb_variable_t variable(uint32_t model, const char *name) {
    gwb_variable_t found = {.model = GWB_NONE};
    CHECK(gwb_find_variable(model, name, &found) == 1);
    return found;
}

static int says(const gwb_result_t *result, const char *text) {
    const int found = strstr(result->message, text) != NULL;
    if (!found) {
        (void)printf("\"%s\" is not in \"%s\"\n", text, result->message);
    }
    return found;
}

/* The run is refused before it starts, with this text. */
static int refused(const gwb_spec_t *spec, const char *text) {
    gwb_result_t result;
    CHECK(gwb_run(spec, &result) == GWB_WRONG_SPEC);
    CHECK(result.status == GWB_WRONG_SPEC);
    CHECK(result.rows == 0);
    CHECK(isnan(result.metric[GWB_PEAK_FORCE]));
    return says(&result, text);
}

static void test_tables(void) {
    CHECK(strlen(gwb_version()) > 0);
    CHECK(gwb_gravity() == 9.81);
    CHECK(strlen(gwb_token(GWB_CONTROLLER)) > 0);
    CHECK(strcmp(gwb_token(GWB_CONTROLLER), gwb_token(GWB_TESTBED)) != 0);
    CHECK(gwb_token(GWB_MODEL_COUNT) == NULL);
    CHECK(gwb_variable_count(GWB_MODEL_COUNT) == 0);
    for (uint32_t model = 0; model < GWB_MODEL_COUNT; ++model) {
        const size_t count = gwb_variable_count(model);
        CHECK(count > 50);
        uint32_t last = 0;
        for (size_t i = 0; i < count; ++i) {
            gwb_variable_t by_index;
            gwb_variable_t by_name;
            CHECK(gwb_variable_at(model, i, &by_index) == 1);
            CHECK(gwb_find_variable(model, by_index.name, &by_name) == 1);
            CHECK(by_name.reference == by_index.reference && by_index.reference > last);
            CHECK(by_index.minimum <= by_index.maximum);
            last = by_index.reference;
        }
        gwb_variable_t untouched = {.reference = 7};
        CHECK(gwb_variable_at(model, count, &untouched) == 0);
        CHECK(gwb_find_variable(model, "no.such", &untouched) == 0);
        CHECK(gwb_find_variable(model, NULL, &untouched) == 0);
        CHECK(gwb_find_variable(GWB_MODEL_COUNT, "tick", &untouched) == 0);
        CHECK(untouched.reference == 7);
        CHECK(gwb_variable_at(model, 0, NULL) == 0);
    }
    const gwb_variable_t mass = variable(GWB_TESTBED, "slider.mass");
    CHECK(mass.type == GWB_REAL && mass.causality == GWB_PARAMETER);
    CHECK(variable(GWB_TESTBED, "bumper.kind").type == GWB_INTEGER);
    CHECK(variable(GWB_TESTBED, "truth.contact").type == GWB_BOOLEAN);
    CHECK(variable(GWB_TESTBED, "truth.contact").causality == GWB_OUTPUT);
    CHECK(variable(GWB_CONTROLLER, "plan.x").causality == GWB_INPUT);
}

static void test_metric_infos(void) {
    gwb_metric_info_t info = {.name = "untouched"};
    int lines[GWB_METRIC_COUNT] = {0};
    CHECK(gwb_metric_count() == GWB_METRIC_COUNT);
    CHECK(gwb_metric_info(GWB_METRIC_COUNT, &info) == 0);
    CHECK(strcmp(info.name, "untouched") == 0);
    CHECK(gwb_metric_info(0, NULL) == 0);
    for (uint32_t metric = 0; metric < GWB_METRIC_COUNT; ++metric) {
        CHECK(gwb_metric_info(metric, &info) == 1);
        CHECK(strlen(info.name) > 0 && strlen(info.unit) > 0 && strlen(info.description) > 10);
        CHECK(info.has_truth <= 1 && info.decimals >= -1 && info.decimals <= 3);
        CHECK(info.line < GWB_METRIC_COUNT && !lines[info.line]);
        lines[info.line] = 1;
    }
    /* Numbers never change: programs have them compiled in, and studies their columns. */
    CHECK(GWB_CONTACT_SPEED == 0 && GWB_PEAK_FORCE == 10 && GWB_EVENTS == 22 && GWB_TIP_MARGIN == 33);
    CHECK(GWB_FAULT_TIME == 42 && GWB_METRIC_COUNT >= 43);
    CHECK(gwb_metric_info(GWB_FALSE_DETECTIONS, &info) == 1);
    CHECK(strcmp(info.description, "detections without true contact or push in the 0.25 s before them") == 0);
    CHECK(info.shown == (GWB_OF_COLLISION | GWB_OF_FREE_RUN) && info.line == 1 && info.decimals == 0);
    CHECK(gwb_windows().cause_s == 0.25 && gwb_windows().transient_s == 0.5);
    CHECK(gwb_windows().contact_gap_s == 0.1 && gwb_windows().peak_torque_s == 0.35);
    CHECK(gwb_metric_info(GWB_PEAK_FORCE, &info) == 1 && strcmp(info.name, "peak force of the run") == 0);
}

static void test_a_run(void) {
    const gwb_variable_t kind = variable(GWB_TESTBED, "bumper.kind");
    const gwb_variable_t force = variable(GWB_TESTBED, "truth.contact_force");
    const gwb_variable_t tick = variable(GWB_CONTROLLER, "tick");
    const gwb_variable_t contact = variable(GWB_TESTBED, "truth.contact");
    static double forces[STEPS + 2];
    static int32_t ticks[STEPS + 2];
    static uint8_t contacts[STEPS + 2];
    forces[STEPS + 1] = -7.0;
    ticks[STEPS + 1] = -7;
    contacts[STEPS + 1] = 77;
    /* Later settings win. */
    const gwb_setting_t settings[] = {{GWB_TESTBED, kind.reference, 1.0}, {GWB_TESTBED, kind.reference, 0.0}};
    const gwb_column_t columns[] = {{GWB_TESTBED, force.reference, forces},
                                    {GWB_CONTROLLER, tick.reference, ticks},
                                    {GWB_TESTBED, contact.reference, contacts}};
    gwb_spec_t spec = rest_spec();
    spec.settings = settings;
    spec.setting_count = 2;
    spec.columns = columns;
    spec.column_count = 3;
    gwb_result_t result;
    CHECK(gwb_run(&spec, &result) == GWB_OK);
    CHECK(result.rows == STEPS + 1);
    CHECK(result.time_s == STEPS * 0.001);
    CHECK(result.message[0] == '\0');
    CHECK(result.model == GWB_NONE && result.reference == GWB_NONE && isnan(result.value));
    double peak = 0.0;
    int touched = 0;
    for (int k = 0; k <= STEPS; ++k) {
        peak = forces[k] > peak ? forces[k] : peak;
        touched += contacts[k];
        CHECK(k == 0 || ticks[k] == ticks[k - 1] + 1);
    }
    CHECK(peak > 100.0 && result.metric[GWB_PEAK_FORCE] == peak);
    CHECK(touched > 10 && touched < STEPS);
    CHECK(isnan(result.truth[GWB_PEAK_FORCE]));
    /* Nothing behind the last row was written. */
    CHECK(forces[STEPS + 1] == -7.0 && ticks[STEPS + 1] == -7 && contacts[STEPS + 1] == 77);

    gwb_result_t softer;
    spec.setting_count = 1;
    spec.column_count = 0;
    CHECK(gwb_run(&spec, &softer) == GWB_OK);
    CHECK(softer.metric[GWB_PEAK_FORCE] < 0.5 * peak);
}

static void test_wrong_specs(void) {
    gwb_result_t result;
    gwb_spec_t spec = rest_spec();
    CHECK(gwb_run(NULL, &result) == GWB_WRONG_SPEC);
    CHECK(gwb_run(&spec, NULL) == GWB_WRONG_SPEC);

    const double steps_s[] = {0.0, -0.001,  nextafter(GWB_STEP_MIN_S, 0.0), nextafter(GWB_STEP_MAX_S, 1.0),
                              NAN, INFINITY};
    for (size_t i = 0; i < sizeof steps_s / sizeof steps_s[0]; ++i) {
        spec.step_s = steps_s[i];
        CHECK(refused(&spec, "step_s = "));
    }
    spec.step_count = 1;
    spec.step_s = GWB_STEP_MIN_S;
    CHECK(gwb_run(&spec, &result) == GWB_OK);
    spec.step_s = GWB_STEP_MAX_S;
    CHECK(gwb_run(&spec, &result) == GWB_OK);

    spec = rest_spec();
    spec.step_count = 0;
    CHECK(refused(&spec, "step_count = 0 is not allowed: [1, 4000000]"));
    spec.step_count = GWB_STEP_COUNT_MAX + 1;
    CHECK(refused(&spec, "step_count = 4000001"));

    spec = rest_spec();
    spec.setting_count = 1;
    CHECK(refused(&spec, "settings is a null pointer"));
    spec = rest_spec();
    spec.column_count = 1;
    CHECK(refused(&spec, "columns is a null pointer"));
    spec = rest_spec();
    spec.plan_rows = 1;
    CHECK(refused(&spec, "plan is a null pointer"));
    spec = rest_spec();
    spec.push_rows = STEPS + 1;
    CHECK(refused(&spec, "push is a null pointer"));
    static double push[STEPS + 1][GWB_PUSH_COLUMNS];
    spec.push = push[0];
    spec.push_rows = STEPS;
    CHECK(refused(&spec, "push_rows = 300 is not allowed: 0, or at least step_count + 1 = 301"));
    spec.push_rows = STEPS + 1;
    CHECK(gwb_run(&spec, &result) == GWB_OK);
    push[STEPS][1] = NAN;
    CHECK(refused(&spec, "push, row 300: testbed.push.force_y = nan is not allowed"));

    double value = 0.0;
    gwb_column_t column = {GWB_TESTBED, variable(GWB_TESTBED, "slider.mass").reference, &value};
    spec = rest_spec();
    spec.columns = &column;
    spec.column_count = 1;
    CHECK(refused(&spec, "columns[0]: testbed.slider.mass is neither an input nor an output"));
    column.reference = variable(GWB_TESTBED, "truth.x").reference;
    column.values = NULL;
    CHECK(refused(&spec, "columns[0].values is a null pointer"));
}

static void set_and_expect(const gwb_setting_t *setting, uint32_t status) {
    gwb_spec_t spec = rest_spec();
    spec.step_count = 1;
    spec.settings = setting;
    spec.setting_count = 1;
    gwb_result_t result;
    if (gwb_run(&spec, &result) != status) {
        (void)printf("%u.%u = %.17g: status %u, not %u: %s\n", (unsigned)setting->model, (unsigned)setting->reference,
                     setting->value, (unsigned)result.status, (unsigned)status, result.message);
        ++failures;
    }
}

static void test_wrong_settings(void) {
    const gwb_variable_t mass = variable(GWB_TESTBED, "slider.mass");
    gwb_setting_t setting = {GWB_TESTBED, mass.reference, -1.0};
    gwb_spec_t spec = rest_spec();
    spec.settings = &setting;
    spec.setting_count = 1;
    CHECK(refused(&spec, "testbed.slider.mass = -1 is not allowed: finite and in ["));
    gwb_result_t result;
    CHECK(gwb_run(&spec, &result) == GWB_WRONG_SPEC);
    CHECK(result.model == GWB_TESTBED && result.reference == mass.reference);
    CHECK(result.value == -1.0 && result.minimum == mass.minimum && result.maximum == mass.maximum);

    setting.reference = 99999;
    CHECK(refused(&spec, "settings[0].reference = 99999 is not allowed: the testbed has no such variable"));
    setting.model = GWB_MODEL_COUNT;
    CHECK(refused(&spec, "settings[0].model = 2 is not allowed"));
    setting = (gwb_setting_t){GWB_CONTROLLER, variable(GWB_CONTROLLER, "plan.x").reference, 0.0};
    CHECK(refused(&spec, "settings[0]: controller.plan.x is an input, not a parameter"));
    setting = (gwb_setting_t){GWB_TESTBED, variable(GWB_TESTBED, "truth.x").reference, 0.0};
    CHECK(refused(&spec, "settings[0]: testbed.truth.x is an output, not a parameter"));
    setting = (gwb_setting_t){GWB_TESTBED, variable(GWB_TESTBED, "bumper.kind").reference, 0.5};
    CHECK(refused(&spec, "testbed.bumper.kind = 0.5 is not allowed: a whole number and in [0, 8]"));
    setting = (gwb_setting_t){GWB_TESTBED, variable(GWB_TESTBED, "slider.present").reference, 2.0};
    CHECK(refused(&spec, "testbed.slider.present = 2 is not allowed: a whole number and in [0, 1]"));

    /* The neighbours of every parameter's bounds: values outside are refused. */
    for (uint32_t model = 0; model < GWB_MODEL_COUNT; ++model) {
        for (size_t i = 0; i < gwb_variable_count(model); ++i) {
            gwb_variable_t v;
            CHECK(gwb_variable_at(model, i, &v) == 1);
            if (v.causality != GWB_PARAMETER) {
                continue;
            }
            const double outside[] = {nextafter(v.minimum, -INFINITY), nextafter(v.maximum, INFINITY), NAN, INFINITY,
                                      -INFINITY};
            for (size_t k = 0; k < sizeof outside / sizeof outside[0]; ++k) {
                const gwb_setting_t one = {model, v.reference, outside[k]};
                if (v.type != GWB_BOOLEAN || k >= 2) {
                    set_and_expect(&one, GWB_WRONG_SPEC);
                }
            }
        }
    }
    /* A bound itself is in. */
    const gwb_setting_t heaviest = {GWB_TESTBED, mass.reference, mass.maximum};
    set_and_expect(&heaviest, GWB_OK);
    const gwb_variable_t tolerance = variable(GWB_TESTBED, "solver.relative_tolerance");
    const gwb_setting_t finest = {GWB_TESTBED, tolerance.reference, tolerance.minimum};
    set_and_expect(&finest, GWB_OK);
}

static void test_a_refusal_of_the_models(void) {
    const gwb_setting_t setting = {GWB_TESTBED, variable(GWB_TESTBED, "outline.count").reference, 4.0};
    gwb_spec_t spec = rest_spec();
    spec.settings = &setting;
    spec.setting_count = 1;
    gwb_result_t result;
    CHECK(gwb_run(&spec, &result) == GWB_REFUSED);
    CHECK(result.model == GWB_TESTBED && result.rows == 0);
    CHECK(says(&result, "testbed: outline"));
}

/* Room for every output and input of a run. */
#define COLUMNS_MAX 400

typedef struct recording {
    gwb_column_t columns[COLUMNS_MAX];
    double values[COLUMNS_MAX][STEPS + 1];
    uint32_t count;
} recording_t;

static void record_all(recording_t *all) {
    all->count = 0;
    for (uint32_t model = 0; model < GWB_MODEL_COUNT; ++model) {
        for (size_t i = 0; i < gwb_variable_count(model); ++i) {
            gwb_variable_t v;
            CHECK(gwb_variable_at(model, i, &v) == 1);
            if ((v.causality != GWB_INPUT && v.causality != GWB_OUTPUT) || all->count == COLUMNS_MAX) {
                continue;
            }
            all->columns[all->count] = (gwb_column_t){model, v.reference, all->values[all->count]};
            ++all->count;
        }
    }
    CHECK(all->count < COLUMNS_MAX);
}

static int evaluation_refused(const gwb_traces_t *traces, const char *text) {
    gwb_result_t result;
    CHECK(gwb_evaluate(traces, &result) == GWB_WRONG_SPEC);
    CHECK(result.status == GWB_WRONG_SPEC && result.rows == 0);
    CHECK(isnan(result.metric[GWB_PEAK_FORCE]));
    return says(&result, text);
}

static void test_recorded_traces(void) {
    static recording_t all;
    static double time_s[STEPS + 1];
    record_all(&all);
    const gwb_setting_t settings[] = {
        {GWB_TESTBED, variable(GWB_TESTBED, "bumper.kind").reference, 2.0},
        {GWB_TESTBED, variable(GWB_TESTBED, "bumper.travel").reference, 0.1},
        {GWB_CONTROLLER, variable(GWB_CONTROLLER, "estimator.average_window").reference, 7.0}};
    gwb_spec_t spec = rest_spec();
    spec.settings = settings;
    spec.setting_count = 3;
    spec.columns = all.columns;
    spec.column_count = all.count;
    spec.transient_limit_n = 260.0;
    spec.lasting_limit_n = 130.0;
    gwb_result_t run;
    CHECK(gwb_run(&spec, &run) == GWB_OK);
    CHECK(run.metric[GWB_DETECTION_TIME] > 0.0 && run.metric[GWB_TRANSIENT_SHARE] > 0.0);
    for (int k = 0; k <= STEPS; ++k) {
        time_s[k] = k * 0.001;
    }
    gwb_traces_t traces = {.time_s = time_s,
                           .columns = all.columns,
                           .settings = settings,
                           .rows = run.rows,
                           .column_count = all.count,
                           .setting_count = 3,
                           .transient_limit_n = 260.0,
                           .lasting_limit_n = 130.0};
    gwb_result_t again;
    CHECK(gwb_evaluate(&traces, &again) == GWB_OK);
    CHECK(again.rows == run.rows && again.time_s == run.time_s && again.message[0] == '\0');
    CHECK(memcmp(run.metric, again.metric, sizeof run.metric) == 0);
    CHECK(memcmp(run.truth, again.truth, sizeof run.truth) == 0);

    /* Parameters count, and a run that ended early is judged by what there is, down to one row. */
    traces.setting_count = 0;
    CHECK(gwb_evaluate(&traces, &again) == GWB_OK);
    CHECK(fabs(again.metric[GWB_BOTTOMING_MARGIN] - run.metric[GWB_BOTTOMING_MARGIN]) > 1.0);
    traces.setting_count = 3;
    for (uint32_t rows = 1; rows <= STEPS; ++rows) {
        traces.rows = rows;
        CHECK(gwb_evaluate(&traces, &again) == GWB_OK);
        CHECK(again.rows == rows && again.metric[GWB_PEAK_FORCE] <= run.metric[GWB_PEAK_FORCE]);
        CHECK(isnan(again.metric[GWB_FAULT_TIME]) == (rows == 1));
    }

    traces.rows = 0;
    CHECK(evaluation_refused(&traces, "rows = 0 is not allowed: [1, 4000001]"));
    traces.rows = STEPS + 1;
    time_s[7] = time_s[6];
    CHECK(evaluation_refused(&traces, "time_s[7] = 0.006"));
    time_s[7] = NAN;
    CHECK(evaluation_refused(&traces, "time_s[7] = nan is not allowed: finite and above the one before it"));
    time_s[7] = 7 * 0.001;
    traces.time_s = NULL;
    CHECK(evaluation_refused(&traces, "time_s is a null pointer"));
    traces.time_s = time_s;
    traces.lasting_limit_n = -1.0;
    CHECK(evaluation_refused(&traces, "lasting_limit_n = -1 is not allowed"));
    traces.lasting_limit_n = 0.0;
    traces.settings = NULL;
    CHECK(evaluation_refused(&traces, "settings is a null pointer"));
    traces.settings = settings;
    traces.columns = NULL;
    CHECK(evaluation_refused(&traces, "columns is a null pointer"));
    traces.columns = all.columns;
    const gwb_setting_t wrong = {GWB_TESTBED, settings[1].reference, -1.0};
    traces.settings = &wrong;
    traces.setting_count = 1;
    CHECK(evaluation_refused(&traces, "testbed.bumper.travel = -1 is not allowed"));
    traces.setting_count = 0;
    CHECK(gwb_evaluate(NULL, &again) == GWB_WRONG_SPEC && gwb_evaluate(&traces, NULL) == GWB_WRONG_SPEC);

    /* Each column alone: one that is needed is named, others and those of the push may be missing. */
    uint32_t needed = 0;
    for (uint32_t i = 0; i < all.count; ++i) {
        const gwb_column_t left_out = all.columns[i];
        gwb_variable_t v = {.name = ""};
        for (size_t k = 0; k < gwb_variable_count(left_out.model) && v.reference != left_out.reference; ++k) {
            CHECK(gwb_variable_at(left_out.model, k, &v) == 1);
        }
        all.columns[i] = all.columns[all.count - 1];
        traces.column_count = all.count - 1;
        if (gwb_evaluate(&traces, &again) == GWB_WRONG_SPEC) {
            CHECK(says(&again, v.name) && says(&again, "is missing"));
            CHECK(again.model == left_out.model && again.reference == left_out.reference);
            CHECK(strncmp(v.name, "push.", 5) != 0);
            ++needed;
        }
        all.columns[i] = left_out;
    }
    CHECK(needed > 40 && needed < all.count);
}

static void test_forces(void) {
    const double time_s[] = {0.0, 0.1, 0.5, 0.7, 1.3, 1.4};
    const double force_n[] = {0.0, 30.0, 50.0, 20.0, 60.0, 0.0};
    gwb_force_t judged;
    CHECK(gwb_judge_force(time_s, force_n, 6, 0.0, &judged) == 1);
    CHECK(judged.transient_n == 60.0 && judged.transient_time_s == 1.3);
    CHECK(judged.lasting_n == 20.0 && judged.lasting_time_s == 0.7 && judged.lasting_known == 1);
    CHECK(judged.longest_contact_s == 0.7 - 0.1);
    CHECK(gwb_judge_force(time_s, force_n, 3, 0.0, &judged) == 1);
    CHECK(judged.lasting_known == 0 && judged.lasting_n == 0.0 && isnan(judged.lasting_time_s));
    CHECK(gwb_judge_force(time_s, force_n, 6, 55.0, &judged) == 1);
    CHECK(judged.transient_n == 60.0 && judged.longest_contact_s == 0.0 && judged.lasting_known == 0);
    CHECK(gwb_judge_force(time_s, force_n, 6, 100.0, &judged) == 1);
    CHECK(judged.transient_n == 0.0 && isnan(judged.transient_time_s) && judged.lasting_known == 1);
    CHECK(gwb_judge_force(time_s, force_n, 0, 0.0, &judged) == 1 && judged.lasting_known == 1);
    CHECK(gwb_judge_force(NULL, force_n, 6, 0.0, &judged) == 0);
    CHECK(gwb_judge_force(time_s, NULL, 6, 0.0, &judged) == 0);
    CHECK(gwb_judge_force(time_s, force_n, 6, 0.0, NULL) == 0);
    const double wrong[] = {0.0, 1.0, 1.0, NAN, -1.0, INFINITY};
    CHECK(gwb_judge_force(wrong, force_n, 2, 0.0, &judged) == 1);
    CHECK(gwb_judge_force(wrong, force_n, 3, 0.0, &judged) == 0);
    CHECK(gwb_judge_force(&wrong[3], force_n, 1, 0.0, &judged) == 0);
    for (int i = 3; i < 6; ++i) {
        CHECK(gwb_judge_force(time_s, &wrong[i], 1, 0.0, &judged) == 0);
    }
}

#define RUNS 6

static void test_batches(void) {
    static gwb_spec_t specs[RUNS];
    static gwb_result_t results[RUNS];
    static gwb_result_t again[RUNS];
    static gwb_setting_t masses[RUNS];
    const gwb_variable_t mass = variable(GWB_TESTBED, "slider.mass");
    for (int i = 0; i < RUNS; ++i) {
        masses[i] = (gwb_setting_t){GWB_TESTBED, mass.reference, 5.0 + i};
        specs[i] = rest_spec();
        specs[i].settings = &masses[i];
        specs[i].setting_count = 1;
    }
    masses[2].value = NAN; /* one that cannot run */
    const gwb_options_t one = {.threads = 1};
    const gwb_options_t two = {.threads = 2};
    char message[GWB_MESSAGE_SIZE] = "";
    gwb_batch_t *batch = NULL;
    gwb_progress_t progress = {0, 0, 0, 0};
    CHECK(gwb_start(specs, RUNS, &two, results, &batch, message) == 1);
    while (!gwb_wait(batch, 10.0, &progress)) {
    }
    CHECK(progress.runs_done == RUNS && progress.runs == RUNS);
    CHECK(progress.steps == (uint64_t)RUNS * STEPS && progress.steps_done == progress.steps);
    gwb_finish(batch);
    CHECK(gwb_start(specs, RUNS, &one, again, &batch, NULL) == 1);
    CHECK(gwb_wait(batch, 600.0, NULL) == 1);
    gwb_finish(batch);
    for (int i = 0; i < RUNS; ++i) {
        CHECK(results[i].status == (i == 2 ? GWB_WRONG_SPEC : GWB_OK));
        CHECK(memcmp(&results[i], &again[i], sizeof results[i]) == 0);
        gwb_result_t alone;
        CHECK(gwb_run(&specs[i], &alone) == results[i].status);
        CHECK(memcmp(&results[i], &alone, sizeof alone) == 0);
    }
    CHECK(results[0].metric[GWB_PEAK_FORCE] != results[1].metric[GWB_PEAK_FORCE]);

    for (int i = 0; i < RUNS; ++i) {
        masses[i].value = 5.0;
        specs[i].step_count = 2000000; /* more than ten seconds of computing */
    }
    CHECK(gwb_start(specs, RUNS, &two, results, &batch, message) == 1);
    do {
        CHECK(gwb_wait(batch, 0.01, &progress) == 0);
    } while (progress.steps_done == 0);
    CHECK(progress.steps_done < progress.steps && progress.runs_done == 0);
    /* It waits for as long as asked, also where a second ends meanwhile; whole seconds are all that C99 has. */
    const time_t before = time(NULL);
    for (int i = 0; i < 5; ++i) {
        CHECK(gwb_wait(batch, 0.45, NULL) == 0);
    }
    const double waited_s = difftime(time(NULL), before);
    CHECK(waited_s >= 2.0 && waited_s <= 3.0); /* 2.25 s, in whole seconds */
    gwb_cancel(batch);
    CHECK(gwb_wait(batch, 60.0, &progress) == 1);
    CHECK(progress.steps_done == progress.steps);
    gwb_finish(batch);
    for (int i = 0; i < RUNS; ++i) {
        CHECK(results[i].status == GWB_CANCELLED);
        CHECK(says(&results[i], "cancelled"));
        /* It ended where the next row would have been computed. */
        CHECK(fabs(results[i].time_s - results[i].rows * specs[i].step_s) < 1e-9);
    }
    CHECK(results[0].rows + results[1].rows > 0 && results[RUNS - 1].rows == 0);
    /* Finishing alone cancels, too. */
    CHECK(gwb_start(specs, RUNS, &two, results, &batch, message) == 1);
    gwb_finish(batch);
    CHECK(results[RUNS - 1].status == GWB_CANCELLED);
}

static void test_wrong_batches(void) {
    const gwb_spec_t spec = rest_spec();
    gwb_result_t result;
    char message[GWB_MESSAGE_SIZE] = "";
    gwb_batch_t *batch = (gwb_batch_t *)&result;
    gwb_options_t options = {.threads = 0};
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    CHECK(batch == NULL);
    CHECK(strcmp(message, "threads = 0 is not allowed: [1, 1024]") == 0);
    options.threads = GWB_THREADS_MAX + 1;
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    options.threads = 1;
    CHECK(gwb_start(NULL, 1, &options, &result, &batch, message) == 0);
    CHECK(strstr(message, "null pointer") != NULL);
    CHECK(gwb_start(&spec, 1, &options, NULL, &batch, NULL) == 0);
    CHECK(gwb_start(&spec, 1, &options, &result, NULL, message) == 0);
    CHECK(gwb_start(&spec, 1, NULL, &result, &batch, message) == 0);
    CHECK(strcmp(message, "options is a null pointer") == 0);
    options.method = 2;
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    CHECK(strcmp(message, "method = 2 is not allowed: 0 (event-exact) or 1 (fixed step)") == 0);
    options.method = GWB_FIXED_STEP;
    options.lanes = 2;
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    CHECK(strncmp(message, "lanes = 2 is not allowed: ", 26) == 0);
    options.lanes = 0;
    options.plant_step_s = NAN;
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    CHECK(strcmp(message, "plant_step_s = nan is not allowed: 0, or [1e-6, 5e-4] s") == 0);
    options.plant_step_s = 1e-3;
    CHECK(gwb_start(&spec, 1, &options, &result, &batch, message) == 0);
    options.plant_step_s = 0.0;
    CHECK(gwb_wait(NULL, 0.0, NULL) == 1);
    gwb_cancel(NULL);
    gwb_finish(NULL);
    CHECK(gwb_start(NULL, 0, &options, NULL, &batch, message) == 1);
    CHECK(gwb_wait(batch, 1.0, NULL) == 1);
    gwb_finish(batch);
}

static gwb_run_up_t some_run_up(void) {
    const gwb_run_up_t run_up = {.end_speed_mps = 0.5,
                                 .duration_s = 0.3,
                                 .slider_mass = 9.08,
                                 .slider_friction = 1.0,
                                 .slider_friction_speed = 0.005,
                                 .rope_hanging_mass = 4.54,
                                 .rope_stiffness = 1e4,
                                 .rope_damping = 150.0,
                                 .rope_drop_height = 0.2,
                                 .rope_attached = 1};
    return run_up;
}

static void test_run_ups(void) {
    double times[] = {0.0, 0.05, 1.0};
    double travels[3] = {-1.0, -1.0, -1.0};
    gwb_run_up_t pulled = some_run_up();
    pulled.times_s = times;
    pulled.travels_m = travels;
    pulled.time_count = 3;
    CHECK(gwb_run_up(&pulled, 1) == 1 && pulled.status == GWB_OK);
    /* Of a stiff rope: both masses take part of the weight less the friction. */
    const double mean = (4.54 * gwb_gravity() - 1.0) / (4.54 + 9.08);
    CHECK(fabs(pulled.duration_s / (0.5 / mean) - 1.0) < 0.1);
    CHECK(pulled.start_speed_mps == 0.0 && fabs(pulled.reached_mps - 0.5) < 1e-9);
    CHECK(travels[0] == 0.0 && travels[1] > 0.0 && travels[1] < pulled.travel_m && travels[2] == pulled.travel_m);

    /* Free, friction alone slows it down. */
    gwb_run_up_t slid = some_run_up();
    slid.rope_attached = 0;
    CHECK(gwb_run_up(&slid, 1) == 1 && slid.status == GWB_OK);
    CHECK(fabs(slid.start_speed_mps - (0.5 + 0.3 / 9.08)) < 1e-9 && slid.duration_s == 0.3);
    CHECK(fabs(slid.travel_m - 0.3 * (0.5 + slid.start_speed_mps) / 2.0) < 1e-9);

    /* The weight has dropped 0.2 m before it is so fast. */
    gwb_run_up_t slow = some_run_up();
    slow.end_speed_mps = 5.0;
    CHECK(gwb_run_up(&slow, 1) == 0 && slow.status == GWB_REFUSED);
    CHECK(fabs(slow.reached_mps / sqrt(2.0 * mean * 0.2) - 1.0) < 0.05);
    gwb_run_up_t stuck = some_run_up();
    stuck.slider_friction = 100.0;
    CHECK(gwb_run_up(&stuck, 1) == 0 && stuck.status == GWB_REFUSED && stuck.reached_mps < 0.005);
    gwb_run_up_t fast = slid;
    fast.slider_damping = 1000.0;
    CHECK(gwb_run_up(&fast, 1) == 0 && fast.status == GWB_REFUSED);
}

static void test_wrong_run_ups(void) {
    gwb_run_up_t wrong[8];
    for (size_t i = 0; i < 8; ++i) {
        wrong[i] = some_run_up();
    }
    double falling[] = {0.1, 0.05};
    double early[] = {-0.1};
    double travels[2] = {7.0, 7.0};
    wrong[0].slider_mass = 0.0;
    wrong[1].slider_friction = NAN;
    wrong[2].end_speed_mps = 0.0; /* the rope pulls */
    wrong[3].rope_attached = 0;
    wrong[3].duration_s = 60.5;
    wrong[4].rope_attached = 2;
    wrong[5].time_count = 1; /* where to? */
    wrong[6].time_count = 2;
    wrong[6].times_s = falling;
    wrong[6].travels_m = travels;
    wrong[7].time_count = 1;
    wrong[7].times_s = early;
    wrong[7].travels_m = travels;
    CHECK(gwb_run_up(wrong, 8) == 0);
    for (size_t i = 0; i < 8; ++i) {
        CHECK(wrong[i].status == GWB_WRONG_SPEC);
    }
    CHECK(travels[0] == 7.0);
    CHECK(gwb_run_up(NULL, 1) == 0);
}

int main(void) {
    test_tables();
    test_metric_infos();
    test_a_run();
    test_wrong_specs();
    test_wrong_settings();
    test_a_refusal_of_the_models();
    test_recorded_traces();
    test_forces();
    test_run_ups();
    test_wrong_run_ups();
    test_batches();
    test_wrong_batches();
    (void)printf("%d failures\n", failures);
    return failures == 0 ? 0 : 1;
}
