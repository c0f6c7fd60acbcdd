/* The layer of point masses: its state as SUNDIALS sees it, motion, forces, power.
 *
 * The state is a structure of arrays over the masses i, so that every loop over masses is one of vectors whatever the
 * number of Maxwell elements:
 *
 *   e_x | e_z | r_x | r_z | vertical a_1, a_2 ... | horizontal | lateral x | lateral z | energies
 *
 * with e_x = ξ - u and e_z = ζ - w the elongations of the links to the carrier, r_x and r_z their rates, and
 * a_j = e - y_j those of the Maxwell springs: k of each, k - 1 of lateral ones. Each array is filled up with zeros to a
 * whole number of vectors. This is the carrier's frame: tolerances mean deflections, not places.
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

/* The channels of the energy, in J, at the end of the state. */
enum { DAMPER, MAXWELL, FRICTION, INPUT, CHANNELS };

/* Numbers in one vector of the widest kind: arrays of the state are a multiple of it long. */
enum { VECTOR = 8 };

/* The carrier at one instant. */
typedef struct {
  double u, w, u_rate, w_rate, u_acceleration, w_acceleration;
} Carrier;

/* Masses, one after another. */
typedef struct {
  int count, *mass;
} List;

typedef struct {
  Scene scene;
  Profile profile;
  int k;
  double per_mass;  /* 1/m */
  int has_friction; /* contacts can stick */

  /* Where things stand in the state; element j of a kind begins at maxwell[kind] + j stride. */
  long stride, order, maxwell[KINDS], energy;
  int count[KINDS];

  /* The phase of the excitation: where it began. */
  const Phase *phase;
  double phase_start, phase_u, phase_w;

  /* Modes, and which masses are in contact, slip and stick: brought up to date by layer_list. */
  Mode *mode;
  List contact, slipping, sticking;
  int lists_stale;
  long mode_changes;
  double *stuck_at; /* ξ = x - X */
  Ground *stuck_on;

  /* At the instant last evaluated: the carrier, motion with the constraints put in, links, forces on the masses. Arrays
   * of links have a place -1. */
  Carrier carrier;
  double *e_x, *e_z, *r_x, *r_z;
  double *speed, *slope, *curvature, *third; /* ẋ and the profile's derivatives, of masses in contact */
  double *elongation[KINDS], *rate[KINDS], *force[KINDS];
  double *f_x, *f_z;
  double known_at; /* time of the accepted state whose forces these are, or NAN */
} Layer;

Layer layer_new(Scene scene);

/* Zeroed memory for an array over the masses, with a place -1. */
double *layer_array(const Layer *layer);

/* At rest under the carrier of the first phase; what lies under the profile is lifted onto it, and then slips, or
 * sticks where it does not move, until events_settle decides. */
void layer_start(Layer *layer, double *y);

/* The phase that begins at time t. */
void layer_enter_phase(Layer *layer, const Phase *phase, double t);
Carrier layer_carrier(const Layer *layer, double t);

void layer_set_mode(Layer *layer, int i, Mode mode);

/* Sticks mass i where it is, with elongation e_x; the carrier is that of the instant last evaluated. */
void layer_stick(Layer *layer, int i, double e_x);

/* Brings the lists of masses in contact up to date. */
void layer_list(Layer *layer);

/* Puts the constraints in, e_x and r_x of slipping masses being there. */
void layer_constrain(Layer *layer);

/* Motion, forces of the links and on the masses in the state y. */
void layer_evaluate(Layer *layer, double t, const double *y);

/* The same, unless the forces at this time are known. */
void layer_evaluate_unless_known(Layer *layer, double t, const double *y);

/* Writes the motion of mass i, or of all masses in contact, into the state, where parts of it rested. */
void layer_store_mass(const Layer *layer, int i, double *y);
void layer_store_contacts(const Layer *layer, double *y);

/* All of these at the instant last evaluated. */
void layer_derivatives(const Layer *layer, const double *y, double *f);
double layer_stored_energy(const Layer *layer, const double *y);
void layer_carrier_forces(const Layer *layer, double *F_x, double *F_z);

/* Σ c_j a_j²/τ_j: power of the Maxwell elements in the state y. */
double layer_maxwell_power(const Layer *layer, const double *y);

/* Powers of all channels, that of the Maxwell elements being given. */
void layer_power(const Layer *layer, double maxwell, double power[CHANNELS]);

/* Of mass i in contact: F_N, f.t, T(0). (9): F_N = (m κ ẋ² - f_z + s f_x)/q. */
static inline double layer_normal_force(const Layer *layer, int i) {
  double s = layer->slope[i], v = layer->speed[i];
  return (layer->scene.mass * layer->curvature[i] * v * v - layer->f_z[i] + s * layer->f_x[i]) / sqrt(1 + s * s);
}

static inline double layer_tangential_force(const Layer *layer, int i) {
  double s = layer->slope[i];
  return (layer->f_x[i] + s * layer->f_z[i]) / sqrt(1 + s * s);
}

static inline double layer_limit(const Layer *layer, int i) {
  return layer->scene.friction * layer_normal_force(layer, i) + layer->scene.shear;
}

/* σ: without friction it does not matter. */
static inline double layer_direction(const Layer *layer, int i) {
  return layer->has_friction ? layer->mode[i] : 0;
}

/* ẍ of a slipping mass: m q² ẍ = f_x + s f_z - F_T q - m s κ ẋ² with F_T = σ (μ F_N + A τ_0), so that
 * with S = σ μ: m q² ẍ = (1 - S s) f_x + (s + S)(f_z - m κ ẋ²) - σ A τ_0 q. */
static inline double layer_slip_acceleration(const Layer *layer, int i) {
  double m = layer->scene.mass, s = layer->slope[i], v = layer->speed[i], sigma = layer_direction(layer, i);
  double q2 = 1 + s * s, S = sigma * layer->scene.friction;
  double force = (1 - S * s) * layer->f_x[i] + (s + S) * (layer->f_z[i] - m * layer->curvature[i] * v * v);
  if (layer->scene.shear != 0) force -= sigma * layer->scene.shear * sqrt(q2);
  return force * layer->per_mass / q2;
}

static inline int is_lateral(int kind) {
  return kind == LATERAL_X || kind == LATERAL_Z;
}

#endif
