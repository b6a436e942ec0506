/* The state of one simulation and what is computed of it; the same for both versions of the interface.
 *
 * All numbers of an instance stand in one array, in the order of the variables of modelDescription.xml:
 *
 *     t | q | v | der(q) | der(v) | q'' | u | p | solver_step, solver_tolerance | contacts | outputs
 *
 * v: velocities of all coordinates, FMU_NA is 0 then and q'' is der(v), with ball joints rates of all joints, and q has
 * their quaternions; or, with velocity constraints, v of the independent ones.
 */
#ifndef SUBSTRUCTURES_SIMULATION_H
#define SUBSTRUCTURES_SIMULATION_H

#include <stddef.h>

#include "model.h"
#if FMU_CONTACTS > 0
#include "contacts.h"
#endif

enum {
    AT_T = 0,
    AT_Q = 1,
    AT_V = AT_Q + FMU_NQ,
    AT_DQ = AT_V + FMU_NV,
    AT_DV = AT_DQ + FMU_NQ,
    AT_U = AT_DV + FMU_NV + FMU_NA,
    /* velocities and accelerations of all coordinates, on which outputs depend */
    AT_QD = FMU_NA ? AT_DQ : AT_V,
    AT_QDD = FMU_NA ? AT_DV + FMU_NV : AT_DV,
    AT_P = AT_U + FMU_NU,
    AT_STEP = AT_P + FMU_NP,
    AT_TOLERANCE = AT_STEP + 1,
    /* of each contact its gap, its force along the normal and two tangents, and its event indicators; then the energy
       that impacts have changed, their number, and when the last one was */
    AT_C = AT_TOLERANCE + 1,
    OF_CONTACT = 6,
    AT_Y = AT_C + (FMU_CONTACTS ? OF_CONTACT * FMU_CONTACTS + 3 : 0),
    FMU_INDICATORS = 2 * FMU_CONTACTS,
    VALUES = AT_Y + FMU_NY,
    STATES = FMU_NQ + FMU_NV
};

/* what may be written: states and inputs, parameters, time */
enum { PHASE_NEW, PHASE_INITIALISING, PHASE_READY, PHASE_ENDED };

typedef struct {
    double v[VALUES];
    double next;      /* step that the adaptive solver tries next; 0: none was made yet */
    int has_rates;    /* der(q), der(v), q'' belong to the state */
    int has_outputs;
    int phase;
#if FMU_CONTACTS > 0
    Contacts contacts;
#endif
} State;

void state_reset(State *s);
/* 0, or 1 where the value may not be written */
int state_write(State *s, size_t at, double value);
/* 0, or 1 where accelerations are not finite */
int state_rates(State *s);
int state_outputs(State *s);
/* 0, or 1 where a value cannot be had */
int state_read(State *s, size_t at, double *value);
/* derivatives of values in the direction of others; 0, or 1 for those that have none */
int state_tangent(State *s, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns, size_t n_knowns,
                  const double *seed, double *found);
/* 0, 1 where the state has changed, or less than 0 where there is no way on, which ``why`` tells */
int state_decide(State *s, const char **why);
/* 1 where the state has to be decided about again */
int state_drifted(State *s);
/* 0, or 1 where a value cannot be had */
int state_indicators(State *s, double *found);
/* to a later time with constant inputs; 0, or 1 where accelerations are not finite, steps become too small, or contacts know
   no way on, which ``why`` tells */
int state_advance(State *s, double to, const char **why);

#endif
