#include "layer.h"

#include <string.h>

#include "arrays.h"

double *layer_array(const Layer *layer) {
  return (double *)room(layer->stride + 2 * VECTOR, sizeof(double)) + VECTOR;
}

static List list_new(int k) {
  return (List){0, room(k, sizeof(int))};
}

/* Where things stand in the state. */
static void lay_out(Layer *layer) {
  layer->stride = (layer->k + VECTOR - 1L) / VECTOR * VECTOR;
  layer->order = 4 * layer->stride;
  for (int kind = 0; kind < KINDS; kind++) {
    layer->count[kind] = is_lateral(kind) ? layer->k - 1 : layer->k;
    layer->maxwell[kind] = layer->order;
    layer->order += layer->scene.link[kind].n * layer->stride;
  }
  layer->energy = layer->order;
  layer->order += VECTOR;
}

Layer layer_new(Scene scene) {
  Layer layer = {.scene = scene, .profile = profile_new(&scene), .k = scene.k, .lists_stale = 1, .known_at = NAN};
  layer.per_mass = 1 / scene.mass;
  layer.has_friction = scene.friction > 0 || scene.shear > 0;
  lay_out(&layer);
  for (int kind = 0; kind < KINDS; kind++) {
    layer.rate[kind] = layer_array(&layer);
    layer.elongation[kind] = layer_array(&layer);
    layer.force[kind] = layer_array(&layer);
  }
  double **arrays[] = {&layer.f_x,   &layer.f_z,       &layer.speed,   &layer.slope,
                       &layer.third, &layer.curvature, &layer.stuck_at};
  for (unsigned i = 0; i < sizeof arrays / sizeof *arrays; i++) *arrays[i] = layer_array(&layer);
  /* The links to the carrier are elongated by the motion itself. */
  layer.e_x = layer.elongation[HORIZONTAL], layer.r_x = layer.rate[HORIZONTAL];
  layer.e_z = layer.elongation[VERTICAL], layer.r_z = layer.rate[VERTICAL];
  layer.mode = room(layer.k, sizeof *layer.mode);
  layer.contact = list_new(layer.k), layer.slipping = list_new(layer.k), layer.sticking = list_new(layer.k);
  layer.stuck_on = room(layer.k, sizeof *layer.stuck_on);
  return layer;
}

/* ---- the carrier ---- */

void layer_enter_phase(Layer *layer, const Phase *phase, double t) {
  if (layer->phase) {
    Carrier carrier = layer_carrier(layer, t);
    layer->phase_u = carrier.u, layer->phase_w = carrier.w;
  }
  layer->phase_start = t;
  layer->phase = phase;
  layer->known_at = NAN;
}

static void follow(const Path *path, double s, double *place, double *rate, double *acceleration) {
  *place += path->rate * s;
  *rate = path->rate;
  *acceleration = 0;
  if (path->amplitude == 0) return;
  double omega = 2 * M_PI * path->frequency, sine = sin(omega * s);
  *place += path->amplitude * sine;
  *rate += path->amplitude * omega * cos(omega * s);
  *acceleration = -path->amplitude * omega * omega * sine;
}

Carrier layer_carrier(const Layer *layer, double t) {
  double s = t - layer->phase_start;
  Carrier carrier = {.u = layer->phase_u, .w = layer->phase_w};
  follow(&layer->phase->u, s, &carrier.u, &carrier.u_rate, &carrier.u_acceleration);
  follow(&layer->phase->w, s, &carrier.w, &carrier.w_rate, &carrier.w_acceleration);
  return carrier;
}

/* ---- modes ---- */

void layer_set_mode(Layer *layer, int i, Mode mode) {
  layer->mode[i] = mode;
  layer->lists_stale = 1;
  layer->mode_changes++;
  layer->known_at = NAN;
}

void layer_stick(Layer *layer, int i, double e_x) {
  layer_set_mode(layer, i, STICKING);
  layer->stuck_at[i] = e_x + layer->carrier.u;
  layer->stuck_on[i] = profile_at(&layer->profile, layer->scene.rest_x[i] + layer->stuck_at[i]);
}

