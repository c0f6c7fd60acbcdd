#include "events.h"

#include <string.h>

#include "arrays.h"

/* What has been decided of a mass at an instant. */
enum { NOTHING, STOPPED, SETTLED };

Events events_new(Layer *layer, double tolerance, double stiffness, double frequency) {
  enum { PART = 1000 }; /* forces and speeds are far smoother than the gap is small */
  Events events = {.layer = layer, .gap_margin = layer_array(layer), .height = layer_array(layer)};
  events.margin = (Margins){tolerance, tolerance * stiffness / PART, tolerance * frequency / PART};
  for (int i = 0; i < layer->k; i++) events.gap_margin[i] = tolerance;
  events.decided = room(layer->k, 1);
  return events;
}

int events_count(const Layer *layer) {
  return layer->has_friction ? 2 * layer->k : layer->k;
}

/* ---- root functions ---- */

static void profile_heights(const Layer *layer, double *restrict height) {
  const Profile profile = layer->profile;
  const double *restrict rest_x = layer->scene.rest_x, *restrict e_x = layer->e_x, u = layer->carrier.u;
  if (profile_is_even(&profile)) {
    EACH(i, layer->k) {
      double t;
      const Piece *piece = profile_even_piece(&profile, rest_x[i] + (e_x[i] + u), &t);
      height[i] = profile_on(piece, t).height;
    }
  } else {
    for (int i = 0; i < layer->k; i++) height[i] = profile_at(&profile, rest_x[i] + (e_x[i] + u)).height;
  }
}

/* The second root function of a mass in contact. */
static double stop_or_break(const Events *events, int i) {
  const Layer *layer = events->layer;
  if (layer->mode[i] != STICKING) return layer->mode[i] * layer->speed[i] + events->margin.speed;
  return layer_limit(layer, i) - fabs(layer_tangential_force(layer, i)) + events->margin.force;
}

void events_roots(Events *events, double t, const double *y, double *restrict roots) {
  Layer *layer = events->layer;
  long k = layer->k;
  layer_evaluate_unless_known(layer, t, y);
  profile_heights(layer, events->height);
  const double *restrict rest_z = layer->scene.rest_z, *restrict e_z = layer->e_z, w = layer->carrier.w;
  const double *restrict height = events->height, *restrict margin = events->gap_margin;
  EACH(i, k) roots[i] = (rest_z[i] + (e_z[i] + w)) - height[i] + margin[i];
  if (layer->has_friction) EACH(i, k) roots[k + i] = 1;
  for (int n = 0; n < layer->contact.count; n++) {
    int i = layer->contact.mass[n];
    roots[i] = layer_normal_force(layer, i) + events->margin.force;
    if (layer->has_friction) roots[k + i] = stop_or_break(events, i);
  }
}

int events_moves_apart(const Layer *layer, const double *y, int i) {
  long stride = layer->stride;
  double s = profile_at(&layer->profile, layer->scene.rest_x[i] + (y[i] + layer->carrier.u)).slope;
  return y[3 * stride + i] + layer->carrier.w_rate > s * (y[2 * stride + i] + layer->carrier.u_rate);
}

/* ---- what follows ---- */

static Mode direction_of(double value) {
  return value < 0 ? BACKWARD : FORWARD;
}

/* Impact, perfectly inelastic along n: v_n = 0 after it, with the impulse J = m max(-v_n, 0); along t Coulomb. */
static void touch(Events *events, double *y, int i) {
  Layer *layer = events->layer;
  Carrier carrier = layer->carrier;
  long stride = layer->stride;
  Ground ground = profile_at(&layer->profile, layer->scene.rest_x[i] + (y[i] + carrier.u));
  double s = ground.slope, q = sqrt(1 + s * s);
  double v_x = y[2 * stride + i] + carrier.u_rate, v_z = y[3 * stride + i] + carrier.w_rate;
  double v_n = (v_z - s * v_x) / q, v_t = (v_x + s * v_z) / q;
  double left = fabs(v_t) - layer->scene.friction * fmax(-v_n, 0), after = left > 0 ? copysign(left, v_t) : 0;
  events->touch++;
  events->impact += layer->scene.mass * (v_n * v_n + v_t * v_t - after * after) / 2;
  y[2 * stride + i] = after / q - carrier.u_rate;
  int sticks = after == 0 && layer->has_friction;
  if (sticks) layer_stick(layer, i, y[i]);
  else layer_set_mode(layer, i, direction_of(after));
  events->decided[i] = sticks ? STOPPED : SETTLED;
}

