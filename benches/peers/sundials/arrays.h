/* Loops over arrays that the compiler can turn into vector instructions. */
#ifndef ARRAYS_H
#define ARRAYS_H

/* For i from 0 to n - 1, in any order: no element written is read at another i. */
#define EACH(i, n) _Pragma("GCC ivdep") for (long i = 0; i < (n); i++)

static inline double sum(long n, const double *a) {
  double total = 0;
#pragma omp simd reduction(+ : total)
  for (long i = 0; i < n; i++) total += a[i];
  return total;
}

static inline double sum_of_squares(long n, const double *a) {
  double total = 0;
#pragma omp simd reduction(+ : total)
  for (long i = 0; i < n; i++) total += a[i] * a[i];
  return total;
}

/* d_i = a_{i+1} - a_i, n of them. */
static inline void differences(long n, const double *restrict a, double *restrict d) {
  EACH(i, n) d[i] = a[i + 1] - a[i];
}

/* (3), (4): f_i = -F_i + F_l,i - F_l,i-1 of k masses, F the links to the carrier, F_l those to the neighbours; places
 * -1 and k - 1 of F_l are set to 0. */
static inline void sum_on_masses(long k, const double *restrict carrier, double *restrict lateral, double *restrict f) {
  lateral[-1] = lateral[k - 1] = 0;
  EACH(i, k) f[i] = -carrier[i] + (lateral[i] - lateral[i - 1]);
}

#endif
