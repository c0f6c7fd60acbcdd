/* The first event of a step, located here and not by SUNDIALS: all root functions at the step's end alone, and where
 * some have changed sign, those few on the interpolated motion. A root that has been passed by less than a fraction of
 * the tolerance counts as at 0, at the step's end, too: most events then need no location. */
#ifndef LOCATE_H
#define LOCATE_H

#include <nvector/nvector_serial.h>

#include "events.h"

/* Puts the state at time t of the last step into y. */
typedef void Interpolate(void *integrator, double t, N_Vector y);

typedef struct {
  Events *events;
  Interpolate *interpolate;
  void *integrator;
  double passed;          /* the fraction of the tolerance */
  Margins tolerance;      /* of the root functions */
  double *before, *after; /* root functions at the start and the end of the step */
  int *candidate, *found; /* root functions that changed sign; of all, whether there is an event */
  N_Vector state;         /* the state interpolated last */
  double state_at;        /* its time */
  long interpolations;
} Locator;

Locator locator_new(Events *events, Interpolate *interpolate, void *integrator, N_Vector model);

/* A step will begin in the state y. */
void locator_begin(Locator *locator, double t, const double *y);

/* Of the step from t0 to t1, whose end is y: the time of the first event, or INFINITY. The state there is `state`
 * unless it is the end. */
double locator_first(Locator *locator, double t0, double t1, const double *y);

/* Time from the step's start until a free mass touches, by its place, speed and acceleration, or INFINITY; the layer is
 * evaluated at the start. */
double locator_foresee(const Locator *locator);

#endif
