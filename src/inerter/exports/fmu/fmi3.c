/* FMI 3.0 for co-simulation over engine.c. Written by inerter after the specification.

   References: 0 is time, 1 + k NU + j is derivative k of input j, and then come the outputs. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine.c"

#if defined _WIN32
#define FMI3 __declspec(dllexport)
#else
#define FMI3 __attribute__((visibility("default")))
#endif

typedef void *Instance, *FmuState, *Environment;
typedef uint32_t Reference;
typedef double Float64;
typedef bool Boolean;
typedef const char *String;
typedef uint8_t Byte;
typedef const uint8_t *Binary;
typedef bool Clock;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;
typedef void (*Log)(Environment, Status, String, String);
typedef void (*Function)(void);

#define FIRST_OUTPUT (1 + ORDERS * NU)
#define ALL (FIRST_OUTPUT + NY)

FMI3 String fmi3GetVersion(void) { return "3.0"; }
FMI3 Status fmi3SetDebugLogging(Instance c, Boolean on, size_t n, const String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return OK;
}
FMI3 Instance fmi3InstantiateCoSimulation(String name, String token, String place, Boolean visible, Boolean logging,
                                          Boolean events, Boolean early, const Reference wanted[], size_t n,
                                          Environment environment, Log log, Function update)
{
    (void)name, (void)place, (void)visible, (void)logging, (void)events, (void)early, (void)wanted, (void)n;
    (void)update;
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        if (log != NULL) log(environment, ERROR, "logStatusError", "the description is of another model");
        return NULL;
    }
    return calloc(1, sizeof(Model));
}
FMI3 Instance fmi3InstantiateModelExchange(String name, String token, String place, Boolean visible, Boolean logging,
                                           Environment environment, Log log)
{
    (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log;
    return NULL;
}
FMI3 Instance fmi3InstantiateScheduledExecution(String name, String token, String place, Boolean visible,
                                                Boolean logging, Environment environment, Log log, Function update,
                                                Function lock, Function unlock)
{
    (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log;
    (void)update, (void)lock, (void)unlock;
    return NULL;
}
FMI3 void fmi3FreeInstance(Instance c) { free(c); }
FMI3 Status fmi3EnterInitializationMode(Instance c, Boolean defined, Float64 tolerance, Float64 start, Boolean stops,
                                        Float64 stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->now.time = start;
    return OK;
}
#define NOTHING(name) \
    FMI3 Status fmi3##name(Instance c) { (void)c; return OK; }
#define REFUSED(name) \
    FMI3 Status fmi3##name(Instance c) { (void)c; return ERROR; }
NOTHING(ExitInitializationMode)
NOTHING(Terminate)
REFUSED(EnterEventMode)
REFUSED(EnterConfigurationMode)
REFUSED(ExitConfigurationMode)
REFUSED(EvaluateDiscreteStates)
REFUSED(EnterContinuousTimeMode)
REFUSED(EnterStepMode)
FMI3 Status fmi3Reset(Instance c) { rest(c); return OK; }

FMI3 Status fmi3GetFloat64(Instance c, const Reference r[], size_t n, Float64 value[], size_t m)
{
    const Model *model = c;
    size_t i;
    if (m < n) return ERROR;
    for (i = 0; i < n; i++) {
        if (r[i] >= ALL) return ERROR;
        if (r[i] == 0) value[i] = model->now.time;
        else if (r[i] < FIRST_OUTPUT) value[i] = model->now.u[(r[i] - 1) / (NU + !NU)][(r[i] - 1) % (NU + !NU)];
        else value[i] = output(model, (int)r[i] - FIRST_OUTPUT);
    }
    return OK;
}
FMI3 Status fmi3SetFloat64(Instance c, const Reference r[], size_t n, const Float64 value[], size_t m)
{
    size_t i;
    if (m < n) return ERROR;
    for (i = 0; i < n; i++) {
        if (r[i] == 0 || r[i] >= FIRST_OUTPUT) return ERROR;
        ((Model *)c)->now.u[(r[i] - 1) / (NU + !NU)][(r[i] - 1) % (NU + !NU)] = value[i];
    }
    return OK;
}
#define NONE(name, type)                                                                                       \
    FMI3 Status fmi3Get##name(Instance c, const Reference r[], size_t n, type value[], size_t m)               \
    {                                                                                                          \
        (void)c, (void)r, (void)value, (void)m;                                                                \
        return n ? ERROR : OK;                                                                                 \
    }                                                                                                          \
    FMI3 Status fmi3Set##name(Instance c, const Reference r[], size_t n, const type value[], size_t m)         \
    {                                                                                                          \
        (void)c, (void)r, (void)value, (void)m;                                                                \
        return n ? ERROR : OK;                                                                                 \
    }
NONE(Float32, float)
NONE(Int8, int8_t)
NONE(UInt8, uint8_t)
NONE(Int16, int16_t)
NONE(UInt16, uint16_t)
NONE(Int32, int32_t)
NONE(UInt32, uint32_t)
NONE(Int64, int64_t)
NONE(UInt64, uint64_t)
NONE(Boolean, Boolean)
NONE(String, String)
FMI3 Status fmi3GetBinary(Instance c, const Reference r[], size_t n, size_t sizes[], Binary value[], size_t m)
{
    (void)c, (void)r, (void)sizes, (void)value, (void)m;
    return n ? ERROR : OK;
}
FMI3 Status fmi3SetBinary(Instance c, const Reference r[], size_t n, const size_t sizes[], const Binary value[], size_t m)
{
    (void)c, (void)r, (void)sizes, (void)value, (void)m;
    return n ? ERROR : OK;
}
FMI3 Status fmi3GetClock(Instance c, const Reference r[], size_t n, Clock value[])
{
    (void)c, (void)r, (void)value;
    return n ? ERROR : OK;
}
FMI3 Status fmi3SetClock(Instance c, const Reference r[], size_t n, const Clock value[])
{
    (void)c, (void)r, (void)value;
    return n ? ERROR : OK;
}

FMI3 Status fmi3GetNumberOfVariableDependencies(Instance c, Reference r, size_t *n) { (void)c, (void)r, (void)n; return ERROR; }
FMI3 Status fmi3GetVariableDependencies(Instance c, Reference r, size_t of[], Reference on[], size_t at[], int kinds[],
                                        size_t n)
{
    (void)c, (void)r, (void)of, (void)on, (void)at, (void)kinds, (void)n;
    return ERROR;
}

FMI3 Status fmi3GetFMUState(Instance c, FmuState *state)
{
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return ERROR;
    memcpy(*state, &((Model *)c)->now, sizeof(State));
    return OK;
}
FMI3 Status fmi3SetFMUState(Instance c, FmuState state)
{
    if (state == NULL) return ERROR;
    memcpy(&((Model *)c)->now, state, sizeof(State));
    return OK;
}
FMI3 Status fmi3FreeFMUState(Instance c, FmuState *state)
{
    (void)c;
    if (state != NULL) free(*state), *state = NULL;
    return OK;
}
FMI3 Status fmi3SerializedFMUStateSize(Instance c, FmuState state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(State);
    return OK;
}
FMI3 Status fmi3SerializeFMUState(Instance c, FmuState state, Byte bytes[], size_t size)
{
    (void)c;
    if (state == NULL || size < sizeof(State)) return ERROR;
    memcpy(bytes, state, sizeof(State));
    return OK;
}
FMI3 Status fmi3DeserializeFMUState(Instance c, const Byte bytes[], size_t size, FmuState *state)
{
    (void)c;
    if (size != sizeof(State)) return ERROR;
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, sizeof(State));
    return OK;
}

FMI3 Status fmi3GetDirectionalDerivative(Instance c, const Reference unknown[], size_t n, const Reference known[],
                                         size_t m, const Float64 seed[], size_t ns, Float64 value[], size_t nv)
{
    size_t i, j;
    (void)c;
    if (ns < m || nv < n) return ERROR;
    for (i = 0; i < n; i++) {
        if (unknown[i] < FIRST_OUTPUT || unknown[i] >= ALL) return ERROR;
        value[i] = 0.0;
        for (j = 0; j < m; j++) {
            if (known[j] == 0 || known[j] >= FIRST_OUTPUT) return ERROR;
            if (known[j] <= NU) value[i] += D[unknown[i] - FIRST_OUTPUT][known[j] - 1] * seed[j];
        }
    }
    return OK;
}
FMI3 Status fmi3GetAdjointDerivative(Instance c, const Reference unknown[], size_t n, const Reference known[], size_t m,
                                     const Float64 seed[], size_t ns, Float64 value[], size_t nv)
{
    (void)c, (void)unknown, (void)n, (void)known, (void)m, (void)seed, (void)ns, (void)value, (void)nv;
    return ERROR;
}

FMI3 Status fmi3GetIntervalDecimal(Instance c, const Reference r[], size_t n, Float64 v[], int q[])
{
    (void)c, (void)r, (void)v, (void)q;
    return n ? ERROR : OK;
}
FMI3 Status fmi3GetIntervalFraction(Instance c, const Reference r[], size_t n, uint64_t v[], uint64_t w[], int q[])
{
    (void)c, (void)r, (void)v, (void)w, (void)q;
    return n ? ERROR : OK;
}
#define DECIMAL(name, type)                                                         \
    FMI3 Status fmi3##name(Instance c, const Reference r[], size_t n, type v[])     \
    {                                                                               \
        (void)c, (void)r, (void)v;                                                  \
        return n ? ERROR : OK;                                                      \
    }
#define FRACTION(name, type)                                                              \
    FMI3 Status fmi3##name(Instance c, const Reference r[], size_t n, type v[], type w[]) \
    {                                                                                     \
        (void)c, (void)r, (void)v, (void)w;                                               \
        return n ? ERROR : OK;                                                            \
    }
DECIMAL(GetShiftDecimal, Float64)
DECIMAL(SetIntervalDecimal, const Float64)
DECIMAL(SetShiftDecimal, const Float64)
FRACTION(GetShiftFraction, uint64_t)
FRACTION(SetIntervalFraction, const uint64_t)
FRACTION(SetShiftFraction, const uint64_t)

FMI3 Status fmi3UpdateDiscreteStates(Instance c, Boolean *a, Boolean *b, Boolean *d, Boolean *e, Boolean *f, Float64 *t)
{
    (void)c, (void)a, (void)b, (void)d, (void)e, (void)f, (void)t;
    return ERROR;
}
FMI3 Status fmi3CompletedIntegratorStep(Instance c, Boolean final, Boolean *event, Boolean *end)
{
    (void)c, (void)final, (void)event, (void)end;
    return ERROR;
}
FMI3 Status fmi3SetTime(Instance c, Float64 time) { (void)c, (void)time; return ERROR; }
FMI3 Status fmi3SetContinuousStates(Instance c, const Float64 x[], size_t n) { (void)c, (void)x, (void)n; return ERROR; }
#define CONTINUOUS(name) \
    FMI3 Status fmi3##name(Instance c, Float64 x[], size_t n) { (void)c, (void)x, (void)n; return ERROR; }
CONTINUOUS(GetContinuousStateDerivatives)
CONTINUOUS(GetEventIndicators)
CONTINUOUS(GetContinuousStates)
CONTINUOUS(GetNominalsOfContinuousStates)
FMI3 Status fmi3GetNumberOfEventIndicators(Instance c, size_t *n) { (void)c; *n = 0; return OK; }
FMI3 Status fmi3GetNumberOfContinuousStates(Instance c, size_t *n) { (void)c; *n = 0; return OK; }
FMI3 Status fmi3GetOutputDerivatives(Instance c, const Reference r[], size_t n, const int32_t order[], Float64 v[],
                                     size_t m)
{
    (void)c, (void)r, (void)order, (void)v, (void)m;
    return n ? ERROR : OK;
}

FMI3 Status fmi3DoStep(Instance c, Float64 time, Float64 step, Boolean final, Boolean *event, Boolean *end,
                       Boolean *early, Float64 *reached)
{
    Model *model = c;
    (void)final;
    *event = *end = *early = false;
    if (!(step >= 0.0)) return ERROR;
    model->now.time = time;
    if (step > 0.0 && !advance(model, step)) return ERROR;
    *reached = model->now.time;
    return OK;
}
FMI3 Status fmi3ActivateModelPartition(Instance c, Reference clock, Float64 time)
{
    (void)c, (void)clock, (void)time;
    return ERROR;
}
