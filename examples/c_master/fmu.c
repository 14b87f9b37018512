#define _POSIX_C_SOURCE 200809L
#include "fmu.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__APPLE__) && defined(__aarch64__)
#define PLATFORM "aarch64-darwin"
#define EXTENSION ".dylib"
#elif defined(__APPLE__)
#define PLATFORM "x86_64-darwin"
#define EXTENSION ".dylib"
#elif defined(__aarch64__)
#define PLATFORM "aarch64-linux"
#define EXTENSION ".so"
#else
#define PLATFORM "x86_64-linux"
#define EXTENSION ".so"
#endif

static void die(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)fputs("c_master: ", stderr);
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
    va_end(arguments);
    exit(1);
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    const Fmu *fmu = environment;
    (void)status;
    (void)category;
    (void)fprintf(stderr, "%s: %s\n", fmu->name, message);
}

void fmu_check(const Fmu *fmu, fmi3Status status, const char *call)
{
    if (status > fmi3Warning) {
        die("%s: %s failed with status %d", fmu->name, call, (int)status);
    }
}

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    long size;
    char *text;
    if (file == NULL) {
        die("%s cannot be read; unzip the FMU into that folder first", path);
    }
    (void)fseek(file, 0, SEEK_END);
    size = ftell(file);
    rewind(file);
    text = malloc((size_t)size + 1);
    if (text == NULL || fread(text, 1, (size_t)size, file) != (size_t)size) {
        die("%s cannot be read", path);
    }
    text[size] = '\0';
    (void)fclose(file);
    return text;
}

/* The value of an attribute of the element at `element` (its "<"), in a buffer that the next call reuses. Enough for
   the descriptions of giveway, which write attributes with double quotes and without entities in names; use an XML
   parser for others. */
static const char *attribute(const char *element, const char *name)
{
    static char value[1024];
    char pattern[64];
    const char *end = strchr(element, '>');
    const char *start;
    size_t length;
    (void)snprintf(pattern, sizeof pattern, " %s=\"", name);
    start = strstr(element, pattern);
    if (start == NULL || end == NULL || start > end) {
        return NULL;
    }
    start += strlen(pattern);
    length = strcspn(start, "\"");
    if (length >= sizeof value) {
        return NULL;
    }
    memcpy(value, start, length);
    value[length] = '\0';
    return value;
}

static const char *element_of(const Fmu *fmu, const char *variable)
{
    char pattern[256];
    const char *found;
    (void)snprintf(pattern, sizeof pattern, " name=\"%s\"", variable);
    found = strstr(fmu->description, pattern);
    if (found == NULL) {
        die("%s has no variable %s", fmu->name, variable);
    }
    while (*found != '<') {
        --found;
    }
    return found;
}

fmi3ValueReference fmu_reference(const Fmu *fmu, const char *variable)
{
    const char *reference = attribute(element_of(fmu, variable), "valueReference");
    if (reference == NULL) {
        die("%s: %s has no value reference", fmu->name, variable);
    }
    return (fmi3ValueReference)strtoul(reference, NULL, 10);
}

const char *fmu_unit(const Fmu *fmu, const char *variable)
{
    const char *element = element_of(fmu, variable);
    const char *unit = attribute(element, "unit");
    const char *type = unit == NULL ? attribute(element, "declaredType") : NULL;
    if (type != NULL) { /* which may state it for all its variables */
        char pattern[1024 + 32];
        (void)snprintf(pattern, sizeof pattern, "<Float64Type name=\"%s\"", type);
        element = strstr(fmu->description, pattern);
        unit = element == NULL ? NULL : attribute(element, "unit");
    }
    return unit == NULL ? "1" : unit;
}

void fmu_assign(Fmu *fmu, const char *assignment)
{
    const char *equals = strchr(assignment, '=');
    char variable[256];
    const char *element;
    fmi3ValueReference reference;
    size_t length = equals == NULL ? sizeof variable : (size_t)(equals - assignment);
    if (length >= sizeof variable) {
        die("%s: %s is not of the form NAME=VALUE", fmu->name, assignment);
    }
    memcpy(variable, assignment, length);
    variable[length] = '\0';
    reference = fmu_reference(fmu, variable);
    element = element_of(fmu, variable);
    if (strncmp(element, "<Float64", 8) == 0) {
        const fmi3Float64 value = strtod(equals + 1, NULL);
        fmu_check(fmu, fmu->set_real(fmu->instance, &reference, 1, &value, 1), assignment);
    } else if (strncmp(element, "<Int32", 6) == 0) {
        const fmi3Int32 value = (fmi3Int32)strtol(equals + 1, NULL, 10);
        fmu_check(fmu, fmu->set_integer(fmu->instance, &reference, 1, &value, 1), assignment);
    } else {
        const fmi3Boolean value = strcmp(equals + 1, "true") == 0 || strcmp(equals + 1, "1") == 0;
        fmu_check(fmu, fmu->set_boolean(fmu->instance, &reference, 1, &value, 1), assignment);
    }
}

