#include "jacobian.h"

#include <string.h>

#include "arrays.h"

static Variation free_variation(const Layer *layer) {
  double per_mass = 1 / layer->scene.mass;
  return (Variation){.x_moves = 1, .z_moves = 1, .x_of_f_x = per_mass, .z_of_f_z = per_mass};
}

Jacobian *jacobian_new(Layer *layer) {
  Jacobian *jacobian = room(1, sizeof *jacobian);
  int k = layer->k;
  jacobian->layer = layer;
  jacobian->of = room(k, sizeof *jacobian->of);
  for (int i = 0; i < k; i++) jacobian->of[i] = free_variation(layer);
  jacobian->varied.mass = room(k, sizeof(int));
  Block **blocks[] = {&jacobian->inverse, &jacobian->lower, &jacobian->upper, &jacobian->back};
  for (unsigned i = 0; i < sizeof blocks / sizeof *blocks; i++) *blocks[i] = room(k, sizeof(Block));
  jacobian->rates = room(2L * k, sizeof(double));
  for (int kind = 0; kind < KINDS; kind++) jacobian->answer[kind].c = layer->scene.link[kind].c;
  return jacobian;
}

/* ---- values ---- */

/* With N = (1 - S s) f_x + (s + S)(f_z - m κ ẋ²) - σ A τ_0 q, ẍ = N/(m q²); ds/dx = κ, dq/dx = s κ/q. */
static Variation slipping_variation(const Layer *layer, int i) {
  double m = layer->scene.mass, s = layer->slope[i], kappa = layer->curvature[i], v = layer->speed[i];
  double sigma = layer_direction(layer, i), S = sigma * layer->scene.friction, along = 1 - S * s, across = s + S;
  double per_q2 = 1 / (1 + s * s), w = layer->per_mass * per_q2;
  double f_x = layer->f_x[i], f_z = layer->f_z[i] - m * kappa * v * v;
  double N = along * f_x + across * f_z;
  double N_x = kappa * (f_z - S * f_x) - across * m * layer->third[i] * v * v;
  if (layer->scene.shear != 0) {
    double shear = sigma * layer->scene.shear, q = sqrt(1 + s * s);
    N -= shear * q;
    N_x -= shear * s * kappa / q;
  }
  return (Variation){.x_moves = 1,
                     .slope = s,
                     .turn = kappa * v,
                     .x_of_f_x = along * w,
                     .x_of_f_z = across * w,
                     .x_of_x = w * (N_x - 2 * s * kappa * per_q2 * N),
                     .x_of_v = -2 * w * across * m * kappa * v};
}

void jacobian_linearise(Jacobian *jacobian) {
  const Layer *layer = jacobian->layer;
  Variation free = free_variation(layer);
  for (int n = 0; n < jacobian->varied.count; n++) jacobian->of[jacobian->varied.mass[n]] = free;
  jacobian->varied.count = layer->contact.count;
  memcpy(jacobian->varied.mass, layer->contact.mass, layer->contact.count * sizeof(int));
  for (int n = 0; n < layer->sticking.count; n++) jacobian->of[layer->sticking.mass[n]] = (Variation){0};
  for (int n = 0; n < layer->slipping.count; n++) {
    int i = layer->slipping.mass[n];
    jacobian->of[i] = slipping_variation(layer, i);
  }
}

void jacobian_set_gamma(Jacobian *jacobian, double gamma) {
  jacobian->gamma = gamma;
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &jacobian->layer->scene.link[kind];
    Answer *answer = &jacobian->answer[kind];
    answer->D = link->d;
    for (int j = 0; j < link->n; j++) {
      answer->w[j] = 1 / (1 + gamma * link->rate[j]);
      answer->kept[j] = link->stiffness[j] * answer->w[j];
      answer->D += gamma * answer->kept[j];
    }
  }
}

void jacobian_add_kept(const Jacobian *jacobian, int kind, const double *a, const double *q, double factor,
                       double *H_) {
  const Layer *layer = jacobian->layer;
  const double *kept = jacobian->answer[kind].kept;
  long stride = layer->stride;
  int n = layer->scene.link[kind].n, j = 0;
  double *restrict H = H_;
  for (; j + 2 <= n; j += 2, a += 2 * stride, q += 2 * stride) {
    const double *restrict a0 = a, *restrict a1 = a + stride, *restrict q0 = q, *restrict q1 = q + stride;
    double c0 = kept[j], c1 = kept[j + 1];
    EACH(i, stride) H[i] += c0 * (a0[i] + factor * q0[i]) + c1 * (a1[i] + factor * q1[i]);
  }
  for (; j < n; j++, a += stride, q += stride) {
    double c = kept[j];
    EACH(i, stride) H[i] += c * (a[i] + factor * q[i]);
  }
}

