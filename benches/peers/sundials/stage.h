/* The nonlinear system of a step of CVODES or of a stage of ARKODE, solved whole: Maxwell elements and positions
 * eliminated, Newton's iterations on the rates of the masses alone, of which only slipping ones are nonlinear, and
 * everything else filled in by one pass. */
#ifndef STAGE_H
#define STAGE_H

#include <nvector/nvector_serial.h>

#include "jacobian.h"

/* z = p + factor q + γ f(t, z). */
typedef struct {
  double t, gamma, factor;
  const double *p, *q;
  const double *weights; /* of the error test */
  double tolerance;      /* of a residual, in the error test's norm */
  int guess_from_p;      /* Newton's iterations start from the rates in p, else from the accelerations found last */
  int correction_wanted; /* what is wanted beside z: its correction to p, else f(t, z) */
  double *z, *beside;
} System;

typedef struct {
  Layer *layer;
  Jacobian *jacobian;
  long factored_at_changes; /* the layer's count of mode changes when the factors were made, or -1: none */
  int factors_are_old;      /* they are of another stage */
  double *star[4];          /* p + factor q of e_x, e_z, r_x, r_z */
  double *kept[KINDS];      /* what the elements' pasts add to the links' forces */
  double *x_acceleration, *z_acceleration; /* r_x, r_z by time, found last */
  long solved, iterations;
} Stage;

Stage *stage_new(Layer *layer, Jacobian *jacobian);

/* Solves a system; 0, or a positive flag where Newton's iterations do not converge. The layer is then evaluated at the
 * solution. */
int stage_solve(Stage *stage, const System *system);

/* The derivatives f of a state were evaluated: the accelerations in them are those found last. */
void stage_know_accelerations(Stage *stage, const double *f);

/* The factors are not to be used again. */
void stage_forget_factors(Stage *stage);

#endif
