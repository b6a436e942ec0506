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
#if FMU_CONTACTS > 0
    s->contacts.margin = 1e-9;
#endif
}

int state_write(State *s, size_t at, double value)
{
    int is_state = at >= AT_Q && at < AT_DQ;
    int is_input = at >= AT_U && at < AT_P;
    int is_parameter = at >= AT_P && at < AT_C;
    if (!(is_state || is_input || is_parameter) || s->phase == PHASE_ENDED) return 1;
    if (s->v[at] != value) {
        s->v[at] = value;
        s->has_rates = s->has_outputs = 0;
        if (at < AT_U) s->next = 0.0;
#if FMU_CONTACTS > 0
        s->contacts.is_decided = 0;
#endif
    }
    return 0;
}

/* rates: der(q), der(v); qdd: the accelerations where they are not among these; told: of contacts, or NULL */
static int accelerations(const State *s, double t, const double *x, double *rates, double *qdd, double *told)
{
    const double *u = s->v + AT_U, *p = s->v + AT_P;
    int wrong = 0;
    fmu_dynamics(t, x, x + FMU_NQ, u, p, rates, rates + FMU_NQ, qdd);
#if FMU_CONTACTS > 0
    Given at = {t, u, p};
    double force[FMU_CONTACTS][3];
    wrong = contacts_act(&s->contacts, &at, x, rates + FMU_NQ, force);
    if (told != NULL) {
        Seen seen;
        double found[FMU_INDICATORS];
        contacts_look(&at, x, &seen);
        contacts_indicate(&s->contacts, &at, x, force, found);
        for (int i = 0; i < FMU_CONTACTS; ++i, told += OF_CONTACT) {
            told[0] = seen.gap[i], told[1] = force[i][0], told[2] = force[i][1], told[3] = force[i][2];
            told[4] = found[2 * i], told[5] = found[2 * i + 1];
        }
        told[0] = s->contacts.energy, told[1] = s->contacts.impacts, told[2] = s->contacts.last;
    }
#else
    (void)told;
#endif
    for (size_t i = 0; i < STATES; ++i) wrong |= !isfinite(rates[i]);
    return wrong;
}

int state_rates(State *s)
{
    if (!s->has_rates) {
        double *v = s->v;
        if (accelerations(s, v[AT_T], v + AT_Q, v + AT_DQ, v + AT_DV + FMU_NV, FMU_CONTACTS ? v + AT_C : NULL)) return 1;
        s->has_rates = 1;
    }
    return 0;
}

int state_indicators(State *s, double *found)
{
#if FMU_CONTACTS > 0
    if (state_rates(s)) return 1;
    for (size_t i = 0; i < 2 * FMU_CONTACTS; ++i) found[i] = s->v[AT_C + OF_CONTACT * (i / 2) + 4 + i % 2];
    return 0;
#else
    (void)s, (void)found;
    return 0;
#endif
}

int state_decide(State *s, const char **why)
{
#if FMU_CONTACTS > 0
    Given at = {s->v[AT_T], s->v + AT_U, s->v + AT_P};
    int found = contacts_decide(&s->contacts, &at, s->v + AT_Q);
    s->has_rates = s->has_outputs = 0;
    *why = found == CONTACTS_BELOW ? SAY_BELOW : SAY_JAMMED;
    return found;
#else
    (void)s, (void)why;
    return 0;
#endif
}

int state_drifted(State *s)
{
#if FMU_CONTACTS > 0
    Given at = {s->v[AT_T], s->v + AT_U, s->v + AT_P};
    return contacts_drifted(&s->contacts, &at, s->v + AT_Q);
#else
    (void)s;
    return 0;
#endif
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
    if (at >= AT_C && state_rates(s)) return 1;
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
    /* those of the formulas are not those beside contacts */
    if (FMU_CONTACTS || state_rates(s)) return 1;
    for (size_t i = 0; i < n_knowns; ++i) {
        unsigned at = knowns[i];
        if (!(at < AT_DQ || (at >= AT_U && at < AT_STEP))) return 1;
        d[at] = seed[i];
    }
    fmu_dynamics_tangent(v[AT_T], v + AT_Q, v + AT_V, v + AT_QDD, v + AT_U, v + AT_P, d, d + AT_DQ);
    int needs_outputs = 0;
    for (size_t i = 0; i < n_unknowns; ++i) {
        if (unknowns[i] >= VALUES || unknowns[i] < AT_Q || (unknowns[i] >= AT_U && unknowns[i] < AT_Y)) return 1;
        needs_outputs |= unknowns[i] >= AT_Y;
    }
    if (needs_outputs)
        fmu_outputs_tangent(v[AT_T], v + AT_Q, v + AT_QD, v + AT_QDD, v + AT_U, v + AT_P, d, d + AT_Y);
    for (size_t i = 0; i < n_unknowns; ++i) found[i] = d[unknowns[i]];
    return 0;
}

