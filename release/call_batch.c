/* call_batch LIBRARY: loads a batch library, computes a run and a batch on two threads, and prints all numbers as bits.
 * The same text comes from every platform's library: see abroad.py. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "giveway_batch.h"

#ifdef _WIN32
#include <windows.h>
static void *load(const char *path) { return (void *)LoadLibraryA(path); }
static void *find(void *library, const char *name) { return (void *)GetProcAddress((HMODULE)library, name); }
#else
#include <dlfcn.h>
static void *load(const char *path) { return dlopen(path, RTLD_NOW); }
static void *find(void *library, const char *name) { return dlsym(library, name); }
#endif

enum { COUNT = 5, STEPS = 300 };

static void *function(void *library, const char *name) {
    void *found = find(library, name);
    if (found == NULL) {
        (void)fprintf(stderr, "no function %s\n", name);
        exit(1);
    }
    return found;
}

static void print_result(const char *name, const gwb_result_t *result) {
    (void)printf("%s %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", name, result->status, result->method, result->rows);
    for (int i = 0; i < GWB_METRIC_COUNT; ++i) {
        uint64_t bits = 0;
        (void)memcpy(&bits, &result->metric[i], sizeof bits);
        (void)printf("%d %016" PRIx64 "\n", i, result->metric[i] != result->metric[i] ? 0 : bits);
    }
}

int main(int count, char **arguments) {
    void *library = count == 2 ? load(arguments[1]) : NULL;
    if (library == NULL) {
        (void)fprintf(stderr, "the library cannot be loaded\n");
        return 1;
    }
    const char *(*version)(void) = (const char *(*)(void))function(library, "gwb_version");
    uint32_t (*run)(const gwb_spec_t *, gwb_result_t *) =
        (uint32_t(*)(const gwb_spec_t *, gwb_result_t *))function(library, "gwb_run");
    int (*start)(const gwb_spec_t *, size_t, const gwb_options_t *, gwb_result_t *, gwb_batch_t **, char *) =
        (int (*)(const gwb_spec_t *, size_t, const gwb_options_t *, gwb_result_t *, gwb_batch_t **, char *))function(
            library, "gwb_start");
    int (*wait)(gwb_batch_t *, double, gwb_progress_t *) =
        (int (*)(gwb_batch_t *, double, gwb_progress_t *))function(library, "gwb_wait");
    void (*finish)(gwb_batch_t *) = (void (*)(gwb_batch_t *))function(library, "gwb_finish");

    static gwb_spec_t specs[COUNT];
    static gwb_result_t results[COUNT];
    for (uint32_t i = 0; i < COUNT; ++i) {
        specs[i].step_s = 0.001;
        specs[i].step_count = STEPS + i;
    }
    (void)printf("%s\n", version());
    (void)run(specs, results);
    print_result("run", results);
    const gwb_options_t options = {.threads = 2, .method = GWB_FIXED_STEP};
    gwb_batch_t *batch = NULL;
    char message[GWB_MESSAGE_SIZE];
    if (!start(specs, COUNT, &options, results, &batch, message)) {
        (void)fprintf(stderr, "%s\n", message);
        return 1;
    }
    while (!wait(batch, 0.1, NULL)) {
    }
    finish(batch);
    for (int i = 0; i < COUNT; ++i) {
        print_result("of the batch", &results[i]);
    }
    return 0;
}
