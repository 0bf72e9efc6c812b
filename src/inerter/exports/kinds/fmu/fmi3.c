/* FMI 3.0 for co-simulation over instance.c, with derivatives of inputs as inputs. Written by inerter after the
   specification. Reference 0 is time. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FIRST 1
#define INPUT_ORDERS ORDERS
#include "instance.c"

#if defined _WIN32
#define FMI3 __declspec(dllexport)
#else
#define FMI3 __attribute__((visibility("default")))
#endif

typedef void *Handle, *FmuState, *Environment;
typedef uint32_t Reference;
typedef double Float64;
typedef bool Boolean;
typedef const char *String;
typedef uint8_t Byte;
typedef const uint8_t *Binary;
typedef bool Clock;
typedef void (*Log)(Environment, Status, String, String);
typedef void (*Function)(void);

typedef struct {
    Model model;
    Log log;
    Environment environment;
} Instance;

static void tell(Model *model, Status status, const char *text)
{
    const Instance *const one = (const Instance *)model;
    if (one->log != NULL) one->log(one->environment, status, status == WARNING ? "logStatusWarning" : "logStatusError", text);
}

FMI3 String fmi3GetVersion(void) { return "3.0"; }
FMI3 Status fmi3SetDebugLogging(Handle c, Boolean on, size_t n, const String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return OK;
}
FMI3 Handle fmi3InstantiateCoSimulation(String name, String token, String place, Boolean visible, Boolean logging,
                                          Boolean events, Boolean early, const Reference wanted[], size_t n,
                                          Environment environment, Log log, Function update)
{
    Instance *one;
    (void)name, (void)place, (void)visible, (void)logging, (void)events, (void)early, (void)wanted, (void)n;
    (void)update;
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        if (log != NULL) log(environment, ERROR, "logStatusError", "the description is of another model");
        return NULL;
    }
    one = calloc(1, sizeof(Instance));
    if (one == NULL) return NULL;
    one->log = log, one->environment = environment;
    rest(&one->model);
    return one;
}
FMI3 Handle fmi3InstantiateModelExchange(String name, String token, String place, Boolean visible, Boolean logging,
                                           Environment environment, Log log)
{
    (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log;
    return NULL;
}
FMI3 Handle fmi3InstantiateScheduledExecution(String name, String token, String place, Boolean visible,
                                                Boolean logging, Environment environment, Log log, Function update,
                                                Function lock, Function unlock)
{
    (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log;
    (void)update, (void)lock, (void)unlock;
    return NULL;
}
FMI3 void fmi3FreeInstance(Handle c) { release(c); }
FMI3 Status fmi3EnterInitializationMode(Handle c, Boolean defined, Float64 tolerance, Float64 start, Boolean stops,
                                        Float64 stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->now.time = start;
    return OK;
}
#define NOTHING(name) \
    FMI3 Status fmi3##name(Handle c) { (void)c; return OK; }
#define REFUSED(name) \
    FMI3 Status fmi3##name(Handle c) { (void)c; return ERROR; }
FMI3 Status fmi3ExitInitializationMode(Handle c)
{
    ((Model *)c)->is_running = 1;
    return answer(c, assemble(c));
}
NOTHING(Terminate)
REFUSED(EnterEventMode)
REFUSED(EnterConfigurationMode)
REFUSED(ExitConfigurationMode)
REFUSED(EvaluateDiscreteStates)
REFUSED(EnterContinuousTimeMode)
REFUSED(EnterStepMode)
FMI3 Status fmi3Reset(Handle c) { rest(c); return OK; }

FMI3 Status fmi3GetFloat64(Handle c, const Reference r[], size_t n, Float64 value[], size_t m)
{
    return m < n ? ERROR : read_values(c, r, n, value);
}
FMI3 Status fmi3SetFloat64(Handle c, const Reference r[], size_t n, const Float64 value[], size_t m)
{
    return m < n ? ERROR : write_values(c, r, n, value);
}
#define NONE(name, type)                                                                                       \
    FMI3 Status fmi3Get##name(Handle c, const Reference r[], size_t n, type value[], size_t m)               \
    {                                                                                                          \
        (void)c, (void)r, (void)value, (void)m;                                                                \
        return n ? ERROR : OK;                                                                                 \
    }                                                                                                          \
    FMI3 Status fmi3Set##name(Handle c, const Reference r[], size_t n, const type value[], size_t m)         \
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
FMI3 Status fmi3GetBinary(Handle c, const Reference r[], size_t n, size_t sizes[], Binary value[], size_t m)
{
    (void)c, (void)r, (void)sizes, (void)value, (void)m;
    return n ? ERROR : OK;
}
FMI3 Status fmi3SetBinary(Handle c, const Reference r[], size_t n, const size_t sizes[], const Binary value[], size_t m)
{
    (void)c, (void)r, (void)sizes, (void)value, (void)m;
    return n ? ERROR : OK;
}
FMI3 Status fmi3GetClock(Handle c, const Reference r[], size_t n, Clock value[])
{
    (void)c, (void)r, (void)value;
    return n ? ERROR : OK;
}
FMI3 Status fmi3SetClock(Handle c, const Reference r[], size_t n, const Clock value[])
{
    (void)c, (void)r, (void)value;
    return n ? ERROR : OK;
}

FMI3 Status fmi3GetNumberOfVariableDependencies(Handle c, Reference r, size_t *n) { (void)c, (void)r, (void)n; return ERROR; }
FMI3 Status fmi3GetVariableDependencies(Handle c, Reference r, size_t of[], Reference on[], size_t at[], int kinds[],
                                        size_t n)
{
    (void)c, (void)r, (void)of, (void)on, (void)at, (void)kinds, (void)n;
    return ERROR;
}

FMI3 Status fmi3GetFMUState(Handle c, FmuState *state) { return get_state(c, state); }
FMI3 Status fmi3SetFMUState(Handle c, FmuState state) { return set_state(c, state); }
FMI3 Status fmi3FreeFMUState(Handle c, FmuState *state)
{
    (void)c;
    if (state != NULL) free(*state), *state = NULL;
    return OK;
}
FMI3 Status fmi3SerializedFMUStateSize(Handle c, FmuState state, size_t *size)
{
    (void)c;
    *size = state == NULL ? 0 : state_size(state);
    return state == NULL ? ERROR : OK;
}
FMI3 Status fmi3SerializeFMUState(Handle c, FmuState state, Byte bytes[], size_t size)
{
    (void)c;
    return serialize_state(state, bytes, size);
}
FMI3 Status fmi3DeserializeFMUState(Handle c, const Byte bytes[], size_t size, FmuState *state)
{
    (void)c;
    return deserialize_state(bytes, size, state);
}

FMI3 Status fmi3GetDirectionalDerivative(Handle c, const Reference unknown[], size_t n, const Reference known[],
                                         size_t m, const Float64 seed[], size_t ns, Float64 value[], size_t nv)
{
    return ns < m || nv < n ? ERROR : directional_derivative(c, unknown, n, known, m, seed, value);
}
FMI3 Status fmi3GetAdjointDerivative(Handle c, const Reference unknown[], size_t n, const Reference known[], size_t m,
                                     const Float64 seed[], size_t ns, Float64 value[], size_t nv)
{
    (void)c, (void)unknown, (void)n, (void)known, (void)m, (void)seed, (void)ns, (void)value, (void)nv;
    return ERROR;
}

FMI3 Status fmi3GetIntervalDecimal(Handle c, const Reference r[], size_t n, Float64 v[], int q[])
{
    (void)c, (void)r, (void)v, (void)q;
    return n ? ERROR : OK;
}
FMI3 Status fmi3GetIntervalFraction(Handle c, const Reference r[], size_t n, uint64_t v[], uint64_t w[], int q[])
{
    (void)c, (void)r, (void)v, (void)w, (void)q;
    return n ? ERROR : OK;
}
#define DECIMAL(name, type)                                                         \
    FMI3 Status fmi3##name(Handle c, const Reference r[], size_t n, type v[])     \
    {                                                                               \
        (void)c, (void)r, (void)v;                                                  \
        return n ? ERROR : OK;                                                      \
    }
#define FRACTION(name, type)                                                              \
    FMI3 Status fmi3##name(Handle c, const Reference r[], size_t n, type v[], type w[]) \
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

FMI3 Status fmi3UpdateDiscreteStates(Handle c, Boolean *a, Boolean *b, Boolean *d, Boolean *e, Boolean *f, Float64 *t)
{
    (void)c, (void)a, (void)b, (void)d, (void)e, (void)f, (void)t;
    return ERROR;
}
FMI3 Status fmi3CompletedIntegratorStep(Handle c, Boolean final, Boolean *event, Boolean *end)
{
    (void)c, (void)final, (void)event, (void)end;
    return ERROR;
}
FMI3 Status fmi3SetTime(Handle c, Float64 time) { (void)c, (void)time; return ERROR; }
FMI3 Status fmi3SetContinuousStates(Handle c, const Float64 x[], size_t n) { (void)c, (void)x, (void)n; return ERROR; }
#define CONTINUOUS(name) \
    FMI3 Status fmi3##name(Handle c, Float64 x[], size_t n) { (void)c, (void)x, (void)n; return ERROR; }
CONTINUOUS(GetContinuousStateDerivatives)
CONTINUOUS(GetEventIndicators)
CONTINUOUS(GetContinuousStates)
CONTINUOUS(GetNominalsOfContinuousStates)
FMI3 Status fmi3GetNumberOfEventIndicators(Handle c, size_t *n) { (void)c; *n = 0; return OK; }
FMI3 Status fmi3GetNumberOfContinuousStates(Handle c, size_t *n) { (void)c; *n = 0; return OK; }
FMI3 Status fmi3GetOutputDerivatives(Handle c, const Reference r[], size_t n, const int32_t order[], Float64 v[],
                                     size_t m)
{
    (void)c, (void)r, (void)order, (void)v, (void)m;
    return n ? ERROR : OK;
}

FMI3 Status fmi3DoStep(Handle c, Float64 time, Float64 step, Boolean final, Boolean *event, Boolean *end,
                       Boolean *early, Float64 *reached)
{
    const Status status = take_step(c, time, step);
    (void)final;
    *event = *end = *early = false;
    *reached = ((const Model *)c)->now.time;
    return status;
}
FMI3 Status fmi3ActivateModelPartition(Handle c, Reference clock, Float64 time)
{
    (void)c, (void)clock, (void)time;
    return ERROR;
}
