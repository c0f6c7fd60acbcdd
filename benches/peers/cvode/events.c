#include "events.h"

#include <stdlib.h>

/* What has been decided of a mass at an instant. */
typedef enum { NOTHING, STOPPED, SETTLED } Decided;

void events_set_margins(Problem *problem, double tolerance, double stiffness, double frequency) {
  enum { PART = 1000 }; /* forces and speeds are far smoother than the gap is small */
  problem->gap_margin = tolerance;
  problem->force_margin = tolerance * stiffness / PART;
  problem->speed_margin = tolerance * frequency / PART;
  problem->margin = room(problem->layer->k, sizeof *problem->margin);
  for (int i = 0; i < problem->layer->k; i++) problem->margin[i] = tolerance;
}

int events_count(const Layer *layer) {
  return layer->has_friction ? 2 * layer->k : layer->k;
}

/* The second root function of a mass in contact. */
static double stop_or_break(const Problem *problem, int i) {
  const Layer *layer = problem->layer;
  if (layer->mode[i] != STICKING) return layer->mode[i] * layer_speed(layer, i) + problem->speed_margin;
  return layer_limit(layer, i) - fabs(layer_tangential_force(layer, i)) + problem->force_margin;
}

int events_roots(double t, N_Vector y, double *roots, void *data) {
  Problem *problem = data;
  Layer *layer = problem->layer;
  if (t != problem->forces_known_at) layer_evaluate(layer, t, N_VGetArrayPointer(y));
  problem->forces_known_at = NAN;
  for (int i = 0; i < layer->k; i++) {
    int is_free = layer->mode[i] == FREE;
    roots[i] =
        is_free ? layer_gap(layer, i) + problem->margin[i] : layer_normal_force(layer, i) + problem->force_margin;
    if (layer->has_friction) roots[layer->k + i] = is_free ? 1 : stop_or_break(problem, i);
  }
  return 0;
}

static Mode direction_of(double value) {
  return value < 0 ? BACKWARD : FORWARD;
}

/* Impact, perfectly inelastic along n: v_n = 0 after it, with the impulse J = m max(-v_n, 0); along t Coulomb. */
static Decided touch(Problem *problem, Events *events, double *y, int i) {
  Layer *layer = problem->layer;
  const Carrier *carrier = &layer->carrier;
  int k = layer->k;
  Ground ground = profile_at(&layer->profile, layer->scene.rest_x[i] + (y[i] + carrier->u));
  double s = ground.slope, q = sqrt(1 + s * s);
  double v_x = y[2 * k + i] + carrier->u_rate, v_z = y[3 * k + i] + carrier->w_rate;
  double v_n = (v_z - s * v_x) / q, v_t = (v_x + s * v_z) / q;
  double left = fabs(v_t) - layer->scene.friction * fmax(-v_n, 0), after = left > 0 ? copysign(left, v_t) : 0;
  events->impact += layer->scene.mass * (v_n * v_n + v_t * v_t - after * after) / 2;
  y[2 * k + i] = after / q - carrier->u_rate;
  if (after == 0 && layer->has_friction) {
    layer_stick(layer, i, y[i]);
    return STOPPED;
  }
  layer_set_mode(layer, i, direction_of(after));
  return SETTLED;
}

static Decided change_mode(Problem *problem, Events *events, double *y, int i, int first) {
  Layer *layer = problem->layer;
  if (layer->mode[i] == FREE) {
    events->touch++;
    return touch(problem, events, y, i);
  }
  if (first) {
    events->lift++;
    layer_set_mode(layer, i, FREE);
    return SETTLED;
  }
  if (layer->mode[i] == STICKING) {
    events->break_++;
    layer_set_mode(layer, i, direction_of(layer_tangential_force(layer, i)));
    return SETTLED;
  }
  events->stop++;
  layer_stick(layer, i, y[i]);
  return STOPPED;
}

/* Decided anew: F_N < 0: free; sticking with |f.t| > T(0), a mass that has just stopped included: slip. One pass is
 * enough: the forces follow from motion, which no decision changes. A contact whose own event this is not may pass its
 * limit by the margin, until CVODE finds its root. */
static void decide(Problem *problem, Events *events, double t, double *y, const char *decided) {
  Layer *layer = problem->layer;
  layer_evaluate(layer, t, y);
  layer_store_contacts(layer, y);
  for (int i = 0; i < layer->k; i++) {
    if (layer->mode[i] == FREE) continue;
    double margin = decided[i] == NOTHING ? problem->force_margin : 0;
    Mode before = layer->mode[i];
    if (layer_normal_force(layer, i) < -margin) {
      layer_set_mode(layer, i, FREE);
    } else if (before == STICKING && decided[i] != SETTLED) {
      double f_t = layer_tangential_force(layer, i);
      if (fabs(f_t) > layer_limit(layer, i) + margin) layer_set_mode(layer, i, direction_of(f_t));
    }
    events->aside += decided[i] == NOTHING && layer->mode[i] != before;
  }
}

void events_settle(Problem *problem, Events *events, double t, double *y) {
  char *decided = calloc(problem->layer->k, 1);
  decide(problem, events, t, y, decided);
  free(decided);
}

/* After a lift the gap opens as t³, for a while below the error of the positions. */
static int moves_apart(const Layer *layer, int i) {
  double x = layer->scene.rest_x[i] + (layer->e_x[i] + layer->carrier.u), s = profile_at(&layer->profile, x).slope;
  return layer->r_z[i] + layer->carrier.w_rate - s * layer_speed(layer, i) > 0;
}

/* Keeps the touches that are none out of `found`, their gaps' margins raised; tells whether an event is left. */
static int leave_out_apart(Problem *problem, Events *events, int *real, const int *found) {
  const Layer *layer = problem->layer;
  int any = 0;
  for (int i = 0; i < layer->k; i++) {
    int second = layer->has_friction && found[layer->k + i];
    real[i] = found[i] || second;
    if (layer->mode[i] == FREE && found[i] && moves_apart(layer, i)) {
      problem->margin[i] *= 4;
      events->apart++;
      real[i] = 0;
    }
    any |= real[i];
  }
  return any;
}

/* Back to the usual margin once a mass has left the surface. */
static void restore_margins(Problem *problem) {
  for (int i = 0; i < problem->layer->k; i++) {
    double *margin = &problem->margin[i];
    if (*margin == problem->gap_margin) continue;
    if (problem->layer->mode[i] != FREE || layer_gap(problem->layer, i) > 2 * *margin) *margin = problem->gap_margin;
  }
}

int events_handle(Problem *problem, Events *events, double t, double *y, const int *found) {
  Layer *layer = problem->layer;
  int *real = malloc(layer->k * sizeof *real);
  char *decided = calloc(layer->k, 1);
  layer_evaluate(layer, t, y);
  int any = leave_out_apart(problem, events, real, found);
  if (any) {
    layer_store_contacts(layer, y);
    for (int i = 0; i < layer->k; i++)
      if (real[i]) decided[i] = change_mode(problem, events, y, i, found[i]);
    decide(problem, events, t, y, decided);
    restore_margins(problem);
  }
  free(real);
  free(decided);
  return any;
}
