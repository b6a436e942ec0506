/* Between events closed contacts keep their gaps, those that stick their places, and those that slip along d = +-e_1
 * have the friction -mu lambda_N d:
 *
 *     g q'' + Gamma q'q' = Q + (G_N - mu d G_T)^T lambda_N + G_T^T lambda_T
 *
 * Impacts: q'+ = q'- + g^-1 G^T L, u_N+ = -e u_N- where L_N > 0, with Coulomb's law between impulses and velocities.
 */
#include "contacts.h"

#include <math.h>
#include <string.h>

#include "complementarity.h"

enum { K = FMU_CONTACTS, N = FMU_NQ, TWO = 2 * K };
static const double FAST = 1e-4, APPROACH = 1e-2, REST = 1e-6, TOUCHING = 1e-9, BELOW = 1e-6, EDGE = 1e-9;
static const double LIGHT = 1e-11, NONE = 1e-11, SLOW = 1e-11, DRIFT = 1e-9, LEAST = 1e-300;

/* of the velocity below which there is no restitution: what is an impact, and a slip that is none */
static double approach_of(int i)
{
    return APPROACH * fmin(FMU_REST_VELOCITY[i], FAST);
}

static double rest_of(int i)
{
    return REST * fmin(FMU_REST_VELOCITY[i], FAST);
}

/* what a gap that opens with a velocity is for indicators at first, so that it is not closed at once: above the rounding
   of gaps, and little beside v^2 / 2 */
static double rebound_of(double v)
{
    return fmin(1e-13, fmax(1e-3 * v * v, 1e-14));
}

static int drags(int i)
{
    return FMU_IS_LINE[i] && FMU_FRICTION[i] > 0.0;
}

void contacts_look(const Given *at, const double *x, Seen *s)
{
    fmu_contacts(at->t, x, x + N, at->u, at->p, s->gap, &s->rows[0][0][0], &s->rate[0][0], &s->bias[0][0], s->acts,
                 &s->metric[0][0]);
}

static double velocity(const Seen *s, const double *x, int i, int r)
{
    double sum = s->rate[i][r];
    for (int a = 0; a < N; ++a) sum += s->rows[i][r][a] * x[N + a];
    return sum;
}

/* W (N, m) = g^-1 F^T of rows F (m, N); 0, or 1 */
static int weighed(const Seen *s, int m, double F[][N], double *W)
{
    for (int a = 0; a < N; ++a)
        for (int j = 0; j < m; ++j) W[a * m + j] = F[j][a];
    return solve(N, &s->metric[0][0], m, W);
}

/* A (m, m) = J W */
static void product(int m, double J[][N], const double *W, double *A)
{
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
            A[i * m + j] = 0.0;
            for (int a = 0; a < N; ++a) A[i * m + j] += J[i][a] * W[a * m + j];
        }
}

/* G_N g^-1 G_N^T of a contact */
static double yield_of(const Seen *s, int i)
{
    double F[1][N], W[N], A[1];
    memcpy(F[0], s->rows[i][0], sizeof F[0]);
    if (weighed(s, 1, F, W)) return LEAST;
    product(1, F, W, A);
    return fmax(A[0], LEAST);
}

int contacts_act(const Contacts *c, const Given *at, const double *x, double *dv, double force[][2])
{
    Seen s;
    double J[TWO][N], F[TWO][N], W[N * TWO], A[TWO * TWO], b[TWO], yields[TWO], found[TWO], way[K];
    int of[TWO], normals = 0, m;
    for (int i = 0; i < K; ++i) {
        force[i][0] = force[i][1] = way[i] = 0.0;
        if (c->mode[i] >= STICK) of[normals++] = i;
    }
    if (normals == 0) return 0;
    contacts_look(at, x, &s);
    m = normals;
    for (int j = 0; j < normals; ++j) {
        int i = of[j];
        double v = velocity(&s, x, i, 1);
        if (c->mode[i] >= FULL && drags(i))
            way[i] = c->way[i] != 0.0 ? c->way[i] : fabs(v) > approach_of(i) ? copysign(1.0, v) : 0.0;
        yields[j] = yield_of(&s, i);
        for (int a = 0; a < N; ++a) {
            J[j][a] = s.rows[i][0][a];
            F[j][a] = s.rows[i][0][a] - FMU_FRICTION[i] * way[i] * s.rows[i][1][a];
        }
        b[j] = -s.bias[i][0];
        if (c->mode[i] == STICK && drags(i)) of[m++] = i;
    }
    for (int j = normals; j < m; ++j) {
        int i = of[j];
        memcpy(J[j], s.rows[i][1], sizeof J[j]), memcpy(F[j], s.rows[i][1], sizeof F[j]);
        yields[j] = yield_of(&s, i);
        b[j] = -s.bias[i][1];
    }
    for (int j = 0; j < m; ++j)
        for (int a = 0; a < N; ++a) b[j] -= J[j][a] * dv[a];
    if (weighed(&s, m, F, W)) return 1;
    product(m, J, W, A);
    if (solve_least(m, A, b, yields, found)) return 1;
    for (int j = 0; j < m; ++j) {
        int i = of[j];
        for (int a = 0; a < N; ++a) dv[a] += W[a * m + j] * found[j];
        if (j < normals) force[i][0] = found[j], force[i][1] = -FMU_FRICTION[i] * found[j] * way[i];
        else force[i][1] = found[j];
    }
    return 0;
}

