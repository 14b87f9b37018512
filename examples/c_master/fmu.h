/* The functions a C program needs to run an FMI 3.0 Co-Simulation FMU from a folder with its unzipped files. POSIX
 * (dlopen).
 */
#ifndef FMU_H
#define FMU_H

#include <fmi3Functions.h>

#include <stddef.h>

typedef struct {
    const char *name; /* of the instance, for messages */
    void *library;
    char *description; /* the text of modelDescription.xml */
    fmi3Instance instance;
    /* The functions that a co-simulation calls. */
    fmi3InstantiateCoSimulationTYPE *instantiate;
    fmi3FreeInstanceTYPE *free_instance;
    fmi3EnterInitializationModeTYPE *enter_initialisation;
    fmi3ExitInitializationModeTYPE *exit_initialisation;
    fmi3TerminateTYPE *terminate;
    fmi3DoStepTYPE *do_step;
    fmi3GetFloat64TYPE *get_real;
    fmi3SetFloat64TYPE *set_real;
    fmi3GetInt32TYPE *get_integer;
    fmi3SetInt32TYPE *set_integer;
    fmi3GetBooleanTYPE *get_boolean;
    fmi3SetBooleanTYPE *set_boolean;
} Fmu;

/* Each ends the program with a message on an error; a real master would return the error. */
void fmu_load(Fmu *fmu, const char *name, const char *folder);
void fmu_instantiate(Fmu *fmu);
void fmu_initialise(Fmu *fmu);
void fmu_step(Fmu *fmu, double time_s, double step_s);
void fmu_free(Fmu *fmu);
void fmu_unload(Fmu *fmu);
void fmu_check(const Fmu *fmu, fmi3Status status, const char *call);

/* The value reference of a variable: look it up once, before the loop. */
fmi3ValueReference fmu_reference(const Fmu *fmu, const char *variable);
/* The unit of a real variable, "1" if it has none; valid until the next call of any of these. */
const char *fmu_unit(const Fmu *fmu, const char *variable);
/* Sets a parameter or an input of any type from a text such as "testbed.slider.mass=9.08" without its "testbed." */
void fmu_assign(Fmu *fmu, const char *assignment);

#endif
