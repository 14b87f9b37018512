/* libgiveway_batch: controller and testbed in one process, one run or many in threads. C99, no FMI.
 *
 * A run gives bit for bit what the FMUs give in co-simulation: the same models with the same checks, in the same
 * exchange order (fmu/README.md). It returns metrics and, on request, traces. Runs share nothing: a run gives the same
 * bits alone, in any batch, on any thread. Many designs run several times as fast over fixed steps (gwb_options_t).
 *
 *     gwb_variable_t mass;
 *     gwb_find_variable(GWB_TESTBED, "slider.mass", &mass);
 *     gwb_setting_t setting = {GWB_TESTBED, mass.reference, 13.62};
 *     gwb_spec_t spec = {.step_s = 0.001, .step_count = 600, .settings = &setting, .setting_count = 1};
 *     gwb_result_t result;
 *     if (gwb_run(&spec, &result) == GWB_OK) { ... result.metric[GWB_PEAK_FORCE] ... }
 *
 * No function prints, exits, throws or keeps a pointer longer than stated. Units are SI unless a name says otherwise.
 */
#ifndef GIVEWAY_BATCH_H
#define GIVEWAY_BATCH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef GWB_BUILDING_LIBRARY
#define GWB_API __attribute__((visibility("default")))
#else
#define GWB_API
#endif

enum { GWB_CONTROLLER = 0, GWB_TESTBED = 1, GWB_MODEL_COUNT = 2 };
enum { GWB_REAL = 0, GWB_INTEGER = 1, GWB_BOOLEAN = 2 };
enum { GWB_PARAMETER = 0, GWB_INPUT = 1, GWB_OUTPUT = 2 };

/* How a batch is computed, and how a run was (gwb_result_t.method). */
enum {
    GWB_EVENT_EXACT = 0, /* as the FMUs: adaptive steps, every event located. The reference */
    GWB_FIXED_STEP = 1   /* several designs side by side over fixed steps, mode changes at step ends */
};

/* How a run ended. */
enum {
    GWB_OK = 0,
    GWB_CANCELLED = 1,  /* before its end, or before its start; traces hold what was computed */
    GWB_WRONG_SPEC = 2, /* the spec cannot be used, e.g. a value is out of its variable's range; nothing was computed */
    GWB_REFUSED = 3,    /* a model refuses its parameters at initialisation; nothing was computed */
    GWB_FAILED = 4,     /* a step failed, e.g. the integrator's; traces hold all rows up to the last good time */
    GWB_NO_MEMORY = 5
};

enum { GWB_PLAN_COLUMNS = 9, GWB_PUSH_COLUMNS = 4, GWB_STEP_COUNT_MAX = 4000000, GWB_MESSAGE_SIZE = 512 };
#define GWB_STEP_MIN_S 1e-4
#define GWB_STEP_MAX_S 0.1
enum { GWB_THREADS_MAX = 1024 };
#define GWB_NONE UINT32_MAX /* no model, no reference */

/* Windows of the metrics' definitions. */
#define GWB_CAUSE_WINDOW_S 0.25       /* a detection is false if nothing touched the robot for this time */
#define GWB_TRANSIENT_WINDOW_S 0.5    /* of a contact with a person; a longer force is quasi-static */
#define GWB_CONTACT_GAP_S 0.1         /* touches less than this apart are one contact */
#define GWB_PEAK_TORQUE_WINDOW_S 0.35 /* from contact on: the impact's peak, not that of the escape */

/* Where a metric is shown. Batches and studies have all of them. */
enum {
    GWB_OF_BATCH = 0,
    GWB_OF_COLLISION = 1, /* the table of a run in which something can be hit */
    GWB_OF_DESIGN = 2,    /* metrics of a bumper design, and of deviations from the request */
    GWB_OF_FREE_RUN = 4   /* the table of a run in which nothing can be hit */
};

