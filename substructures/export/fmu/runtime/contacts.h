/* Contacts of points with planes or lines: impacts, sticking, slipping, lifting off. */
#ifndef SUBSTRUCTURES_CONTACTS_H
#define SUBSTRUCTURES_CONTACTS_H

#include "model.h"

enum {
    PASSING = -1, /* below its plane, where it did not act when it came there */
    OPEN = 0,
    STICK = 1,
    FULL = 2, /* has all of its friction, as one that slips, but others hold it */
    SLIP = 3,
    STARTS = 4 /* slips from rest in two directions */
};

/* what contacts do; way: the unit vector along which a point slips */
typedef struct {
    int mode[FMU_CONTACTS];
    double way[FMU_CONTACTS][2];
    double scale[FMU_CONTACTS];
    double offset[FMU_CONTACTS]; /* of a gap that has just opened */
    int is_decided, has_begun;
    double margin; /* offset of a gap that lifts off: above the errors of the first steps of whoever integrates */
    double energy; /* changed by impacts so far */
    double impacts, last; /* how many, and when the last one was */
} Contacts;

/* what is seen of them at a state */
typedef struct {
    double gap[FMU_CONTACTS], rows[FMU_CONTACTS][3][FMU_NV], rate[FMU_CONTACTS][3], bias[FMU_CONTACTS][3];
    double acts[FMU_CONTACTS], metric[FMU_NV][FMU_NV];
} Seen;

typedef struct {
    double t;
    const double *u, *p;
} Given;

void contacts_look(const Given *at, const double *x, Seen *s);
/* adds what contact forces (normal, two tangents) do to the accelerations; 0, or 1 where these are not found */
int contacts_act(const Contacts *c, const Given *at, const double *x, double *dv, double force[][3]);
/* FMU_INDICATORS numbers that are positive until something happens; force: of contacts_act */
void contacts_indicate(const Contacts *c, const Given *at, const double *x, double force[][3], double *found);
/* 1 where the state has left closed contacts, or has come below a plane */
int contacts_drifted(const Contacts *c, const Given *at, const double *x);
/* impacts, and who touches, sticks and slips from here on: 0, 1 where the state has changed, or less than 0 */
int contacts_decide(Contacts *c, const Given *at, double *x);

enum { CONTACTS_BELOW = -1, CONTACTS_JAMMED = -2 };
#define SAY_BELOW "the point of a contact starts below its plane: raise it"
#define SAY_JAMMED "no contact forces were found that agree with Coulomb's law (the contact jams): take less friction"

#endif
