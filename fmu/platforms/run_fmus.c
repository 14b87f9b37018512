/* Steps FMI 3.0 Co-Simulation FMUs through a run that a file describes, and prints every bit of their outputs: the same
 * program on every platform. Used by the checks beside it and by tests/fmu/controller.
 *
 *     run_fmus PLAN > OUTPUTS
 *
 * Twice in one process the libraries are loaded, run, freed and unloaded, so the outputs come twice. Then the process
 * ends as any does: exit code 0 says that nothing of the libraries is needed once they are gone.
 *
 * PLAN, one item a line, I, J: instances in the order of their lines; K: r, i or b; VALUE: a real's bits in 16
 * hexadecimal digits, else a number: library LIBRARY            is loaded and unloaded with the others, and nothing
 * else fmu LIBRARY TOKEN          LIBRARY is ignored by a program that holds its one FMU inside (-DGIVEWAY_LINKED) set
 * I K REFERENCE VALUE    before the initialisation connect I REFERENCE J REFERENCE K    from an output of I to an input
 * of J, just before each step of J drive I K REFERENCE        an input with one VALUE for each step, in the lines after
 * `run`, in this order read I K REFERENCE         an output, printed after every step, in this order run STEPS SIZE
 * SIZE in the bits of a real, s
 */
#ifdef GIVEWAY_LINKED
#define FMI3_FUNCTION_PREFIX giveway_controller_
#endif
#include <fmi3Functions.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#elif !defined(GIVEWAY_LINKED)
#include <dlfcn.h>
#endif

enum { max_instances = 4, max_items = 1024, max_text = 512 };

typedef struct {
    fmi3InstantiateCoSimulationTYPE *instantiate;
    fmi3EnterInitializationModeTYPE *enter;
    fmi3ExitInitializationModeTYPE *exit;
    fmi3DoStepTYPE *step;
    fmi3GetFloat64TYPE *get_real;
    fmi3GetInt32TYPE *get_integer;
    fmi3GetBooleanTYPE *get_boolean;
    fmi3SetFloat64TYPE *set_real;
    fmi3SetInt32TYPE *set_integer;
    fmi3SetBooleanTYPE *set_boolean;
    fmi3TerminateTYPE *terminate;
    fmi3FreeInstanceTYPE *free_instance;
    fmi3Instance instance;
} fmu_t;

typedef struct {
    char path[512];
    void *handle;
} library_t;

/* An input or output of an instance. */
typedef struct {
    unsigned instance;
    char kind;
    fmi3ValueReference reference;
} port_t;

typedef union {
    double real;
    int32_t integer;
    bool boolean;
} value_t;

static library_t libraries[max_instances];
static unsigned library_count;
static fmu_t fmus[max_instances];
static unsigned fmu_count;
static port_t from[max_items], to[max_items], driven[max_items], shown[max_items];
static unsigned connection_count, driven_count, shown_count;

static void fail(const char *what, const char *detail) {
    fprintf(stderr, "error: %s: %s\n", what, detail);
    exit(1);
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message) {
    (void)environment;
    (void)status;
    (void)category;
    fprintf(stderr, "FMU: %s\n", message);
}

static void check(fmi3Status status, const char *what) {
    if (status != fmi3OK) {
        fail(what, "the FMU refused (its message is above)");
    }
}

#ifdef GIVEWAY_LINKED
#define LOAD(library, function) function
static void *open_library(const char *path) {
    (void)path;
    return NULL;
}
static void close_library(const library_t *library) { (void)library; }
#else
static void *symbol(void *library, const char *name) {
#ifdef _WIN32
    void *address = (void *)(uintptr_t)GetProcAddress((HMODULE)library, name);
#else
    void *address = dlsym(library, name);
#endif
    if (address == NULL) {
        fail(name, "the library does not have it");
    }
    return address;
}
#define LOAD(library, function) ((function##TYPE *)(uintptr_t)symbol(library, #function))

static void *open_library(const char *path) {
#ifdef _WIN32
    void *library = (void *)LoadLibraryA(path);
    const char *why = "LoadLibrary failed";
#else
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const char *why = library == NULL ? dlerror() : "";
#endif
    if (library == NULL) {
        fail(path, why);
    }
    return library;
}