void contacts_indicate(const Contacts *c, const Given *at, const double *x, double force[][2], double *found)
{
    Seen s;
    contacts_look(at, x, &s);
    for (int i = 0; i < K; ++i) {
        double *one = found + 2 * i, edge = EDGE * c->scale[i];
        one[0] = one[1] = 1.0;
        if (c->mode[i] == OPEN) one[0] = s.gap[i] + c->offset[i];
        else if (c->mode[i] == PASSING) one[0] = SLOW - s.gap[i];
        else one[0] = force[i][0] + edge;
        if (c->mode[i] == STICK && drags(i)) one[1] = FMU_FRICTION[i] * force[i][0] - fabs(force[i][1]) + edge;
        if (c->mode[i] == SLIP && drags(i)) one[1] = c->way[i] * velocity(&s, x, i, 1) + rest_of(i);
    }
}

int contacts_drifted(const Contacts *c, const Given *at, const double *x)
{
    Seen s;
    contacts_look(at, x, &s);
    for (int i = 0; i < K; ++i) {
        /* an importer that has not seen a zero */
        if (c->mode[i] == OPEN && s.gap[i] < -DRIFT && velocity(&s, x, i, 0) < 0.0) return 1;
        if (c->mode[i] < STICK) continue;
        if (fabs(s.gap[i]) > DRIFT || fabs(velocity(&s, x, i, 0)) > DRIFT) return 1;
        if (c->mode[i] == STICK && drags(i) && fabs(velocity(&s, x, i, 1)) > DRIFT) return 1;
    }
    return 0;
}

/* dq (N,) with J dq = wanted, least in the metric, is added; 0, or 1 */
static int change(const Seen *s, int m, double J[][N], const double *wanted, double *x)
{
    double W[N * TWO], A[TWO * TWO], yields[TWO], found[TWO];
    if (m == 0) return 0;
    if (weighed(s, m, J, W)) return 1;
    product(m, J, W, A);
    for (int i = 0; i < m; ++i) yields[i] = A[i * m + i];
    if (solve_least(m, A, wanted, yields, found)) return 1;
    for (int a = 0; a < N; ++a)
        for (int j = 0; j < m; ++j) x[a] += W[a * m + j] * found[j];
    return 0;
}

/* the nearest state whose closed gaps are zero and, where ``still`` is there, stay so and do not slip; it is seen */
static int land(const Given *at, double *x, const int *closed, const int *still, Seen *s)
{
    double J[TWO][N], wanted[TWO];
    int m;
    for (int round = 0; round < 3; ++round) {
        double worst = 0.0;
        contacts_look(at, x, s);
        m = 0;
        for (int i = 0; i < K; ++i) {
            if (!closed[i]) continue;
            memcpy(J[m], s->rows[i][0], sizeof J[m]);
            wanted[m++] = -s->gap[i];
            worst = fmax(worst, fabs(s->gap[i]));
        }
        if (worst <= 1e-16) break;
        if (change(s, m, J, wanted, x)) return 1;
    }
    if (still != NULL) {
        m = 0;
        for (int r = 0; r < 2; ++r)
            for (int i = 0; i < K; ++i) {
                if (r ? !(still[i] && drags(i)) : !closed[i]) continue;
                memcpy(J[m], s->rows[i][r], sizeof J[m]);
                wanted[m++] = -velocity(s, x, i, r);
            }
        if (change(s, m, J, wanted, x + N)) return 1;
    }
    contacts_look(at, x, s);
    return 0;
}

