/* Mode changes: the root functions that find them and the rules that follow.
 *
 * One root function a mass, and with friction a second one:
 *
 *   free       gap                       touch
 *   contact    F_N                       lift
 *   slipping   σ ẋ                       stop
 *   sticking   T(0) - |f.t|              break
 *
 * each falling through 0. Each is raised by a margin well inside the tolerances, so that right after its own event it
 * is above 0: CVODE leaves out a root function that starts at 0. */
#ifndef EVENTS_H
#define EVENTS_H

#include "linear.h"

typedef struct {
  long touch, lift, stop, break_; /* found by CVODE */
  long aside;                     /* modes that changed with another mass's event or a kink of the carrier's motion */
  long apart;                     /* gaps closed by rounding while the mass moves away: no touch */
  double impact;                  /* kinetic energy lost, J */
} Events;

/* Margins from the absolute tolerance, m. */
void events_set_margins(Problem *problem, double tolerance, double stiffness, double frequency);

int events_count(const Layer *layer);
int events_roots(double t, N_Vector y, double *roots, void *problem);

/* Decides all contacts anew, as at the start or at a kink, and puts their motion into y. */
void events_settle(Problem *problem, Events *events, double t, double *y);

/* The events that CVODE has found. Returns 0 where none was one: then nothing has changed but a margin. */
int events_handle(Problem *problem, Events *events, double t, double *y, const int *found);

#endif