static void close_library(const library_t *library) {
#ifdef _WIN32
    const bool closed = FreeLibrary((HMODULE)library->handle) && GetModuleHandleA(library->path) == NULL;
#else
    const bool closed = dlclose(library->handle) == 0 && dlopen(library->path, RTLD_NOW | RTLD_NOLOAD) == NULL;
#endif
    if (!closed) {
        fail(library->path, "it is still there after it was unloaded");
    }
}
#endif

static void *load_library(const char *path) {
    if (library_count == max_instances) {
        fail(path, "too many libraries");
    }
    library_t *library = &libraries[library_count++];
    snprintf(library->path, sizeof library->path, "%s", path);
    library->handle = open_library(path);
    return library->handle;
}

static void unload_libraries(void) {
    while (library_count > 0) {
        close_library(&libraries[--library_count]);
    }
    fmu_count = connection_count = driven_count = shown_count = 0;
}

static void load(const char *path, const char *token) {
    if (fmu_count == max_instances) {
        fail(path, "too many FMUs");
    }
    void *library = load_library(path);
    fmu_t *fmu = &fmus[fmu_count++];
    (void)library;
    fmu->instantiate = LOAD(library, fmi3InstantiateCoSimulation);
    fmu->enter = LOAD(library, fmi3EnterInitializationMode);
    fmu->exit = LOAD(library, fmi3ExitInitializationMode);
    fmu->step = LOAD(library, fmi3DoStep);
    fmu->get_real = LOAD(library, fmi3GetFloat64);
    fmu->get_integer = LOAD(library, fmi3GetInt32);
    fmu->get_boolean = LOAD(library, fmi3GetBoolean);
    fmu->set_real = LOAD(library, fmi3SetFloat64);
    fmu->set_integer = LOAD(library, fmi3SetInt32);
    fmu->set_boolean = LOAD(library, fmi3SetBoolean);
    fmu->terminate = LOAD(library, fmi3Terminate);
    fmu->free_instance = LOAD(library, fmi3FreeInstance);
    fmu->instance = fmu->instantiate("run", token, NULL, false, false, false, false, NULL, 0, NULL, log_message, NULL);
    if (fmu->instance == NULL) {
        fail(path, "no instance");
    }
}

static value_t get(port_t port) {
    const fmu_t *fmu = &fmus[port.instance];
    value_t value;
    memset(&value, 0, sizeof value);
    switch (port.kind) {
    case 'r':
        check(fmu->get_real(fmu->instance, &port.reference, 1, &value.real, 1), "get");
        break;
    case 'i':
        check(fmu->get_integer(fmu->instance, &port.reference, 1, &value.integer, 1), "get");
        break;
    default:
        check(fmu->get_boolean(fmu->instance, &port.reference, 1, &value.boolean, 1), "get");
        break;
    }
    return value;
}

static void set(port_t port, value_t value) {
    const fmu_t *fmu = &fmus[port.instance];
    switch (port.kind) {
    case 'r':
        check(fmu->set_real(fmu->instance, &port.reference, 1, &value.real, 1), "set");
        break;
    case 'i':
        check(fmu->set_integer(fmu->instance, &port.reference, 1, &value.integer, 1), "set");
        break;
    default:
        check(fmu->set_boolean(fmu->instance, &port.reference, 1, &value.boolean, 1), "set");
        break;
    }
}

