#include "vectors.h"

#include <math.h>
#include <string.h>

#include "arrays.h"
#include "scene.h"

/* SUNDIALS lets the result be one of the operands: element by element that does no harm. */

Shortcuts shortcuts;

static double *of(N_Vector vector) {
  return NV_DATA_S(vector);
}

static long length(N_Vector vector) {
  return NV_LENGTH_S(vector);
}

/* Whether a sum is one that need not be done. */
static int is_done(realtype a, realtype b, const double *z) {
  if (a == 1 && b == 1 && z == shortcuts.solution) {
    shortcuts.solution = NULL;
    return 1;
  }
  if (a == 1 && b == -1 && shortcuts.trivial_prediction) {
    shortcuts.nought = z;
    return 1;
  }
  return 0;
}

static void linear_sum(realtype a, N_Vector x_, realtype b, N_Vector y_, N_Vector z_) {
  const double *x = of(x_), *y = of(y_);
  double *z = of(z_);
  long n = length(z_);
  if (is_done(a, b, z)) return;
  if (a == 1 && b == 1) EACH(i, n) z[i] = x[i] + y[i];
  else if (a == 1 && b == -1) EACH(i, n) z[i] = x[i] - y[i];
  else EACH(i, n) z[i] = a * x[i] + b * y[i];
}

static void set(realtype value, N_Vector z_) {
  double *z = of(z_);
  long n = length(z_);
  if (value == 0 && z == shortcuts.correction) return;
  if (value == 0) memset(z, 0, n * sizeof *z);
  else EACH(i, n) z[i] = value;
}

static void scale(realtype c, N_Vector x_, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  long n = length(z_);
  if (c != 1) EACH(i, n) z[i] = c * x[i];
  else if (shortcuts.trivial_prediction && z == shortcuts.copy) shortcuts.original = x;
  else if (x != z) memcpy(z, x, n * sizeof *z);
}

static void product(N_Vector x_, N_Vector y_, N_Vector z_) {
  const double *x = of(x_), *y = of(y_);
  double *z = of(z_);
  EACH(i, length(z_)) z[i] = x[i] * y[i];
}

static void quotient(N_Vector x_, N_Vector y_, N_Vector z_) {
  const double *x = of(x_), *y = of(y_);
  double *z = of(z_);
  EACH(i, length(z_)) z[i] = x[i] / y[i];
}

static void absolute(N_Vector x_, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  EACH(i, length(z_)) z[i] = fabs(x[i]);
}

static void invert(N_Vector x_, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  EACH(i, length(z_)) z[i] = 1 / x[i];
}

static void add_constant(N_Vector x_, realtype b, N_Vector z_) {
  const double *x = of(x_);
  double *z = of(z_);
  EACH(i, length(z_)) z[i] = x[i] + b;
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

enum { MOST_TERMS = 24 };

typedef struct {
  double c;
  const double *x;
} Term;

/* The terms that count, the result's own first: it may be any of them. */
static int collect(int count, const realtype *c, N_Vector *x, const double *z, Term *terms) {
  int n = 0;
  for (int j = 0; j < count; j++) {
    if (c[j] == 0 || of(x[j]) == shortcuts.nought) continue;
    if (n == MOST_TERMS) fail("a sum of more than %d vectors", MOST_TERMS);
    terms[n] = (Term){c[j], of(x[j])};
    if (terms[n].x == z && n > 0) {
      Term first = terms[0];
      terms[0] = terms[n];
      terms[n] = first;
    }
    n++;
  }
  shortcuts.nought = NULL;
  return n;
}

/* z = the first terms, up to four; their number. */
static int first_terms(int count, const Term *terms, long n, double *z) {
  double a = terms[0].c, b = count > 1 ? terms[1].c : 0, c = count > 2 ? terms[2].c : 0, d = count > 3 ? terms[3].c : 0;
  const double *p = terms[0].x, *q = terms[1].x, *r = terms[2].x, *s = terms[3].x;
  switch (count) {
    case 1:
      EACH(i, n) z[i] = a * p[i];
      return 1;
    case 2:
      EACH(i, n) z[i] = a * p[i] + b * q[i];
      return 2;
    case 3:
      EACH(i, n) z[i] = a * p[i] + b * q[i] + c * r[i];
      return 3;
    default:
      EACH(i, n) z[i] = (a * p[i] + b * q[i]) + (c * r[i] + d * s[i]);
      return 4;
  }
}

/* Few passes through memory: three and four vectors at a time. */
static int linear_combination(int count, realtype *c, N_Vector *x, N_Vector z_) {
  Term terms[MOST_TERMS];
  double *z = of(z_);
  long n = length(z_);
  count = collect(count, c, x, z, terms);
  if (count == 0) {
    memset(z, 0, n * sizeof *z);
    return 0;
  }
  int j = first_terms(count, terms, n, z);
  for (; j + 3 <= count; j += 3) {
    const double *p = terms[j].x, *q = terms[j + 1].x, *r = terms[j + 2].x;
    double a = terms[j].c, b = terms[j + 1].c, d = terms[j + 2].c;
    EACH(i, n) z[i] += a * p[i] + b * q[i] + d * r[i];
  }
  for (; j < count; j++) {
    const double *p = terms[j].x;
    double a = terms[j].c;
    EACH(i, n) z[i] += a * p[i];
  }
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

/* On a cache line, as loads of whole vectors want it. */
static N_Vector clone(N_Vector w) {
  N_Vector vector = N_VCloneEmpty(w);
  if (!vector) return NULL;
  NV_DATA_S(vector) = room(length(w), sizeof(double));
  NV_OWN_DATA_S(vector) = SUNTRUE;
  return vector;
}

static void replace(N_Vector_Ops ops) {
  ops->nvclone = clone;
  ops->nvlinearsum = linear_sum;
  ops->nvconst = set;
  ops->nvprod = product;
  ops->nvdiv = quotient;
  ops->nvscale = scale;
  ops->nvabs = absolute;
  ops->nvinv = invert;
  ops->nvaddconst = add_constant;
  ops->nvwrmsnorm = weighted_norm;
  ops->nvwsqrsumlocal = weighted_squares;
  ops->nvlinearcombination = linear_combination;
  ops->nvscaleaddmulti = scale_add_multi;
  ops->nvscalevectorarray = scale_vectors;
}

N_Vector vector_new(long length, SUNContext context) {
  N_Vector vector = N_VMake_Serial(length, room(length, sizeof(double)), context);
  if (!vector || N_VEnableFusedOps_Serial(vector, 1)) fail("out of memory");
  replace(vector->ops);
  return vector;
}
