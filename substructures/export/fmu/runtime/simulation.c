#include "simulation.h"

#include <math.h>
#include <string.h>

/* Dormand and Prince 5(4), J. Comp. Appl. Math. 6 (1980), 19-26, table 2 */
enum { STAGES = 7 };
static const double NODES[STAGES] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double WEIGHTS[STAGES][STAGES] = {
    {0.0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
/* of the solution of order 5 minus those of the embedded one of order 4 */
static const double ERRORS[STAGES] = {71.0 / 57600,      0.0,           -71.0 / 16695, 71.0 / 1920,
                                      -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
static const double SAFETY = 0.9, LEAST = 0.2, MOST = 5.0;
static const long STEPS = 10000000; /* of one communication step */

void state_reset(State *s)
{
    memset(s, 0, sizeof *s);
    fmu_start(s->v + AT_Q, s->v + AT_V, s->v + AT_U, s->v + AT_P);
    s->v[AT_TOLERANCE] = FMU_TOLERANCE;
    s->phase = PHASE_NEW;
}

int state_write(State *s, size_t at, double value)
{
    int is_state = at >= AT_Q && at < AT_DQ;
    int is_input = at >= AT_U && at < AT_P;
    int is_parameter = at >= AT_P && at < AT_Y;
    if (!(is_state || is_input || is_parameter) || s->phase == PHASE_ENDED) return 1;
    if (s->v[at] != value) {
        s->v[at] = value;
        s->has_rates = s->has_outputs = 0;
        if (at < AT_U) s->next = 0.0;
    }
    return 0;
}

/* rates: der(q), der(v); qdd: the accelerations where they are not among these */
static int accelerations(double t, const double *x, const double *u, const double *p, double *rates, double *qdd)
{
    int wrong = 0;
    fmu_dynamics(t, x, x + FMU_NQ, u, p, rates, rates + FMU_NQ, qdd);
    for (size_t i = 0; i < STATES; ++i) wrong |= !isfinite(rates[i]);
    return wrong;
}

int state_rates(State *s)
{
    if (!s->has_rates) {
        if (accelerations(s->v[AT_T], s->v + AT_Q, s->v + AT_U, s->v + AT_P, s->v + AT_DQ, s->v + AT_DV + FMU_NV))
            return 1;
        s->has_rates = 1;
    }
    return 0;
}

int state_outputs(State *s)
{
    double *v = s->v;
    if (state_rates(s)) return 1;
    if (!s->has_outputs)
        fmu_outputs(v[AT_T], v + AT_Q, v + AT_QD, v + AT_QDD, v + AT_U, v + AT_P, v + AT_Y);
    s->has_outputs = 1;
    return 0;
}

int state_read(State *s, size_t at, double *value)
{
    if (at >= VALUES) return 1;
    if (at >= AT_DQ && at < AT_U && state_rates(s)) return 1;
    if (at >= AT_Y && state_outputs(s)) return 1;
    *value = s->v[at];
    return 0;
}

int state_tangent(State *s, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns, size_t n_knowns,
                  const double *seed, double *found)
{
    /* d: the direction, laid out as the values are */
    double d[VALUES], *v = s->v;
    memset(d, 0, sizeof d);
    if (state_rates(s)) return 1;
    for (size_t i = 0; i < n_knowns; ++i) {
        unsigned at = knowns[i];
        int may = (at >= AT_Q && at < AT_DQ) || (at >= AT_U && at < AT_STEP);
        if (!may) return 1;
        d[at] = seed[i];
    }
    fmu_dynamics_tangent(v[AT_T], v + AT_Q, v + AT_V, v + AT_QDD, v + AT_U, v + AT_P, d, d + AT_DQ);
    int needs_outputs = 0;
    for (size_t i = 0; i < n_unknowns; ++i) {
        if (unknowns[i] >= VALUES || unknowns[i] < AT_DQ || (unknowns[i] >= AT_U && unknowns[i] < AT_Y)) return 1;
        needs_outputs |= unknowns[i] >= AT_Y;
    }
    if (needs_outputs)
        fmu_outputs_tangent(v[AT_T], v + AT_Q, v + AT_QD, v + AT_QDD, v + AT_U, v + AT_P, d, d + AT_Y);
    for (size_t i = 0; i < n_unknowns; ++i) found[i] = d[unknowns[i]];
    return 0;
}

/* Classical fixed steps of order 4, the last one shorter. */
static int advance_fixed(State *s, double to)
{
    double k[4][STATES], y[STATES], qdd[FMU_NA + 1];
    double *x = s->v + AT_Q;
    const double *u = s->v + AT_U, *p = s->v + AT_P;
    double from = s->v[AT_T], step = s->v[AT_STEP];
    double wanted = ceil((to - from) / step - 1e-9);
    if (!(wanted < (double)STEPS)) return 1;
    long count = wanted < 1.0 ? 1 : (long)wanted;
    double h = (to - from) / (double)count;
    for (long n = 0; n < count; ++n) {
        double t = from + (double)n * h;
        for (int j = 0; j < 4; ++j) {
            double part = j == 0 ? 0.0 : j == 3 ? h : 0.5 * h;
            for (size_t i = 0; i < STATES; ++i) y[i] = x[i] + (j ? part * k[j - 1][i] : 0.0);
            if (accelerations(t + part, y, u, p, k[j], qdd)) return 1;
        }
        for (size_t i = 0; i < STATES; ++i) x[i] += h / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
    }
    return 0;
}

/* The size of a step whose first term of the error is a hundredth of what may be. */
static double first_step(const double *x, const double *rates, double tolerance, double span)
{
    double size = 0.0, speed = 0.0;
    for (size_t i = 0; i < STATES; ++i) {
        double scale = tolerance * (1.0 + fabs(x[i]));
        size = fmax(size, fabs(x[i]) / scale);
        speed = fmax(speed, fabs(rates[i]) / scale);
    }
    return fmin(span, speed > 0.0 && size > 0.0 ? 0.01 * size / speed : 1e-6);
}

static int advance_adaptive(State *s, double to)
{
    double k[STAGES][STATES], y[STATES], qdd[FMU_NA + 1];
    double *x = s->v + AT_Q;
    const double *u = s->v + AT_U, *p = s->v + AT_P;
    double t = s->v[AT_T], tolerance = s->v[AT_TOLERANCE];
    if (accelerations(t, x, u, p, k[0], qdd)) return 1;
    if (!(s->next > 0.0)) s->next = first_step(x, k[0], tolerance, to - t);
    for (long n = 0; t < to; ++n) {
        int is_last = t + s->next >= to - 1e-12 * fabs(to);
        double h = is_last ? to - t : s->next, worst = 0.0;
        int failed = 0;
        if (n >= STEPS || !(t + h > t)) return 1;
        for (int j = 1; j < STAGES && !failed; ++j) {
            for (size_t i = 0; i < STATES; ++i) {
                double sum = 0.0;
                for (int m = 0; m < j; ++m) sum += WEIGHTS[j][m] * k[m][i];
                y[i] = x[i] + h * sum;
            }
            failed = accelerations(t + NODES[j] * h, y, u, p, k[j], qdd);
        }
        for (size_t i = 0; i < STATES && !failed; ++i) {
            double error = 0.0;
            for (int j = 0; j < STAGES; ++j) error += ERRORS[j] * k[j][i];
            worst = fmax(worst, fabs(h * error) / (tolerance * (1.0 + fmax(fabs(x[i]), fabs(y[i])))));
        }
        double factor = failed ? LEAST : SAFETY * pow(fmax(worst, 1e-10), -0.2);
        factor = fmin(MOST, fmax(LEAST, factor));
        if (failed || worst > 1.0) {
            s->next = h * fmin(factor, 1.0);
            continue;
        }
        /* a last step that was cut short says little about the next one */
        if (!is_last || h * factor > s->next) s->next = h * factor;
        t = is_last ? to : t + h;
        memcpy(x, y, sizeof y);
        memcpy(k[0], k[STAGES - 1], sizeof k[0]);
    }
    return 0;
}

int state_advance(State *s, double to)
{
    int wrong = 0;
    if (to > s->v[AT_T] && FMU_NQ > 0) wrong = s->v[AT_STEP] > 0.0 ? advance_fixed(s, to) : advance_adaptive(s, to);
    if (!wrong) s->v[AT_T] = to;
    s->has_rates = s->has_outputs = 0;
    return wrong;
}
