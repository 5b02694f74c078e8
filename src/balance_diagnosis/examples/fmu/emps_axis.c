/* The force that an electro-mechanical axis needs for its motion, as in ../emps_axis.py. */
#include <math.h>

enum { X, V, A, SIGN,  /* motion: m, m/s, m/s2, and the rounded sign of the speed */
       MASS, VISCOUS, COULOMB,
       OFFSET, BY_DIRECTION, COULOMB_BY_DIRECTION, BREAKAWAY, STRIBECK_SPEED, DRAG, ALONG, SPRING,
       FORCE, COUNT };

#define GUID "emps-axis"

static void start(double *v) {
    v[MASS] = 95.0, v[VISCOUS] = 200.0, v[COULOMB] = 20.0, v[STRIBECK_SPEED] = 0.01;
}

static void step(double *v, double time, double h) { (void)v, (void)time, (void)h; }

static void tell(double *v) {
    double along = v[VISCOUS] + v[BY_DIRECTION] * v[SIGN] + v[DRAG] * fabs(v[V]);
    double slow = v[V] / v[STRIBECK_SPEED];
    double friction = along * v[V] + (v[COULOMB] + v[ALONG] * v[X]) * v[SIGN];
    friction += v[COULOMB_BY_DIRECTION] * fabs(v[SIGN]) + v[BREAKAWAY] * v[SIGN] * exp(-slow * slow);
    v[FORCE] = v[MASS] * v[A] + friction + v[OFFSET] + v[SPRING] * v[X];
}

#include "fmi2.c"