/* Every metric, in the order in which tables show them: enumerator, number, name, unit, whether the testbed knows the
 * truth, decimals worth printing (-1: judged by its exponent), where it is shown, and its definition. Numbers never
 * change; a new metric gets the next one, a line here and its value in metrics.cpp.
 *
 * "Contact" is the first one of the cover with the robot, at the time that the integrator found; detection times
 * resolve one step. "True" is what the testbed knows. The base frame has x forward, y left, and is fixed to the robot.
 */
/* clang-format off */
#define GWB_METRICS(METRIC) \
    METRIC(GWB_CONTACT_SPEED, 0, "contact speed", "m/s", 0, 3, GWB_OF_COLLISION, \
           "speed of the slider's nose relative to the robot in the last step before contact") \
    METRIC(GWB_FALSE_DETECTIONS, 1, "false detections", "1", 1, 0, GWB_OF_COLLISION | GWB_OF_FREE_RUN, \
           "detections without true contact or push in the " GWB_TEXT(GWB_CAUSE_WINDOW_S) " s before them") \
    METRIC(GWB_DETECTION_TIME, 2, "detection time", "ms", 0, 1, GWB_OF_COLLISION, \
           "from contact to the controller's decision, all delays included") \
    METRIC(GWB_FORCE_DIRECTION, 3, "force direction", "deg", 1, 1, GWB_OF_COLLISION, \
           "direction of the detection's mean force in the base frame; true: of the impulse up to detection") \
    METRIC(GWB_DIRECTION_ERROR, 4, "direction error", "deg", 1, 1, GWB_OF_COLLISION, \
           "estimated minus true force direction, in [-180, 180)") \
    METRIC(GWB_CONTACT_POINT_X, 5, "contact point x", "mm", 1, 1, GWB_OF_COLLISION, \
           "x of where the robot was hit, base frame; true: mean up to detection, weighted by the force") \
    METRIC(GWB_CONTACT_POINT_Y, 6, "contact point y", "mm", 1, 1, GWB_OF_COLLISION, \
           "y of where the robot was hit, base frame; true: mean up to detection, weighted by the force") \
    METRIC(GWB_LOCATION_ERROR, 7, "location error", "mm", 1, 1, GWB_OF_COLLISION, \
           "distance of the estimated contact point from the true one") \
    METRIC(GWB_FORCE_AT_DETECTION, 8, "force at detection", "N", 1, 1, GWB_OF_COLLISION, \
           "filtered estimate of the force; true: mean force vector over the filter's window, to detection") \
    METRIC(GWB_IMPULSE, 9, "impulse at detection", "N.s", 1, 2, GWB_OF_COLLISION, \
           "integral of the estimated force vector from contact to detection; true: of the contact force") \
    METRIC(GWB_CONTACTS, 29, "contacts", "1", 0, 0, GWB_OF_COLLISION, \
           "number of contacts; touches less than " GWB_TEXT(GWB_CONTACT_GAP_S) " s apart are one: a plate bounces") \
    METRIC(GWB_FIRST_PEAK_FORCE, 34, "peak force of the first contact", "N", 0, 1, GWB_OF_COLLISION, \
           "largest true contact force of the first contact") \
    METRIC(GWB_PEAK_FORCE, 10, "peak force of the run", "N", 0, 1, GWB_OF_COLLISION, \
           "largest true contact force of the run") \
    METRIC(GWB_BUMPER_COMPRESSION, 11, "bumper compression", "mm", 0, 1, GWB_OF_COLLISION, \
           "largest compression: what the collision used of the bumper's travel, which is a parameter") \
    METRIC(GWB_PEAK_TORQUE, 12, "peak wheel torque", "N.m", 0, 2, GWB_OF_COLLISION, \
           "largest true torque of a wheel that carries the impact, in the impact's direction, within " \
           GWB_TEXT(GWB_PEAK_TORQUE_WINDOW_S) " s of contact") \
    METRIC(GWB_PEAK_TORQUE_ANY, 13, "peak torque, any sign", "N.m", 0, 2, GWB_OF_COLLISION, \
           "largest true torque of any wheel, either sign, from contact on") \
    METRIC(GWB_ESCAPE, 14, "escape distance", "m", 1, 3, GWB_OF_COLLISION, \
           "travel of the controller's reference from the last detection to the end; true: of the base") \
    METRIC(GWB_TRANSIENT_FORCE, 23, "transient force", "N", 0, 1, GWB_OF_DESIGN, \
           "largest contact force within the first " GWB_TEXT(GWB_TRANSIENT_WINDOW_S) " s of a contact") \
    METRIC(GWB_LASTING_FORCE, 24, "lasting force", "N", 0, 1, GWB_OF_DESIGN, \
           "largest contact force later in a contact; unknown if the run ended so soon after the first touch") \
    METRIC(GWB_LONGEST_CONTACT, 25, "longest contact", "s", 0, 3, GWB_OF_DESIGN, \
           "length of the longest contact; it ends when no force came for " GWB_TEXT(GWB_TRANSIENT_WINDOW_S) " s") \
    METRIC(GWB_TRANSIENT_SHARE, 26, "transient force share", "1", 0, 2, GWB_OF_DESIGN, \
           "transient force over the body region's limit; infinite where no contact is allowed and there was one") \
    METRIC(GWB_LASTING_SHARE, 27, "lasting force share", "1", 0, 2, GWB_OF_DESIGN, \
           "lasting force over the body region's limit") \
    METRIC(GWB_BOTTOMING_MARGIN, 28, "bottoming margin", "mm", 0, 1, GWB_OF_DESIGN, \
           "travel that the bumper had left at its largest compression; negative in its stop") \
    METRIC(GWB_REBOUND_SPEED, 30, "rebound speed", "m/s", 0, 3, GWB_OF_DESIGN, \
           "speed of the slider's nose relative to the robot when the first contact has ended") \
    METRIC(GWB_RELATCHES, 31, "re-latches", "1", 0, 0, GWB_OF_DESIGN, \
           "times that the bumper's magnet caught its plate again") \
    METRIC(GWB_RELATCH_TIME, 32, "re-latch time", "ms", 0, 1, GWB_OF_DESIGN, \
           "from contact to the first time that the bumper's magnet caught its plate again") \
    METRIC(GWB_TIP_MARGIN, 33, "tip margin", "1", 0, 2, GWB_OF_DESIGN, \
           "least margin of the run: 1 level and at rest; 0: a wheel lifts or, with base.tipping, the base goes over") \
    METRIC(GWB_FIRST_CONTACT_X, 35, "first contact x", "mm", 0, 1, GWB_OF_DESIGN, \
           "x of the true contact point in the first row of the first contact, base frame") \
    METRIC(GWB_FIRST_CONTACT_Y, 36, "first contact y", "mm", 0, 1, GWB_OF_DESIGN, \
           "y of the true contact point in the first row of the first contact, base frame") \
    METRIC(GWB_ROBOT_SPEED, 37, "robot speed at contact", "m/s", 0, 3, GWB_OF_DESIGN, \
           "true speed of the base in the last row before contact") \
    METRIC(GWB_PLAN_DISTANCE, 38, "distance from the plan", "mm", 0, 1, GWB_OF_DESIGN | GWB_OF_FREE_RUN, \
           "largest distance of the tracking controller's reference from the plan, up to its first reaction") \
    METRIC(GWB_PLAN_ANGLE, 39, "angle from the plan", "deg", 0, 1, GWB_OF_DESIGN | GWB_OF_FREE_RUN, \
           "largest angle of the tracking controller's reference from the plan, up to its first reaction") \
    METRIC(GWB_SENSED_TORQUE_SHARE, 40, "sensed torque share", "1", 0, 2, GWB_OF_DESIGN, \
           "largest sensed torque of a wheel over what counts as saturated") \
    METRIC(GWB_MOTOR_TORQUE_SHARE, 41, "motor torque share", "1", 0, 2, GWB_OF_DESIGN, \
           "largest motor torque over its limit") \
    METRIC(GWB_FAULT_TIME, 42, "time in sensor fault", "s", 0, 3, GWB_OF_DESIGN, \
           "time in the controller's mode 6") \
    METRIC(GWB_CONTACT_TIME, 16, "contact time", "s", 0, 3, GWB_OF_DESIGN, \
           "time of contact in the run") \
    METRIC(GWB_ENERGY_RESIDUAL, 15, "energy residual", "1", 1, -1, GWB_OF_COLLISION | GWB_OF_FREE_RUN, \
           "largest error of work in = stored + dissipated, over the largest of work, change of storage and loss") \
    METRIC(GWB_DETECTIONS, 17, "detections", "1", 0, 0, GWB_OF_BATCH, \
           "detections of the whole run") \
    METRIC(GWB_CONTACT_IMPULSE, 18, "contact impulse", "N.s", 0, 2, GWB_OF_BATCH, \
           "magnitude of the true impulse of the whole run") \
    METRIC(GWB_CONTACT_AT_END, 19, "contact at end", "1", 0, 0, GWB_OF_BATCH, \
           "1 if the cover touches the robot in the last row, else 0") \
    METRIC(GWB_LATCHED_AT_END, 20, "latched at end", "1", 0, 0, GWB_OF_BATCH, \
           "1 if the bumper's magnet holds its plate in the last row, else 0") \
    METRIC(GWB_ROPE_TAUT_AT_END, 21, "rope taut at end", "1", 0, 0, GWB_OF_BATCH, \
           "1 if the rope is taut in the last row, else 0") \
    METRIC(GWB_EVENTS, 22, "events", "1", 0, 0, GWB_OF_BATCH, \
           "events that the integrator located")
