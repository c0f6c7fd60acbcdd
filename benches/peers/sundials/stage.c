#include "stage.h"

#include <string.h>
#include <sundials/sundials_nonlinearsolver.h>

#include "arrays.h"

/* Newton's iterations after which the system counts as unsolved, and the one after which old factors are replaced. */
enum { MOST_ITERATIONS = 8, OLD_FACTORS_SERVE = 3 };

enum { E_X, E_Z, R_X, R_Z, MOTIONS };

Stage *stage_new(Layer *layer, Jacobian *jacobian) {
  Stage *stage = room(1, sizeof *stage);
  stage->layer = layer;
  stage->jacobian = jacobian;
  stage->factored_at_changes = -1;
  for (int part = 0; part < MOTIONS; part++) stage->star[part] = layer_array(layer);
  for (int kind = 0; kind < KINDS; kind++) stage->kept[kind] = layer_array(layer);
  stage->x_acceleration = layer_array(layer);
  stage->z_acceleration = layer_array(layer);
  return stage;
}

void stage_forget_factors(Stage *stage) {
  stage->factored_at_changes = -1;
}

void stage_know_accelerations(Stage *stage, const double *f) {
  long stride = stage->layer->stride, bytes = stage->layer->k * sizeof *f;
  memcpy(stage->x_acceleration, f + R_X * stride, bytes);
  memcpy(stage->z_acceleration, f + R_Z * stride, bytes);
}

/* ---- before the iterations ---- */

static void collect_past(Stage *stage, const System *system) {
  const Layer *layer = stage->layer;
  long stride = layer->stride;
  double factor = system->factor;
  for (int kind = 0; kind < KINDS; kind++) {
    long at = layer->maxwell[kind];
    memset(stage->kept[kind], 0, stride * sizeof(double));
    jacobian_add_kept(stage->jacobian, kind, system->p + at, system->q + at, factor, stage->kept[kind]);
  }
  for (int part = 0; part < MOTIONS; part++) {
    const double *restrict p = system->p + part * stride, *restrict q = system->q + part * stride;
    double *restrict star = stage->star[part];
    EACH(i, layer->k) star[i] = p[i] + factor * q[i];
  }
}

static void guess(Stage *stage, const System *system) {
  Layer *layer = stage->layer;
  long k = layer->k, stride = layer->stride;
  if (system->guess_from_p) {
    memcpy(layer->r_x, system->p + R_X * stride, k * sizeof(double));
    memcpy(layer->r_z, system->p + R_Z * stride, k * sizeof(double));
    return;
  }
  double gamma = system->gamma, *restrict r_x = layer->r_x, *restrict r_z = layer->r_z;
  const double *restrict star_x = stage->star[R_X], *restrict star_z = stage->star[R_Z];
  const double *restrict a_x = stage->x_acceleration, *restrict a_z = stage->z_acceleration;
  EACH(i, k) {
    r_x[i] = star_x[i] + gamma * a_x[i];
    r_z[i] = star_z[i] + gamma * a_z[i];
  }
}

static void begin(Stage *stage, const System *system) {
  Layer *layer = stage->layer;
  layer_list(layer);
  layer->carrier = layer_carrier(layer, system->t);
  layer->known_at = NAN;
  if (stage->factored_at_changes != layer->mode_changes) stage_forget_factors(stage);
  if (system->gamma != stage->jacobian->gamma) {
    jacobian_set_gamma(stage->jacobian, system->gamma);
    stage_forget_factors(stage);
  }
  stage->factors_are_old = stage->factored_at_changes >= 0;
  collect_past(stage, system);
  guess(stage, system);
}

/* ---- an iteration ---- */

/* Motion by the rates. */
static void move(Stage *stage, double gamma) {
  Layer *layer = stage->layer;
  double *restrict e_x = layer->e_x, *restrict e_z = layer->e_z;
  const double *restrict r_x = layer->r_x, *restrict r_z = layer->r_z;
  const double *restrict star_x = stage->star[E_X], *restrict star_z = stage->star[E_Z];
  EACH(i, layer->k) {
    e_x[i] = star_x[i] + gamma * r_x[i];
    e_z[i] = star_z[i] + gamma * r_z[i];
  }
  layer_constrain(layer);
}

/* Force of a kind of lateral link by the motion e and r of the masses. */
static void pull_neighbours(Stage *stage, int kind, const double *restrict e, const double *restrict r) {
  Layer *layer = stage->layer;
  const double c = stage->jacobian->answer[kind].c, D = stage->jacobian->answer[kind].D;
  const double *restrict kept = stage->kept[kind];
  double *restrict rate = layer->rate[kind], *restrict force = layer->force[kind];
  EACH(i, layer->k - 1) {
    double stretching = r[i + 1] - r[i];
    rate[i] = stretching;
    force[i] = c * (e[i + 1] - e[i]) + D * stretching + kept[i];
  }
}

