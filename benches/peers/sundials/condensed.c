#include <string.h>

#include "arrays.h"
#include "linear.h"

/* (I - γ J) δ = b, with b named by what it belongs to.
 *
 * Elements:   δa_j = w_j (b_a,j + γ δė),  w_j = 1/(1 + γ/τ_j)
 * Positions:  δe_x = b_x + γ δr_x, where x moves; e_z alike where z moves. A slipping mass follows the
 *             profile: δe_z = s δe_x, δė_z = s δr_x + κ ẋ δe_x.
 * A link then answers with c δe + D δė + Σ_j c_j w_j b_a,j, D = d + γ Σ_j c_j w_j, and what is left
 * are the rates of each mass: a block of 2 x 2, coupled to those of its neighbours. */

typedef struct {
  Problem *problem;
  /* By kind of link, of the right side alone at first, then of the solution: elongations, their rates, forces. */
  double *e[KINDS], *rate[KINDS], *force[KINDS];
  double *f_x, *f_z; /* on the masses, from the right side alone */
} Condensed;

static int set_up_system(double t, N_Vector y, N_Vector f, SUNMatrix matrix, booleantype jok, booleantype *jcur,
                         double gamma, void *data, N_Vector a, N_Vector b, N_Vector c) {
  (void)f, (void)matrix, (void)a, (void)b, (void)c;
  Problem *problem = data;
  *jcur = !jok;
  if (!jok) {
    layer_evaluate(problem->layer, t, N_VGetArrayPointer(y));
    jacobian_linearise(problem->jacobian);
  }
  jacobian_set_gamma(problem->jacobian, gamma);
  return 0;
}

static int factorise(SUNLinearSolver solver, SUNMatrix matrix) {
  (void)matrix;
  Condensed *condensed = solver->content;
  jacobian_factor(condensed->problem->jacobian);
  return 0;
}

/* The lateral links' from those of the masses. */
static void between_masses(double *const of[KINDS], long k) {
  differences(k - 1, of[HORIZONTAL], of[LATERAL_X]);
  differences(k - 1, of[VERTICAL], of[LATERAL_Z]);
}

/* c e + D ė + Σ_j c_j w_j b_a,j of a kind of link. */
static void answer_force(const Condensed *condensed, int kind, const double *b) {
  const Layer *layer = condensed->problem->layer;
  const Answer *answer = &condensed->problem->jacobian->answer[kind];
  const double *restrict e = condensed->e[kind], *restrict rate = condensed->rate[kind];
  double *restrict force = condensed->force[kind], c = answer->c, D = answer->D;
  const double *a = b + layer->maxwell[kind];
  EACH(i, layer->count[kind]) force[i] = c * e[i] + D * rate[i];
  for (int j = 0; j < layer->scene.link[kind].n; j++, a += layer->stride) {
    double kept = answer->kept[j];
    EACH(i, layer->count[kind]) force[i] += kept * a[i];
  }
}

/* Forces on the masses by the right side alone. */
static void known_forces(Condensed *condensed, const double *b) {
  const Layer *layer = condensed->problem->layer;
  const Variation *of = condensed->problem->jacobian->of;
  long k = layer->k, stride = layer->stride;
  double *restrict e_x = condensed->e[HORIZONTAL], *restrict e_z = condensed->e[VERTICAL];
  double *restrict rate_x = condensed->rate[HORIZONTAL], *restrict rate_z = condensed->rate[VERTICAL];
  EACH(i, k) {
    e_x[i] = of[i].x_moves * b[i];
    e_z[i] = of[i].slope * e_x[i] + of[i].z_moves * b[stride + i];
    rate_x[i] = 0;
    rate_z[i] = of[i].turn * e_x[i];
  }
  between_masses(condensed->e, k);
  between_masses(condensed->rate, k);
  for (int kind = 0; kind < KINDS; kind++) answer_force(condensed, kind, b);
  sum_on_masses(k, condensed->force[HORIZONTAL], condensed->force[LATERAL_X], condensed->f_x);
  sum_on_masses(k, condensed->force[VERTICAL], condensed->force[LATERAL_Z], condensed->f_z);
}