/* POSIX hands functions out as data pointers; copying the bits is the way that C allows. */
static void bind_function(const Fmu *fmu, void *target, const char *name)
{
    void *symbol = dlsym(fmu->library, name);
    if (symbol == NULL) {
        die("%s: its binary has no %s", fmu->name, name);
    }
    memcpy(target, &symbol, sizeof symbol);
}

void fmu_load(Fmu *fmu, const char *name, const char *folder)
{
    char path[4096];
    const char *identifier;
    memset(fmu, 0, sizeof *fmu);
    fmu->name = name;
    (void)snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    fmu->description = read_text(path);
    if (strstr(fmu->description, "fmiVersion=\"3.0\"") == NULL) {
        die("%s is not an FMU of FMI 3.0", folder);
    }
    identifier = strstr(fmu->description, "<CoSimulation");
    identifier = identifier == NULL ? NULL : attribute(identifier, "modelIdentifier");
    if (identifier == NULL) {
        die("%s has no Co-Simulation interface", folder);
    }
    (void)snprintf(path, sizeof path, "%s/binaries/" PLATFORM "/%s" EXTENSION, folder, identifier);
    fmu->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (fmu->library == NULL) {
        die("%s", dlerror());
    }
    bind_function(fmu, &fmu->instantiate, "fmi3InstantiateCoSimulation");
    bind_function(fmu, &fmu->free_instance, "fmi3FreeInstance");
    bind_function(fmu, &fmu->enter_initialisation, "fmi3EnterInitializationMode");
    bind_function(fmu, &fmu->exit_initialisation, "fmi3ExitInitializationMode");
    bind_function(fmu, &fmu->terminate, "fmi3Terminate");
    bind_function(fmu, &fmu->do_step, "fmi3DoStep");
    bind_function(fmu, &fmu->get_real, "fmi3GetFloat64");
    bind_function(fmu, &fmu->set_real, "fmi3SetFloat64");
    bind_function(fmu, &fmu->get_integer, "fmi3GetInt32");
    bind_function(fmu, &fmu->set_integer, "fmi3SetInt32");
    bind_function(fmu, &fmu->get_boolean, "fmi3GetBoolean");
    bind_function(fmu, &fmu->set_boolean, "fmi3SetBoolean");
}

void fmu_instantiate(Fmu *fmu)
{
    const char *token = attribute(strstr(fmu->description, "<fmiModelDescription"), "instantiationToken");
    fmu->instance = fmu->instantiate(fmu->name, token, NULL, fmi3False, fmi3True, fmi3False, fmi3False, NULL, 0, fmu,
                                     log_message, NULL);
    if (fmu->instance == NULL) {
        die("%s cannot be instantiated", fmu->name);
    }
}

void fmu_initialise(Fmu *fmu)
{
    fmu_check(fmu, fmu->enter_initialisation(fmu->instance, fmi3False, 0.0, 0.0, fmi3False, 0.0), "initialisation");
    fmu_check(fmu, fmu->exit_initialisation(fmu->instance), "initialisation");
}

void fmu_step(Fmu *fmu, double time_s, double step_s)
{
    fmi3Boolean event, terminate, early;
    fmi3Float64 reached;
    fmu_check(fmu, fmu->do_step(fmu->instance, time_s, step_s, fmi3True, &event, &terminate, &early, &reached),
              "fmi3DoStep");
}

void fmu_free(Fmu *fmu)
{
    fmu_check(fmu, fmu->terminate(fmu->instance), "fmi3Terminate");
    fmu->free_instance(fmu->instance);
    fmu->instance = NULL;
}

void fmu_unload(Fmu *fmu)
{
    (void)dlclose(fmu->library);
    free(fmu->description);
}