/* clang-format on */
#define GWB_TEXT(number) GWB_TEXT_OF(number)
#define GWB_TEXT_OF(number) #number

#define GWB_ENUMERATOR(metric, number, name, unit, has_truth, decimals, shown, description) metric = (number),
#define GWB_ONE(metric, number, name, unit, has_truth, decimals, shown, description) +1
enum { GWB_METRICS(GWB_ENUMERATOR) GWB_METRIC_COUNT = 0 GWB_METRICS(GWB_ONE) };
#undef GWB_ENUMERATOR
#undef GWB_ONE

typedef struct gwb_variable {
    uint32_t model;
    uint32_t reference; /* the FMUs' value reference */
    uint32_t type;
    uint32_t causality;
    double minimum, maximum; /* inclusive; infinite if there is none */
    const char *name;        /* lives as long as the library */
} gwb_variable_t;

/* A metric's line in GWB_METRICS. The texts live as long as the library. */
typedef struct gwb_metric_info {
    const char *name;
    const char *unit;
    uint32_t has_truth;
    int32_t decimals;
    uint32_t shown; /* sum of GWB_OF_... */
    uint32_t line;  /* 0 for the first: the order in which tables show them */
    const char *description;
} gwb_metric_info_t;

/* A parameter's value; integers as whole numbers, booleans as 0 and 1. Later settings win. */
typedef struct gwb_setting {
    uint32_t model;
    uint32_t reference;
    double value;
} gwb_setting_t;

