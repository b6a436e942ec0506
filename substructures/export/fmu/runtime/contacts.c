/* Between events closed contacts keep their gaps, those that stick their places, and those that slip along d have the
 * friction -mu lambda_N d:
 *
 *     g q'' + Gamma q'q' = Q + (G_N - mu d . G_T)^T lambda_N + G_T^T lambda_T
 *
 * Impacts: q'+ = q'- + g^-1 G^T L, u_N+ = -e u_N- where L_N > 0, with Coulomb's law between impulses and velocities.
 */
#include "contacts.h"

#include <math.h>
#include <string.h>

#include "complementarity.h"

enum { K = FMU_CONTACTS, M = FMU_NQ, N = FMU_NV };
static const double FAST = 1e-4, APPROACH = 1e-2, CREEP = 1e-3, REST = 1e-6, TOUCHING = 1e-9, BELOW = 1e-6, EDGE = 1e-9;
static const double STOPS = 1e-2, GOES = 2.0, LIGHT = 1e-11, NONE = 1e-11, SLOW = 1e-11, DRIFT = 1e-9, LEAST = 1e-300;

/* of the velocity below which there is no restitution: what is an impact, and a slip that is none */
static double approach_of(int i)
{
    return APPROACH * fmin(FMU_REST_VELOCITY[i], FAST);
}

