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
 * No function prints, exits, throws or keeps a pointer longer than it says. Units are SI unless a name says otherwise.
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

/* Metrics, append-only; units in the comments and from gwb_metric_info. "Truth" is what the testbed knows. The
 * definitions are those of cosim/giveway/metrics.py where it has the same name. */
enum {
    GWB_CONTACT_SPEED = 0,       /* m/s: of the nose relative to the robot, last step before contact */
    GWB_FALSE_DETECTIONS = 1,    /* 1: without true contact in the 0.25 s before */
    GWB_DETECTION_TIME = 2,      /* ms: contact to decision */
    GWB_FORCE_DIRECTION = 3,     /* deg, base frame */
    GWB_DIRECTION_ERROR = 4,     /* deg */
    GWB_CONTACT_POINT_X = 5,     /* mm, base frame */
    GWB_CONTACT_POINT_Y = 6,     /* mm, base frame */
    GWB_LOCATION_ERROR = 7,      /* mm */
    GWB_FORCE_AT_DETECTION = 8,  /* N; truth: averaged over the estimator's window */
    GWB_IMPULSE = 9,             /* N.s: contact to detection */
    GWB_PEAK_FORCE = 10,         /* N: largest true contact force */
    GWB_BUMPER_COMPRESSION = 11, /* mm: largest; its travel is a parameter */
    GWB_PEAK_TORQUE = 12,        /* N.m: of a loaded wheel in the impact's direction, within 0.35 s of contact */
    GWB_PEAK_TORQUE_ANY = 13,    /* N.m: of any wheel, either sign, from contact on */
    GWB_ESCAPE = 14,             /* m: reference's travel from the last detection to the end; truth: the base's */
    GWB_ENERGY_RESIDUAL = 15,    /* 1: largest error of the energy balance over the energy in play */
    GWB_CONTACT_TIME = 16,       /* s: first cover contact, located by the integrator */
    GWB_DETECTIONS = 17,         /* 1: all of the run */
    GWB_CONTACT_IMPULSE = 18,    /* N.s: of the whole run, magnitude */
    GWB_CONTACT_AT_END = 19,     /* 0 or 1 */
    GWB_LATCHED_AT_END = 20,     /* 0 or 1: the bumper's magnetic latch */
    GWB_ROPE_TAUT_AT_END = 21,   /* 0 or 1 */
    GWB_EVENTS = 22,             /* 1: located by the integrator */
    /* A contact ends when no force came for 0.5 s (cosim/giveway/body_regions.py). */
    GWB_TRANSIENT_FORCE = 23, /* N: largest within the first 0.5 s of a contact */
    GWB_LASTING_FORCE =
        24, /* N: largest later than 0.5 s into a contact; NaN if the run ended within 0.5 s of the first */
    GWB_LONGEST_CONTACT = 25,  /* s */
    GWB_TRANSIENT_SHARE = 26,  /* 1: of the body region's transient limit; infinite where none is allowed and one was */
    GWB_LASTING_SHARE = 27,    /* 1: of the body region's lasting limit */
    GWB_BOTTOMING_MARGIN = 28, /* mm: bumper's travel less its largest compression; negative in the stop */
    GWB_CONTACTS = 29,         /* 1: contacts; touches less than 0.1 s apart are one: a bumper's plate bounces */
    GWB_REBOUND_SPEED = 30,    /* m/s: of the nose relative to the robot when the first contact has ended */
    GWB_RELATCHES = 31,        /* 1: times that the bumper's magnet caught its plate again */
    GWB_RELATCH_TIME = 32,     /* ms: contact to the first of them */
    GWB_TIP_MARGIN = 33,       /* 1: least of the run; 0: a wheel lifts (on a plane), or it goes over (base.tipping) */
    /* What happened otherwise than asked (cosim/giveway/run_warnings.py). */
    GWB_FIRST_PEAK_FORCE = 34, /* N: largest true contact force of the first contact; GWB_PEAK_FORCE is the run's */
    GWB_FIRST_CONTACT_X = 35,  /* mm, base frame: true point in the first row of the first contact */
    GWB_FIRST_CONTACT_Y = 36,  /* mm */
    GWB_ROBOT_SPEED = 37,      /* m/s: of the base in the last row before contact */
    GWB_PLAN_DISTANCE = 38, /* mm: largest of the reference from the plan while it tracks, up to the first reaction */
    GWB_PLAN_ANGLE = 39,    /* deg: likewise */
    GWB_SENSED_TORQUE_SHARE = 40, /* 1: largest sensed torque over what counts as saturated */
    GWB_MOTOR_TORQUE_SHARE = 41,  /* 1: largest motor torque over its limit */
    GWB_FAULT_TIME = 42,          /* s: in the controller's mode 6, sensor fault */
    GWB_METRIC_COUNT = 43
};