/* ---- blocks ---- */

/* Force of a link of constants c, D by the rates of mass v at one end: along x; along z by r_x and by r_z. */
static inline double x_by_x(const Variation *v, double gamma, double c, double D) {
  return v->x_moves * (c * gamma + D);
}

static inline double z_by_x(const Variation *v, double gamma, double c, double D) {
  return c * v->slope * gamma + D * (v->turn * gamma + v->slope);
}

static inline double z_by_z(const Variation *v, double gamma, double c, double D) {
  return v->z_moves * (c * gamma + D);
}

/* The row of mass v, given the forces along x and z on it by the rates of a mass: without the identity. */
static inline Block block(const Variation *v, double gamma, double x_x, double z_x, double z_z) {
  double a = gamma * v->x_of_f_x, b = gamma * v->x_of_f_z, c = gamma * v->z_of_f_z;
  return (Block){-(a * x_x + b * z_x), -b * z_z, -c * z_x, -c * z_z};
}

static inline Block times(Block a, Block b) {
  return (Block){a.xx * b.xx + a.xz * b.zx, a.xx * b.xz + a.xz * b.zz, a.zx * b.xx + a.zz * b.zx,
                 a.zx * b.xz + a.zz * b.zz};
}

static inline Block minus(Block a, Block b) {
  return (Block){a.xx - b.xx, a.xz - b.xz, a.zx - b.zx, a.zz - b.zz};
}

static inline Block inverse(Block a) {
  double per = 1 / (a.xx * a.zz - a.xz * a.zx);
  return (Block){a.zz * per, -a.xz * per, -a.zx * per, a.xx * per};
}

/* The block of a mass with a number of neighbours. */
static inline Block own_block(const Jacobian *jacobian, const Variation *v, int neighbours) {
  const Answer *answer = jacobian->answer;
  double gamma = jacobian->gamma;
  double c_x = answer[HORIZONTAL].c + neighbours * answer[LATERAL_X].c;
  double D_x = answer[HORIZONTAL].D + neighbours * answer[LATERAL_X].D;
  double c_z = answer[VERTICAL].c + neighbours * answer[LATERAL_Z].c;
  double D_z = answer[VERTICAL].D + neighbours * answer[LATERAL_Z].D;
  Block own = block(v, gamma, -x_by_x(v, gamma, c_x, D_x), -z_by_x(v, gamma, c_z, D_z), -z_by_z(v, gamma, c_z, D_z));
  own.xx += 1 - gamma * (gamma * v->x_of_x + v->x_of_v);
  own.zz += 1;
  return own;
}

/* The row of mass `row` by the rates of its neighbour `column`. */
static inline Block coupling(const Jacobian *jacobian, const Variation *row, const Variation *column) {
  const Answer *x = &jacobian->answer[LATERAL_X], *z = &jacobian->answer[LATERAL_Z];
  double gamma = jacobian->gamma;
  return block(row, gamma, x_by_x(column, gamma, x->c, x->D), z_by_x(column, gamma, z->c, z->D),
               z_by_z(column, gamma, z->c, z->D));
}

/* The matrix: free masses among free ones are all alike, the others are put in one by one. */
static void assemble(Jacobian *jacobian) {
  const Layer *layer = jacobian->layer;
  const Variation free = free_variation(layer), *of = jacobian->of;
  Block *pivot = jacobian->inverse, *lower = jacobian->lower, *upper = jacobian->upper;
  int k = layer->k;
  Block own = own_block(jacobian, &free, 2), beside = coupling(jacobian, &free, &free);
  for (int i = 0; i < k; i++) pivot[i] = own, lower[i] = upper[i] = beside;
  pivot[0] = own_block(jacobian, &of[0], k > 1);
  pivot[k - 1] = own_block(jacobian, &of[k - 1], k > 1);
  for (int n = 0; n < layer->contact.count; n++) {
    int i = layer->contact.mass[n];
    pivot[i] = own_block(jacobian, &of[i], (i > 0) + (i < k - 1));
    if (i > 0) {
      lower[i] = coupling(jacobian, &of[i], &of[i - 1]);
      upper[i - 1] = coupling(jacobian, &of[i - 1], &of[i]);
    }
    if (i < k - 1) {
      upper[i] = coupling(jacobian, &of[i], &of[i + 1]);
      lower[i + 1] = coupling(jacobian, &of[i + 1], &of[i]);
    }
  }
}