/* A step of a method from t, x with k[0] = x' there: y, and the size of its error in units of the tolerance; 1 where it
   fails. */
typedef int Method(const State *s, double t, const double *x, double h, double k[][STATES], double *y, double *worst);

static int classical(const State *s, double t, const double *x, double h, double k[][STATES], double *y, double *worst)
{
    double qdd[FMU_NA + 1];
    *worst = 0.0;
    for (int j = 1; j < 4; ++j) {
        double part = j == 3 ? h : 0.5 * h;
        for (size_t i = 0; i < STATES; ++i) y[i] = x[i] + part * k[j - 1][i];
        if (accelerations(s, t + part, y, k[j], qdd, NULL)) return 1;
    }
    for (size_t i = 0; i < STATES; ++i) y[i] = x[i] + h / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
    return 0;
}

static int dormand_prince(const State *s, double t, const double *x, double h, double k[][STATES], double *y,
                          double *worst)
{
    double qdd[FMU_NA + 1], tolerance = s->v[AT_TOLERANCE];
    *worst = 0.0;
    for (int j = 1; j < STAGES; ++j) {
        for (size_t i = 0; i < STATES; ++i) {
            double sum = 0.0;
            for (int m = 0; m < j; ++m) sum += WEIGHTS[j][m] * k[m][i];
            y[i] = x[i] + h * sum;
        }
        if (accelerations(s, t + NODES[j] * h, y, k[j], qdd, NULL)) return 1;
    }
    for (size_t i = 0; i < STATES; ++i) {
        double error = 0.0;
        for (int j = 0; j < STAGES; ++j) error += ERRORS[j] * k[j][i];
        *worst = fmax(*worst, fabs(h * error) / (tolerance * (1.0 + fmax(fabs(x[i]), fabs(y[i])))));
    }
    return 0;
}

#if FMU_CONTACTS > 0
static const double FALLEN = 1e-9;

/* the event indicators at a state; 0, or 1 */
static int indicators(const State *s, double t, const double *x, double *found)
{
    double rates[STATES], qdd[FMU_NA + 1], told[AT_Y - AT_C];
    if (accelerations(s, t, x, rates, qdd, told)) return 1;
    for (size_t i = 0; i < FMU_INDICATORS; ++i) found[i] = told[OF_CONTACT * (i / 2) + 4 + i % 2];
    return 0;
}

/* whether an indicator that was positive is so no more, or one that was not has fallen */
static int happens(const State *s, const double *before, double t, const double *x)
{
    double found[FMU_INDICATORS];
    if (indicators(s, t, x, found)) return 1;
    for (size_t i = 0; i < FMU_INDICATORS; ++i)
        if (before[i] > 0.0 ? !(found[i] > 0.0) : found[i] < before[i] - FALLEN) return 1;
    return 0;
}

/* Up to the first event in a step to y, whose size becomes h; 0 where there is none. */
static int to_event(const State *s, Method *method, double t, const double *x, double *h, double k[][STATES], double *y)
{
    double before[FMU_INDICATORS], trial[STATES], low = 0.0, high = *h, worst;
    if (indicators(s, t, x, before) || !happens(s, before, t + high, y)) return 0;
    while (high - low > 4e-16 * fmax(fabs(t), high)) {
        double middle = low + 0.5 * (high - low);
        if (!(middle > low && middle < high)) break;
        if (method(s, t, x, middle, k, trial, &worst) || happens(s, before, t + middle, trial)) {
            high = middle;
            memcpy(y, trial, sizeof trial);
        } else {
            low = middle;
        }
    }
    *h = high;
    return 1;
}
#endif

/* Take y, the end of a step of size h at t, or the event before it: h and k[0] become those of the new state. 0, 1
   where the step ended earlier, or less than 0 */
