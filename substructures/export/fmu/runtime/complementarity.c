/* Small dense systems, and Coulomb's law as a linear complementarity problem (Stewart and Trinkle 1996), from whose
 * facets Newton's method leads to the cones of points that slip in two directions (Alart and Curnier 1991). */
#include "complementarity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ZERO = 1e-12, MET = 1e-9, SOFT = 1e-8, EXACT = 1e-14, ROUNDING = 4e-16, LEAST = 1e-300;
static const double TURN = 6.283185307179586 / 64.0, SHARES[] = {1.0, 0.5, 0.25, 0.1, 0.03, 0.01};
/* FACETS of a cone, TURNS of these and YIELDING steps where Newton's method leads nowhere from there */
enum { ROUNDS = 30, FACETS = 8, TURNS = 8, NEWTON = 100, YIELDING = 9 };
enum { COLUMNS = (1 + FACETS) * FMU_CONTACTS, SIDE = COLUMNS + FMU_CONTACTS };

int solve(int n, const double *A, int m, double *B)
{
    double T[LARGEST * LARGEST];
    memcpy(T, A, sizeof(double) * (size_t)(n * n));
    for (int k = 0; k < n; ++k) {
        int best = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(T[i * n + k]) > fabs(T[best * n + k])) best = i;
        if (!(fabs(T[best * n + k]) > 0.0)) return 1;
        for (int j = 0; j < n && best != k; ++j) {
            double kept = T[k * n + j];
            T[k * n + j] = T[best * n + j], T[best * n + j] = kept;
        }
        for (int j = 0; j < m && best != k; ++j) {
            double kept = B[k * m + j];
            B[k * m + j] = B[best * m + j], B[best * m + j] = kept;
        }
        for (int i = k + 1; i < n; ++i) {
            double factor = T[i * n + k] / T[k * n + k];
            for (int j = k + 1; j < n; ++j) T[i * n + j] -= factor * T[k * n + j];
            for (int j = 0; j < m; ++j) B[i * m + j] -= factor * B[k * m + j];
        }
    }
    for (int j = 0; j < m; ++j)
        for (int i = n; i-- > 0;) {
            double sum = B[i * m + j];
            for (int l = i + 1; l < n; ++l) sum -= T[i * n + l] * B[l * m + j];
            B[i * m + j] = sum / T[i * n + i];
        }
    return 0;
}

int solve_least(int n, const double *A, const double *b, const double *yields, double *x)
{
    double soft[ROWS * ROWS], left[ROWS];
    memcpy(soft, A, sizeof(double) * (size_t)(n * n));
    for (int i = 0; i < n; ++i) {
        soft[i * n + i] += SOFT * fmax(yields[i], LEAST);
        x[i] = 0.0, left[i] = b[i];
    }
    for (int round = 0; round < ROUNDS && n > 0; ++round) {
        double worst = 0.0, size = 0.0;
        if (solve(n, soft, 1, left)) return 1;
        for (int i = 0; i < n; ++i) x[i] += left[i];
        for (int i = 0; i < n; ++i) {
            double sum = b[i], whole = fabs(b[i]);
            for (int j = 0; j < n; ++j) {
                sum -= A[i * n + j] * x[j];
                whole += fabs(A[i * n + j] * x[j]);
            }
            left[i] = sum;
            worst = fmax(worst, fabs(sum)), size = fmax(size, whole);
        }
        if (!(worst > ROUNDING * size)) break;
    }
    return 0;
}

/* z >= 0 with M z + q >= 0 and z . (M z + q) = 0 by Lemke's pivoting, ties by the lexicographic rule (Cottle, Pang,
   Stone 1992, 4.4); T: rows 1 | -M | -1 | q of n, which are worked on; 1 where it ends on a ray */
