/* Functional Mock-up Interface 2.0, model exchange and co-simulation (https://fmi-standard.org, 2.0.4). */
#include "simulation.h"

#include <stdlib.h>
#include <string.h>

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

#define FMI(NAME) fmi2##NAME
#define FMI_STATE(VERB) fmi2##VERB##FMUstate
#define FMI_STATE_SIZE fmi2SerializedFMUstateSize
#define FMI_DESERIALIZE fmi2DeSerializeFMUstate
#define FMI_RATES fmi2GetDerivatives
#include "fmi.h"

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
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

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    Model *m = c;
    (void)has_stop, (void)stop;
    if (has_tolerance && tolerance > 0.0) m->s.v[AT_TOLERANCE] = tolerance;
    m->s.v[AT_T] = start;
    m->s.has_rates = m->s.has_outputs = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    ((Model *)c)->s.phase = PHASE_INITIALISING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t n, fmi2Real values[])
{
    Model *m = c;
    for (size_t i = 0; i < n; ++i) {
        if (references[i] >= VALUES) return say(m, fmi2Error, "there is no such variable");
        if (state_read(&m->s, references[i], values + i)) return say(m, fmi2Discard, "the accelerations are not finite");
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t n,
                              const fmi2Real values[])
{
    Model *m = c;
    for (size_t i = 0; i < n; ++i)
        if (state_write(&m->s, references[i], values[i])) return say(m, fmi2Error, "this variable cannot be set");
    return fmi2OK;
}

/* There are no variables of other types. */
#define NONE(TYPE)                                                                                                     \
    EXPORT fmi2Status fmi2Get##TYPE(fmi2Component c, const fmi2ValueReference references[], size_t n,                  \
                                         fmi2##TYPE values[])                                                          \
    {                                                                                                                  \
        (void)references, (void)values;                                                                                \
        return n ? say(c, fmi2Error, "there is no variable of this type") : fmi2OK;                                    \
    }                                                                                                                  \
    EXPORT fmi2Status fmi2Set##TYPE(fmi2Component c, const fmi2ValueReference references[], size_t n,                  \
                                         const fmi2##TYPE values[])                                                    \
    {                                                                                                                  \
        (void)references, (void)values;                                                                                \
        return n ? say(c, fmi2Error, "there is no variable of this type") : fmi2OK;                                    \
    }
NONE(Integer)
NONE(Boolean)
NONE(String)

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                               size_t n_unknowns, const fmi2ValueReference knowns[],
                                               size_t n_knowns, const fmi2Real seed[], fmi2Real sensitivity[])
{
    Model *m = c;
    if (state_tangent(&m->s, unknowns, n_unknowns, knowns, n_knowns, seed, sensitivity))
        return say(m, fmi2Error, "there is no derivative of one of these variables");
    return fmi2OK;
}

EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    Model *m = c;
    const char *why;
    memset(info, 0, sizeof *info);
    int found = state_decide(&m->s, &why);
    info->valuesOfContinuousStatesChanged = found > 0;
    return found < 0 ? say(m, fmi2Error, why) : fmi2OK;
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t n,
                                              const fmi2Integer orders[], const fmi2Real values[])
{
    (void)references, (void)orders, (void)values;
    return n ? say(c, fmi2Error, "inputs are constant during a step") : fmi2OK;
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t n,
                                               const fmi2Integer orders[], fmi2Real values[])
{
    (void)references, (void)orders, (void)values;
    return n ? say(c, fmi2Error, "there are no derivatives of outputs") : fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real at, fmi2Real step, fmi2Boolean no_return)
{
    Model *m = c;
    const char *why;
    (void)no_return;
    if (!(step > 0.0)) return say(m, fmi2Error, "the step has to be positive");
    m->s.v[AT_T] = at;
    if (state_advance(&m->s, at + step, &why)) return say(m, fmi2Error, why);
    return fmi2OK;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return say(c, fmi2Error, "steps end before they can be cancelled");
}

#define NO_STATUS(TYPE, OF)                                                                                            \
    EXPORT fmi2Status fmi2Get##TYPE##Status(fmi2Component c, int kind, OF *value)                                      \
    {                                                                                                                  \
        (void)c, (void)kind, (void)value;                                                                              \
        return fmi2Discard;                                                                                            \
    }
NO_STATUS(, fmi2Status)
NO_STATUS(Real, fmi2Real)
NO_STATUS(Integer, fmi2Integer)
NO_STATUS(Boolean, fmi2Boolean)
NO_STATUS(String, fmi2String)