static int accept(State *s, Method *method, double t, double *h, double k[][STATES], double *y, const char **why)
{
    int happened = 0;
    double *x = s->v + AT_Q, qdd[FMU_NA + 1];
#if FMU_CONTACTS > 0
    happened = to_event(s, method, t, x, h, k, y);
#endif
    memcpy(x, y, STATES * sizeof *x);
    s->v[AT_T] = t + *h;
    if (happened || state_drifted(s)) {
        if (state_decide(s, why) < 0) return -1;
    } else if (method == dormand_prince) {
        memcpy(k[0], k[STAGES - 1], sizeof k[0]);
        return 0;
    }
    return accelerations(s, s->v[AT_T], x, k[0], qdd, NULL) ? -1 : happened;
}

/* Classical fixed steps of order 4, the last one shorter. */
static int advance_fixed(State *s, double to, const char **why)
{
    double k[STAGES][STATES], y[STATES], qdd[FMU_NA + 1], worst;
    double from = s->v[AT_T], step = s->v[AT_STEP];
    double wanted = ceil((to - from) / step - 1e-9);
    if (!(wanted < (double)STEPS)) return 1;
    long count = wanted < 1.0 ? 1 : (long)wanted, events = 0;
    double h = (to - from) / (double)count;
    if (accelerations(s, from, s->v + AT_Q, k[0], qdd, NULL)) return 1;
    for (long n = 0; n < count; ++n) {
        double t = from + (double)n * h, left = h;
        for (int happened = 1; happened;) {
            double part = left;
            if (classical(s, t, s->v + AT_Q, part, k, y, &worst)) return 1;
            happened = accept(s, classical, t, &part, k, y, why);
            if (happened < 0 || ++events > STEPS) return 1;
            t += part;
            left -= part;
            happened = happened && left > 0.0;
        }
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

static int advance_adaptive(State *s, double to, const char **why)
{
    double k[STAGES][STATES], y[STATES], qdd[FMU_NA + 1];
    double *x = s->v + AT_Q, t = s->v[AT_T];
    if (accelerations(s, t, x, k[0], qdd, NULL)) return 1;
    if (!(s->next > 0.0)) s->next = first_step(x, k[0], s->v[AT_TOLERANCE], to - t);
    for (long n = 0; t < to; ++n) {
        int is_last = t + s->next >= to - 1e-12 * fabs(to);
        double h = is_last ? to - t : s->next, worst = 0.0;
        if (n >= STEPS || !(t + h > t)) return 1;
        int failed = dormand_prince(s, t, x, h, k, y, &worst);
        double factor = failed ? LEAST : SAFETY * pow(fmax(worst, 1e-10), -0.2);
        factor = fmin(MOST, fmax(LEAST, factor));
        if (failed || worst > 1.0) {
            s->next = h * fmin(factor, 1.0);
            continue;
        }
        /* a last step that was cut short says little about the next one */
        if (!is_last || h * factor > s->next) s->next = h * factor;
        int happened = accept(s, dormand_prince, t, &h, k, y, why);
        if (happened < 0) return 1;
        t = is_last && !happened ? to : t + h;
    }
    return 0;
}

/* quaternions back to length 1, on which nothing else depends */
static void normalise(double *q)
{
#if FMU_BALLS > 0
    for (size_t i = 0; i < FMU_BALLS; ++i) {
        double *w = q + FMU_QUATERNIONS[i], size = 0.0;
        for (size_t j = 0; j < 4; ++j) size += w[j] * w[j];
        for (size_t j = 0; j < 4 && size > 0.0; ++j) w[j] /= sqrt(size);
    }
#else
    (void)q;
#endif
}

int state_advance(State *s, double to, const char **why)
{
    int wrong = 0;
    *why = "the accelerations are not finite, or the tolerance needs too small steps";
#if FMU_CONTACTS > 0
    s->contacts.margin = 1e-11;
    wrong = !s->contacts.is_decided && state_decide(s, why) < 0;
#endif
    if (!wrong && to > s->v[AT_T] && FMU_NQ > 0)
        wrong = s->v[AT_STEP] > 0.0 ? advance_fixed(s, to, why) : advance_adaptive(s, to, why);
    if (!wrong) s->v[AT_T] = to;
    normalise(s->v + AT_Q);
    s->has_rates = s->has_outputs = 0;
    return wrong;
}