void layer_list(Layer *layer) {
  if (!layer->lists_stale) return;
  layer->contact.count = layer->slipping.count = layer->sticking.count = 0;
  for (int i = 0; i < layer->k; i++) {
    if (layer->mode[i] == FREE) continue;
    List *list = layer->mode[i] == STICKING ? &layer->sticking : &layer->slipping;
    layer->contact.mass[layer->contact.count++] = i;
    list->mass[list->count++] = i;
  }
  layer->lists_stale = 0;
}

/* ---- start ---- */

/* A mass that lies under the profile: lifted onto it, it keeps the part of its velocity along t. */
static void lift(Layer *layer, double *y, int i) {
  long stride = layer->stride;
  Carrier carrier = layer->carrier;
  Ground ground = profile_at(&layer->profile, layer->scene.rest_x[i] + carrier.u);
  double height = ground.height - layer->scene.rest_z[i] - carrier.w, s = ground.slope;
  if (height <= 0) return;
  double v = (carrier.u_rate + s * carrier.w_rate) / (1 + s * s);
  y[stride + i] = height;
  y[2 * stride + i] = v - carrier.u_rate;
  y[3 * stride + i] = s * v - carrier.w_rate;
  if (v == 0 && layer->has_friction) layer_stick(layer, i, 0);
  else layer_set_mode(layer, i, v < 0 ? BACKWARD : FORWARD);
}

void layer_start(Layer *layer, double *y) {
  memset(y, 0, layer->order * sizeof *y);
  layer->carrier = layer_carrier(layer, 0);
  for (int i = 0; i < layer->k; i++) lift(layer, y, i);
  layer_evaluate(layer, 0, y);
  if (layer->scene.relaxed) return;
  for (int kind = 0; kind < KINDS; kind++)
    for (int j = 0; j < layer->scene.link[kind].n; j++)
      memcpy(y + layer->maxwell[kind] + j * layer->stride, layer->elongation[kind], layer->count[kind] * sizeof *y);
}

/* ---- motion ---- */

static void constrain_sticking(Layer *layer) {
  Carrier carrier = layer->carrier;
  for (int n = 0; n < layer->sticking.count; n++) {
    int i = layer->sticking.mass[n];
    const Ground *ground = &layer->stuck_on[i];
    layer->e_x[i] = layer->stuck_at[i] - carrier.u;
    layer->e_z[i] = ground->height - layer->scene.rest_z[i] - carrier.w;
    layer->r_x[i] = -carrier.u_rate, layer->r_z[i] = -carrier.w_rate;
    layer->speed[i] = layer->third[i] = 0;
    layer->slope[i] = ground->slope, layer->curvature[i] = ground->curvature;
  }
}

static inline void constrain_to(Layer *layer, const Carrier *carrier, int i, Ground ground) {
  double v = layer->r_x[i] + carrier->u_rate;
  layer->speed[i] = v;
  layer->slope[i] = ground.slope, layer->curvature[i] = ground.curvature, layer->third[i] = ground.third;
  layer->e_z[i] = ground.height - layer->scene.rest_z[i] - carrier->w;
  layer->r_z[i] = ground.slope * v - carrier->w_rate;
}

void layer_constrain(Layer *layer) {
  constrain_sticking(layer);
  Carrier carrier = layer->carrier;
  const Profile profile = layer->profile;
  const double *rest_x = layer->scene.rest_x;
  const int *mass = layer->slipping.mass, count = layer->slipping.count;
  if (profile_is_even(&profile)) {
    for (int n = 0; n < count; n++) {
      int i = mass[n];
      double t;
      const Piece *piece = profile_even_piece(&profile, rest_x[i] + layer->e_x[i] + carrier.u, &t);
      constrain_to(layer, &carrier, i, profile_on(piece, t));
    }
  } else {
    for (int n = 0; n < count; n++) {
      int i = mass[n];
      constrain_to(layer, &carrier, i, profile_at(&profile, rest_x[i] + (layer->e_x[i] + carrier.u)));
    }
  }
}

