/* A stand-in for the header of Simulink, with what S-functions of ours use of it: one block, called by hand. */
#ifndef SIMSTRUC_H
#define SIMSTRUC_H

#include <stddef.h>

#define MOST_PORTS 32
#define MOST_STATES 64
#define MOST_INPUTS 64
#define MOST_OUTPUTS 65536
typedef double real_T;
typedef int int_T;
typedef struct {
    const double *values;
    size_t count;
} mxArray;
typedef struct {
    mxArray parameters[2];
    int asked, states, has_input, ports, input_width, width[MOST_PORTS], starts[MOST_PORTS];
    double t, x[MOST_STATES], rates[MOST_STATES], u[MOST_INPUTS], y[MOST_OUTPUTS];
    const char *error;
} SimStruct;

#define mxGetNumberOfElements(a) ((a)->count)
#define mxGetPr(a) ((double *)(a)->values)
#define ssGetSFcnParam(S, k) (&(S)->parameters[k])
#define ssSetNumSFcnParams(S, n) ((S)->asked = (n))
#define ssGetNumSFcnParams(S) ((S)->asked)
#define ssGetSFcnParamsCount(S) 2
#define ssSetErrorStatus(S, text) ((S)->error = (text))
#define ssGetErrorStatus(S) ((S)->error)
#define ssSetNumContStates(S, n) ((S)->states = (n))
#define ssSetNumDiscStates(S, n) ((void)(n))
#define ssSetNumInputPorts(S, n) ((S)->has_input = (n), 1)
#define ssSetInputPortWidth(S, k, n) ((S)->input_width = (n))
#define ssSetInputPortRequiredContiguous(S, k, n) ((void)(n))
#define ssSetInputPortDirectFeedThrough(S, k, n) ((void)(n))
#define ssSetNumOutputPorts(S, n) ((S)->ports = (n), (n) <= MOST_PORTS)
#define ssSetOutputPortWidth(S, k, n) ((S)->width[k] = (n))
#define ssSetNumSampleTimes(S, n) ((void)(n))
#define ssSetOptions(S, n) ((void)(n))
#define SS_OPTION_EXCEPTION_FREE_CODE 0
#define CONTINUOUS_SAMPLE_TIME 0.0
#define ssSetSampleTime(S, k, n) ((void)(S), (void)(n))
#define ssSetOffsetTime(S, k, n) ((void)(S), (void)(n))
#define ssGetContStates(S) ((S)->x)
#define ssGetdX(S) ((S)->rates)
#define ssGetInputPortRealSignal(S, k) ((const real_T *)(S)->u)
#define ssGetOutputPortRealSignal(S, k) ((S)->y + (S)->starts[k])
#define ssGetT(S) ((S)->t)

#endif
