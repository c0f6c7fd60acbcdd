/* The linear systems of the implicit steps, (I - γ J) x = b, and two ways to solve them. */
#ifndef LINEAR_H
#define LINEAR_H

#include <cvodes/cvodes.h>

#include "layer.h"

/* What the Jacobian needs to know of each mass; 0 where not said otherwise. */
typedef struct {
  double *x_moves;  /* 1 where e_x, r_x are a degree of freedom: free or slipping */
  double *z_moves;  /* 1 where e_z, r_z are one: free */
  double *slope;    /* slipping: e_z, r_z per e_x, r_x: s */
  double *turn;     /* slipping: r_z per e_x: κ ẋ */
  double *x_of_f_x; /* ẍ per f_x */
  double *x_of_f_z; /* ẍ per f_z */
  double *z_of_f_z; /* z̈ per f_z */
  double *x_of_x;   /* ẍ per e_x at given forces: the profile turns under the mass */
  double *x_of_v;   /* ẍ per r_x at given forces */
} Variation;

Variation variation_new(int k);

/* A linear solver as CVODE takes it. */
typedef struct {
  SUNLinearSolver solver;
  SUNMatrix matrix;
  CVLsLinSysFn system;
} LinearSolver;

/* CVODE's user data. */
typedef struct {
  Layer *layer;
  Variation variation;
  double rtol, atol_place, atol_rate;            /* of elongations, m, and of their rates, m/s */
  double gap_margin, force_margin, speed_margin; /* events.h */
  double *margin;                                /* of each mass's gap */
  double forces_known_at; /* time of the accepted state that the layer has evaluated last, or NAN */
  LinearSolver linear;
  void *linear_data;
} Problem;

/* Evaluates the layer in the state y, and its variation there. */
void linearise(Problem *problem, double t, N_Vector y);

/* Sparse LU by KLU on a fixed pattern that holds every entry of any mode, analysed once for the run. */
LinearSolver klu_new(Problem *problem, N_Vector y, SUNContext context);

/* Maxwell elements and positions eliminated by hand; block tridiagonal, 2x2, in the rates. */
LinearSolver condensed_new(Problem *problem, SUNContext context);

#endif
