/* Small dense systems, and Coulomb's law as a linear complementarity problem (Stewart and Trinkle 1996). */
#include "complementarity.h"

#include <math.h>
#include <string.h>

static const double ZERO = 1e-12, MET = 1e-9, SOFT = 1e-8, EXACT = 1e-14, ROUNDING = 4e-16, LEAST = 1e-300;
enum { ROUNDS = 30, SIDE = 4 * FMU_CONTACTS };

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
    double soft[2 * FMU_CONTACTS * 2 * FMU_CONTACTS], left[2 * FMU_CONTACTS];
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
   Stone 1992, 4.4); 1 where it ends on a ray */
static int lemke(int n, double M[][SIDE], const double *q, double *z)
{
    double T[SIDE][2 * SIDE + 2];
    int basis[SIDE], row = 0, entering = 2 * n, width = 2 * n + 2;
    for (int i = 0; i < n; ++i) {
        z[i] = 0.0;
        if (q[i] < q[row]) row = i;
    }
    if (n == 0 || q[row] >= 0.0) return 0;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) T[i][j] = i == j ? 1.0 : 0.0, T[i][n + j] = -M[i][j];
        T[i][2 * n] = -1.0, T[i][2 * n + 1] = q[i];
        basis[i] = i;
    }
    for (int count = 0; count < 50 * (n + 1); ++count) {
        int leaving = basis[row], candidates = 0, some[SIDE];
        double pivot = T[row][entering], largest = 1.0, least = INFINITY;
        basis[row] = entering;
        for (int j = 0; j < width; ++j) T[row][j] /= pivot;
        for (int i = 0; i < n; ++i) {
            double factor = T[i][entering];
            for (int j = 0; j < width && i != row; ++j) T[i][j] -= factor * T[row][j];
        }
        if (leaving == 2 * n) {
            for (int i = 0; i < n; ++i)
                if (basis[i] >= n && basis[i] < 2 * n) z[basis[i] - n] = fmax(T[i][width - 1], 0.0);
            return 0;
        }
        entering = leaving < n ? leaving + n : leaving - n;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j) largest = fmax(largest, fabs(T[i][j]));
        for (int i = 0; i < n; ++i)
            if (T[i][entering] > ZERO * largest) some[candidates++] = i;
        if (candidates == 0) return 1;
        /* the column of q, then those of w, until one row is left */
        for (int by = -1; by < n && candidates > 1; ++by) {
            int column = by < 0 ? width - 1 : by, kept = 0;
            least = INFINITY;
            for (int i = 0; i < candidates; ++i) least = fmin(least, T[some[i]][column] / T[some[i]][entering]);
            for (int i = 0; i < candidates; ++i)
                if (T[some[i]][column] / T[some[i]][entering] <= least + ZERO) some[kept++] = some[i];
            candidates = kept;
            for (int i = 0; i < candidates && by < 0; ++i)
                if (basis[some[i]] == 2 * n) some[0] = some[i], candidates = 1;
        }
        row = some[0];
    }
    return 1;
}

/* the same of w = A p + b with two facets of each tangent: z = (p_N, beta, gamma) */
static int pressed(const Cones *c, const double *A, const double *b, double *p)
{
    double M[SIDE][SIDE], q[SIDE], z[SIDE], F[2 * FMU_CONTACTS][3 * FMU_CONTACTS];
    int k = c->count, of[2 * FMU_CONTACTS], m = 0, n, two = 2 * k;
    memset(M, 0, sizeof M), memset(F, 0, sizeof F);
    for (int i = 0; i < k; ++i) F[2 * i][i] = 1.0;
    for (int i = 0; i < k; ++i)
        for (int side = 0; side < 2 && c->drags[i]; ++side, ++m) F[2 * i + 1][k + m] = side ? -1.0 : 1.0, of[m] = i;
    for (int r = 0; r < k + m; ++r) {
        q[r] = 0.0;
        for (int i = 0; i < two; ++i) {
            if (F[i][r] == 0.0) continue;
            q[r] += F[i][r] * b[i];
            for (int s = 0; s < k + m; ++s)
                for (int j = 0; j < two; ++j) M[r][s] += F[i][r] * A[i * two + j] * F[j][s];
        }
    }
    n = k + m;
    for (int i = 0; i < k; ++i) {
        if (!c->drags[i]) continue;
        for (int j = 0; j < m; ++j)
            if (of[j] == i) M[k + j][n] = 1.0, M[n][k + j] = -1.0;
        M[n][i] = c->friction[i], q[n] = 0.0;
        ++n;
    }
    if (lemke(n, M, q, z)) return 1;
    for (int i = 0; i < two; ++i) {
        p[i] = 0.0;
        for (int r = 0; r < k + m; ++r) p[i] += F[i][r] * z[r];
    }
    return 0;
}

/* the largest failure of a condition, relative; w: what is left */
static double violation(const Cones *c, const double *A, const double *b, const double *p)
{
    double w[2 * FMU_CONTACTS], size = LEAST, force = LEAST, worst = 0.0;
    int two = 2 * c->count;
    for (int i = 0; i < two; ++i) {
        double whole = fabs(b[i]);
        w[i] = b[i];
        for (int j = 0; j < two; ++j) w[i] += A[i * two + j] * p[j], whole += fabs(A[i * two + j] * p[j]);
        size = fmax(size, whole), force = fmax(force, fmax(fabs(p[i]), fabs(b[i])));
    }
    for (int i = 0; i < c->count; ++i) {
        double w_N = w[2 * i], w_T = w[2 * i + 1], p_N = p[2 * i], p_T = p[2 * i + 1], most = c->friction[i] * p_N;
        worst = fmax(worst, fmax(-w_N / size, -p_N / force));
        worst = fmax(worst, fabs(w_N * p_N) / (size * force));
        if (!c->drags[i]) continue;
        worst = fmax(worst, (fabs(p_T) - most) / force);
        worst = fmax(worst, (fabs(w_T) * most + w_T * p_T) / (size * force));
    }
    return worst;
}

int coulomb(const Cones *c, double *p)
{
    double A[4 * FMU_CONTACTS * FMU_CONTACTS], soft[4 * FMU_CONTACTS * FMU_CONTACTS], b[2 * FMU_CONTACTS];
    double scale[2 * FMU_CONTACTS], moved[2 * FMU_CONTACTS], size = 0.0;
    int two = 2 * c->count;
    for (int i = 0; i < two; ++i) {
        scale[i] = 1.0 / sqrt(c->yields[i / 2]);
        size = fmax(size, fabs(c->b[i] * scale[i]));
    }
    if (!(size > 0.0)) size = 1.0;
    for (int i = 0; i < two; ++i) {
        b[i] = c->b[i] * scale[i] / size, p[i] = 0.0;
        for (int j = 0; j < two; ++j) A[i * two + j] = c->A[i * two + j] * scale[i] * scale[j];
    }
    memcpy(soft, A, sizeof soft);
    for (int i = 0; i < two; ++i) soft[i * two + i] += SOFT;
    /* what yields less and less */
    for (int round = 0; round < ROUNDS; ++round) {
        for (int i = 0; i < two; ++i) moved[i] = b[i] - SOFT * p[i];
        if (pressed(c, soft, moved, p)) return 1;
        if (violation(c, A, b, p) <= EXACT) break;
    }
    if (!(violation(c, A, b, p) <= MET)) return 1;
    for (int i = 0; i < two; ++i) p[i] *= scale[i] * size;
    return 0;
}
