/* Two linear solvers for CVODES' own Newton iteration on (I - γ J) x = b. */
#ifndef LINEAR_H
#define LINEAR_H

#include <cvodes/cvodes.h>

#include "jacobian.h"

/* A linear solver as CVODES takes it. Its `system` has a Problem for user data. */
typedef struct {
  SUNLinearSolver solver;
  SUNMatrix matrix;
  CVLsLinSysFn system;
} LinearSolver;

/* What both need. */
typedef struct {
  Layer *layer;
  Jacobian *jacobian;
  void *linear_data;
} Problem;

/* Sparse LU by KLU on a fixed pattern that holds every entry of any mode, analysed once for the run. */
LinearSolver klu_new(Problem *problem, N_Vector y, SUNContext context);

/* Maxwell elements and positions eliminated by hand; block tridiagonal, 2x2, in the rates. */
LinearSolver condensed_new(Problem *problem, SUNContext context);

#endif
