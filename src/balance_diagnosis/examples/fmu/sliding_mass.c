/* A mass that a force pushes against friction and, perhaps, a spring. */
#include <math.h>

enum { PUSH, MASS, VISCOUS, COULOMB, SPRING, X, V, SPEED, COUNT };

#define GUID "sliding-mass"

static void start(double *v) { v[MASS] = 10.0, v[VISCOUS] = 20.0, v[COULOMB] = 8.0; }

static double acceleration(const double *p, double x, double v) {
    double rub = p[COULOMB] * tanh(v / 0.01) + p[VISCOUS] * v;
    return (p[PUSH] - rub - p[SPRING] * x) / p[MASS];
}

static void step(double *v, double time, double h) {
    (void)time;
    double s = h / 4.0;
    for (int k = 0; k < 4; k++) { /* classical Runge-Kutta */
        double a1 = acceleration(v, v[X], v[V]), v2 = v[V] + 0.5 * s * a1;
        double a2 = acceleration(v, v[X] + 0.5 * s * v[V], v2), v3 = v[V] + 0.5 * s * a2;
        double a3 = acceleration(v, v[X] + 0.5 * s * v2, v3), v4 = v[V] + s * a3;
        double a4 = acceleration(v, v[X] + s * v3, v4);
        v[X] += s / 6.0 * (v[V] + 2.0 * v2 + 2.0 * v3 + v4);
        v[V] += s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
}

static void tell(double *v) { v[SPEED] = v[V]; }

#include "fmi2.c"
