#include "linear.h"

Variation variation_new(int k) {
  double *memory = room(9L * k, sizeof *memory);
  return (Variation){memory,         memory + k,     memory + 2 * k, memory + 3 * k, memory + 4 * k,
                     memory + 5 * k, memory + 6 * k, memory + 7 * k, memory + 8 * k};
}

static void vary_free(Variation *v, const Layer *layer) {
  double per_mass = 1 / layer->scene.mass;
  for (int i = 0; i < layer->k; i++) {
    v->x_moves[i] = v->z_moves[i] = 1;
    v->slope[i] = v->turn[i] = v->x_of_f_z[i] = v->x_of_x[i] = v->x_of_v[i] = 0;
    v->x_of_f_x[i] = v->z_of_f_z[i] = per_mass;
  }
}

static void vary_sticking(Variation *v, int i) {
  v->x_moves[i] = v->z_moves[i] = v->x_of_f_x[i] = v->z_of_f_z[i] = 0;
}

/* With N = (1 - S s) f_x + (s + S)(f_z - m κ ẋ²) - σ A τ_0 q, ẍ = N/(m q²); ds/dx = κ, dq/dx = s κ/q. */
static void vary_slipping(Variation *v, const Layer *layer, int i) {
  const Ground *ground = &layer->ground[i];
  double m = layer->scene.mass, s = ground->slope, kappa = ground->curvature, speed = layer_speed(layer, i);
  double sigma = layer->mode[i], S = sigma * layer->scene.friction, shear = sigma * layer->scene.shear;
  double q2 = 1 + s * s, q = sqrt(q2), w = 1 / (m * q2);
  double inertia = m * kappa * speed * speed, f_x = layer->f_x[i], f_z = layer->f_z[i] - inertia;
  double N = (1 - S * s) * f_x + (s + S) * f_z - shear * q;
  double N_x = kappa * (f_z - S * f_x - shear * s / q) - (s + S) * m * ground->third * speed * speed;
  v->z_moves[i] = v->z_of_f_z[i] = 0;
  v->slope[i] = s;
  v->turn[i] = kappa * speed;
  v->x_of_f_x[i] = (1 - S * s) * w;
  v->x_of_f_z[i] = (s + S) * w;
  v->x_of_x[i] = w * (N_x - 2 * s * kappa / q2 * N);
  v->x_of_v[i] = -2 * w * (s + S) * m * kappa * speed;
}

void linearise(Problem *problem, double t, N_Vector y) {
  Layer *layer = problem->layer;
  problem->forces_known_at = NAN;
  layer_evaluate(layer, t, N_VGetArrayPointer(y));
  vary_free(&problem->variation, layer);
  for (int j = 0; j < layer->contacts; j++) {
    int i = layer->contact[j];
    if (layer->mode[i] == STICKING) vary_sticking(&problem->variation, i);
    else vary_slipping(&problem->variation, layer, i);
  }
}
