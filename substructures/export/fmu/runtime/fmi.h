/* What versions 2.0 and 3.0 of the Functional Mock-up Interface have in common, under the names of the one that includes
   it: FMI(NAME), FMI_STATE(VERB), FMI_STATE_SIZE, FMI_DESERIALIZE, FMI_RATES, and say(model, status, message). */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

EXPORT FMI(Status) FMI(SetDebugLogging)(void *instance, FMI(Boolean) on, size_t n, const FMI(String) categories[])
{
    (void)instance, (void)on, (void)n, (void)categories;
    return FMI(OK);
}

EXPORT void FMI(FreeInstance)(void *instance)
{
    free(instance);
}

EXPORT FMI(Status) FMI(ExitInitializationMode)(void *instance)
{
    ((Model *)instance)->s.phase = PHASE_READY;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(Terminate)(void *instance)
{
    ((Model *)instance)->s.phase = PHASE_ENDED;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(Reset)(void *instance)
{
    state_reset(&((Model *)instance)->s);
    return FMI(OK);
}

EXPORT FMI(Status) FMI_STATE(Get)(void *instance, void **state)
{
    Model *m = instance;
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return say(m, FMI(Error), "there is no memory for the state");
    memcpy(*state, &m->s, sizeof(State));
    return FMI(OK);
}

EXPORT FMI(Status) FMI_STATE(Set)(void *instance, void *state)
{
    Model *m = instance;
    if (state == NULL) return say(m, FMI(Error), "there is no state");
    memcpy(&m->s, state, sizeof(State));
    return FMI(OK);
}

EXPORT FMI(Status) FMI_STATE(Free)(void *instance, void **state)
{
    (void)instance;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return FMI(OK);
}

EXPORT FMI(Status) FMI_STATE_SIZE(void *instance, void *state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof FMU_TOKEN + sizeof(State);
    return FMI(OK);
}

EXPORT FMI(Status) FMI_STATE(Serialize)(void *instance, void *state, FMI(Byte) bytes[], size_t size)
{
    if (size < sizeof FMU_TOKEN + sizeof(State)) return say(instance, FMI(Error), "there is too little room for the state");
    memcpy(bytes, FMU_TOKEN, sizeof FMU_TOKEN);
    memcpy(bytes + sizeof FMU_TOKEN, state, sizeof(State));
    return FMI(OK);
}

EXPORT FMI(Status) FMI_DESERIALIZE(void *instance, const FMI(Byte) bytes[], size_t size, void **state)
{
    if (size < sizeof FMU_TOKEN + sizeof(State) || memcmp(bytes, FMU_TOKEN, sizeof FMU_TOKEN) != 0)
        return say(instance, FMI(Error), "this is no state of this model");
    if (*state == NULL) *state = malloc(sizeof(State));
    if (*state == NULL) return say(instance, FMI(Error), "there is no memory for the state");
    memcpy(*state, bytes + sizeof FMU_TOKEN, sizeof(State));
    return FMI(OK);
}

EXPORT FMI(Status) FMI(EnterEventMode)(void *instance)
{
    (void)instance;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(EnterContinuousTimeMode)(void *instance)
{
    (void)instance;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(CompletedIntegratorStep)(void *instance, FMI(Boolean) no_return, FMI(Boolean) *event,
                                                FMI(Boolean) *ends)
{
    (void)no_return;
    /* in event mode the state comes back to closed contacts */
    *event = state_drifted(&((Model *)instance)->s);
    *ends = 0;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(SetTime)(void *instance, double time)
{
    Model *m = instance;
    m->s.v[AT_T] = time;
    m->s.has_rates = m->s.has_outputs = 0;
    return FMI(OK);
}

EXPORT FMI(Status) FMI(SetContinuousStates)(void *instance, const double x[], size_t n)
{
    Model *m = instance;
    if (n != STATES) return say(m, FMI(Error), "the wrong number of states");
    memcpy(m->s.v + AT_Q, x, STATES * sizeof *x);
    m->s.has_rates = m->s.has_outputs = 0;
    return FMI(OK);
}

EXPORT FMI(Status) FMI_RATES(void *instance, double rates[], size_t n)
{
    Model *m = instance;
    if (n != STATES) return say(m, FMI(Error), "the wrong number of states");
    if (state_rates(&m->s)) return say(m, FMI(Discard), "the accelerations are not finite");
    memcpy(rates, m->s.v + AT_DQ, STATES * sizeof *rates);
    return FMI(OK);
}

EXPORT FMI(Status) FMI(GetEventIndicators)(void *instance, double indicators[], size_t n)
{
    Model *m = instance;
    if (n != FMU_INDICATORS) return say(m, FMI(Error), "the wrong number of event indicators");
    return state_indicators(&m->s, indicators) ? say(m, FMI(Discard), "the accelerations are not finite") : FMI(OK);
}

EXPORT FMI(Status) FMI(GetContinuousStates)(void *instance, double x[], size_t n)
{
    Model *m = instance;
    if (n != STATES) return say(m, FMI(Error), "the wrong number of states");
    memcpy(x, m->s.v + AT_Q, STATES * sizeof *x);
    return FMI(OK);
}

EXPORT FMI(Status) FMI(GetNominalsOfContinuousStates)(void *instance, double nominals[], size_t n)
{
    if (n != STATES) return say(instance, FMI(Error), "the wrong number of states");
    for (size_t i = 0; i < n; ++i) nominals[i] = 1.0;
    return FMI(OK);
}