/* An input or output, recorded once per step and once at the end: `values` has room for step_count + 1 values of the
 * variable's type, which are double (real), int32_t (integer) or uint8_t (boolean). Row k holds the testbed's outputs
 * at t_k, what the controller made of them, and the inputs of both for the step that begins at t_k
 * (in the last row, the testbed's inputs are those of the row before). */
typedef struct gwb_column {
    uint32_t model;
    uint32_t reference;
    void *values;
} gwb_column_t;

/* One run. A spec of zeros but step_s and step_count is a run with all start values. Pointers may be null if their
 * count is 0; all of them are only read, and the columns' values written. */
typedef struct gwb_spec {
    double step_s;       /* communication step, [GWB_STEP_MIN_S, GWB_STEP_MAX_S] */
    uint32_t step_count; /* [1, GWB_STEP_COUNT_MAX] */
    uint32_t setting_count;
    const gwb_setting_t *settings;
    /* The planned motion, world frame: plan_rows rows of x, y, theta, vx, vy, omega, ax, ay, alpha; row i belongs to
     * path tick i (1 ms) and the last row to all later ones, so that one row is a plan to rest. None: rest at 0. */
    const double *plan;
    /* An external push: rows of force x, y (N, world frame), point x, y (m, base frame); row k acts from t_k to
     * t_(k+1). None, or at least step_count + 1 rows. */
    const double *push;
    uint32_t plan_rows;
    uint32_t push_rows;
    const gwb_column_t *columns;
    uint32_t column_count;
    uint32_t reserved; /* 0 */
    /* Limits of the body region that is hit, N; a lasting limit of 0: none is given. With one, a transient limit of 0
     * says that no transient contact is allowed. */
    double transient_limit_n, lasting_limit_n;
} gwb_spec_t;

