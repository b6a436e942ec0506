/* Functional Mock-up Interface 3.0, model exchange and co-simulation (https://fmi-standard.org/docs/3.0/). */
#include "simulation.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);

typedef struct {
    State s;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Model;

static fmi3Status say(const Model *m, fmi3Status status, const char *message)
{
    if (m->log) m->log(m->environment, status, "logStatusError", message);
    return status;
}

#define FMI(NAME) fmi3##NAME
#define FMI_STATE(VERB) fmi3##VERB##FMUState
#define FMI_STATE_SIZE fmi3SerializedFMUStateSize
#define FMI_DESERIALIZE fmi3DeserializeFMUState
#define FMI_RATES fmi3GetContinuousStateDerivatives
#include "fmi.h"

static fmi3Instance instantiate(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    Model *m;
    if (token == NULL || strcmp(token, FMU_TOKEN) != 0) {
        if (log) log(environment, fmi3Error, "logStatusError", "the instantiation token is that of another model");
        return NULL;
    }
    m = calloc(1, sizeof *m);
    if (m == NULL) return NULL;
    state_reset(&m->s);
    m->environment = environment;
    m->log = log;
    return m;
}

EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logging,
                                                 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)name, (void)resources, (void)visible, (void)logging;
    return instantiate(token, environment, log);
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                                fmi3Boolean early, const fmi3ValueReference intermediate[],
                                                size_t n, fmi3InstanceEnvironment environment,
                                                fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)intermediate, (void)n;
    (void)update;
    return instantiate(token, environment, log);
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log, void *update, void *lock,
                                                      void *unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    if (log) log(environment, fmi3Error, "logStatusError", "there is no scheduled execution");
    return NULL;
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                              fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
                                              fmi3Float64 stop)
{
    Model *m = instance;
    (void)has_stop, (void)stop;
    if (has_tolerance && tolerance > 0.0) m->s.v[AT_TOLERANCE] = tolerance;
    m->s.v[AT_T] = start;
    m->s.has_rates = m->s.has_outputs = 0;
    m->s.phase = PHASE_INITIALISING;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                 fmi3Float64 values[], size_t n_values)
{
    Model *m = instance;
    size_t k = 0;
    for (size_t i = 0; i < n; ++i) {
        fmi3ValueReference at = references[i];
        unsigned size = at < VALUES ? FMU_SIZES[at] : 0;
        if (size == 0 || k + size > n_values) return say(m, fmi3Error, "no such variable, or the wrong number of values");
        for (unsigned j = 0; j < size; ++j)
            if (state_read(&m->s, at + j, values + k++)) return say(m, fmi3Discard, "the accelerations are not finite");
    }
    return k == n_values ? fmi3OK : say(m, fmi3Error, "the wrong number of values");
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                 const fmi3Float64 values[], size_t n_values)
{
    Model *m = instance;
    size_t k = 0;
    for (size_t i = 0; i < n; ++i) {
        fmi3ValueReference at = references[i];
        unsigned size = at < VALUES ? FMU_SIZES[at] : 0;
        if (size == 0 || k + size > n_values) return say(m, fmi3Error, "no such variable, or the wrong number of values");
        for (unsigned j = 0; j < size; ++j)
            if (state_write(&m->s, at + j, values[k++])) return say(m, fmi3Error, "this variable cannot be set");
    }
    return k == n_values ? fmi3OK : say(m, fmi3Error, "the wrong number of values");
}

/* There are no variables of other types. */
#define NONE(TYPE)                                                                                                     \
    EXPORT fmi3Status fmi3Get##TYPE(fmi3Instance instance, const fmi3ValueReference references[], size_t n,            \
                                         fmi3##TYPE values[], size_t n_values)                                         \
    {                                                                                                                  \
        (void)references, (void)values, (void)n_values;                                                                \
        return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;                             \
    }                                                                                                                  \
    EXPORT fmi3Status fmi3Set##TYPE(fmi3Instance instance, const fmi3ValueReference references[], size_t n,            \
                                         const fmi3##TYPE values[], size_t n_values)                                   \
    {                                                                                                                  \
        (void)references, (void)values, (void)n_values;                                                                \
        return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;                             \
    }

typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(Int32)
NONE(UInt32)
NONE(Int64)
NONE(UInt64)
NONE(Boolean)
NONE(String)

EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                size_t sizes[], fmi3Binary values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                const size_t sizes[], const fmi3Binary values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;
}

EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                               fmi3Clock values[])
{
    (void)references, (void)values;
    return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;
}

EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                               const fmi3Clock values[])
{
    (void)references, (void)values;
    return n ? say(instance, fmi3Error, "there is no variable of this type") : fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference,
                                                      size_t *n)
{
    (void)reference, (void)n;
    return say(instance, fmi3Error, "dependencies are those of modelDescription.xml");
}

EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                              size_t elements[], fmi3ValueReference independents[],
                                              size_t elements_of[], int kinds[], size_t n)
{
    (void)dependent, (void)elements, (void)independents, (void)elements_of, (void)kinds, (void)n;
    return say(instance, fmi3Error, "dependencies are those of modelDescription.xml");
}

/* All elements of variables; their number, or VALUES + 1 for a variable that is none. */
static size_t elements(const fmi3ValueReference references[], size_t n, unsigned found[])
{
    size_t k = 0;
    for (size_t i = 0; i < n; ++i) {
        unsigned size = references[i] < VALUES ? FMU_SIZES[references[i]] : 0;
        if (size == 0 || k + size > VALUES) return VALUES + 1;
        for (unsigned j = 0; j < size; ++j) found[k++] = references[i] + j;
    }
    return k;
}

EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                               size_t n_unknowns, const fmi3ValueReference knowns[],
                                               size_t n_knowns, const fmi3Float64 seed[], size_t n_seed,
                                               fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    Model *m = instance;
    unsigned of[VALUES], by[VALUES];
    if (elements(unknowns, n_unknowns, of) != n_sensitivity || elements(knowns, n_knowns, by) != n_seed)
        return say(m, fmi3Error, "no such variable, or the wrong number of values");
    if (state_tangent(&m->s, of, n_sensitivity, by, n_seed, seed, sensitivity))
        return say(m, fmi3Error, "there is no derivative of one of these variables");
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                           size_t n_unknowns, const fmi3ValueReference knowns[], size_t n_knowns,
                                           const fmi3Float64 seed[], size_t n_seed, fmi3Float64 sensitivity[],
                                           size_t n_sensitivity)
{
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)n_seed, (void)sensitivity;
    (void)n_sensitivity;
    return say(instance, fmi3Error, "there are no adjoint derivatives");
}

EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    return say(instance, fmi3Error, "there are no structural parameters");
}

EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    return say(instance, fmi3Error, "there are no structural parameters");
}

#define NO_CLOCK(NAME, ...)                                                                                            \
    EXPORT fmi3Status fmi3##NAME(fmi3Instance instance, const fmi3ValueReference references[], size_t n,               \
                                      __VA_ARGS__)                                                                     \
    {                                                                                                                  \
        (void)references, (void)a, (void)b;                                                                            \
        return n ? say(instance, fmi3Error, "there are no clocks") : fmi3OK;                                           \
    }
NO_CLOCK(GetIntervalDecimal, fmi3Float64 a[], int b[])
NO_CLOCK(SetIntervalFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])
NO_CLOCK(GetShiftFraction, fmi3UInt64 a[], fmi3UInt64 b[])
NO_CLOCK(SetShiftFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])

EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                          fmi3UInt64 counters[], fmi3UInt64 resolutions[], int qualifiers[])
{
    (void)references, (void)counters, (void)resolutions, (void)qualifiers;
    return n ? say(instance, fmi3Error, "there are no clocks") : fmi3OK;
}

EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                      fmi3Float64 shifts[])
{
    (void)references, (void)shifts;
    return n ? say(instance, fmi3Error, "there are no clocks") : fmi3OK;
}

EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                         const fmi3Float64 intervals[])
{
    (void)references, (void)intervals;
    return n ? say(instance, fmi3Error, "there are no clocks") : fmi3OK;
}

EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                      const fmi3Float64 shifts[])
{
    (void)references, (void)shifts;
    return n ? say(instance, fmi3Error, "there are no clocks") : fmi3OK;
}

EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *ends,
                                           fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *has_event,
                                           fmi3Float64 *event)
{
    Model *m = instance;
    const char *why;
    int found = state_decide(&m->s, &why);
    *again = *ends = *nominals = *has_event = false;
    *values = found > 0;
    *event = 0.0;
    return found < 0 ? say(m, fmi3Error, why) : fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = FMU_INDICATORS;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = STATES;
    return fmi3OK;
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                                           const int32_t orders[], fmi3Float64 values[], size_t n_values)
{
    (void)references, (void)orders, (void)values, (void)n_values;
    return n ? say(instance, fmi3Error, "there are no derivatives of outputs") : fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 at, fmi3Float64 step, fmi3Boolean no_return,
                             fmi3Boolean *event, fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *reached)
{
    Model *m = instance;
    const char *why;
    (void)no_return;
    *event = *ends = *early = false;
    *reached = at;
    if (!(step > 0.0)) return say(m, fmi3Error, "the step has to be positive");
    m->s.v[AT_T] = at;
    if (state_advance(&m->s, at + step, &why)) return say(m, fmi3Error, why);
    *reached = m->s.v[AT_T];
    return fmi3OK;
}

EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return say(instance, fmi3Error, "there is no scheduled execution");
}