static int lemke(int n, double *T, int *basis, double *z)
{
    int row = 0, entering = 2 * n, width = 2 * n + 2, some[SIDE];
    for (int i = 0; i < n; ++i) {
        z[i] = 0.0, basis[i] = i;
        if (T[i * width + width - 1] < T[row * width + width - 1]) row = i;
    }
    if (n == 0 || T[row * width + width - 1] >= 0.0) return 0;
    for (int count = 0; count < 50 * (n + 1); ++count) {
        int leaving = basis[row], candidates = 0;
        double pivot = T[row * width + entering], largest = 1.0;
        basis[row] = entering;
        for (int j = 0; j < width; ++j) T[row * width + j] /= pivot;
        for (int i = 0; i < n; ++i) {
            double factor = T[i * width + entering];
            for (int j = 0; j < width && i != row; ++j) T[i * width + j] -= factor * T[row * width + j];
        }
        if (leaving == 2 * n) {
            for (int i = 0; i < n; ++i)
                if (basis[i] >= n && basis[i] < 2 * n) z[basis[i] - n] = fmax(T[i * width + width - 1], 0.0);
            return 0;
        }
        entering = leaving < n ? leaving + n : leaving - n;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j) largest = fmax(largest, fabs(T[i * width + j]));
        for (int i = 0; i < n; ++i)
            if (T[i * width + entering] > ZERO * largest) some[candidates++] = i;
        if (candidates == 0) return 1;
        /* the column of q, then those of w, until one row is left */
        for (int by = -1; by < n && candidates > 1; ++by) {
            int column = by < 0 ? width - 1 : by, kept = 0;
            double least = INFINITY, ratios[SIDE];
            for (int i = 0; i < candidates; ++i) {
                ratios[i] = T[some[i] * width + column] / T[some[i] * width + entering];
                least = fmin(least, ratios[i]);
            }
            for (int i = 0; i < candidates; ++i)
                if (ratios[i] <= least + ZERO) some[kept++] = some[i];
            candidates = kept;
            for (int i = 0; i < candidates && by < 0; ++i)
                if (basis[some[i]] == 2 * n) some[0] = some[i], candidates = 1;
        }
        row = some[0];
    }
    return 1;
}

/* unit vectors D (2, m) of the friction of all contacts, turned by an angle, and whose they are; m */
static int facets(const Cones *c, double turn, double D[][2], int *of)
{
    int m = 0;
    for (int i = 0; i < c->count; ++i) {
        int count = c->tangents[i] == 2 ? FACETS : 2 * c->tangents[i];
        for (int f = 0; f < count; ++f, ++m) {
            double angle = turn + TURN * TURNS * f;
            of[m] = i;
            D[m][0] = count == 2 ? 1.0 - 2.0 * f : cos(angle), D[m][1] = count == 2 ? 0.0 : sin(angle);
        }
    }
    return m;
}

/* p of w = A p + b with facets in place of cones, z = (p_N, beta, gamma); 0, or 1 */
static int pressed(const Cones *c, const double *A, const double *b, double turn, double *p)
{
    double D[COLUMNS][2], z[SIDE], F[COLUMNS][3], *T;
    int k = c->count, three = 3 * k, of[COLUMNS], row[FMU_CONTACTS], basis[SIDE], m, n, width, wrong;
    m = facets(c, turn, D + k, of + k) + k;
    memset(F, 0, sizeof F);
    for (int s = 0; s < m; ++s) {
        if (s < k) of[s] = s, F[s][0] = 1.0;
        else F[s][1] = D[s][0], F[s][2] = D[s][1];
    }
    n = m;
    for (int i = 0; i < k; ++i) row[i] = c->tangents[i] ? n++ : -1;
    width = 2 * n + 2;
    T = calloc((size_t)(n * width), sizeof *T);
    if (T == NULL) return 1;
    for (int r = 0; r < n; ++r) T[r * width + r] = 1.0, T[r * width + 2 * n] = -1.0;
    for (int r = 0; r < m; ++r) {
        double *one = T + r * width;
        int i = of[r];
        for (int d = 0; d < 3; ++d) one[width - 1] += F[r][d] * b[3 * i + d];
        for (int s = 0; s < m; ++s)
            for (int d = 0; d < 3; ++d)
                for (int e = 0; e < 3; ++e)
                    one[n + s] -= F[r][d] * A[(3 * i + d) * three + 3 * of[s] + e] * F[s][e];
        if (r < k && row[r] >= 0) T[row[r] * width + n + r] = -c->friction[r];
        if (r >= k) one[n + row[i]] = -1.0, T[row[i] * width + n + r] = 1.0;
    }
    wrong = lemke(n, T, basis, z);
    free(T);
    for (int i = 0; i < three; ++i) p[i] = 0.0;
    for (int s = 0; s < m && !wrong; ++s)
        for (int d = 0; d < 3; ++d) p[3 * of[s] + d] += F[s][d] * z[s];
    return wrong;
}