typedef struct gwb_variable {
    uint32_t model;
    uint32_t reference; /* the FMUs' value reference */
    uint32_t type;
    uint32_t causality;
    double minimum, maximum; /* inclusive; infinite if there is none */
    const char *name;        /* lives as long as the library */
} gwb_variable_t;

typedef struct gwb_metric_info {
    const char *name;
    const char *unit;
    uint32_t has_truth;
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
    /* NaN for what did not happen; all NaN unless status is GWB_OK. */
    double metric[GWB_METRIC_COUNT];
    double truth[GWB_METRIC_COUNT]; /* NaN where there is none */
    char message[GWB_MESSAGE_SIZE]; /* empty if status is GWB_OK; one line, ends in a zero */
} gwb_result_t;

/* Version of giveway, e.g. "0.1.0". */
GWB_API const char *gwb_version(void);

/* Hash of the model's variable table, the FMUs' instantiation token; null for an unknown model. */
GWB_API const char *gwb_token(uint32_t model);

/* Number of variables of a model; 0 for an unknown model. */
GWB_API size_t gwb_variable_count(uint32_t model);

/* The variable at `index` in the order of references, or with this name. 1 if there is one; else 0, and *variable is
 * as before. */
GWB_API int gwb_variable_at(uint32_t model, size_t index, gwb_variable_t *variable);
GWB_API int gwb_find_variable(uint32_t model, const char *name, gwb_variable_t *variable);

/* GWB_METRIC_COUNT of the library, and name and unit of a metric (1; 0 if there is none, and *info is as before). */
GWB_API uint32_t gwb_metric_count(void);
GWB_API int gwb_metric_info(uint32_t metric, gwb_metric_info_t *info);

/* One run on the calling thread. Returns result->status; GWB_WRONG_SPEC for null pointers. */
GWB_API uint32_t gwb_run(const gwb_spec_t *spec, gwb_result_t *result);

/* Many runs on threads of their own. There are no callbacks: whoever waits asks for progress as often as it likes,
 * on its own thread.
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
 * bits in every lane, with any number of lanes, on any thread and in any batch. Its step follows from its own
 * parameters alone; the integrator's settings (solver.*) do not act. What it cannot do is run event-exact, and the
 * result's method says so: a base that tips, a communication step that is not a whole number of servo ticks (0.5 ms),
 * and designs so stiff that their step would be below 0.5 ms / 32. */
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

/* Starts threads on `count` runs; results[i] is that of specs[i]. All that is passed must stay as it is until
 * gwb_finish returns, but the options, which are copied. A run that cannot be done says so in its result and does not
 * stop the others. 1 if the batch was started; else 0, *batch is null, and message (GWB_MESSAGE_SIZE bytes, or null)
 * says why. */
GWB_API int gwb_start(const gwb_spec_t *specs, size_t count, const gwb_options_t *options, gwb_result_t *results,
                      gwb_batch_t **batch, char *message);

/* Waits until all runs are done, at most timeout_s. 1 if they are, else 0. progress may be null. */
GWB_API int gwb_wait(gwb_batch_t *batch, double timeout_s, gwb_progress_t *progress);

/* Ends running runs after their present step and starts no more; any thread may call it. */
GWB_API void gwb_cancel(gwb_batch_t *batch);

/* Cancels what is not done, waits for the threads' end and frees the batch. Every result is written then. Null is
 * allowed. */
GWB_API void gwb_finish(gwb_batch_t *batch);

#ifdef __cplusplus
}
#endif

#endif
