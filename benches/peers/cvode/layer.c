#include "layer.h"

#include <string.h>

#include "arrays.h"

Layer layer_new(Scene scene) {
  int k = scene.k;
  Layer layer = {.scene = scene, .profile = profile_new(&scene), .k = k};
  layer.has_friction = scene.friction > 0 || scene.shear > 0;
  layer.order = 4L * k;
  for (int kind = 0; kind < KINDS; kind++) {
    int lateral = kind == LATERAL_X || kind == LATERAL_Z;
    layer.count[kind] = lateral ? k - 1 : k;
    layer.maxwell[kind] = layer.order;
    layer.order += (long)scene.link[kind].n * layer.count[kind];
    layer.rate[kind] = room(k, sizeof(double));
    layer.elongation[kind] = room(k, sizeof(double));
    layer.force[kind] = room(k, sizeof(double));
  }
  double **arrays[] = {&layer.f_x, &layer.f_z, &layer.stuck_at};
  for (unsigned i = 0; i < sizeof arrays / sizeof *arrays; i++) *arrays[i] = room(k, sizeof(double));
  /* The links to the carrier are elongated by the motion itself. */
  layer.e_x = layer.elongation[HORIZONTAL], layer.r_x = layer.rate[HORIZONTAL];
  layer.e_z = layer.elongation[VERTICAL], layer.r_z = layer.rate[VERTICAL];
  layer.mode = room(k, sizeof *layer.mode);
  layer.contact = room(k, sizeof *layer.contact);
  layer.ground = room(k, sizeof *layer.ground);
  layer.stuck_on = room(k, sizeof *layer.stuck_on);
  return layer;
}