double left_by(const Cones *c, const double *A, const double *b, const double *p, double *w)
{
    double size = LEAST;
    int n = 3 * c->count;
    for (int i = 0; i < n; ++i) {
        double whole = fabs(b[i]);
        w[i] = b[i];
        for (int j = 0; j < n; ++j) w[i] += A[i * n + j] * p[j], whole += fabs(A[i * n + j] * p[j]);
        size = fmax(size, whole);
    }
    return size;
}

/* the largest failure of a condition, relative */
static double violation(const Cones *c, const double *A, const double *b, const double *p)
{
    double w[ROWS], size = left_by(c, A, b, p, w), force = LEAST, worst = 0.0;
    for (int i = 0; i < 3 * c->count; ++i) force = fmax(force, fmax(fabs(p[i]), fabs(b[i])));
    for (int i = 0; i < c->count; ++i) {
        const double *w_i = w + 3 * i, *p_i = p + 3 * i;
        double most = c->friction[i] * p_i[0], slip = 0.0, drag = 0.0, along = 0.0;
        worst = fmax(worst, fmax(-w_i[0] / size, -p_i[0] / force));
        worst = fmax(worst, fabs(w_i[0] * p_i[0]) / (size * force));
        for (int r = 1; r <= c->tangents[i]; ++r)
            slip = hypot(slip, w_i[r]), drag = hypot(drag, p_i[r]), along += w_i[r] * p_i[r];
        if (c->tangents[i] == 0) continue;
        worst = fmax(worst, (drag - most) / force);
        /* what slips has all of its friction against its way */
        worst = fmax(worst, (slip * most + along) / (size * force));
    }
    return worst;
}

/* p less its projection, and where S is there the derivative (3k, 3k) of the projection by p - w; the largest of it */
static double missing(const Cones *c, const double *A, const double *b, const double *p, double *left, double *S)
{
    double w[ROWS], worst = 0.0;
    int n = 3 * c->count;
    left_by(c, A, b, p, w);
    if (S != NULL) memset(S, 0, sizeof(double) * (size_t)(n * n));
    for (int i = 0; i < c->count; ++i) {
        double near[3] = {0.0, 0.0, 0.0}, slopes[3][3] = {{0.0}}, y[3], size = 0.0, most;
        for (int d = 0; d < 3; ++d) y[d] = d <= c->tangents[i] ? p[3 * i + d] - w[3 * i + d] : 0.0;
        size = hypot(y[1], y[2]), most = c->friction[i] * y[0];
        if (y[0] > 0.0) near[0] = y[0], slopes[0][0] = 1.0;
        for (int d = 1; d <= c->tangents[i] && y[0] > 0.0; ++d) {
            int slips = size > most;
            near[d] = slips ? most * y[d] / size : y[d];
            slopes[d][0] = slips ? c->friction[i] * y[d] / size : 0.0;
            for (int e = 1; e <= c->tangents[i]; ++e)
                slopes[d][e] = slips ? most / size * ((d == e) - y[d] * y[e] / (size * size)) : d == e;
        }
        for (int d = 0; d < 3; ++d) {
            left[3 * i + d] = p[3 * i + d] - near[d];
            worst = fmax(worst, fabs(left[3 * i + d]));
            for (int e = 0; e < 3 && S != NULL; ++e) S[(3 * i + d) * n + 3 * i + e] = slopes[d][e];
        }
    }
    return worst;
}