/* w = A p + b of some contacts, with rows F of their forces */
static int cones_of(const Seen *s, int k, const int *some, double F[][N], Cones *c)
{
    double G[TWO][N], W[N * TWO];
    c->count = k;
    for (int j = 0; j < k; ++j) {
        for (int r = 0; r < 2; ++r) memcpy(G[2 * j + r], s->rows[some[j]][r], sizeof G[0]);
        c->friction[j] = FMU_FRICTION[some[j]];
        c->yields[j] = yield_of(s, some[j]);
    }
    if (weighed(s, 2 * k, F, W)) return 1;
    product(2 * k, G, W, c->A);
    return 0;
}

/* the state after an impact of some contacts; 0, or 1 */
static int hit(Contacts *c, double t, double *x, int k, const int *some, const Seen *s)
{
    Cones cones;
    double G[TWO][N], W[N * TWO], L[TWO], largest = 0.0, before[N];
    for (int j = 0; j < k; ++j) {
        int i = some[j];
        double u = velocity(s, x, i, 0), rebound = -u <= FMU_REST_VELOCITY[i] ? 0.0 : FMU_RESTITUTION[i];
        cones.drags[j] = drags(i);
        cones.b[2 * j] = u + rebound * fmin(u, 0.0), cones.b[2 * j + 1] = velocity(s, x, i, 1);
        for (int r = 0; r < 2; ++r) memcpy(G[2 * j + r], s->rows[i][r], sizeof G[0]);
    }
    if (cones_of(s, k, some, G, &cones) || coulomb(&cones, L) || weighed(s, 2 * k, G, W)) return 1;
    memcpy(before, x + N, sizeof before);
    for (int j = 0; j < 2 * k; ++j)
        for (int a = 0; a < N; ++a) x[N + a] += W[a * 2 * k + j] * L[j];
    for (int j = 0; j < k; ++j) largest = fmax(largest, fabs(L[2 * j]));
    for (int j = 0; j < k; ++j) {
        if (L[2 * j] > LIGHT * largest) c->impacts += 1.0, c->last = t;
        for (int r = 0; r < 2; ++r)
            for (int a = 0; a < N; ++a) c->energy += 0.5 * (before[a] + x[N + a]) * G[2 * j + r][a] * L[2 * j + r];
    }
    return 0;
}

/* which of some closed contacts stay closed, and who of those that are still sticks; 0, or 1 */
static int hold(Contacts *c, const Given *at, const double *x, int k, const int *some, const int *still, const Seen *s)
{
    Cones cones;
    double F[TWO][N], p[TWO], free[N], force[K][2], rates[2 * N], v[K], size = LEAST, largest = 0.0, most_b = 0.0;
    fmu_dynamics(at->t, x, x + N, at->u, at->p, rates, free, rates + N);
    for (int j = 0; j < k; ++j) {
        int i = some[j];
        v[j] = drags(i) && !still[i] ? copysign(1.0, velocity(s, x, i, 1)) : 0.0;
        cones.drags[j] = drags(i) && still[i];
        for (int r = 0; r < 2; ++r) {
            cones.b[2 * j + r] = s->bias[i][r];
            for (int a = 0; a < N; ++a) {
                cones.b[2 * j + r] += s->rows[i][r][a] * free[a];
                F[2 * j + r][a] = s->rows[i][r][a] - (r ? 0.0 : FMU_FRICTION[i] * v[j] * s->rows[i][1][a]);
            }
            most_b = fmax(most_b, fabs(cones.b[2 * j + r]));
        }
    }
    if (cones_of(s, k, some, F, &cones) || coulomb(&cones, p)) return 1;
    for (int j = 0; j < 2 * k; ++j) {
        double whole = fabs(cones.b[j]);
        for (int l = 0; l < 2 * k; ++l) whole += fabs(cones.A[j * 2 * k + l] * p[l]);
        size = fmax(size, whole), largest = fmax(largest, j % 2 ? 0.0 : p[j]);
    }
    for (int j = 0; j < k; ++j) {
        int i = some[j], begins;
        double w = cones.b[2 * j + 1];
        for (int l = 0; l < 2 * k; ++l) w += cones.A[(2 * j + 1) * 2 * k + l] * p[l];
        begins = cones.drags[j] && fabs(w) > NONE * size;
        /* what is not pressed has no force, also where it only touches */
        c->mode[i] = !(p[2 * j] > LIGHT * largest) ? OPEN : cones.drags[j] && !begins ? STICK : SLIP;
        c->way[i] = begins ? copysign(1.0, w) : v[j];
        c->scale[i] = fmax(p[2 * j], most_b / cones.yields[j]);
    }
    /* of forces that are not unique: who would pull is open, who would drag more than it can drags what it can */
    for (int round = 0; round < 2 * k; ++round) {
        int changed = 0;
        double trial[N];
        memcpy(trial, free, sizeof trial);
        if (contacts_act(c, at, x, trial, force)) return 1;
        for (int i = 0; i < K; ++i) {
            double edge = 0.5 * EDGE * c->scale[i];
            if (c->mode[i] < STICK) continue;
            if (force[i][0] < -edge) c->mode[i] = OPEN, changed = 1;
            else if (c->mode[i] == STICK && fabs(force[i][1]) > FMU_FRICTION[i] * force[i][0] + edge)
                c->mode[i] = FULL, c->way[i] = -copysign(1.0, force[i][1]), changed = 1;
        }
        if (!changed) break;
    }
    return 0;
}