static void solve_rates(Condensed *condensed, const double *restrict b) {
  Jacobian *jacobian = condensed->problem->jacobian;
  const Variation *of = jacobian->of;
  long stride = jacobian->layer->stride;
  double gamma = jacobian->gamma, *restrict right = jacobian->rates;
  const double *restrict f_x = condensed->f_x, *restrict f_z = condensed->f_z;
  EACH(i, jacobian->layer->k) {
    double x = of[i].x_of_f_x * f_x[i] + of[i].x_of_f_z * f_z[i] + of[i].x_of_x * b[i];
    right[2 * i] = of[i].x_moves * (b[2 * stride + i] + gamma * x);
    right[2 * i + 1] = of[i].z_moves * (b[3 * stride + i] + gamma * of[i].z_of_f_z * f_z[i]);
  }
  jacobian_solve(jacobian);
}

/* Positions, and the rates of elongation of the links, from the rates found. A rate that does not move keeps its own
 * right side. */
static void recover_masses(Condensed *condensed, const double *restrict b, double *restrict delta) {
  const Jacobian *jacobian = condensed->problem->jacobian;
  const Variation *of = jacobian->of;
  long k = jacobian->layer->k, stride = jacobian->layer->stride;
  double gamma = jacobian->gamma;
  const double *restrict rates = jacobian->rates;
  double *restrict rate_x = condensed->rate[HORIZONTAL], *restrict rate_z = condensed->rate[VERTICAL];
  EACH(i, k) {
    double r_x = rates[2 * i], r_z = rates[2 * i + 1], x = of[i].x_moves * r_x, z = of[i].z_moves * r_z;
    double e_x = b[i] + gamma * x;
    delta[i] = e_x;
    delta[stride + i] = b[stride + i] + gamma * z;
    delta[2 * stride + i] = of[i].x_moves != 0 ? r_x : b[2 * stride + i];
    delta[3 * stride + i] = of[i].z_moves != 0 ? r_z : b[3 * stride + i];
    rate_x[i] = x;
    rate_z[i] = z + of[i].turn * e_x + of[i].slope * x;
  }
  between_masses(condensed->rate, k);
}

static void recover_elements(const Condensed *condensed, int kind, const double *restrict b, double *restrict delta) {
  const Layer *layer = condensed->problem->layer;
  const double *restrict rate = condensed->rate[kind], *w = condensed->problem->jacobian->answer[kind].w;
  double gamma = condensed->problem->jacobian->gamma;
  for (int j = 0; j < layer->scene.link[kind].n; j++, b += layer->stride, delta += layer->stride) {
    double part = w[j];
    EACH(i, layer->count[kind]) delta[i] = part * (b[i] + gamma * rate[i]);
  }
}

static int solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector delta, N_Vector right_side, double tolerance) {
  (void)matrix, (void)tolerance;
  Condensed *condensed = solver->content;
  const Layer *layer = condensed->problem->layer;
  const double *b = N_VGetArrayPointer(right_side);
  double *d = N_VGetArrayPointer(delta);
  known_forces(condensed, b);
  solve_rates(condensed, b);
  recover_masses(condensed, b, d);
  for (int kind = 0; kind < KINDS; kind++)
    recover_elements(condensed, kind, b + layer->maxwell[kind], d + layer->maxwell[kind]);
  memcpy(d + layer->energy, b + layer->energy, VECTOR * sizeof *d);
  return 0;
}

static SUNLinearSolver_Type type(SUNLinearSolver solver) {
  (void)solver;
  return SUNLINEARSOLVER_DIRECT;
}

/* The matrix exists for CVODES alone. */
static SUNMatrix_ID id(SUNMatrix matrix) {
  (void)matrix;
  return SUNMATRIX_CUSTOM;
}

static SUNMatrix clone(SUNMatrix matrix) {
  SUNMatrix copy = SUNMatNewEmpty(matrix->sunctx);
  SUNMatCopyOps(matrix, copy);
  return copy;
}

static Condensed *workspace(Problem *problem) {
  Condensed *condensed = room(1, sizeof *condensed);
  condensed->problem = problem;
  for (int kind = 0; kind < KINDS; kind++) {
    condensed->e[kind] = layer_array(problem->layer);
    condensed->rate[kind] = layer_array(problem->layer);
    condensed->force[kind] = layer_array(problem->layer);
  }
  condensed->f_x = layer_array(problem->layer);
  condensed->f_z = layer_array(problem->layer);
  return condensed;
}

LinearSolver condensed_new(Problem *problem, SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  solver->content = workspace(problem);
  solver->ops->gettype = type;
  solver->ops->setup = factorise;
  solver->ops->solve = solve;
  SUNMatrix matrix = SUNMatNewEmpty(context);
  matrix->ops->getid = id;
  matrix->ops->clone = clone;
  matrix->ops->destroy = SUNMatFreeEmpty;
  return (LinearSolver){solver, matrix, set_up_system};
}
