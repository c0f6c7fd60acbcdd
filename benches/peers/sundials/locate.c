#include "locate.h"

#include <string.h>

Locator locator_new(Events *events, Interpolate *interpolate, void *integrator, N_Vector model) {
  int count = events_count(events->layer);
  Locator locator = {.events = events, .interpolate = interpolate, .integrator = integrator};
  locator.before = room(count, sizeof(double));
  locator.after = room(count, sizeof(double));
  locator.candidate = room(count, sizeof(int));
  locator.found = room(count, sizeof(int));
  locator.state = N_VClone(model);
  return locator;
}

void locator_begin(Locator *locator, double t, const double *y) {
  events_roots(locator->events, t, y, locator->before);
}

/* ---- one root function in any state ---- */

/* Motion of one mass. */
typedef struct {
  double e_x, e_z, r_x, r_z, speed, slope, curvature;
} Motion;

/* Forces along x and z. */
typedef struct {
  double x, z;
} Force;

static Motion motion_of(const Layer *layer, const double *y, int i) {
  long stride = layer->stride;
  Motion motion = {.e_x = y[i], .e_z = y[stride + i], .r_x = y[2 * stride + i], .r_z = y[3 * stride + i]};
  if (layer->mode[i] == FREE) return motion;
  Carrier carrier = layer->carrier;
  Ground ground = layer->stuck_on[i];
  if (layer->mode[i] == STICKING) {
    motion.e_x = layer->stuck_at[i] - carrier.u;
    motion.r_x = -carrier.u_rate;
  } else {
    ground = profile_at(&layer->profile, layer->scene.rest_x[i] + (motion.e_x + carrier.u));
  }
  motion.speed = motion.r_x + carrier.u_rate;
  motion.slope = ground.slope, motion.curvature = ground.curvature;
  motion.e_z = ground.height - layer->scene.rest_z[i] - carrier.w;
  motion.r_z = ground.slope * motion.speed - carrier.w_rate;
  return motion;
}

static double force_of(const Layer *layer, int kind, int i, double e, double r, const double *y) {
  const Link *link = &layer->scene.link[kind];
  const double *a = y + layer->maxwell[kind] + i;
  double force = link->c * e + link->d * r;
  for (int j = 0; j < link->n; j++) force += link->stiffness[j] * a[j * layer->stride];
  return force;
}

/* Of the lateral links between mass i and the next. */
static Force between(const Layer *layer, const double *y, int i, const Motion *left, const Motion *right) {
  return (Force){force_of(layer, LATERAL_X, i, right->e_x - left->e_x, right->r_x - left->r_x, y),
                 force_of(layer, LATERAL_Z, i, right->e_z - left->e_z, right->r_z - left->r_z, y)};
}

static Force force_on(const Layer *layer, const double *y, int i, const Motion *own) {
  Force force = {-force_of(layer, HORIZONTAL, i, own->e_x, own->r_x, y),
                 -force_of(layer, VERTICAL, i, own->e_z, own->r_z, y)};
  if (i < layer->k - 1) {
    Motion next = motion_of(layer, y, i + 1);
    Force lateral = between(layer, y, i, own, &next);
    force.x += lateral.x, force.z += lateral.z;
  }
  if (i > 0) {
    Motion previous = motion_of(layer, y, i - 1);
    Force lateral = between(layer, y, i - 1, &previous, own);
    force.x -= lateral.x, force.z -= lateral.z;
  }
  return force;
}

static double gap_of(const Locator *locator, const double *y, int i) {
  const Layer *layer = locator->events->layer;
  double height = profile_at(&layer->profile, layer->scene.rest_x[i] + (y[i] + layer->carrier.u)).height;
  double z = layer->scene.rest_z[i] + (y[layer->stride + i] + layer->carrier.w);
  return z - height + locator->events->gap_margin[i];
}

/* The layer's carrier is that of the state's time. */
static double root_of(const Locator *locator, const double *y, int root) {
  const Layer *layer = locator->events->layer;
  Margins margin = locator->events->margin;
  int second = root >= layer->k, i = second ? root - layer->k : root;
  if (layer->mode[i] == FREE) return gap_of(locator, y, i);
  Motion motion = motion_of(layer, y, i);
  if (second && layer->mode[i] != STICKING) return layer->mode[i] * motion.speed + margin.speed;
  Force force = force_on(layer, y, i, &motion);
  double s = motion.slope, per_q = 1 / sqrt(1 + s * s);
  double inertia = layer->scene.mass * motion.curvature * motion.speed * motion.speed;
  double normal = (inertia - force.z + s * force.x) * per_q;
  if (!second) return normal + margin.force;
  double limit = layer->scene.friction * normal + layer->scene.shear;
  return limit - fabs(force.x + s * force.z) * per_q + margin.force;
}

static double tolerance_of(const Locator *locator, int root) {
  const Layer *layer = locator->events->layer;
  int second = root >= layer->k, i = second ? root - layer->k : root;
  if (layer->mode[i] == FREE) return locator->tolerance.gap;
  return second && layer->mode[i] != STICKING ? locator->tolerance.speed : locator->tolerance.force;
}

/* ---- location ---- */

/* An interval of time, and the lowest of the candidates at its ends, over their tolerances. */
typedef struct {
  double low, high, at_low, at_high;
} Bracket;