typedef struct gwb_result {
    uint32_t status;
    uint32_t model;                 /* that was wrong, refused or failed; else GWB_NONE */
    uint32_t reference;             /* the variable whose value was not allowed; else GWB_NONE */
    uint32_t rows;                  /* of every column that were written */
    uint32_t method;                /* that the run was computed with: not always the batch's, see gwb_options_t */
    uint32_t reserved;              /* 0 */
    double time_s;                  /* how far the run came: its end, or the last good time */
    double plant_step_s;            /* GWB_FIXED_STEP: the plant's step; else 0 */
    double value, minimum, maximum; /* of that variable; else NaN */
    /* NaN for events that did not happen; all NaN unless status is GWB_OK. */
    double metric[GWB_METRIC_COUNT];
    double truth[GWB_METRIC_COUNT]; /* NaN where there is none */
    char message[GWB_MESSAGE_SIZE]; /* empty if status is GWB_OK; one line, ends in a zero */
} gwb_result_t;

/* Version of giveway, e.g. "0.1.0". */
GWB_API const char *gwb_version(void);

/* Hash of the model's variable table, the FMUs' instantiation token; null for an unknown model. */
GWB_API const char *gwb_token(uint32_t model);

/* The plant's gravity, m/s2. */
GWB_API double gwb_gravity(void);

/* Number of variables of a model; 0 for an unknown model. */
GWB_API size_t gwb_variable_count(uint32_t model);

/* The variable at `index` in the order of references, or with this name. 1 if there is one; else 0, and *variable is
 * as before. */
GWB_API int gwb_variable_at(uint32_t model, size_t index, gwb_variable_t *variable);
GWB_API int gwb_find_variable(uint32_t model, const char *name, gwb_variable_t *variable);

/* GWB_METRIC_COUNT of the library, and what it says of a metric (1; 0 if there is none, and *info is as before). */
GWB_API uint32_t gwb_metric_count(void);
GWB_API int gwb_metric_info(uint32_t metric, gwb_metric_info_t *info);

/* The windows of the library. */
typedef struct gwb_windows {
    double cause_s, transient_s, contact_gap_s, peak_torque_s;
} gwb_windows_t;
GWB_API gwb_windows_t gwb_windows(void);

/* One run on the calling thread. Returns result->status; GWB_WRONG_SPEC for null pointers. */
GWB_API uint32_t gwb_run(const gwb_spec_t *spec, gwb_result_t *result);

/* What a run recorded, of this library or of the FMUs, whether it came to its end or not. All pointers are only read.
 * Of the variables that no metric needs, columns and settings may be missing or there; those of the inputs push.* may
 * be missing, too: there was no push. */