/* Motion of the masses: as the state has it where they are free, with the constraints put in where they are not. */
static void evaluate_motion(Layer *layer, const double *y) {
  long bytes = layer->k * sizeof *y, stride = layer->stride;
  layer_list(layer);
  memcpy(layer->e_x, y, bytes);
  memcpy(layer->e_z, y + stride, bytes);
  memcpy(layer->r_x, y + 2 * stride, bytes);
  memcpy(layer->r_z, y + 3 * stride, bytes);
  layer_constrain(layer);
}

/* ---- forces ---- */

/* Rows 21, 22 of (13)-(15): F = c e + d ė + Σ_j c_j a_j. Four elements at a time, to pass through memory less often,
 * and whole vectors: what fills the arrays up is 0. */
static void evaluate_link(const Layer *layer, int kind, const double *restrict a) {
  const Link *link = &layer->scene.link[kind];
  const double *restrict e = layer->elongation[kind], *restrict r = layer->rate[kind];
  double *restrict force = layer->force[kind];
  long count = layer->count[kind], stride = layer->stride;
  double c = link->c, d = link->d;
  EACH(i, count) force[i] = c * e[i] + d * r[i];
  int j = 0;
  for (; j + 4 <= link->n; j += 4, a += 4 * stride) {
    const double c0 = link->stiffness[j], c1 = link->stiffness[j + 1], c2 = link->stiffness[j + 2],
                 c3 = link->stiffness[j + 3];
    const double *a1 = a + stride, *a2 = a1 + stride, *a3 = a2 + stride;
    EACH(i, stride) force[i] += (c0 * a[i] + c1 * a1[i]) + (c2 * a2[i] + c3 * a3[i]);
  }
  for (; j < link->n; j++, a += stride) {
    double c0 = link->stiffness[j];
    EACH(i, stride) force[i] += c0 * a[i];
  }
}

void layer_evaluate(Layer *layer, double t, const double *y) {
  long between = layer->k - 1;
  layer->known_at = NAN;
  layer->carrier = layer_carrier(layer, t);
  evaluate_motion(layer, y);
  differences(between, layer->e_x, layer->elongation[LATERAL_X]);
  differences(between, layer->e_z, layer->elongation[LATERAL_Z]);
  differences(between, layer->r_x, layer->rate[LATERAL_X]);
  differences(between, layer->r_z, layer->rate[LATERAL_Z]);
  for (int kind = 0; kind < KINDS; kind++) evaluate_link(layer, kind, y + layer->maxwell[kind]);
  sum_on_masses(layer->k, layer->force[HORIZONTAL], layer->force[LATERAL_X], layer->f_x);
  sum_on_masses(layer->k, layer->force[VERTICAL], layer->force[LATERAL_Z], layer->f_z);
}

void layer_evaluate_unless_known(Layer *layer, double t, const double *y) {
  if (t != layer->known_at) layer_evaluate(layer, t, y);
}

void layer_carrier_forces(const Layer *layer, double *F_x, double *F_z) {
  *F_x = sum(layer->k, layer->force[HORIZONTAL]);
  *F_z = sum(layer->k, layer->force[VERTICAL]);
}

void layer_store_mass(const Layer *layer, int i, double *y) {
  long stride = layer->stride;
  y[i] = layer->e_x[i], y[stride + i] = layer->e_z[i];
  y[2 * stride + i] = layer->r_x[i], y[3 * stride + i] = layer->r_z[i];
}

void layer_store_contacts(const Layer *layer, double *y) {
  for (int n = 0; n < layer->contact.count; n++) layer_store_mass(layer, layer->contact.mass[n], y);
}

/* ---- derivatives ---- */