/* the speed below which a point does not slip */
static double creep_of(int i)
{
    return CREEP * fmin(FMU_REST_VELOCITY[i], FAST);
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

/* along how many tangents there is friction */
static int tangents(int i)
{
    return FMU_FRICTION[i] > 0.0 ? FMU_TANGENTS[i] : 0;
}

void contacts_look(const Given *at, const double *x, Seen *s)
{
    fmu_contacts(at->t, x, x + M, at->u, at->p, s->gap, &s->rows[0][0][0], &s->rate[0][0], &s->bias[0][0], s->acts,
                 &s->metric[0][0]);
}

static double velocity(const Seen *s, const double *x, int i, int r)
{
    double sum = s->rate[i][r];
    for (int a = 0; a < N; ++a) sum += s->rows[i][r][a] * x[M + a];
    return sum;
}

/* along the tangents with friction */
static void slip(const Seen *s, const double *x, int i, double *v)
{
    for (int r = 0; r < 2; ++r) v[r] = r < tangents(i) ? velocity(s, x, i, 1 + r) : 0.0;
}

static double size_of(const double *v)
{
    return hypot(v[0], v[1]);
}

static double dot(const double *v, const double *w)
{
    return v[0] * w[0] + v[1] * w[1];
}

/* of length 1, or 0 */
static void direction(const double *v, double *d)
{
    double size = size_of(v);
    for (int r = 0; r < 2; ++r) d[r] = size > 0.0 ? v[r] / size : 0.0;
}

/* whether a point has a way of its own, which ends at a speed above zero, before it is none */
static int turns(const Contacts *c, int i)
{
    return c->mode[i] == SLIP && tangents(i) == 2;
}

/* the way of a point with all of its friction; of others as before where they hardly move, or slip back after a stop */
static void way_of(const Contacts *c, const Seen *s, const double *x, int i, double *d)
{
    double v[2];
    slip(s, x, i, v);
    if (turns(c, i))
        for (int r = 0; r < 2; ++r) d[r] = v[r] / fmax(size_of(v), STOPS * creep_of(i));
    else if (size_of(v) > creep_of(i) && dot(v, c->way[i]) >= 0.0) direction(v, d);
    else memcpy(d, c->way[i], sizeof c->way[i]);
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

int contacts_act(const Contacts *c, const Given *at, const double *x, double *dv, double force[][3])
{
    Seen s;
    double J[ROWS][N], F[ROWS][N], W[N * ROWS], A[ROWS * ROWS], b[ROWS], yields[ROWS], found[ROWS], way[K][2];
    int of[ROWS], row[ROWS], normals = 0, m;
    memset(way, 0, sizeof way);
    for (int i = 0; i < K; ++i) {
        force[i][0] = force[i][1] = force[i][2] = 0.0;
        if (c->mode[i] >= STICK) of[normals++] = i;
    }
    if (normals == 0) return 0;
    contacts_look(at, x, &s);
    m = normals;
    for (int j = 0; j < normals; ++j) {
        int i = of[j];
        if (c->mode[i] >= FULL) way_of(c, &s, x, i, way[i]);
        row[j] = 0;
        for (int r = 1; r <= tangents(i) && c->mode[i] == STICK; ++r) of[m] = i, row[m++] = r;
    }
    for (int j = 0; j < m; ++j) {
        int i = of[j];
        yields[j] = yield_of(&s, i);
        memcpy(J[j], s.rows[i][row[j]], sizeof J[j]), memcpy(F[j], J[j], sizeof F[j]);
        for (int a = 0; a < N && j < normals; ++a)
            F[j][a] -= FMU_FRICTION[i] * (way[i][0] * s.rows[i][1][a] + way[i][1] * s.rows[i][2][a]);
        b[j] = -s.bias[i][row[j]];
        for (int a = 0; a < N; ++a) b[j] -= J[j][a] * dv[a];
    }
    if (weighed(&s, m, F, W)) return 1;
    product(m, J, W, A);
    if (solve_least(m, A, b, yields, found)) return 1;
    for (int j = 0; j < m; ++j) {
        int i = of[j];
        for (int a = 0; a < N; ++a) dv[a] += W[a * m + j] * found[j];
        force[i][row[j]] = found[j];
        for (int r = 0; r < 2 && j < normals; ++r) force[i][1 + r] = -FMU_FRICTION[i] * found[j] * way[i][r];
    }
    return 0;
}

void contacts_indicate(const Contacts *c, const Given *at, const double *x, double force[][3], double *found)
{
    Seen s;
    contacts_look(at, x, &s);
    for (int i = 0; i < K; ++i) {
        double *one = found + 2 * i, edge = EDGE * c->scale[i], v[2];
        one[0] = one[1] = 1.0;
        if (c->mode[i] == OPEN) one[0] = s.gap[i] + c->offset[i];
        else if (c->mode[i] == PASSING) one[0] = SLOW - s.gap[i];
        else one[0] = force[i][0] + edge;
        if (tangents(i) == 0) continue;
        slip(&s, x, i, v);
        if (c->mode[i] == STICK) one[1] = FMU_FRICTION[i] * force[i][0] - size_of(force[i] + 1) + edge;
        if (c->mode[i] >= SLIP) one[1] = dot(c->way[i], v) + rest_of(i);
        if (c->mode[i] == STARTS) one[1] = fmin(one[1], GOES * creep_of(i) - size_of(v));
        /* the way has turned by 60 degrees, or ends */
        if (turns(c, i))
            one[1] = fmin(dot(c->way[i], v) - 0.5 * size_of(v), size_of(v) - STOPS * creep_of(i));
    }
}

int contacts_drifted(const Contacts *c, const Given *at, const double *x)
{
    Seen s;
    contacts_look(at, x, &s);
    for (int i = 0; i < K; ++i) {
        double v[2];
        slip(&s, x, i, v);
        /* an importer that has not seen a zero */
        if (c->mode[i] == OPEN && s.gap[i] < -DRIFT && velocity(&s, x, i, 0) < 0.0) return 1;
        if (c->mode[i] < STICK) continue;
        if (fabs(s.gap[i]) > DRIFT || fabs(velocity(&s, x, i, 0)) > DRIFT) return 1;
        if (c->mode[i] == STICK && size_of(v) > DRIFT) return 1;
    }
    return 0;
}

/* d (N,) with J d = wanted, least in the metric; 0, or 1 */
static int change(const Seen *s, int m, double J[][N], const double *wanted, double *d)
{
    double W[N * ROWS], A[ROWS * ROWS], yields[ROWS], found[ROWS];
    for (int a = 0; a < N; ++a) d[a] = 0.0;
    if (m == 0) return 0;
    if (weighed(s, m, J, W)) return 1;
    product(m, J, W, A);
    for (int i = 0; i < m; ++i) yields[i] = A[i * m + i];
    if (solve_least(m, A, wanted, yields, found)) return 1;
    for (int a = 0; a < N; ++a)
        for (int j = 0; j < m; ++j) d[a] += W[a * m + j] * found[j];
    return 0;
}

/* q comes where a small displacement d (N,) leads: by q' at these rates, as quaternions turn */
static void displace(const Given *at, double *x, const double *d)
{
    double rates[M], second[N], unused[1];
    fmu_dynamics(at->t, x, d, at->u, at->p, rates, second, unused);
    for (int a = 0; a < M; ++a) x[a] += rates[a];
}

/* the nearest state whose closed gaps are zero and, where ``still`` is there, stay so and do not slip; it is seen */
static int land(const Given *at, double *x, const int *closed, const int *still, Seen *s)
{
    double J[ROWS][N], wanted[ROWS], d[N];
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
        if (change(s, m, J, wanted, d)) return 1;
        displace(at, x, d);
    }
    if (still != NULL) {
        m = 0;
        for (int r = 0; r < 3; ++r)
            for (int i = 0; i < K; ++i) {
                if (r ? !(still[i] && r <= tangents(i)) : !closed[i]) continue;
                memcpy(J[m], s->rows[i][r], sizeof J[m]);
                wanted[m++] = -velocity(s, x, i, r);
            }
        if (change(s, m, J, wanted, d)) return 1;
        for (int a = 0; a < N; ++a) x[M + a] += d[a];
    }
    contacts_look(at, x, s);
    return 0;
}

/* w = A p + b of some contacts, with rows F of their forces */
static int cones_of(const Seen *s, int k, const int *some, double F[][N], Cones *c)
{
    double G[ROWS][N], W[N * ROWS];
    c->count = k;
    for (int j = 0; j < k; ++j) {
        memcpy(G[3 * j], s->rows[some[j]], sizeof s->rows[0]);
        c->friction[j] = FMU_FRICTION[some[j]];
        c->yields[j] = yield_of(s, some[j]);
    }
    if (weighed(s, 3 * k, F, W)) return 1;
    product(3 * k, G, W, c->A);
    return 0;
}

/* the state after an impact of some contacts; 0, or 1 */
static int hit(Contacts *c, double t, double *x, int k, const int *some, const Seen *s)
{
    Cones cones;
    double G[ROWS][N], W[N * ROWS], L[ROWS], largest = 0.0, before[N];
    for (int j = 0; j < k; ++j) {
        int i = some[j];
        double u = velocity(s, x, i, 0), rebound = -u <= FMU_REST_VELOCITY[i] ? 0.0 : FMU_RESTITUTION[i];
        cones.tangents[j] = tangents(i);
        for (int r = 0; r < 3; ++r) cones.b[3 * j + r] = velocity(s, x, i, r);
        cones.b[3 * j] += rebound * fmin(u, 0.0);
        memcpy(G[3 * j], s->rows[i], sizeof s->rows[0]);
    }
    if (cones_of(s, k, some, G, &cones) || coulomb(&cones, L) || weighed(s, 3 * k, G, W)) return 1;
    memcpy(before, x + M, sizeof before);
    for (int j = 0; j < 3 * k; ++j)
        for (int a = 0; a < N; ++a) x[M + a] += W[a * 3 * k + j] * L[j];
    for (int j = 0; j < k; ++j) largest = fmax(largest, fabs(L[3 * j]));
    for (int j = 0; j < k; ++j) {
        if (L[3 * j] > LIGHT * largest) c->impacts += 1.0, c->last = t;
        for (int r = 3 * j; r < 3 * j + 3; ++r)
            for (int a = 0; a < N; ++a) c->energy += 0.5 * (before[a] + x[M + a]) * G[r][a] * L[r];
    }
    return 0;
}

/* which of some closed contacts stay closed, and who of those that are still sticks; 0, or 1 */
static int hold(Contacts *c, const Given *at, const double *x, int k, const int *some, const int *still, const Seen *s)
{
    Cones cones;
    double F[ROWS][N], p[ROWS], w[ROWS], free[N], force[K][3], rates[M], unused[1], size, largest = 0.0, most_b = 0.0;
    fmu_dynamics(at->t, x, x + M, at->u, at->p, rates, free, unused);
    for (int j = 0; j < k; ++j) {
        int i = some[j];
        double v[2] = {0.0, 0.0}, *d = c->way[i];
        if (!still[i]) slip(s, x, i, v);
        direction(v, d);
        cones.tangents[j] = still[i] ? tangents(i) : 0;
        for (int r = 0; r < 3; ++r) {
            double *b = cones.b + 3 * j + r;
            *b = s->bias[i][r];
            for (int a = 0; a < N; ++a) *b += s->rows[i][r][a] * free[a];
            most_b = fmax(most_b, fabs(*b));
        }
        memcpy(F[3 * j], s->rows[i], sizeof s->rows[0]);
        for (int a = 0; a < N; ++a)
            F[3 * j][a] -= FMU_FRICTION[i] * (d[0] * s->rows[i][1][a] + d[1] * s->rows[i][2][a]);
    }
    if (cones_of(s, k, some, F, &cones) || coulomb(&cones, p)) return 1;
    size = left_by(&cones, cones.A, cones.b, p, w);
    for (int j = 0; j < k; ++j) largest = fmax(largest, p[3 * j]);
    for (int j = 0; j < k; ++j) {
        int i = some[j], drags = cones.tangents[j];
        double w_T[2] = {drags > 0 ? w[3 * j + 1] : 0.0, drags > 1 ? w[3 * j + 2] : 0.0};
        int begins = size_of(w_T) > NONE * size;
        /* what is not pressed has no force, also where it only touches */
        c->mode[i] = !(p[3 * j] > LIGHT * largest) ? OPEN : drags && !begins ? STICK : SLIP;
        if (begins) direction(w_T, c->way[i]);
        if (begins && drags == 2 && c->mode[i] == SLIP) c->mode[i] = STARTS;
        c->scale[i] = fmax(p[3 * j], most_b / cones.yields[j]);
    }
    /* of forces that are not unique: who would pull is open, who would drag more than it can drags what it can */
    for (int round = 0; round < 2 * k; ++round) {
        int changed = 0;
        double trial[N];
        memcpy(trial, free, sizeof trial);
        if (contacts_act(c, at, x, trial, force)) return 1;
        for (int i = 0; i < K; ++i) {
            double edge = 0.5 * EDGE * c->scale[i], back[2] = {-force[i][1], -force[i][2]};
            if (c->mode[i] < STICK) continue;
            if (force[i][0] < -edge) c->mode[i] = OPEN, changed = 1;
            else if (c->mode[i] == STICK && size_of(back) > FMU_FRICTION[i] * force[i][0] + edge)
                c->mode[i] = FULL, direction(back, c->way[i]), changed = 1;
        }
        if (!changed) break;
    }
    return 0;
}

/* contacts that touch, and begin or end to pass; those that slipped back, or drifted a little, are at rest */
static int touching(Contacts *c, const Given *at, double *x, int *touch, int *comes, Seen *s)
{
    int kept[K], still[K], some = 0, count = 0;
    contacts_look(at, x, s);
    for (int i = 0; i < K; ++i) {
        double v = velocity(s, x, i, 0), v_T[2], back;
        slip(s, x, i, v_T);
        back = -dot(c->way[i], v_T);
        kept[i] = c->mode[i] >= STICK && fabs(v) <= FMU_REST_VELOCITY[i];
        /* not one whose way has turned */
        still[i] = kept[i] && c->mode[i] >= SLIP && back > 0.5 * size_of(v_T);
        still[i] |= kept[i] && c->mode[i] == STICK && size_of(v_T) <= FMU_REST_VELOCITY[i];
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
    double start[M + N];
    int touch[K], closed[K], still[K], some[K], was[K], comes = 0, count, k = 0;
    memcpy(start, x, sizeof start);
    for (int i = 0; i < K; ++i) was[i] = c->mode[i] >= STICK;
    count = touching(c, at, x, touch, &comes, &s);
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
            double v_T[2];
            slip(&s, x, i, v_T);
            closed[i] = touch[i] && fabs(velocity(&s, x, i, 0)) <= approach_of(i);
            still[i] = closed[i] && size_of(v_T) <= creep_of(i);
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