static double real_of(const char *text) {
    const uint64_t bits = strtoull(text, NULL, 16);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static value_t value_of(char kind, const char *text) {
    value_t value;
    memset(&value, 0, sizeof value);
    if (kind == 'r') {
        value.real = real_of(text);
    } else if (kind == 'i') {
        value.integer = (int32_t)strtol(text, NULL, 10);
    } else {
        value.boolean = text[0] == '1';
    }
    return value;
}

static void show(port_t port) {
    const value_t value = get(port);
    uint64_t bits;
    memcpy(&bits, &value.real, sizeof bits);
    if (port.kind == 'r') {
        printf("%016" PRIx64 " ", bits);
    } else {
        printf("%" PRId32 " ", port.kind == 'i' ? value.integer : (int32_t)value.boolean);
    }
}

static port_t port_of(unsigned instance, char kind, unsigned reference) {
    const port_t port = {instance, kind, reference};
    if (instance >= fmu_count || (kind != 'r' && kind != 'i' && kind != 'b')) {
        fail("plan", "an instance or a kind that there is not");
    }
    return port;
}

static void step(unsigned instance, double time, double size) {
    const fmu_t *fmu = &fmus[instance];
    bool event, terminate, early;
    double reached;
    for (unsigned i = 0; i < connection_count; ++i) {
        if (to[i].instance == instance) {
            set(to[i], get(from[i]));
        }
    }
    check(fmu->step(fmu->instance, time, size, true, &event, &terminate, &early, &reached), "fmi3DoStep");
}

static void run(FILE *plan, unsigned steps, double size) {
    for (unsigned i = 0; i < fmu_count; ++i) {
        check(fmus[i].enter(fmus[i].instance, false, 0.0, 0.0, false, 0.0), "fmi3EnterInitializationMode");
        check(fmus[i].exit(fmus[i].instance), "fmi3ExitInitializationMode");
    }
    for (unsigned k = 0; k < steps; ++k) {
        for (unsigned i = 0; i < driven_count; ++i) {
            char text[max_text];
            if (fscanf(plan, "%511s", text) != 1) {
                fail("plan", "too few values");
            }
            set(driven[i], value_of(driven[i].kind, text));
        }
        for (unsigned i = 0; i < fmu_count; ++i) {
            step(i, k * size, size);
        }
        for (unsigned i = 0; i < shown_count; ++i) {
            show(shown[i]);
        }
        printf("\n");
    }
    for (unsigned i = 0; i < fmu_count; ++i) {
        check(fmus[i].terminate(fmus[i].instance), "fmi3Terminate");
        fmus[i].free_instance(fmus[i].instance);
    }
}

/* Runs the plan once, from its first line to its last. */
static void run_plan(FILE *plan) {
    char word[max_text], text[max_text];
    unsigned i, j, a, b;
    char kind;
    while (fscanf(plan, "%511s", word) == 1) {
        if (driven_count == max_items || shown_count == max_items || connection_count == max_items) {
            fail("plan", "too many lines");
        }
        if (strcmp(word, "library") == 0 && fscanf(plan, "%511s", text) == 1) {
            (void)load_library(text);
        } else if (strcmp(word, "fmu") == 0 && fscanf(plan, "%511s %511s", word, text) == 2) {
            load(word, text);
        } else if (strcmp(word, "set") == 0 && fscanf(plan, "%u %c %u %511s", &i, &kind, &a, text) == 4) {
            set(port_of(i, kind, a), value_of(kind, text));
        } else if (strcmp(word, "connect") == 0 && fscanf(plan, "%u %u %u %u %c", &i, &a, &j, &b, &kind) == 5) {
            from[connection_count] = port_of(i, kind, a);
            to[connection_count++] = port_of(j, kind, b);
        } else if (strcmp(word, "drive") == 0 && fscanf(plan, "%u %c %u", &i, &kind, &a) == 3) {
            driven[driven_count++] = port_of(i, kind, a);
        } else if (strcmp(word, "read") == 0 && fscanf(plan, "%u %c %u", &i, &kind, &a) == 3) {
            shown[shown_count++] = port_of(i, kind, a);
        } else if (strcmp(word, "run") == 0 && fscanf(plan, "%u %511s", &a, text) == 2) {
            run(plan, a, real_of(text));
            return;
        } else {
            fail("plan", word);
        }
    }
    fail("plan", "it does not end in run");
}

int main(int count, char **arguments) {
    FILE *plan = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (plan == NULL) {
        fail("usage", "run_fmus PLAN, and PLAN can be read");
    }
    for (int pass = 0; pass < 2; ++pass) {
        rewind(plan);
        run_plan(plan);
        unload_libraries();
    }
    return 0;
}