/* contacts that touch, and begin or end to pass; those that slipped back, or drifted a little, are at rest */
static int touching(Contacts *c, const Given *at, double *x, int *touch, int *stopped, int *comes, Seen *s)
{
    int kept[K], still[K], some = 0, count = 0;
    contacts_look(at, x, s);
    for (int i = 0; i < K; ++i) {
        double v = velocity(s, x, i, 0), v_T = drags(i) ? velocity(s, x, i, 1) : 0.0;
        kept[i] = c->mode[i] >= STICK && fabs(v) <= FMU_REST_VELOCITY[i];
        stopped[i] = kept[i] && c->mode[i] == SLIP && drags(i) && c->way[i] * v_T < 0.0;
        still[i] = stopped[i] || (kept[i] && c->mode[i] == STICK && fabs(v_T) <= FMU_REST_VELOCITY[i]);
        some |= kept[i];
    }
    if (some && land(at, x, kept, still, s)) return -1;
    for (int i = 0; i < K; ++i) {
        double v = velocity(s, x, i, 0);
        int here;
        if (c->mode[i] == PASSING && s->gap[i] >= -TOUCHING && v > 0.0) c->mode[i] = OPEN;
        here = c->mode[i] == OPEN && s->gap[i] <= TOUCHING && v <= rest_of(i);
        if (here && !(s->acts[i] > 0.0)) c->mode[i] = PASSING, here = 0;
        touch[i] = c->mode[i] >= STICK || here;
        count += touch[i];
        if (touch[i] && v < -approach_of(i)) *comes = 1;
    }
    return count;
}

int contacts_decide(Contacts *c, const Given *at, double *x)
{
    Seen s;
    double start[2 * N];
    int touch[K], stopped[K], closed[K], still[K], some[K], was[K], comes = 0, count, k = 0;
    memcpy(start, x, sizeof start);
    for (int i = 0; i < K; ++i) was[i] = c->mode[i] >= STICK;
    count = touching(c, at, x, touch, stopped, &comes, &s);
    for (int i = 0; i < K && !c->has_begun; ++i)
        if (c->mode[i] == OPEN && s.acts[i] > 0.0 && s.gap[i] < -BELOW) return CONTACTS_BELOW;
    c->has_begun = c->is_decided = 1;
    if (count < 0) return CONTACTS_JAMMED;
    for (int i = 0; i < K; ++i)
        if (touch[i]) some[k++] = i;
    if (k > 0) {
        if (land(at, x, touch, NULL, &s)) return CONTACTS_JAMMED;
        if (comes && hit(c, at->t, x, k, some, &s)) return CONTACTS_JAMMED;
        k = 0;
        for (int i = 0; i < K; ++i) {
            double v_T = drags(i) ? velocity(&s, x, i, 1) : 0.0;
            closed[i] = touch[i] && fabs(velocity(&s, x, i, 0)) <= approach_of(i);
            still[i] = closed[i] && fabs(v_T) <= approach_of(i);
            if (touch[i]) c->mode[i] = OPEN;
            if (closed[i]) some[k++] = i;
        }
        if (k > 0 && land(at, x, closed, still, &s)) return CONTACTS_JAMMED;
        if (k > 0 && hold(c, at, x, k, some, still, &s)) return CONTACTS_JAMMED;
    }
    for (int i = 0; i < K; ++i) {
        double v = velocity(&s, x, i, 0);
        double least = was[i] && !comes ? c->margin : v <= rest_of(i) ? SLOW : rebound_of(v);
        c->offset[i] = c->mode[i] == OPEN && s.gap[i] <= TOUCHING ? least - s.gap[i] : 0.0;
    }
    return memcmp(start, x, sizeof start) != 0;
}
