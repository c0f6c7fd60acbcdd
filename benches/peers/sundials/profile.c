#include "profile.h"

#include <stdlib.h>

/* Solves a tridiagonal system, rows 0..n-1, for two right sides in place; the diagonal is spent. */
static void solve_tridiagonal(int n, const double *lower, double *diagonal, const double *upper, double *r, double *q) {
  for (int i = 1; i < n; i++) {
    double factor = lower[i] / diagonal[i - 1];
    diagonal[i] -= factor * upper[i - 1];
    r[i] -= factor * r[i - 1];
    q[i] -= factor * q[i - 1];
  }
  for (int i = n - 1; i >= 0; i--) {
    int inner = i < n - 1;
    r[i] = (r[i] - (inner ? upper[i] * r[i + 1] : 0)) / diagonal[i];
    q[i] = (q[i] - (inner ? upper[i] * q[i + 1] : 0)) / diagonal[i];
  }
}

/* Second derivatives M_i at the data points. Row i of the spline's equations, h the distances before and after point i:
 * h_l/6 M_{i-1} + (h_l + h_r)/3 M_i + h_r/6 M_{i+1} = rise after - rise before.
 * Natural: M = 0 at the ends. Periodic: point n is point 0 again; the two corner entries are a matrix of rank one, put
 * back by the formula of Sherman and Morrison. */
static double *second_derivatives(const Scene *scene) {
  const double *x = scene->x, *z = scene->z;
  int n = scene->points - 1, periodic = scene->periodic;
  double *lower = room(5 * (n + 1), sizeof *lower), *diagonal = lower + n + 1, *upper = diagonal + n + 1;
  double *q = upper + n + 1, *m = room(n + 1, sizeof *m);
  diagonal[0] = 1;
  for (int i = !periodic; i < n; i++) {
    int before = i > 0 ? i - 1 : n - 1;
    double left = x[before + 1] - x[before], right = x[i + 1] - x[i];
    lower[i] = left / 6;
    diagonal[i] = (left + right) / 3;
    upper[i] = right / 6;
    m[i] = (z[i + 1] - z[i]) / right - (z[before + 1] - z[before]) / left;
  }
  if (periodic) {
    double corner = lower[0], gamma = -diagonal[0];
    q[0] = gamma;
    q[n - 1] = upper[n - 1];
    diagonal[n - 1] -= upper[n - 1] * corner / gamma;
    diagonal[0] -= gamma;
    solve_tridiagonal(n, lower, diagonal, upper, m, q);
    double factor = (m[0] + corner / gamma * m[n - 1]) / (1 + q[0] + corner / gamma * q[n - 1]);
    for (int i = 0; i < n; i++) m[i] -= factor * q[i];
    m[n] = m[0];
  } else {
    upper[0] = 0;
    solve_tridiagonal(n, lower, diagonal, upper, m, q); /* row n - 1: M_n = 0 needs no term */
  }
  free(lower);
  return m;
}

static int are_even(const double *x, int n) {
  double h = (x[n] - x[0]) / n;
  for (int i = 0; i < n; i++)
    if (fabs(x[i + 1] - x[i] - h) > 1e-6 * h) return 0;
  return 1;
}

Profile profile_new(const Scene *scene) {
  int n = scene->points - 1;
  const double *x = scene->x, *z = scene->z;
  double *m = second_derivatives(scene);
  Profile profile = {.pieces = n, .periodic = scene->periodic, .start = x[0], .length = x[n] - x[0]};
  profile.per_length = are_even(x, n) ? n / profile.length : 0;
  profile.per_period = 1 / profile.length;
  profile.piece = room(n + 1, sizeof *profile.piece);
  for (int i = 0; i < n; i++) {
    double h = x[i + 1] - x[i];
    profile.piece[i] = (Piece){x[i], z[i], (z[i + 1] - z[i]) / h - h * (2 * m[i] + m[i + 1]) / 6, m[i] / 2,
                               (m[i + 1] - m[i]) / (6 * h)};
  }
  double h = x[n] - x[n - 1];
  profile.tangent = profile.piece[0].slope;
  profile.piece[n] = (Piece){x[n], z[n], (z[n] - z[n - 1]) / h + h * (2 * m[n] + m[n - 1]) / 6, 0, 0};
  free(m);
  return profile;
}

int profile_search(const Profile *profile, double x) {
  int low = 0, high = profile->pieces;
  while (high - low > 1) {
    int middle = (low + high) / 2;
    if (profile->piece[middle].x <= x) low = middle;
    else high = middle;
  }
  return low;
}