/* The mode change of a mass whose first root function has come to 0, or else its second. */
static void change_mode(Events *events, double *y, int i, int first) {
  Layer *layer = events->layer;
  Mode before = layer->mode[i];
  events->decided[i] = SETTLED;
  if (before == FREE) {
    touch(events, y, i);
  } else if (first) {
    events->lift++;
    layer_set_mode(layer, i, FREE);
  } else if (before == STICKING) {
    events->break_++;
    layer_set_mode(layer, i, direction_of(layer_tangential_force(layer, i)));
  } else {
    events->stop++;
    layer_stick(layer, i, y[i]);
    events->decided[i] = STOPPED;
  }
}

/* One contact: F_N < 0: free; sticking with |f.t| > T(0), a mass that has just stopped included: slip. A contact whose
 * own event this is not may pass its limit by the margin, until its root is found. */
static void decide(Events *events, int i) {
  Layer *layer = events->layer;
  double margin = events->decided[i] == NOTHING ? events->margin.force : 0;
  Mode before = layer->mode[i];
  if (layer_normal_force(layer, i) < -margin) {
    layer_set_mode(layer, i, FREE);
  } else if (before == STICKING && events->decided[i] != SETTLED && layer->has_friction) {
    double f_t = layer_tangential_force(layer, i);
    if (fabs(f_t) > layer_limit(layer, i) + margin) layer_set_mode(layer, i, direction_of(f_t));
  }
  events->aside += events->decided[i] == NOTHING && layer->mode[i] != before;
}

/* One pass is enough: the forces follow from motion, which no decision changes. */
void events_settle(Events *events, double t, double *y) {
  Layer *layer = events->layer;
  layer_evaluate(layer, t, y);
  layer_store_contacts(layer, y);
  for (int n = 0; n < layer->contact.count; n++) decide(events, layer->contact.mass[n]);
}

/* Back to the usual margin once a mass has left the surface. */
static void restore_margins(Events *events, const double *y) {
  const Layer *layer = events->layer;
  for (int i = 0; i < layer->k; i++) {
    double *margin = &events->gap_margin[i];
    if (*margin == events->margin.gap) continue;
    double height = profile_at(&layer->profile, layer->scene.rest_x[i] + (y[i] + layer->carrier.u)).height;
    double gap = layer->scene.rest_z[i] + y[layer->stride + i] + layer->carrier.w - height;
    if (layer->mode[i] != FREE || gap > 2 * *margin) *margin = events->margin.gap;
  }
}

/* Whether a root that was found is an event; where the mass moves away, its gap's margin is raised. */
static int is_event(Events *events, const double *y, const int *found, int i) {
  const Layer *layer = events->layer;
  int second = layer->has_friction && found[layer->k + i];
  if (layer->mode[i] != FREE || !found[i] || !events_moves_apart(layer, y, i)) return found[i] || second;
  events->gap_margin[i] *= 4;
  events->apart++;
  return 0;
}

int events_handle(Events *events, double t, double *y, const int *found) {
  enum { REAL = SETTLED + 1 };
  Layer *layer = events->layer;
  int any = 0;
  layer->carrier = layer_carrier(layer, t);
  layer->known_at = NAN;
  for (int i = 0; i < layer->k; i++) {
    events->decided[i] = is_event(events, y, found, i) ? REAL : NOTHING;
    any |= events->decided[i];
  }
  if (!any) return 0;
  layer_evaluate(layer, t, y);
  layer_store_contacts(layer, y);
  for (int i = 0; i < layer->k; i++)
    if (events->decided[i] == REAL) change_mode(events, y, i, found[i]);
  events_settle(events, t, y);
  memset(events->decided, NOTHING, layer->k);
  restore_margins(events, y);
  return 1;
}