/* ---- elimination from both ends, two chains of divisions that do not wait for each other ---- */

/* Takes mass `from` out of the row of its inner neighbour, `into`; gives the pivot left there. */
static inline Block eliminate(Jacobian *jacobian, int from, Block *into_from, Block from_into, Block pivot) {
  Block outer = jacobian->inverse[from];
  jacobian->back[from] = times(outer, from_into);
  Block less = times(*into_from, jacobian->back[from]);
  *into_from = times(*into_from, outer);
  return minus(pivot, less);
}

void jacobian_factor(Jacobian *jacobian) {
  jacobian->factorisations++;
  assemble(jacobian);
  int k = jacobian->layer->k, middle = k / 2, top = middle, bottom = k - 1 - middle;
  Block *inv = jacobian->inverse, *lower = jacobian->lower, *upper = jacobian->upper;
  if (top > 0) inv[0] = inverse(inv[0]);
  if (bottom > 0) inv[k - 1] = inverse(inv[k - 1]);
  for (int n = 1; n < top || n < bottom; n++) {
    int i = n, j = k - 1 - n;
    if (n < top) inv[i] = inverse(eliminate(jacobian, i - 1, &lower[i], upper[i - 1], inv[i]));
    if (n < bottom) inv[j] = inverse(eliminate(jacobian, j + 1, &upper[j], lower[j + 1], inv[j]));
  }
  Block pivot = inv[middle];
  if (top > 0) pivot = eliminate(jacobian, middle - 1, &lower[middle], upper[middle - 1], pivot);
  if (bottom > 0) pivot = eliminate(jacobian, middle + 1, &upper[middle], lower[middle + 1], pivot);
  inv[middle] = inverse(pivot);
}

typedef struct {
  double x, z;
} Pair;

/* r_i less a block of the pair solved before; the pair that is left. */
static inline Pair take_out(double *r, const Block *block, Pair before) {
  Pair left = {r[0] - (block->xx * before.x + block->xz * before.z),
               r[1] - (block->zx * before.x + block->zz * before.z)};
  r[0] = left.x, r[1] = left.z;
  return left;
}

static void inwards(Jacobian *jacobian) {
  int k = jacobian->layer->k, middle = k / 2, top = middle, bottom = k - 1 - middle;
  double *r = jacobian->rates;
  const Block *lower = jacobian->lower, *upper = jacobian->upper;
  Pair first = {r[0], r[1]}, last = {r[2 * k - 2], r[2 * k - 1]};
  int n = 1, both = top < bottom ? top : bottom;
  for (; n < both; n++) {
    first = take_out(&r[2 * n], &lower[n], first);
    last = take_out(&r[2 * (k - 1 - n)], &upper[k - 1 - n], last);
  }
  for (int i = n; i < top; i++) first = take_out(&r[2 * i], &lower[i], first);
  for (int i = n; i < bottom; i++) last = take_out(&r[2 * (k - 1 - i)], &upper[k - 1 - i], last);
  if (top > 0) take_out(&r[2 * middle], &lower[middle], first);
  if (bottom > 0) take_out(&r[2 * middle], &upper[middle], last);
}

static void apply_pivots(Jacobian *jacobian) {
  const Block *inv = jacobian->inverse;
  double *r = jacobian->rates;
  EACH(i, jacobian->layer->k) {
    double x = r[2 * i], z = r[2 * i + 1];
    r[2 * i] = inv[i].xx * x + inv[i].xz * z;
    r[2 * i + 1] = inv[i].zx * x + inv[i].zz * z;
  }
}

static void outwards(Jacobian *jacobian) {
  int k = jacobian->layer->k, middle = k / 2;
  double *r = jacobian->rates;
  const Block *back = jacobian->back;
  Pair up = {r[2 * middle], r[2 * middle + 1]}, down = up;
  int i = middle - 1, j = middle + 1;
  for (; i >= 0 && j < k; i--, j++) {
    up = take_out(&r[2 * i], &back[i], up);
    down = take_out(&r[2 * j], &back[j], down);
  }
  for (; i >= 0; i--) up = take_out(&r[2 * i], &back[i], up);
  for (; j < k; j++) down = take_out(&r[2 * j], &back[j], down);
}

void jacobian_solve(Jacobian *jacobian) {
  inwards(jacobian);
  apply_pivots(jacobian);
  outwards(jacobian);
}
