/* A co-simulation FMU (FMI 2.0) about three functions of a model, included by it:
 *
 *   static void start(double *v);                        start values
 *   static void step(double *v, double time, double h);  from one instant to the next
 *   static void tell(double *v);                         outputs of states, parameters and inputs
 *
 * v holds the model's COUNT variables; a value reference is an index of it. Include this file last.
 */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

typedef struct {
    double v[COUNT];
} Unit;

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *call, fmi2Boolean seen, fmi2Boolean log) {
    (void)name, (void)place, (void)call, (void)seen, (void)log;
    if (type != fmi2CoSimulation || strcmp(guid, GUID) != 0) return NULL;
    Unit *unit = calloc(1, sizeof *unit);
    if (unit) start(unit->v);
    return unit;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2Reset(fmi2Component c) {
    memset(c, 0, sizeof(Unit));
    start(((Unit *)c)->v);
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real x[]) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return fmi2Error;
        ((Unit *)c)->v[r[i]] = x[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real x[]) {
    tell(((Unit *)c)->v);
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return fmi2Error;
        x[i] = ((Unit *)c)->v[r[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean last) {
    (void)last;
    if (!(h > 0.0)) return fmi2Error;
    step(((Unit *)c)->v, time, h);
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e,
                               fmi2Real f) {
    (void)c, (void)a, (void)b, (void)d, (void)e, (void)f;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
fmi2Status fmi2Terminate(fmi2Component c) { return c ? fmi2OK : fmi2Error; }

/* What the standard asks for and these models do not have. */
#define NONE(name, ...) \
    fmi2Status name(__VA_ARGS__) { return fmi2Error; }
NONE(fmi2SetDebugLogging, fmi2Component c, fmi2Boolean on, size_t n, const fmi2String s[])
NONE(fmi2GetInteger, fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer x[])
NONE(fmi2GetBoolean, fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean x[])
NONE(fmi2GetString, fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String x[])
NONE(fmi2SetInteger, fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer x[])
NONE(fmi2SetBoolean, fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean x[])
NONE(fmi2SetString, fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String x[])
NONE(fmi2GetFMUstate, fmi2Component c, fmi2FMUstate *s)
NONE(fmi2SetFMUstate, fmi2Component c, fmi2FMUstate s)
NONE(fmi2FreeFMUstate, fmi2Component c, fmi2FMUstate *s)
NONE(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n)
NONE(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
NONE(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
NONE(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t n,
     const fmi2ValueReference k[], size_t m, const fmi2Real d[], fmi2Real e[])
NONE(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference r[], size_t n,
     const fmi2Integer o[], const fmi2Real x[])
NONE(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference r[], size_t n,
     const fmi2Integer o[], fmi2Real x[])
NONE(fmi2CancelStep, fmi2Component c)
NONE(fmi2GetStatus, fmi2Component c, const fmi2StatusKind k, fmi2Status *s)
NONE(fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind k, fmi2Real *x)
NONE(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind k, fmi2Integer *x)
NONE(fmi2GetBooleanStatus, fmi2Component c, const fmi2StatusKind k, fmi2Boolean *x)
NONE(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind k, fmi2String *x)