/* p on Coulomb's cones, from facets of them: p_N = max(0, p_N - w_N), and p_T the point of the disc of radius
   mu max(0, p_N - w_N) nearest to p_T - w_T */
static void on_cones(const Cones *c, const double *A, const double *b, double *p)
{
    double S[ROWS * ROWS], M[ROWS * ROWS], step[ROWS], left[ROWS], trial[ROWS], size, before = INFINITY;
    int n = 3 * c->count;
    for (int count = 0; count < NEWTON; ++count) {
        size = missing(c, A, b, p, step, S);
        if (size <= EXACT || !(size < before)) return;
        before = size;
        /* 1 - S (1 - A) */
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                M[i * n + j] = (i == j) - S[i * n + j];
                for (int d = i / 3 * 3; d < i / 3 * 3 + 3; ++d) M[i * n + j] += S[i * n + d] * A[d * n + j];
            }
        if (solve(n, M, 1, step)) return;
        for (size_t s = 0; s < sizeof SHARES / sizeof *SHARES; ++s) {
            for (int i = 0; i < n; ++i) trial[i] = p[i] - SHARES[s] * step[i];
            if (missing(c, A, b, trial, left, NULL) < size) {
                memcpy(p, trial, sizeof(double) * (size_t)n);
                break;
            }
        }
    }
}

/* p of contacts that yield less and less, from where they hardly know of each other */
static void stiffened(const Cones *c, const double *A, const double *b, double *p)
{
    double soft[ROWS * ROWS];
    int n = 3 * c->count;
    memset(p, 0, sizeof(double) * (size_t)n);
    for (int step = 0; step < YIELDING; ++step) {
        memcpy(soft, A, sizeof(double) * (size_t)(n * n));
        for (int i = 0; i < n; ++i) soft[i * n + i] += pow(10.0, 1 - step);
        on_cones(c, soft, b, p);
    }
}

/* p of contacts that yield, from p, if that is not zero, from facets, or as above; 0, or 1 */
static int found(const Cones *c, const double *A, const double *b, double *p)
{
    int turns = 1, near = 0;
    for (int i = 0; i < c->count; ++i) {
        if (c->tangents[i] == 2) turns = TURNS;
        for (int d = 0; d < 3; ++d) near = near || p[3 * i + d] != 0.0;
    }
    for (int start = near ? -1 : 0; start <= turns; ++start) {
        if (start == 1) stiffened(c, A, b, p);
        else if (start >= 0 && pressed(c, A, b, TURN * (start ? start - 1 : 0), p))
            memset(p, 0, sizeof(double) * 3 * (size_t)c->count);
        on_cones(c, A, b, p);
        if (violation(c, A, b, p) <= MET) return 0;
    }
    return 1;
}

int coulomb(const Cones *c, double *p)
{
    double A[ROWS * ROWS], soft[ROWS * ROWS], b[ROWS], scale[ROWS], moved[ROWS], size = 0.0;
    int n = 3 * c->count;
    for (int i = 0; i < n; ++i) {
        scale[i] = 1.0 / sqrt(c->yields[i / 3]);
        size = fmax(size, fabs(c->b[i] * scale[i]));
    }
    if (!(size > 0.0)) size = 1.0;
    for (int i = 0; i < n; ++i) {
        b[i] = c->b[i] * scale[i] / size, p[i] = 0.0;
        for (int j = 0; j < n; ++j) A[i * n + j] = c->A[i * n + j] * scale[i] * scale[j];
    }
    memcpy(soft, A, sizeof soft);
    for (int i = 0; i < n; ++i) soft[i * n + i] += SOFT;
    /* what yields less and less */
    for (int round = 0; round < ROUNDS; ++round) {
        for (int i = 0; i < n; ++i) moved[i] = b[i] - SOFT * p[i];
        if (found(c, soft, moved, p)) return 1;
        if (violation(c, A, b, p) <= EXACT) break;
    }
    if (!(violation(c, A, b, p) <= MET)) return 1;
    for (int i = 0; i < n; ++i) p[i] *= scale[i] * size;
    return 0;
}