void layer_enter_phase(Layer *layer, const Phase *phase, double t) {
  if (layer->phase) {
    Carrier carrier = layer_carrier(layer, t);
    layer->phase_u = carrier.u, layer->phase_w = carrier.w;
  }
  layer->phase_start = t;
  layer->phase = phase;
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

void layer_set_mode(Layer *layer, int i, Mode mode) {
  int was_free = layer->mode[i] == FREE;
  layer->mode[i] = mode;
  if (was_free == (mode == FREE)) return;
  layer->contacts = 0;
  for (int j = 0; j < layer->k; j++)
    if (layer->mode[j] != FREE) layer->contact[layer->contacts++] = j;
}

void layer_stick(Layer *layer, int i, double e_x) {
  layer_set_mode(layer, i, STICKING);
  layer->stuck_at[i] = e_x + layer->carrier.u;
  layer->stuck_on[i] = profile_at(&layer->profile, layer->scene.rest_x[i] + layer->stuck_at[i]);
}

void layer_start(Layer *layer, double *y) {
  int k = layer->k;
  Carrier carrier = layer->carrier = layer_carrier(layer, 0);
  memset(y, 0, layer->order * sizeof *y);
  for (int i = 0; i < k; i++) {
    Ground ground = profile_at(&layer->profile, layer->scene.rest_x[i] + carrier.u);
    double lift = ground.height - layer->scene.rest_z[i] - carrier.w, s = ground.slope;
    if (lift <= 0) continue;
    double v = (carrier.u_rate + s * carrier.w_rate) / (1 + s * s); /* ẋ of what is left of the velocity, along t */
    y[k + i] = lift;
    y[2 * k + i] = v - carrier.u_rate;
    y[3 * k + i] = s * v - carrier.w_rate;
    if (v == 0 && layer->has_friction) layer_stick(layer, i, 0);
    else layer_set_mode(layer, i, v < 0 ? BACKWARD : FORWARD);
  }
  layer_evaluate(layer, 0, y);
  if (layer->scene.relaxed) return;
  for (int kind = 0; kind < KINDS; kind++)
    for (int j = 0; j < layer->scene.link[kind].n; j++)
      memcpy(y + layer->maxwell[kind] + (long)j * layer->count[kind], layer->elongation[kind],
             layer->count[kind] * sizeof *y);
  layer_evaluate(layer, 0, y);
}

/* Motion of the masses: as the state has it where they are free, with the constraints put in where they are not. */
static void evaluate_motion(Layer *layer, const double *y) {
  int k = layer->k;
  const Scene *scene = &layer->scene;
  Carrier carrier = layer->carrier;
  memcpy(layer->e_x, y, k * sizeof *y);
  memcpy(layer->e_z, y + k, k * sizeof *y);
  memcpy(layer->r_x, y + 2 * k, k * sizeof *y);
  memcpy(layer->r_z, y + 3 * k, k * sizeof *y);
  for (int j = 0; j < layer->contacts; j++) {
    int i = layer->contact[j];
    if (layer->mode[i] == STICKING) {
      layer->ground[i] = layer->stuck_on[i];
      layer->e_x[i] = layer->stuck_at[i] - carrier.u;
      layer->r_x[i] = -carrier.u_rate;
    } else {
      layer->ground[i] = profile_at(&layer->profile, scene->rest_x[i] + (layer->e_x[i] + carrier.u));
    }
    layer->e_z[i] = layer->ground[i].height - scene->rest_z[i] - carrier.w;
    layer->r_z[i] = layer->ground[i].slope * layer_speed(layer, i) - carrier.w_rate;
  }
}

/* Rows 21, 22 of (13)-(15): F = c e + d ė + Σ_j c_j a_j. Four elements at a time, to pass through memory less often.
 */
static void evaluate_link(const Link *link, int count, const double *restrict e, const double *restrict r,
                          const double *restrict a, double *restrict force) {
  double c = link->c, d = link->d;
  EACH(i, count) force[i] = c * e[i] + d * r[i];
  const double *cj = link->stiffness;
  int j = 0;
  for (; j + 4 <= link->n; j += 4, a += 4L * count) {
    const double *a1 = a + count, *a2 = a1 + count, *a3 = a2 + count;
    EACH(i, count) force[i] += (cj[j] * a[i] + cj[j + 1] * a1[i]) + (cj[j + 2] * a2[i] + cj[j + 3] * a3[i]);
  }
  for (; j < link->n; j++, a += count) EACH(i, count) force[i] += cj[j] * a[i];
}

void layer_evaluate(Layer *layer, double t, const double *y) {
  layer->carrier = layer_carrier(layer, t);
  evaluate_motion(layer, y);
  differences(layer->k - 1, layer->e_x, layer->elongation[LATERAL_X]);
  differences(layer->k - 1, layer->e_z, layer->elongation[LATERAL_Z]);
  differences(layer->k - 1, layer->r_x, layer->rate[LATERAL_X]);
  differences(layer->k - 1, layer->r_z, layer->rate[LATERAL_Z]);
  for (int kind = 0; kind < KINDS; kind++)
    evaluate_link(&layer->scene.link[kind], layer->count[kind], layer->elongation[kind], layer->rate[kind],
                  y + layer->maxwell[kind], layer->force[kind]);
  sum_on_masses(layer->k, layer->force[HORIZONTAL], layer->force[LATERAL_X], layer->f_x);
  sum_on_masses(layer->k, layer->force[VERTICAL], layer->force[LATERAL_Z], layer->f_z);
  layer->F_x = sum(layer->k, layer->force[HORIZONTAL]);
  layer->F_z = sum(layer->k, layer->force[VERTICAL]);
}

void layer_store_contacts(const Layer *layer, double *y) {
  int k = layer->k;
  for (int j = 0; j < layer->contacts; j++) {
    int i = layer->contact[j];
    y[i] = layer->e_x[i], y[k + i] = layer->e_z[i];
    y[2 * k + i] = layer->r_x[i], y[3 * k + i] = layer->r_z[i];
  }
}

/* ẍ of a slipping mass: m q² ẍ = f_x + s f_z - F_T q - m s κ ẋ² with F_T = σ (μ F_N + A τ_0), so that
 * with S = σ μ: m q² ẍ = (1 - S s) f_x + (s + S)(f_z - m κ ẋ²) - σ A τ_0 q. */
static double slip_acceleration(const Layer *layer, int i) {
  double m = layer->scene.mass, s = layer->ground[i].slope, v = layer_speed(layer, i), sigma = layer->mode[i];
  double q2 = 1 + s * s, S = sigma * layer->scene.friction;
  double force = (1 - S * s) * layer->f_x[i] + (s + S) * (layer->f_z[i] - m * layer->ground[i].curvature * v * v);
  if (layer->scene.shear != 0) force -= sigma * layer->scene.shear * sqrt(q2);
  return force / (m * q2);
}

static void mass_derivatives(const Layer *layer, double *restrict f) {
  int k = layer->k;
  double per_mass = 1 / layer->scene.mass, u_acceleration = layer->carrier.u_acceleration,
         w_acceleration = layer->carrier.w_acceleration;
  memcpy(f, layer->r_x, k * sizeof *f);
  memcpy(f + k, layer->r_z, k * sizeof *f);
  EACH(i, k) f[2 * k + i] = layer->f_x[i] * per_mass - u_acceleration;
  EACH(i, k) f[3 * k + i] = layer->f_z[i] * per_mass - w_acceleration;
  for (int j = 0; j < layer->contacts; j++) {
    int i = layer->contact[j], sticks = layer->mode[i] == STICKING;
    if (sticks) f[i] = 0;
    f[k + i] = f[3 * k + i] = 0;
    f[2 * k + i] = sticks ? 0 : slip_acceleration(layer, i) - u_acceleration;
  }
}

/* ȧ_j = ė - a_j/τ_j. */
static void maxwell_derivatives(const Link *link, int count, const double *restrict rate, const double *restrict a,
                                double *restrict f) {
  for (int j = 0; j < link->n; j++, a += count, f += count) {
    double per_tau = link->rate[j];
    EACH(i, count) f[i] = rate[i] - per_tau * a[i];
  }
}

void layer_derivatives(const Layer *layer, const double *y, double *f) {
  mass_derivatives(layer, f);
  for (int kind = 0; kind < KINDS; kind++)
    maxwell_derivatives(&layer->scene.link[kind], layer->count[kind], layer->rate[kind], y + layer->maxwell[kind],
                        f + layer->maxwell[kind]);
}

/* P_damper = Σ d ė², P_maxwell = Σ c_j τ_j ẏ_j² = Σ c_j a_j²/τ_j, P_friction = Σ F_T v_t
 * and P_in = -(F_x u̇ + F_z ẇ). */
void layer_power(const Layer *layer, const double *y, double power[CHANNELS]) {
  memset(power, 0, CHANNELS * sizeof *power);
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &layer->scene.link[kind];
    long count = layer->count[kind];
    power[DAMPER] += link->d * sum_of_squares(count, layer->rate[kind]);
    for (int j = 0; j < link->n; j++)
      power[MAXWELL] +=
          link->stiffness[j] * link->rate[j] * sum_of_squares(count, y + layer->maxwell[kind] + j * count);
  }
  for (int j = 0; layer->has_friction && j < layer->contacts; j++) {
    int i = layer->contact[j];
    if (layer->mode[i] == STICKING) continue;
    double s = layer->ground[i].slope, v_t = layer_speed(layer, i) * sqrt(1 + s * s);
    power[FRICTION] += layer->mode[i] * layer_limit(layer, i) * v_t;
  }
  power[INPUT] = -(layer->F_x * layer->carrier.u_rate + layer->F_z * layer->carrier.w_rate);
}

double layer_stored_energy(const Layer *layer, const double *y) {
  double energy = 0;
  for (int i = 0; i < layer->k; i++) {
    double v_x = layer->r_x[i] + layer->carrier.u_rate, v_z = layer->r_z[i] + layer->carrier.w_rate;
    energy += layer->scene.mass * (v_x * v_x + v_z * v_z) / 2;
  }
  for (int kind = 0; kind < KINDS; kind++) {
    const Link *link = &layer->scene.link[kind];
    long count = layer->count[kind];
    energy += link->c * sum_of_squares(count, layer->elongation[kind]) / 2;
    for (int j = 0; j < link->n; j++)
      energy += link->stiffness[j] * sum_of_squares(count, y + layer->maxwell[kind] + j * count) / 2;
  }
  return energy;
}