typedef struct gwb_traces {
    const double *time_s;        /* of the rows: finite, each above the one before */
    const gwb_column_t *columns; /* as in gwb_spec_t, each of `rows` values */
    const gwb_setting_t *settings;
    uint32_t rows; /* [1, GWB_STEP_COUNT_MAX + 1] */
    uint32_t column_count;
    uint32_t setting_count;
    uint32_t reserved; /* 0 */
    double transient_limit_n, lasting_limit_n;
} gwb_traces_t;

/* The metrics of recorded traces: bit for bit those of the run that recorded them. Returns result->status: GWB_OK,
 * GWB_NO_MEMORY, or GWB_WRONG_SPEC with a message that names what is missing or wrong. */
GWB_API uint32_t gwb_evaluate(const gwb_traces_t *traces, gwb_result_t *result);

/* A replay: the controller alone, on inputs that were recorded, of this library or of a real robot.
 *
 *     gwb_replay_t *replay;
 *     if (gwb_replay_start(settings, setting_count, 0.001, &replay, message)) {
 *         while (more) { gwb_replay_steps(replay, columns, column_count, rows, &result); ... }
 *         gwb_replay_finish(replay);
 *     }
 *
 * On the inputs that a run recorded it gives the controller's outputs of that run, bit for bit. */
typedef struct gwb_replay gwb_replay_t;

/* Settings are the controller's; they are copied. 1 if it was started; else 0, *replay is null, and message
 * (GWB_MESSAGE_SIZE bytes, or null) says why. */
GWB_API int gwb_replay_start(const gwb_setting_t *settings, uint32_t setting_count, double step_s,
                             gwb_replay_t **replay, char *message);

/* Goes on by `rows` steps, row k of the columns being the k-th of them: the controller's inputs are read, its outputs
 * written. An input without a column keeps its last value, at first its start value. Returns result->status: GWB_OK;
 * GWB_WRONG_SPEC, then result->rows were done, and the value of an input that is not allowed is in the row after them;
 * or GWB_FAILED. The replay can go on after GWB_WRONG_SPEC. */
GWB_API uint32_t gwb_replay_steps(gwb_replay_t *replay, const gwb_column_t *columns, uint32_t column_count,
                                  uint32_t rows, gwb_result_t *result);

/* Frees it. Null is allowed. */
GWB_API void gwb_replay_finish(gwb_replay_t *replay);

/* A contact force over time as GWB_TRANSIENT_FORCE, GWB_LASTING_FORCE and GWB_LONGEST_CONTACT have it. */
typedef struct gwb_force {
    double transient_n, transient_time_s; /* 0 and NaN without contact */
    double lasting_n, lasting_time_s;     /* 0 and NaN if none lasted so long */
    double longest_contact_s;
    uint32_t lasting_known; /* 0: the trace ends too soon after the first touch */
    uint32_t reserved;      /* 0 */
} gwb_force_t;

/* Judges `rows` forces: a touch is a force above touch_n, above the noise of a measured trace. 1; or 0 for null
 * pointers, a time that is not finite and above the one before it, or a force that is not finite and at least 0. */
GWB_API int gwb_judge_force(const double *time_s, const double *force_n, size_t rows, double touch_n,
                            gwb_force_t *judged);

/* Where a slider starts that is to have a speed when it meets the robot: the testbed's own equations of slider, rail
 * friction, rope and weight up to the contact, before any bumper gives way.
 *
 * With the rope it is pulled from rest until it is so fast. Without, it slides for a given time against the rail's
 * friction. */
#define GWB_RUN_UP_LONGEST_S 60.0
typedef struct gwb_run_up {
    double end_speed_mps; /* asked: [0, 20], with the rope above 0 */
    double duration_s;    /* without the rope asked, [0, GWB_RUN_UP_LONGEST_S]; with it found */
    /* The testbed's variables of these names, in their ranges. */
    double slider_mass, slider_friction, slider_friction_speed, slider_damping;
    double rope_hanging_mass, rope_stiffness, rope_damping, rope_drop_height;
    uint32_t rope_attached; /* 0 or 1 */
    uint32_t status; /* found: GWB_OK; GWB_WRONG_SPEC; GWB_FAILED, the integrator's; GWB_NO_MEMORY; GWB_REFUSED: the
                        weight has landed, or the longest time is over, at reached_mps (duration_s and travel_m are
                        those of that moment), or without the rope the start would have to be faster than 1000 m/s */
    /* Found. */
    double start_speed_mps, travel_m, reached_mps;
    /* Where it is in between, if GWB_OK: its travel from the start at `time_count` times, ascending and not negative;
     * after duration_s that of the end. */
    size_t time_count;
    const double *times_s;
    double *travels_m;
} gwb_run_up_t;

