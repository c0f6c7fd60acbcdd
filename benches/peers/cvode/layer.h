/* The layer of point masses: its state as CVODE sees it, motion, forces, power.
 *
 * The state is a structure of arrays over the masses i, so that every loop over masses is one of vectors whatever the
 * number of Maxwell elements:
 *
 *   e_x | e_z | r_x | r_z | vertical a_1, a_2 ... | horizontal | lateral x | lateral z
 *
 * with e_x = ξ - u and e_z = ζ - w the elongations of the links to the carrier, r_x and r_z their rates, and
 * a_j = e - y_j those of the Maxwell springs: k of each, k - 1 of lateral ones. This is the carrier's frame: tolerances
 * mean deflections, not places.
 *
 * The dimension is fixed, so that nothing is set up anew when modes change. A slipping mass has one degree of freedom:
 * its e_z and r_z rest in the state, z = z_r(x) and ż = s ẋ are put in where they are needed. A sticking mass has
 * none. */
#ifndef LAYER_H
#define LAYER_H

#include "profile.h"
#include "scene.h"

/* Free: gap > 0. Slipping along +t or -t: gap = 0, the value is the direction. Sticking: gap = 0, ẋ = 0. */
typedef enum { BACKWARD = -1, FREE = 0, FORWARD = 1, STICKING = 2 } Mode;

/* The carrier at one instant. */
typedef struct {
  double u, w, u_rate, w_rate, u_acceleration, w_acceleration;
} Carrier;

typedef struct {
  Scene scene;
  Profile profile;
  int k;
  int has_friction; /* contacts can stick */

  /* Where things stand in the state; row j of a kind begins at maxwell[kind] + j count[kind]. */
  long order, maxwell[KINDS];
  int count[KINDS];

  /* The phase of the excitation: where it began. */
  const Phase *phase;
  double phase_start, phase_u, phase_w;

  /* Modes, the masses in contact one after another, and where the sticking ones stand. */
  Mode *mode;
  int *contact, contacts;
  double *stuck_at; /* ξ = x - X */
  Ground *stuck_on;

  /* At the instant last evaluated: the carrier, motion with the constraints put in, links, forces on the masses. */
  Carrier carrier;
  double *e_x, *e_z, *r_x, *r_z;
  Ground *ground; /* of masses in contact */
  double *elongation[KINDS], *rate[KINDS], *force[KINDS];
  double *f_x, *f_z;
  double F_x, F_z; /* on the carrier */
} Layer;

/* The channels of the energy: what CVODE integrates beside the state. */
enum { DAMPER, MAXWELL, FRICTION, INPUT, CHANNELS };

Layer layer_new(Scene scene);

/* At rest under the carrier of the first phase; what lies under the profile is lifted onto it, and then slips, or
 * sticks where it does not move, until events_settle decides. */
void layer_start(Layer *layer, double *y);

void layer_enter_phase(Layer *layer, const Phase *phase, double t);
Carrier layer_carrier(const Layer *layer, double t);

/* Sets a mode, and keeps the list of contacts. A mass that sticks does so where it is, at e_x under the carrier. */
void layer_set_mode(Layer *layer, int i, Mode mode);
void layer_stick(Layer *layer, int i, double e_x);

/* Evaluates motion and forces in the state y at time t. */
void layer_evaluate(Layer *layer, double t, const double *y);

/* Writes the motion of the masses in contact into the state, where parts of it rested. */
void layer_store_contacts(const Layer *layer, double *y);

/* All of these at the instant last evaluated. */
void layer_derivatives(const Layer *layer, const double *y, double *f);
void layer_power(const Layer *layer, const double *y, double power[CHANNELS]);
double layer_stored_energy(const Layer *layer, const double *y);

/* Of mass i: ẋ; and in contact F_N, f.t, T(0). */
static inline double layer_speed(const Layer *layer, int i) {
  return layer->r_x[i] + layer->carrier.u_rate;
}

/* (9): F_N = (m κ ẋ² - f_z + s f_x)/q. */
static inline double layer_normal_force(const Layer *layer, int i) {
  const Ground *ground = &layer->ground[i];
  double s = ground->slope, v = layer_speed(layer, i);
  return (layer->scene.mass * ground->curvature * v * v - layer->f_z[i] + s * layer->f_x[i]) / sqrt(1 + s * s);
}

static inline double layer_tangential_force(const Layer *layer, int i) {
  double s = layer->ground[i].slope;
  return (layer->f_x[i] + s * layer->f_z[i]) / sqrt(1 + s * s);
}

static inline double layer_limit(const Layer *layer, int i) {
  return layer->scene.friction * layer_normal_force(layer, i) + layer->scene.shear;
}

static inline double layer_gap(const Layer *layer, int i) {
  double x = layer->scene.rest_x[i] + (layer->e_x[i] + layer->carrier.u);
  double z = layer->scene.rest_z[i] + (layer->e_z[i] + layer->carrier.w);
  return z - profile_at(&layer->profile, x).height;
}

#endif
