/* Vector kernels: Debian builds SUNDIALS without wide vector instructions and without restrict. */
#ifndef VECTORS_H
#define VECTORS_H

#include <nvector/nvector_serial.h>

/* What need not be done of the operations that SUNDIALS asks for around a nonlinear solver that takes the system whole.
 * All zero: everything is done. */
typedef struct {
  int trivial_prediction;        /* ARKODE's prediction is the state at the step's start: its copy is not made, */
  const double *copy, *original; /* but the original read for it, once the solver has seen where it goes */
  const double *nought;          /* the state less that copy: left out of the sum that follows */
  const double *correction;      /* begins as zeros: the solver does not read it */
  const double *solution;        /* prediction plus correction: the solver has written it */
} Shortcuts;

extern Shortcuts shortcuts;

/* A zeroed serial vector with these kernels; its clones have them, too. */
N_Vector vector_new(long length, SUNContext context);

#endif
