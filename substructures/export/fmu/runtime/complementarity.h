/* Contact forces, or impulses, and what they leave. */
#ifndef SUBSTRUCTURES_COMPLEMENTARITY_H
#define SUBSTRUCTURES_COMPLEMENTARITY_H

#include "model.h"

enum { ROWS = 3 * FMU_CONTACTS, LARGEST = FMU_NQ > ROWS ? FMU_NQ : ROWS };

/* w = A p + b of ``count`` contacts, each with its normal and two tangents; how many of these there are: none where a
   point has no friction, or slips already, as its friction is a part of what its normal force does */
typedef struct {
    int count, tangents[FMU_CONTACTS];
    double A[ROWS * ROWS], b[ROWS], friction[FMU_CONTACTS], yields[FMU_CONTACTS];
} Cones;

/* B (n, m) becomes A^-1 B; 0, or 1 where A (n, n) is singular; n: LARGEST at most */
int solve(int n, const double *A, int m, double *B);
/* x with A x = b; where many do, that of rows that yield a little; 0, or 1 */
int solve_least(int n, const double *A, const double *b, const double *yields, double *x);
/* w = A p + b with other A and b; the largest |A| |p| + |b|, of which it is the rest */
double left_by(const Cones *c, const double *A, const double *b, const double *p, double *w);
/* p by which all conditions of Coulomb's law hold; 0, or 1 where there is none */
int coulomb(const Cones *c, double *p);

#endif
