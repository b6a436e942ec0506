/* Functional Mock-up Interface 2.0, model exchange and co-simulation (https://fmi-standard.org, 2.0.4). */
#include "simulation.h"

#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

typedef struct {
    State s;
    const fmi2CallbackFunctions *functions;
    char name[256];
} Model;

static fmi2Status say(const Model *m, fmi2Status status, const char *message)
{
    if (m->functions && m->functions->logger)
        m->functions->logger(m->functions->componentEnvironment, m->name, status, "logStatusError", "%s", message);
    return status;
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

FMI2_EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                          fmi2Boolean logging)
{
    Model *m = calloc(1, sizeof *m);
    (void)type, (void)resources, (void)visible, (void)logging;
    if (m == NULL) return NULL;
    m->functions = functions;
    if (name) strncpy(m->name, name, sizeof m->name - 1);
    if (guid == NULL || strcmp(guid, FMU_TOKEN) != 0) {
        say(m, fmi2Error, "the GUID is that of another model");
        free(m);
        return NULL;
    }
    state_reset(&m->s);
    return m;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    Model *m = c;
    (void)has_stop, (void)stop;
    if (has_tolerance && tolerance > 0.0) m->s.v[AT_TOLERANCE] = tolerance;
    m->s.v[AT_T] = start;
    m->s.has_rates = m->s.has_outputs = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    ((Model *)c)->s.phase = PHASE_INITIALISING;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    ((Model *)c)->s.phase = PHASE_READY;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    ((Model *)c)->s.phase = PHASE_ENDED;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    state_reset(&((Model *)c)->s);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t n, fmi2Real values[])
{
    Model *m = c;
    for (size_t i = 0; i < n; ++i) {
        if (references[i] >= VALUES) return say(m, fmi2Error, "there is no such variable");
        if (state_read(&m->s, references[i], values + i)) return say(m, fmi2Discard, "the accelerations are not finite");
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t n,
                                   const fmi2Real values[])
{
    Model *m = c;
    for (size_t i = 0; i < n; ++i)
        if (state_write(&m->s, references[i], values[i])) return say(m, fmi2Error, "this variable cannot be set");
    return fmi2OK;
}

/* There are no variables of other types. */
#define NONE(TYPE)                                                                                                      \
    FMI2_EXPORT fmi2Status fmi2Get##TYPE(fmi2Component c, const fmi2ValueReference references[], size_t n,              \
                                         fmi2##TYPE values[])                                                           \
    {                                                                                                                   \
        (void)references, (void)values;                                                                                 \
        return n ? say(c, fmi2Error, "there is no variable of this type") : fmi2OK;                                     \
    }                                                                                                                   \
    FMI2_EXPORT fmi2Status fmi2Set##TYPE(fmi2Component c, const fmi2ValueReference references[], size_t n,              \
                                         const fmi2##TYPE values[])                                                     \
    {                                                                                                                   \
        (void)references, (void)values;                                                                                 \
        return n ? say(c, fmi2Error, "there is no variable of this type") : fmi2OK;                                     \
    }
NONE(Integer)
NONE(Boolean)
NONE(String)

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Model *m = c;
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return say(m, fmi2Error, "there is no memory for the state");
    memcpy(*state, &m->s, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Model *m = c;
    if (state == NULL) return say(m, fmi2Error, "there is no state");
    memcpy(&m->s, state, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof FMU_TOKEN + sizeof(State);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (size < sizeof FMU_TOKEN + sizeof(State)) return say(c, fmi2Error, "there is too little room for the state");
    memcpy(bytes, FMU_TOKEN, sizeof FMU_TOKEN);
    memcpy(bytes + sizeof FMU_TOKEN, state, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state)
{
    if (size < sizeof FMU_TOKEN + sizeof(State) || memcmp(bytes, FMU_TOKEN, sizeof FMU_TOKEN) != 0)
        return say(c, fmi2Error, "this is no state of this model");
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return say(c, fmi2Error, "there is no memory for the state");
    memcpy(*state, bytes + sizeof FMU_TOKEN, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                                    size_t n_unknowns, const fmi2ValueReference knowns[],
                                                    size_t n_knowns, const fmi2Real seed[], fmi2Real sensitivity[])
{
    Model *m = c;
    if (state_tangent(&m->s, unknowns, n_unknowns, knowns, n_knowns, seed, sensitivity))
        return say(m, fmi2Error, "there is no derivative of one of these variables");
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    (void)c;
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *event,
                                                   fmi2Boolean *ends)
{
    (void)c, (void)no_return;
    *event = *ends = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    Model *m = c;
    m->s.v[AT_T] = time;
    m->s.has_rates = m->s.has_outputs = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    Model *m = c;
    if (n != STATES) return say(m, fmi2Error, "the wrong number of states");
    memcpy(m->s.v + AT_Q, x, STATES * sizeof *x);
    m->s.has_rates = m->s.has_outputs = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real rates[], size_t n)
{
    Model *m = c;
    if (n != STATES) return say(m, fmi2Error, "the wrong number of states");
    if (state_rates(&m->s)) return say(m, fmi2Discard, "the accelerations are not finite");
    memcpy(rates, m->s.v + AT_DQ, STATES * sizeof *rates);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t n)
{
    (void)indicators;
    return n ? say(c, fmi2Error, "there are no event indicators") : fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    Model *m = c;
    if (n != STATES) return say(m, fmi2Error, "the wrong number of states");
    memcpy(x, m->s.v + AT_Q, STATES * sizeof *x);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t n)
{
    if (n != STATES) return say(c, fmi2Error, "the wrong number of states");
    for (size_t i = 0; i < n; ++i) nominals[i] = 1.0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t n,
                                                   const fmi2Integer orders[], const fmi2Real values[])
{
    (void)references, (void)orders, (void)values;
    return n ? say(c, fmi2Error, "inputs are constant during a step") : fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t n,
                                                    const fmi2Integer orders[], fmi2Real values[])
{
    (void)references, (void)orders, (void)values;
    return n ? say(c, fmi2Error, "there are no derivatives of outputs") : fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real at, fmi2Real step, fmi2Boolean no_return)
{
    Model *m = c;
    (void)no_return;
    if (!(step > 0.0)) return say(m, fmi2Error, "the step has to be positive");
    m->s.v[AT_T] = at;
    if (state_advance(&m->s, at + step))
        return say(m, fmi2Error, "the accelerations are not finite, or the tolerance needs too small steps");
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return say(c, fmi2Error, "steps end before they can be cancelled");
}

#define NO_STATUS(TYPE, OF)                                                                                             \
    FMI2_EXPORT fmi2Status fmi2Get##TYPE##Status(fmi2Component c, int kind, OF *value)                                  \
    {                                                                                                                   \
        (void)c, (void)kind, (void)value;                                                                               \
        return fmi2Discard;                                                                                             \
    }
NO_STATUS(, fmi2Status)
NO_STATUS(Real, fmi2Real)
NO_STATUS(Integer, fmi2Integer)
NO_STATUS(Boolean, fmi2Boolean)
NO_STATUS(String, fmi2String)
