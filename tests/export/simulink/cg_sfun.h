/* The block, called once: sizes, start, rates and outputs; what Simulink does in this order. */
#include <string.h>

static SimStruct one;

const char *block_start(const double *p, size_t np, const double *x, size_t nx)
{
    memset(&one, 0, sizeof one);
    one.parameters[0].values = p;
    one.parameters[0].count = np;
    one.parameters[1].values = x;
    one.parameters[1].count = nx;
    mdlInitializeSizes(&one);
    if (one.error) return one.error;
    for (int k = 1; k < one.ports; ++k) one.starts[k] = one.starts[k - 1] + one.width[k - 1];
    mdlInitializeSampleTimes(&one);
    mdlInitializeConditions(&one);
    return NULL;
}

int block_call(double t, const double *u, double *rates, double *outputs)
{
    int count = one.starts[one.ports - 1] + one.width[one.ports - 1];
    one.t = t;
    memcpy(one.u, u, (size_t)one.input_width * sizeof *u);
    mdlOutputs(&one, 0);
    mdlDerivatives(&one);
    memcpy(rates, one.rates, (size_t)one.states * sizeof *rates);
    memcpy(outputs, one.y, (size_t)count * sizeof *outputs);
    mdlTerminate(&one);
    return count;
}
