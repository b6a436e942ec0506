/* Contact forces, or impulses, and what they leave. */
#ifndef SUBSTRUCTURES_COMPLEMENTARITY_H
#define SUBSTRUCTURES_COMPLEMENTARITY_H

#include "model.h"

enum { LARGEST = FMU_NQ > 2 * FMU_CONTACTS ? FMU_NQ : 2 * FMU_CONTACTS };

/* w = A p + b of ``count`` contacts, each with its normal and its tangent (which is there where it drags) */
typedef struct {
    int count, drags[FMU_CONTACTS];
    double A[4 * FMU_CONTACTS * FMU_CONTACTS], b[2 * FMU_CONTACTS], friction[FMU_CONTACTS], yields[FMU_CONTACTS];
} Cones;

/* B (n, m) becomes A^-1 B; 0, or 1 where A (n, n) is singular; n: LARGEST at most */
int solve(int n, const double *A, int m, double *B);
/* x with A x = b; where many do, that of rows that yield a little; 0, or 1 */
int solve_least(int n, const double *A, const double *b, const double *yields, double *x);
/* p by which all conditions of Coulomb's law hold; 0, or 1 where there is none */
int coulomb(const Cones *c, double *p);

#endif
