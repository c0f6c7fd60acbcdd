/* Mode changes: the root functions that tell of them and the rules that follow.
 *
 * One root function a mass, and with friction a second one:
 *
 *   free       gap                       touch
 *   contact    F_N                       lift
 *   slipping   σ ẋ                       stop
 *   sticking   T(0) - |f.t|              break
 *
 * each falling through 0. Each is raised by a margin well inside the tolerances, so that right after its own event it
 * is above 0. */
#ifndef EVENTS_H
#define EVENTS_H

#include "layer.h"

typedef struct {
  double gap, force, speed; /* of the root functions; m, N, m/s */
} Margins;

typedef struct {
  Layer *layer;
  Margins margin;
  double *gap_margin;             /* of each mass: raised where a gap is closed by rounding */
  char *decided;                  /* of each mass at an instant; all 0 between */
  double *height;                 /* of the profile under each mass */
  long touch, lift, stop, break_; /* by their own root functions */
  long aside;                     /* modes that changed with another mass's event or a kink of the carrier's motion */
  long apart;                     /* gaps closed by rounding while the mass moves away: no touch */
  double impact;                  /* kinetic energy lost, J */
} Events;

/* Margins from the absolute tolerance of an elongation, m, and the vertical link's stiffness and frequency. */
Events events_new(Layer *layer, double tolerance, double stiffness, double frequency);

int events_count(const Layer *layer);

/* All root functions in the state y. */
void events_roots(Events *events, double t, const double *y, double *roots);

/* Whether a free mass that touches moves away: the error's doing, no touch. The layer's carrier is that of the time. */
int events_moves_apart(const Layer *layer, const double *y, int i);

/* Decides all contacts anew, as at the start or at a kink, and puts their motion into y. */
void events_settle(Events *events, double t, double *y);

/* The events that were found. Returns 0 where none was one: then nothing has changed but a margin. */
int events_handle(Events *events, double t, double *y, const int *found);

#endif