/* Notes the root functions that fell through 0; their number. */
static int note_candidates(Locator *locator, Bracket *bracket) {
  int count = events_count(locator->events->layer), n = 0;
  bracket->at_low = bracket->at_high = INFINITY;
  for (int root = 0; root < count; root++) {
    if (locator->after[root] > 0 || locator->before[root] <= 0) continue;
    double tolerance = tolerance_of(locator, root);
    locator->candidate[n++] = root;
    bracket->at_low = fmin(bracket->at_low, locator->before[root] / tolerance);
    bracket->at_high = fmin(bracket->at_high, locator->after[root] / tolerance);
  }
  return n;
}

static void interpolate(Locator *locator, double t) {
  Layer *layer = locator->events->layer;
  locator->interpolate(locator->integrator, t, locator->state);
  locator->interpolations++;
  locator->state_at = t;
  layer->carrier = layer_carrier(layer, t);
  layer->known_at = NAN;
}

static double lowest(Locator *locator, double t, int count) {
  interpolate(locator, t);
  const double *y = NV_DATA_S(locator->state);
  double least = INFINITY;
  for (int n = 0; n < count; n++) {
    int root = locator->candidate[n];
    least = fmin(least, root_of(locator, y, root) / tolerance_of(locator, root));
  }
  return least;
}

/* False position with the value of an end that stays halved (Illinois), then bisection, until the upper end has passed
 * by less than the fraction allowed. */
static void narrow(Locator *locator, Bracket *bracket, int count) {
  enum { MOST = 60, BISECT_AFTER = 20 };
  double resolution = 1e-10 * (bracket->high - bracket->low);
  int stayed = 0; /* 1: the upper end did, -1: the lower */
  for (int n = 0; n < MOST && bracket->at_high < -locator->passed && bracket->high - bracket->low > resolution; n++) {
    double width = bracket->high - bracket->low;
    double share = n > BISECT_AFTER ? 0.5 : bracket->at_high / (bracket->at_high - bracket->at_low);
    double t = bracket->high - width * fmin(fmax(share, 1e-3), 1 - 1e-3), value = lowest(locator, t, count);
    if (value > 0) {
      bracket->low = t, bracket->at_low = value;
      if (stayed == 1) bracket->at_high /= 2;
      stayed = 1;
    } else {
      bracket->high = t, bracket->at_high = value;
      if (stayed == -1) bracket->at_low /= 2;
      stayed = -1;
    }
  }
}

/* Raises the margin of a gap that closes while the mass moves away, at both ends of the step. */
static void raise_margin(Locator *locator, int i) {
  double more = 3 * locator->events->gap_margin[i];
  locator->events->gap_margin[i] += more;
  locator->before[i] += more;
  locator->after[i] += more;
  locator->events->apart++;
}

/* Notes which of the candidates are events in the state y; their number. */
static int note_events(Locator *locator, const double *y, int is_end, int count) {
  const Layer *layer = locator->events->layer;
  int events = 0;
  memset(locator->found, 0, events_count(layer) * sizeof(int));
  for (int n = 0; n < count; n++) {
    int root = locator->candidate[n];
    if (!is_end && root_of(locator, y, root) > 0) continue;
    int touches = root < layer->k && layer->mode[root] == FREE;
    if (touches && events_moves_apart(layer, y, root)) {
      raise_margin(locator, root);
    } else {
      locator->found[root] = 1;
      events++;
    }
  }
  return events;
}

double locator_first(Locator *locator, double t0, double t1, const double *y) {
  Layer *layer = locator->events->layer;
  events_roots(locator->events, t1, y, locator->after);
  for (;;) {
    Bracket bracket = {.low = t0, .high = t1};
    int count = note_candidates(locator, &bracket);
    if (count == 0) {
      double *after = locator->after;
      locator->after = locator->before;
      locator->before = after;
      return INFINITY;
    }
    locator->state_at = t1;
    narrow(locator, &bracket, count);
    int is_end = bracket.high == t1;
    if (!is_end && locator->state_at != bracket.high) interpolate(locator, bracket.high);
    layer->carrier = layer_carrier(layer, bracket.high);
    layer->known_at = NAN;
    if (note_events(locator, is_end ? y : NV_DATA_S(locator->state), is_end, count)) return bracket.high;
  }
}

/* ---- foresight ---- */

/* Until the gap g of a mass is closed, by its rate and acceleration: the first root of g + ġ t + g̈ t²/2. */
static double time_to_touch(const Layer *layer, int i, double gap) {
  const double far = 1e-5; /* m */
  if (gap > far) return INFINITY;
  Ground ground = profile_at(&layer->profile, layer->scene.rest_x[i] + (layer->e_x[i] + layer->carrier.u));
  double s = ground.slope, v_x = layer->r_x[i] + layer->carrier.u_rate;
  double rate = layer->r_z[i] + layer->carrier.w_rate - s * v_x;
  double acceleration = (layer->f_z[i] - s * layer->f_x[i]) / layer->scene.mass - ground.curvature * v_x * v_x;
  double square = rate * rate - 2 * acceleration * gap;
  if (square < 0 || (rate >= 0 && acceleration >= 0)) return INFINITY;
  double time = 2 * gap / (sqrt(square) - rate);
  return time > 0 ? time : INFINITY;
}

double locator_foresee(const Locator *locator) {
  const Layer *layer = locator->events->layer;
  double first = INFINITY;
  for (int i = 0; i < layer->k; i++)
    if (layer->mode[i] == FREE) first = fmin(first, time_to_touch(layer, i, locator->before[i]));
  return first;
}