static void mass_derivatives(const Layer *layer, double *restrict f) {
  long k = layer->k, stride = layer->stride;
  double per_mass = layer->per_mass;
  double u_acceleration = layer->carrier.u_acceleration, w_acceleration = layer->carrier.w_acceleration;
  const double *restrict f_x = layer->f_x, *restrict f_z = layer->f_z;
  double *restrict r_x_rate = f + 2 * stride, *restrict r_z_rate = f + 3 * stride;
  memcpy(f, layer->r_x, k * sizeof *f);
  memcpy(f + stride, layer->r_z, k * sizeof *f);
  EACH(i, k) r_x_rate[i] = f_x[i] * per_mass - u_acceleration;
  EACH(i, k) r_z_rate[i] = f_z[i] * per_mass - w_acceleration;
  for (int n = 0; n < layer->contact.count; n++) {
    int i = layer->contact.mass[n], sticks = layer->mode[i] == STICKING;
    if (sticks) f[i] = 0;
    f[stride + i] = r_z_rate[i] = 0;
    r_x_rate[i] = sticks ? 0 : layer_slip_acceleration(layer, i) - u_acceleration;
  }
}

/* ȧ_j = ė - a_j/τ_j. */
static void maxwell_derivatives(const Layer *layer, int kind, const double *restrict a, double *restrict f) {
  const Link *link = &layer->scene.link[kind];
  const double *restrict rate = layer->rate[kind];
  long count = layer->count[kind];
  for (int j = 0; j < link->n; j++, a += layer->stride, f += layer->stride) {
    double per_tau = link->rate[j];
    EACH(i, count) f[i] = rate[i] - per_tau * a[i];
  }
}

void layer_derivatives(const Layer *layer, const double *y, double *f) {
  mass_derivatives(layer, f);
  for (int kind = 0; kind < KINDS; kind++)
    maxwell_derivatives(layer, kind, y + layer->maxwell[kind], f + layer->maxwell[kind]);
  memset(f + layer->energy, 0, VECTOR * sizeof *f);
  layer_power(layer, layer_maxwell_power(layer, y), f + layer->energy);
}

/* ---- energies ---- */

double layer_maxwell_power(const Layer *layer, const double *y) {
  double power = 0;
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &layer->scene.link[kind];
    for (int j = 0; j < link->n; j++)
      power += link->stiffness[j] * link->rate[j] *
               sum_of_squares(layer->stride, y + layer->maxwell[kind] + j * layer->stride);
  }
  return power;
}

/* P_damper = Σ d ė², P_friction = Σ F_T v_t and P_in = -(F_x u̇ + F_z ẇ). */
void layer_power(const Layer *layer, double maxwell, double power[CHANNELS]) {
  double damper = 0, friction = 0, F_x, F_z;
  for (int kind = 0; kind < KINDS; kind++)
    damper += layer->scene.link[kind].d * sum_of_squares(layer->count[kind], layer->rate[kind]);
  for (int n = 0; layer->has_friction && n < layer->slipping.count; n++) {
    int i = layer->slipping.mass[n];
    double s = layer->slope[i];
    friction += layer->mode[i] * layer_limit(layer, i) * layer->speed[i] * sqrt(1 + s * s);
  }
  layer_carrier_forces(layer, &F_x, &F_z);
  power[DAMPER] = damper;
  power[MAXWELL] = maxwell;
  power[FRICTION] = friction;
  power[INPUT] = -(F_x * layer->carrier.u_rate + F_z * layer->carrier.w_rate);
}

double layer_stored_energy(const Layer *layer, const double *y) {
  double energy = 0;
  for (int i = 0; i < layer->k; i++) {
    double v_x = layer->r_x[i] + layer->carrier.u_rate, v_z = layer->r_z[i] + layer->carrier.w_rate;
    energy += layer->scene.mass * (v_x * v_x + v_z * v_z) / 2;
  }
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &layer->scene.link[kind];
    energy += link->c * sum_of_squares(layer->count[kind], layer->elongation[kind]) / 2;
    for (int j = 0; j < link->n; j++)
      energy +=
          link->stiffness[j] * sum_of_squares(layer->count[kind], y + layer->maxwell[kind] + j * layer->stride) / 2;
  }
  return energy;
}
