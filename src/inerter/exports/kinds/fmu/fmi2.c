/* FMI 2.0 for co-simulation over instance.c. Written by inerter after the specification. */

#include <stddef.h>

#define FIRST 0
#define INPUT_ORDERS 1
#include "instance.c"

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
typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Type;
typedef enum { DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED } StatusKind;
typedef struct {
    void (*logger)(void *, String, Status, String, String, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;
typedef struct {
    Model model;
    Callbacks callbacks;
    char name[128];
} Instance;

static void tell(Model *model, Status status, const char *text)
{
    const Instance *const one = (const Instance *)model;
    const String category = status == WARNING ? "logStatusWarning" : "logStatusError";
    if (one->callbacks.logger != NULL) one->callbacks.logger(one->callbacks.environment, one->name, status, category, text);
}

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
    Instance *one;
    (void)visible, (void)logging, (void)place;
    if (type != CO_SIMULATION || guid == NULL || strcmp(guid, TOKEN) != 0) {
        if (callbacks != NULL && callbacks->logger != NULL)
            callbacks->logger(callbacks->environment, name, ERROR, "logStatusError",
                              "not for co-simulation, or the description is of another model");
        return NULL;
    }
    one = calloc(1, sizeof(Instance));
    if (one == NULL) return NULL;
    if (callbacks != NULL) one->callbacks = *callbacks;
    if (name != NULL) strncpy(one->name, name, sizeof one->name - 1);
    rest(&one->model);
    return one;
}

FMI2 void fmi2FreeInstance(Component c) { release(c); }
FMI2 Status fmi2SetupExperiment(Component c, Boolean defined, Real tolerance, Real start, Boolean stops, Real stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->now.time = start;
    return OK;
}
FMI2 Status fmi2EnterInitializationMode(Component c) { (void)c; return OK; }
FMI2 Status fmi2ExitInitializationMode(Component c)
{
    ((Model *)c)->is_running = 1;
    return answer(c, assemble(c));
}
FMI2 Status fmi2Terminate(Component c) { (void)c; return OK; }
FMI2 Status fmi2Reset(Component c) { rest(c); return OK; }

FMI2 Status fmi2GetReal(Component c, const Reference r[], size_t n, Real value[]) { return read_values(c, r, n, value); }
FMI2 Status fmi2SetReal(Component c, const Reference r[], size_t n, const Real value[]) { return write_values(c, r, n, value); }

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

FMI2 Status fmi2GetFMUstate(Component c, FmuState *state) { return get_state(c, state); }
FMI2 Status fmi2SetFMUstate(Component c, FmuState state) { return set_state(c, state); }
FMI2 Status fmi2FreeFMUstate(Component c, FmuState *state)
{
    (void)c;
    if (state != NULL) free(*state), *state = NULL;
    return OK;
}
FMI2 Status fmi2SerializedFMUstateSize(Component c, FmuState state, size_t *size)
{
    (void)c;
    *size = state == NULL ? 0 : state_size(state);
    return state == NULL ? ERROR : OK;
}
FMI2 Status fmi2SerializeFMUstate(Component c, FmuState state, Byte bytes[], size_t size)
{
    (void)c;
    return serialize_state(state, bytes, size);
}
FMI2 Status fmi2DeSerializeFMUstate(Component c, const Byte bytes[], size_t size, FmuState *state)
{
    (void)c;
    return deserialize_state(bytes, size, state);
}

FMI2 Status fmi2GetDirectionalDerivative(Component c, const Reference unknown[], size_t n, const Reference known[],
                                         size_t m, const Real seed[], Real value[])
{
    return directional_derivative(c, unknown, n, known, m, seed, value);
}

FMI2 Status fmi2SetRealInputDerivatives(Component c, const Reference r[], size_t n, const Integer order[],
                                        const Real value[])
{
    Model *const model = c;
    size_t i;
    for (i = 0; i < n; i++) {
        const Variable one = variable(r[i]);
        if (one.kind == MOTION) continue; /* its derivatives are inputs themselves */
        if (one.kind != INPUT || order[i] < 1 || !isfinite(value[i])) return ERROR;
        if (order[i] < ORDERS) model->now.e[order[i]][one.number] = value[i];
        else if (value[i] != 0.0) return DISCARD;
        model->now.stale = 1;
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
    Model *const model = c;
    const Status status = take_step(model, time, step);
    (void)final;
    memset(model->now.e[1], 0, sizeof model->now.e - sizeof model->now.e[0]); /* derivatives are of one step */
    model->now.stale = 1;
    return status;
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
