/* What the linear systems of the implicit steps, (I - γ J) x = b, have in common: J mass by mass, the Maxwell elements'
 * answer to a rate, and the block tridiagonal matrix that is left once elements and positions are eliminated. */
#ifndef JACOBIAN_H
#define JACOBIAN_H

#include "layer.h"

/* What the Jacobian needs to know of a mass; 0 where not said otherwise. */
typedef struct {
  double x_moves;  /* 1 where e_x, r_x are a degree of freedom: free or slipping */
  double z_moves;  /* 1 where e_z, r_z are one: free */
  double slope;    /* slipping: e_z, r_z per e_x, r_x: s */
  double turn;     /* slipping: r_z per e_x: κ ẋ */
  double x_of_f_x; /* ẍ per f_x */
  double x_of_f_z; /* ẍ per f_z */
  double z_of_f_z; /* z̈ per f_z */
  double x_of_x;   /* ẍ per e_x at given forces: the profile turns under the mass */
  double x_of_v;   /* ẍ per r_x at given forces */
} Variation;

/* The answer of a kind of link within a step: its elements follow as δa_j = w_j (b_j + γ δė), w_j = 1/(1 + γ/τ_j), so
 * that δF = c δe + D δė + Σ_j c_j w_j b_j, with D = d + γ Σ_j c_j w_j. */
typedef struct {
  double c, D;
  double w[MOST_ELEMENTS], kept[MOST_ELEMENTS]; /* w_j and c_j w_j */
} Answer;

/* Row by row. */
typedef struct {
  double xx, xz, zx, zz;
} Block;

typedef struct {
  Layer *layer;
  Variation *of; /* by mass */
  List varied;   /* those that were in contact */
  double gamma;
  Answer answer[KINDS];
  /* The factors, from both ends to the middle mass: inverse pivots; couplings to the masses that are eliminated before
   * and after, times the inverse pivot of the former; inverse pivot times the coupling on the way back. */
  Block *inverse, *lower, *upper, *back;
  double *rates; /* right side and solution: r_x and r_z, mass by mass */
  long factorisations;
} Jacobian;

Jacobian *jacobian_new(Layer *layer);

/* Its values at the instant that the layer has evaluated last. */
void jacobian_linearise(Jacobian *jacobian);

/* Sets γ and the answers. */
void jacobian_set_gamma(Jacobian *jacobian, double gamma);

/* Factors the matrix for the rates. */
void jacobian_factor(Jacobian *jacobian);

/* Solves in `rates`. */
void jacobian_solve(Jacobian *jacobian);

/* H_i += Σ_j k_j a_j,i of a kind of link, k_j being c_j w_j; with q, of a_j,i + factor q_j,i. */
void jacobian_add_kept(const Jacobian *jacobian, int kind, const double *a, const double *q, double factor, double *H);

#endif