/* Of a kind of link to the carrier. */
static void pull_carrier(Stage *stage, int kind) {
  Layer *layer = stage->layer;
  const double c = stage->jacobian->answer[kind].c, D = stage->jacobian->answer[kind].D;
  const double *restrict kept = stage->kept[kind], *restrict e = layer->elongation[kind];
  const double *restrict r = layer->rate[kind];
  double *restrict force = layer->force[kind];
  EACH(i, layer->k) force[i] = c * e[i] + D * r[i] + kept[i];
}

/* Motion and forces of the layer by the rates. */
static void evaluate(Stage *stage, double gamma) {
  Layer *layer = stage->layer;
  move(stage, gamma);
  pull_neighbours(stage, LATERAL_X, layer->e_x, layer->r_x);
  pull_neighbours(stage, LATERAL_Z, layer->e_z, layer->r_z);
  pull_carrier(stage, HORIZONTAL);
  pull_carrier(stage, VERTICAL);
  sum_on_masses(layer->k, layer->force[HORIZONTAL], layer->force[LATERAL_X], layer->f_x);
  sum_on_masses(layer->k, layer->force[VERTICAL], layer->force[LATERAL_Z], layer->f_z);
}

static void residuals(Stage *stage, double gamma) {
  const Layer *layer = stage->layer;
  double *restrict residual = stage->jacobian->rates, per_mass = gamma / layer->scene.mass;
  const double *restrict star_x = stage->star[R_X], *restrict star_z = stage->star[R_Z];
  const double *restrict r_x = layer->r_x, *restrict r_z = layer->r_z;
  const double *restrict f_x = layer->f_x, *restrict f_z = layer->f_z;
  double u_gain = gamma * layer->carrier.u_acceleration, w_gain = gamma * layer->carrier.w_acceleration;
  EACH(i, layer->k) {
    residual[2 * i] = star_x[i] - r_x[i] + per_mass * f_x[i] - u_gain;
    residual[2 * i + 1] = star_z[i] - r_z[i] + per_mass * f_z[i] - w_gain;
  }
  for (int n = 0; n < layer->sticking.count; n++) {
    int i = layer->sticking.mass[n];
    residual[2 * i] = residual[2 * i + 1] = 0;
  }
  for (int n = 0; n < layer->slipping.count; n++) {
    int i = layer->slipping.mass[n];
    residual[2 * i] = star_x[i] - r_x[i] + gamma * layer_slip_acceleration(layer, i) - u_gain;
    residual[2 * i + 1] = 0;
  }
}

static double residual_norm(const Stage *stage, const System *system) {
  const Layer *layer = stage->layer;
  const double *residual = stage->jacobian->rates;
  const double *x_weight = system->weights + R_X * layer->stride, *z_weight = system->weights + R_Z * layer->stride;
  double norm = 0;
#pragma omp simd reduction(+ : norm)
  for (int i = 0; i < layer->k; i++) {
    double x = residual[2 * i] * x_weight[i], z = residual[2 * i + 1] * z_weight[i];
    norm += x * x + z * z;
  }
  return sqrt(norm / layer->order);
}

static void refactor(Stage *stage) {
  jacobian_linearise(stage->jacobian);
  jacobian_factor(stage->jacobian);
  stage->factored_at_changes = stage->layer->mode_changes;
  stage->factors_are_old = 0;
}

static void correct(Stage *stage) {
  Layer *layer = stage->layer;
  if (stage->factored_at_changes < 0) refactor(stage);
  stage->iterations++;
  jacobian_solve(stage->jacobian);
  const double *restrict correction = stage->jacobian->rates;
  double *restrict r_x = layer->r_x, *restrict r_z = layer->r_z;
  EACH(i, layer->k) {
    r_x[i] += correction[2 * i];
    r_z[i] += correction[2 * i + 1];
  }
}

/* Without slip the equations are linear: one correction is the solution. */
static int iterate(Stage *stage, const System *system) {
  int linear = stage->layer->slipping.count == 0;
  for (int done = 0;; done++) {
    evaluate(stage, system->gamma);
    if (done > 0 && linear) return 0;
    residuals(stage, system->gamma);
    if (done > 0) {
      double norm = residual_norm(stage, system);
      if (norm <= system->tolerance) return 0;
      if (norm != norm || done == MOST_ITERATIONS) return SUN_NLS_CONV_RECVR;
      if (done == OLD_FACTORS_SERVE && stage->factors_are_old) refactor(stage);
    }
    correct(stage);
  }
}

/* ---- after the iterations ---- */

