/* CVODES and ARKODE behind one interface. */
#ifndef INTEGRATOR_H
#define INTEGRATOR_H

#include "events.h"
#include "linear.h"
#include "stage.h"
#include "variant.h"

/* What the right side of ARKODE has already: f is asked for again where it is known. */
typedef struct {
  const double *of_stage; /* of the stage just solved */
  const double *first;    /* where ARKODE keeps that of the step's start, */
  double first_at;        /* and the time that it is of, or NAN */
} KnownDerivatives;

typedef struct {
  Problem problem; /* first: the user data of SUNDIALS is both */
  const Variant *variant;
  Events *events;
  Stage *stage;
  void *memory; /* SUNDIALS' */
  N_Vector y;
  double end;                         /* of the phase */
  double rtol, atol_place, atol_rate; /* of elongations, m, and of their rates, m/s */
  int stiffly_accurate;               /* ARKODE: the last stage is the step's end; -1: not known yet */
  KnownDerivatives known;
  long steps, failures, iterations; /* CVODES: up to the last restart */
} Integrator;

/* What came of a step. */
typedef enum { STEPPED, AT_STOP, AT_ROOT } StepEnd;

/* Tolerances: elongations rtol times `length` (m), rates that times `frequency` (1/s). */
Integrator *integrator_new(const Variant *variant, Layer *layer, Events *events, N_Vector y, double rtol, double length,
                           double frequency, SUNContext context);

/* Begins a phase that ends at `end`. */
void integrator_begin(Integrator *integrator, double t, double end);

/* Goes on from y after an event. */
void integrator_restart(Integrator *integrator, double t);

/* One step of the phase, ending at `stop` at the latest, into y. */
StepEnd integrator_step(Integrator *integrator, double stop, double *t);

/* The state at time t of the last step. */
void integrator_interpolate(void *integrator, double t, N_Vector state);

/* Which root functions CVODES found. */
void integrator_roots_found(Integrator *integrator, int *found);

/* Brings the counts up to date. */
void integrator_count(Integrator *integrator);

#endif
