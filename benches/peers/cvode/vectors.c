#include "vectors.h"

#include <math.h>
#include <string.h>

#include "arrays.h"

/* SUNDIALS lets the result be one of the operands: element by element that does no harm. */

static double *of(N_Vector vector) {
  return NV_DATA_S(vector);
}

static long length(N_Vector vector) {
  return NV_LENGTH_S(vector);
}

static void linear_sum(realtype a, N_Vector x_, realtype b, N_Vector y_, N_Vector z_) {
  const double *x = of(x_), *y = of(y_);
  double *z = of(z_);
  long n = length(z_);
  if (a == 1 && b == 1) EACH(i, n) z[i] = x[i] + y[i];
  else EACH(i, n) z[i] = a * x[i] + b * y[i];
}

static void set(realtype value, N_Vector z_) {
  double *z = of(z_);
  long n = length(z_);
  EACH(i, n) z[i] = value;
}

static void scale(realtype c, N_Vector x_, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  long n = length(z_);
  if (c == 1) {
    if (x != z) memcpy(z, x, n * sizeof *z);
  } else {
    EACH(i, n) z[i] = c * x[i];
  }
}

static void invert(N_Vector x_, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  long n = length(z_);
  EACH(i, n) z[i] = 1 / x[i];
}

static realtype weighted_squares(N_Vector x_, N_Vector w_) {
  const double *x = of(x_), *w = of(w_);
  long n = length(x_);
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (long i = 0; i < n; i++) {
    double p = x[i] * w[i];
    sum += p * p;
  }
  return sum;
}

static realtype weighted_norm(N_Vector x, N_Vector w) {
  return sqrt(weighted_squares(x, w) / length(x));
}

/* Two at a time. The result may be the first operand, as in CVODE, and no other. */
static int linear_combination(int count, realtype *c, N_Vector *x, N_Vector z_) {
  double *z = of(z_);
  long n = length(z_);
  if (count == 1) scale(c[0], x[0], z_);
  else linear_sum(c[0], x[0], c[1], x[1], z_);
  int j = 2;
  for (; j + 1 < count; j += 2) {
    const double *a = of(x[j]), *b = of(x[j + 1]);
    double p = c[j], q = c[j + 1];
    EACH(i, n) z[i] += p * a[i] + q * b[i];
  }
  if (j < count) linear_sum(1, z_, c[j], x[j], z_);
  return 0;
}

/* z_j = c_j x + y_j, a block of x at a time, which then stays in the nearest cache. */
static int scale_add_multi(int count, realtype *c, N_Vector x_, N_Vector *y_, N_Vector *z_) {
  enum { BLOCK = 1024 };
  long n = length(x_);
  for (long start = 0; start < n; start += BLOCK) {
    long size = n - start < BLOCK ? n - start : BLOCK;
    const double *x = of(x_) + start;
    for (int j = 0; j < count; j++) {
      const double *y = of(y_[j]) + start;
      double *z = of(z_[j]) + start, factor = c[j];
      EACH(i, size) z[i] = factor * x[i] + y[i];
    }
  }
  return 0;
}

static int scale_vectors(int count, realtype *c, N_Vector *x, N_Vector *z) {
  for (int j = 0; j < count; j++) scale(c[j], x[j], z[j]);
  return 0;
}

void vectors_replace(N_Vector vector) {
  N_Vector_Ops ops = vector->ops;
  ops->nvlinearsum = linear_sum;
  ops->nvconst = set;
  ops->nvscale = scale;
  ops->nvinv = invert;
  ops->nvwrmsnorm = weighted_norm;
  ops->nvwsqrsumlocal = weighted_squares;
  ops->nvlinearcombination = linear_combination;
  ops->nvscaleaddmulti = scale_add_multi;
  ops->nvscalevectorarray = scale_vectors;
}