static void keep_accelerations(Stage *stage, double gamma) {
  const Layer *layer = stage->layer;
  double per_gamma = 1 / gamma, *restrict a_x = stage->x_acceleration, *restrict a_z = stage->z_acceleration;
  const double *restrict star_x = stage->star[R_X], *restrict star_z = stage->star[R_Z];
  const double *restrict r_x = layer->r_x, *restrict r_z = layer->r_z;
  EACH(i, layer->k) {
    a_x[i] = (r_x[i] - star_x[i]) * per_gamma;
    a_z[i] = (r_z[i] - star_z[i]) * per_gamma;
  }
  for (int n = 0; n < layer->contact.count; n++) a_z[layer->contact.mass[n]] = 0;
  for (int n = 0; n < layer->sticking.count; n++) a_x[layer->sticking.mass[n]] = 0;
}

/* The motion into z; what is no degree of freedom rests. */
static void copy_motion(const Stage *stage, double *z) {
  const Layer *layer = stage->layer;
  long k = layer->k, stride = layer->stride;
  memcpy(z + E_X * stride, layer->e_x, k * sizeof *z);
  memcpy(z + E_Z * stride, layer->e_z, k * sizeof *z);
  memcpy(z + R_X * stride, layer->r_x, k * sizeof *z);
  memcpy(z + R_Z * stride, layer->r_z, k * sizeof *z);
  for (int n = 0; n < layer->contact.count; n++) {
    int i = layer->contact.mass[n], rests = layer->mode[i] == STICKING ? E_X : E_Z;
    for (int part = rests; part < MOTIONS; part += 1 + (rests == E_Z)) z[part * stride + i] = stage->star[part][i];
  }
}

static void fill_in_motion(const Stage *stage, const System *system) {
  long count = MOTIONS * stage->layer->stride;
  double factor = system->factor, per_gamma = 1 / system->gamma;
  copy_motion(stage, system->z);
  const double *restrict z = system->z;
  const double *restrict p = system->p, *restrict q = system->q;
  double *restrict beside = system->beside;
  if (system->correction_wanted) EACH(i, count) beside[i] = z[i] - p[i];
  else EACH(i, count) beside[i] = (z[i] - (p[i] + factor * q[i])) * per_gamma;
}

/* The elongations of one element into z; their sum of squares. Once for each of the two things wanted beside. */
static double fill_in_correction(long count, double w, const System *system, long at, const double *restrict rate) {
  const double *restrict p = system->p + at, *restrict q = system->q + at;
  double *restrict z = system->z + at, *restrict correction = system->beside + at;
  double factor = system->factor, gamma = system->gamma, squares = 0;
#pragma omp simd reduction(+ : squares)
  for (long i = 0; i < count; i++) {
    double a = w * (p[i] + factor * q[i] + gamma * rate[i]);
    z[i] = a;
    correction[i] = a - p[i];
    squares += a * a;
  }
  return squares;
}

static double fill_in_derivative(long count, double w, const System *system, long at, const double *restrict rate) {
  const double *restrict p = system->p + at, *restrict q = system->q + at;
  double *restrict z = system->z + at, *restrict derivative = system->beside + at;
  double factor = system->factor, gamma = system->gamma, per_gamma = 1 / gamma, squares = 0;
#pragma omp simd reduction(+ : squares)
  for (long i = 0; i < count; i++) {
    double star = p[i] + factor * q[i], a = w * (star + gamma * rate[i]);
    z[i] = a;
    derivative[i] = (a - star) * per_gamma;
    squares += a * a;
  }
  return squares;
}

/* The elements into z; their power. */
static double fill_in_elements(const Stage *stage, const System *system) {
  const Layer *layer = stage->layer;
  double power = 0;
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &layer->scene.link[kind];
    for (int j = 0; j < link->n; j++) {
      long at = layer->maxwell[kind] + j * layer->stride, count = layer->count[kind];
      double w = stage->jacobian->answer[kind].w[j];
      double squares = system->correction_wanted ? fill_in_correction(count, w, system, at, layer->rate[kind])
                                                 : fill_in_derivative(count, w, system, at, layer->rate[kind]);
      power += link->stiffness[j] * link->rate[j] * squares;
    }
  }
  return power;
}

static void fill_in_energies(const Stage *stage, const System *system, double maxwell_power) {
  double power[CHANNELS];
  layer_power(stage->layer, maxwell_power, power);
  for (int channel = 0; channel < CHANNELS; channel++) {
    long at = stage->layer->energy + channel;
    double gain = system->factor * system->q[at] + system->gamma * power[channel];
    system->z[at] = system->p[at] + gain;
    system->beside[at] = system->correction_wanted ? gain : power[channel];
  }
}

int stage_solve(Stage *stage, const System *system) {
  stage->solved++;
  begin(stage, system);
  int flag = iterate(stage, system);
  if (flag) return flag;
  keep_accelerations(stage, system->gamma);
  fill_in_motion(stage, system);
  fill_in_energies(stage, system, fill_in_elements(stage, system));
  stage->layer->known_at = system->t;
  return 0;
}
