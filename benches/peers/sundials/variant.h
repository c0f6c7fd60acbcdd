/* The ways to integrate the model that the program knows, by name. */
#ifndef VARIANT_H
#define VARIANT_H

typedef enum { BDF, ADAMS, DIRK } Family;

/* What solves the nonlinear systems: SUNDIALS' Newton iteration with one of two linear solvers, or stage.h. */
typedef enum { BY_KLU, BY_CONDENSATION, WHOLE } Solver;

typedef struct {
  const char *name;
  Family family;     /* CVODES' two, ARKODE's diagonally implicit Runge-Kutta */
  const char *table; /* ARKODE's name of the tableau */
  Solver solver;
  int own_events;         /* located by locate.h, else by CVODES */
  int constant_weights;   /* of the error test: from the absolute tolerance alone, else relative to the values, too */
  double passed;          /* part of a tolerance by which an event may have been passed at a step's end */
  int foresees;           /* steps end where the next touch is foreseen: an interpolation is near its end then */
  double first_step;      /* the first step after an event over the one before it; 0: as the integrator has it */
  int interpolant_degree; /* of ARKODE's Hermite interpolant */
} Variant;

/* Ends the program where there is none of this name. */
const Variant *variant_of(const char *name);

#endif