/* Answers `count` of them; returns how many are GWB_OK. */
GWB_API size_t gwb_run_up(gwb_run_up_t *run_ups, size_t count);

/* Many runs on separate threads. There are no callbacks: the waiting thread asks for the progress as often as needed.
 *
 *     gwb_options_t options = {.threads = 2, .method = GWB_FIXED_STEP};
 *     gwb_batch_t *batch;
 *     if (gwb_start(specs, count, &options, results, &batch, message)) {
 *         while (!gwb_wait(batch, 0.1, &progress)) { ... show progress; perhaps gwb_cancel(batch) ... }
 *         gwb_finish(batch);
 *     }
 */
typedef struct gwb_batch gwb_batch_t;

typedef struct gwb_progress {
    uint64_t runs_done, runs;   /* with their result written */
    uint64_t steps_done, steps; /* of all runs; a run that ends early counts all of its steps */
} gwb_progress_t;

/* GWB_FIXED_STEP trades a bounded error (README.md of fmu/batch has the figures) for speed. A design gives the same
 * bits in every lane, with any number of lanes, on any thread and in any batch. Its step follows from its parameters
 * alone; the integrator's settings (solver.*) have no effect. The following runs are event-exact instead, which the
 * result's method shows: a base that tips, a communication step that is not a whole number of servo ticks (0.5 ms), and
 * designs so stiff that their step would be below 0.5 ms / 32. */
typedef struct gwb_options {
    uint32_t threads;    /* [1, GWB_THREADS_MAX]; not more than runs are started */
    uint32_t method;     /* GWB_EVENT_EXACT or GWB_FIXED_STEP */
    uint32_t lanes;      /* of GWB_FIXED_STEP: 1, 4 or 8, at most gwb_widest_lanes(); 0: these */
    uint32_t reserved;   /* 0 */
    double plant_step_s; /* of GWB_FIXED_STEP: [1e-6, 5e-4], rounded down to a whole part of 0.5 ms; 0: as the design
                            needs */
} gwb_options_t;

/* Designs that this processor computes side by side: 8 with AVX-512 (F, DQ, VL), 4 with AVX2, else 1. */
GWB_API uint32_t gwb_widest_lanes(void);

/* Starts threads on `count` runs; results[i] is that of specs[i]. All arguments except the options, which are copied,
 * must stay unchanged until gwb_finish returns. A run that is not possible is reported in its result and does not stop
 * the others. 1 if the batch was started; else 0, *batch is null, and message (GWB_MESSAGE_SIZE bytes, or null) says
 * why. WebAssembly has no threads: there all runs are done when it returns. */
GWB_API int gwb_start(const gwb_spec_t *specs, size_t count, const gwb_options_t *options, gwb_result_t *results,
                      gwb_batch_t **batch, char *message);

/* Waits until all runs are done, at most timeout_s. 1 if they are, else 0. progress may be null. */
GWB_API int gwb_wait(gwb_batch_t *batch, double timeout_s, gwb_progress_t *progress);

/* Ends running runs after their present step and starts no more; any thread may call it. */
GWB_API void gwb_cancel(gwb_batch_t *batch);

/* Cancels unfinished runs, waits for the threads' end and frees the batch. Then every result is written. Null is
 * allowed. */
GWB_API void gwb_finish(gwb_batch_t *batch);

#ifdef __cplusplus
}
#endif

#endif
