/* FMI 2.0 for co-simulation over engine.c. Written by inerter after the specification.

   References: 0 to NU - 1 are the inputs, NU to NU + NY - 1 the outputs. */

#include <stddef.h>

#include "engine.c"

#if defined _WIN32
#define FMI2 __declspec(dllexport)
#else
#define FMI2 __attribute__((visibility("default")))
#endif

typedef void *Component, *FmuState;
typedef unsigned int Reference;
typedef double Real;
typedef int Integer, Boolean;
typedef const char *String;
typedef char Byte;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Type;
typedef enum { DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED } StatusKind;
typedef struct {
    void (*logger)(void *, String, Status, String, String, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;

FMI2 String fmi2GetTypesPlatform(void) { return "default"; }
FMI2 String fmi2GetVersion(void) { return "2.0"; }
FMI2 Status fmi2SetDebugLogging(Component c, Boolean on, size_t n, const String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return OK;
}

FMI2 Component fmi2Instantiate(String name, Type type, String guid, String place, const Callbacks *callbacks,
                               Boolean visible, Boolean logging)
{
    (void)visible, (void)logging, (void)place;
    if (type != CO_SIMULATION || guid == NULL || strcmp(guid, TOKEN) != 0) {
        if (callbacks != NULL && callbacks->logger != NULL)
            callbacks->logger(callbacks->environment, name, ERROR, "logStatusError",
                              "not for co-simulation, or the description is of another model");
        return NULL;
    }
    return calloc(1, sizeof(Model));
}

FMI2 void fmi2FreeInstance(Component c) { free(c); }
FMI2 Status fmi2SetupExperiment(Component c, Boolean defined, Real tolerance, Real start, Boolean stops, Real stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->now.time = start;
    return OK;
}
FMI2 Status fmi2EnterInitializationMode(Component c) { (void)c; return OK; }
FMI2 Status fmi2ExitInitializationMode(Component c) { (void)c; return OK; }
FMI2 Status fmi2Terminate(Component c) { (void)c; return OK; }
FMI2 Status fmi2Reset(Component c) { rest(c); return OK; }

FMI2 Status fmi2GetReal(Component c, const Reference r[], size_t n, Real value[])
{
    const Model *model = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] >= NU + NY) return ERROR;
        value[i] = r[i] < NU ? model->now.u[0][r[i]] : output(model, (int)r[i] - NU);
    }
    return OK;
}

FMI2 Status fmi2SetReal(Component c, const Reference r[], size_t n, const Real value[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] >= NU) return ERROR;
        ((Model *)c)->now.u[0][r[i]] = value[i];
    }
    return OK;
}

#define NONE(name, type)                                                                  \
    FMI2 Status fmi2Get##name(Component c, const Reference r[], size_t n, type value[])   \
    {                                                                                     \
        (void)c, (void)r, (void)value;                                                    \
        return n ? ERROR : OK;                                                            \
    }                                                                                     \
    FMI2 Status fmi2Set##name(Component c, const Reference r[], size_t n, const type value[]) \
    {                                                                                     \
        (void)c, (void)r, (void)value;                                                    \
        return n ? ERROR : OK;                                                            \
    }
NONE(Integer, Integer)
NONE(Boolean, Boolean)
NONE(String, String)

FMI2 Status fmi2GetFMUstate(Component c, FmuState *state)
{
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return ERROR;
    memcpy(*state, &((Model *)c)->now, sizeof(State));
    return OK;
}
FMI2 Status fmi2SetFMUstate(Component c, FmuState state)
{
    if (state == NULL) return ERROR;
    memcpy(&((Model *)c)->now, state, sizeof(State));
    return OK;
}
FMI2 Status fmi2FreeFMUstate(Component c, FmuState *state)
{
    (void)c;
    if (state != NULL) free(*state), *state = NULL;
    return OK;
}
FMI2 Status fmi2SerializedFMUstateSize(Component c, FmuState state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(State);
    return OK;
}
FMI2 Status fmi2SerializeFMUstate(Component c, FmuState state, Byte bytes[], size_t size)
{
    (void)c;
    if (state == NULL || size < sizeof(State)) return ERROR;
    memcpy(bytes, state, sizeof(State));
    return OK;
}
FMI2 Status fmi2DeSerializeFMUstate(Component c, const Byte bytes[], size_t size, FmuState *state)
{
    (void)c;
    if (size != sizeof(State)) return ERROR;
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, sizeof(State));
    return OK;
}

FMI2 Status fmi2GetDirectionalDerivative(Component c, const Reference unknown[], size_t n, const Reference known[],
                                         size_t m, const Real seed[], Real value[])
{
    size_t i, j;
    (void)c;
    for (i = 0; i < n; i++) {
        value[i] = 0.0;
        for (j = 0; j < m; j++) {
            if (unknown[i] < NU || unknown[i] >= NU + NY || known[j] >= NU) return ERROR;
            value[i] += D[unknown[i] - NU][known[j]] * seed[j];
        }
    }
    return OK;
}

FMI2 Status fmi2SetRealInputDerivatives(Component c, const Reference r[], size_t n, const Integer order[],
                                        const Real value[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] >= NU || order[i] < 1) return ERROR;
        if (order[i] < ORDERS) ((Model *)c)->now.u[order[i]][r[i]] = value[i];
        else if (value[i] != 0.0) return DISCARD;
    }
    return OK;
}
FMI2 Status fmi2GetRealOutputDerivatives(Component c, const Reference r[], size_t n, const Integer order[], Real value[])
{
    (void)c, (void)r, (void)order, (void)value;
    return n ? ERROR : OK;
}

FMI2 Status fmi2DoStep(Component c, Real time, Real step, Boolean final)
{
    Model *model = c;
    int k;
    (void)final;
    if (!(step >= 0.0)) return ERROR;
    model->now.time = time;
    if (step > 0.0 && !advance(model, step)) return ERROR;
    for (k = 1; k < ORDERS; k++) memset(model->now.u[k], 0, sizeof model->now.u[k]); /* they are of one step */
    return OK;
}
FMI2 Status fmi2CancelStep(Component c) { (void)c; return ERROR; }
FMI2 Status fmi2GetStatus(Component c, StatusKind kind, Status *value) { (void)c, (void)kind; *value = OK; return OK; }
FMI2 Status fmi2GetRealStatus(Component c, StatusKind kind, Real *value)
{
    if (kind != LAST_SUCCESSFUL_TIME) return DISCARD;
    *value = ((Model *)c)->now.time;
    return OK;
}
FMI2 Status fmi2GetIntegerStatus(Component c, StatusKind kind, Integer *value)
{
    (void)c, (void)kind, (void)value;
    return DISCARD;
}
FMI2 Status fmi2GetBooleanStatus(Component c, StatusKind kind, Boolean *value)
{
    (void)c;
    if (kind != TERMINATED) return DISCARD;
    *value = 0;
    return OK;
}
FMI2 Status fmi2GetStringStatus(Component c, StatusKind kind, String *value)
{
    (void)c, (void)kind, (void)value;
    return DISCARD;
}
