#include "linear.h"

/* (I - gamma J) delta = b, with b named by what it belongs to.
 *
 * Elements:   delta a_j = w_j (b_a,j + gamma delta e'),  w_j = 1/(1 + gamma/tau_j)
 * Positions:  delta e_x = b_x + gamma delta r_x, where x moves; e_z alike where z moves. A slipping mass follows the
 *             profile: delta e_z = s delta e_x, delta e_z' = s delta r_x + kappa x' delta e_x.
 * A link then answers with c delta e + D delta e' + sum_j c_j w_j b_a,j, D = d + gamma sum_j c_j w_j, and what is left
 * are the rates of each mass: a block of 2 x 2, coupled to those of its neighbours. */

#define EACH(i, n) _Pragma("GCC ivdep") for (int i = 0; i < (n); i++)

typedef struct {
  double xx, xz, zx, zz;
} Block;

typedef struct {
  double c, D, w[MOST_ELEMENTS], kept[MOST_ELEMENTS]; /* w_j and c_j w_j */
} Answer;

typedef struct {
  Problem *problem;
  double gamma;
  Answer answer[KINDS];
  Block *inverse, *lower, *upper; /* factors: inverted diagonal, row i by column i - 1 times the inverse above, column i + 1 */
  double *known_x, *known_v, *known_z, *known_vz; /* what positions and rates of the right side alone give */
  double *known[KINDS];                           /* and the links' forces from it */
  double *f_x, *f_z, *r_x, *r_z;
} Condensed;

static Answer answer_of(const Link *link, double gamma) {
  Answer answer = {.c = link->c, .D = link->d};
  for (int j = 0; j < link->n; j++) {
    answer.w[j] = 1 / (1 + gamma * link->rate[j]);
    answer.kept[j] = link->stiffness[j] * answer.w[j];
    answer.D += gamma * answer.kept[j];
  }
  return answer;
}

static int set_up_system(double t, N_Vector y, N_Vector f, SUNMatrix matrix, booleantype jok, booleantype *jcur, double gamma, void *data, N_Vector a, N_Vector b, N_Vector c) {
  (void)f, (void)matrix, (void)a, (void)b, (void)c;
  Problem *problem = data;
  Condensed *condensed = problem->linear_data;
  *jcur = !jok;
  if (!jok) {
    problem->forces_known_at = NAN;
    layer_evaluate(problem->layer, t, N_VGetArrayPointer(y));
    variation_evaluate(&problem->variation, problem->layer);
  }
  condensed->gamma = gamma;
  for (int kind = 0; kind < KINDS; kind++) condensed->answer[kind] = answer_of(&problem->layer->scene.link[kind], gamma);
  return 0;
}

/* Force of a link of constants c, D by the rates of mass j at one end: along x; along z by r_x and by r_z. */
static inline double x_by_x(const Variation *v, int j, double gamma, double c, double D) {
  return v->x_moves[j] * (c * gamma + D);
}

static inline double z_by_x(const Variation *v, int j, double gamma, double c, double D) {
  return c * v->slope[j] * gamma + D * (v->turn[j] * gamma + v->slope[j]);
}

static inline double z_by_z(const Variation *v, int j, double gamma, double c, double D) {
  return v->z_moves[j] * (c * gamma + D);
}

/* Row i by column j, given the forces along x and z on mass i by the rates of mass j: without the identity. */
static inline Block block(const Variation *v, int i, double gamma, double x_x, double z_x, double z_z) {
  double a = gamma * v->x_of_f_x[i], b = gamma * v->x_of_f_z[i], c = gamma * v->z_of_f_z[i];
  return (Block){-(a * x_x + b * z_x), -b * z_z, -c * z_x, -c * z_z};
}

static inline Block times(Block a, Block b) {
  return (Block){a.xx * b.xx + a.xz * b.zx, a.xx * b.xz + a.xz * b.zz, a.zx * b.xx + a.zz * b.zx, a.zx * b.xz + a.zz * b.zz};
}

static inline Block inverse(Block a) {
  double per = 1 / (a.xx * a.zz - a.xz * a.zx);
  return (Block){a.zz * per, -a.xz * per, -a.zx * per, a.xx * per};
}

static Block diagonal(const Condensed *condensed, int i) {
  const Variation *v = &condensed->problem->variation;
  const Answer *answer = condensed->answer;
  int neighbours = (i > 0) + (i < condensed->problem->layer->k - 1);
  double gamma = condensed->gamma;
  double c_x = answer[HORIZONTAL].c + neighbours * answer[LATERAL_X].c, D_x = answer[HORIZONTAL].D + neighbours * answer[LATERAL_X].D;
  double c_z = answer[VERTICAL].c + neighbours * answer[LATERAL_Z].c, D_z = answer[VERTICAL].D + neighbours * answer[LATERAL_Z].D;
  Block d = block(v, i, gamma, -x_by_x(v, i, gamma, c_x, D_x), -z_by_x(v, i, gamma, c_z, D_z), -z_by_z(v, i, gamma, c_z, D_z));
  d.xx += 1 - gamma * (gamma * v->x_of_x[i] + v->x_of_v[i]);
  d.zz += 1;
  return d;
}

/* Row i by column j of a neighbour. */
static inline Block beside(const Condensed *condensed, int i, int j) {
  const Variation *v = &condensed->problem->variation;
  const Answer *x = &condensed->answer[LATERAL_X], *z = &condensed->answer[LATERAL_Z];
  double gamma = condensed->gamma;
  return block(v, i, gamma, x_by_x(v, j, gamma, x->c, x->D), z_by_x(v, j, gamma, z->c, z->D), z_by_z(v, j, gamma, z->c, z->D));
}

static int factorise(SUNLinearSolver solver, SUNMatrix matrix) {
  (void)matrix;
  Condensed *condensed = solver->content;
  Block *up = condensed->upper, *low = condensed->lower, *inv = condensed->inverse;
  int k = condensed->problem->layer->k;
  for (int i = 0; i < k; i++) inv[i] = diagonal(condensed, i);
  for (int i = 0; i < k - 1; i++) up[i] = beside(condensed, i, i + 1);
  for (int i = 1; i < k; i++) low[i] = beside(condensed, i, i - 1);
  inv[0] = inverse(inv[0]);
  for (int i = 1; i < k; i++) {
    low[i] = times(low[i], inv[i - 1]);
    Block less = times(low[i], up[i - 1]);
    inv[i] = inverse((Block){inv[i].xx - less.xx, inv[i].xz - less.xz, inv[i].zx - less.zx, inv[i].zz - less.zz});
  }
  return 0;
}

/* c e + D e' of the right side alone, plus sum_j c_j w_j b_a,j. */
static void add_elements(const Link *link, const Answer *answer, int count, const double *restrict b, double *restrict force) {
  for (int j = 0; j < link->n; j++, b += count) {
    double kept = answer->kept[j];
    EACH(i, count) force[i] += kept * b[i];
  }
}

static void known_force_on_carrier(const Condensed *condensed, int kind, int count, const double *restrict e, const double *restrict v, const double *restrict b, double *restrict force) {
  const Answer *answer = &condensed->answer[kind];
  double c = answer->c, D = answer->D;
  EACH(i, count) force[i] = c * e[i] + D * v[i];
  add_elements(&condensed->problem->layer->scene.link[kind], answer, count, b, force);
}

static void known_force_between(const Condensed *condensed, int kind, int count, const double *restrict e, const double *restrict v, const double *restrict b, double *restrict force) {
  const Answer *answer = &condensed->answer[kind];
  double c = answer->c, D = answer->D;
  EACH(i, count) force[i] = c * (e[i + 1] - e[i]) + D * (v[i + 1] - v[i]);
  add_elements(&condensed->problem->layer->scene.link[kind], answer, count, b, force);
}

static void sum_on_masses(int k, const double *restrict carrier, const double *restrict lateral, double *restrict f) {
  f[0] = -carrier[0] + (k > 1 ? lateral[0] : 0);
  EACH(i, k - 2) f[i + 1] = -carrier[i + 1] + (lateral[i + 1] - lateral[i]);
  if (k > 1) f[k - 1] = -carrier[k - 1] - lateral[k - 2];
}

/* Forces on the masses that follow from the right side alone. */
static void known_forces(Condensed *condensed, const double *restrict b) {
  const Layer *layer = condensed->problem->layer;
  const Variation *v = &condensed->problem->variation;
  int k = layer->k;
  double *restrict x = condensed->known_x, *restrict z = condensed->known_z, *restrict v_x = condensed->known_v, *restrict v_z = condensed->known_vz;
  EACH(i, k) x[i] = v->x_moves[i] * b[i];
  EACH(i, k) z[i] = v->slope[i] * x[i] + v->z_moves[i] * b[k + i];
  EACH(i, k) v_z[i] = v->turn[i] * x[i];
  known_force_on_carrier(condensed, HORIZONTAL, k, x, v_x, b + layer->maxwell[HORIZONTAL], condensed->known[HORIZONTAL]);
  known_force_on_carrier(condensed, VERTICAL, k, z, v_z, b + layer->maxwell[VERTICAL], condensed->known[VERTICAL]);
  known_force_between(condensed, LATERAL_X, k - 1, x, v_x, b + layer->maxwell[LATERAL_X], condensed->known[LATERAL_X]);
  known_force_between(condensed, LATERAL_Z, k - 1, z, v_z, b + layer->maxwell[LATERAL_Z], condensed->known[LATERAL_Z]);
  sum_on_masses(k, condensed->known[HORIZONTAL], condensed->known[LATERAL_X], condensed->f_x);
  sum_on_masses(k, condensed->known[VERTICAL], condensed->known[LATERAL_Z], condensed->f_z);
}

/* The rates: right side, forwards, backwards. A rate that does not move keeps its own right side, 0, whatever comes in. */
static void solve_rates(Condensed *condensed, const double *restrict b) {
  const Variation *v = &condensed->problem->variation;
  int k = condensed->problem->layer->k;
  double gamma = condensed->gamma, *restrict r_x = condensed->r_x, *restrict r_z = condensed->r_z;
  const double *restrict f_x = condensed->f_x, *restrict f_z = condensed->f_z;
  EACH(i, k) r_x[i] = v->x_moves[i] * (b[2 * k + i] + gamma * (v->x_of_f_x[i] * f_x[i] + v->x_of_f_z[i] * f_z[i] + v->x_of_x[i] * b[i]));
  EACH(i, k) r_z[i] = v->z_moves[i] * (b[3 * k + i] + gamma * v->z_of_f_z[i] * f_z[i]);
  for (int i = 1; i < k; i++) {
    Block low = condensed->lower[i];
    r_x[i] -= low.xx * r_x[i - 1] + low.xz * r_z[i - 1];
    r_z[i] -= low.zx * r_x[i - 1] + low.zz * r_z[i - 1];
  }
  double x = 0, z = 0;
  for (int i = k - 1; i >= 0; i--) {
    Block up = condensed->upper[i], inv = condensed->inverse[i];
    double right_x = r_x[i] - (up.xx * x + up.xz * z), right_z = r_z[i] - (up.zx * x + up.zz * z);
    r_x[i] = x = inv.xx * right_x + inv.xz * right_z;
    r_z[i] = z = inv.zx * right_x + inv.zz * right_z;
  }
}

/* Positions and the rates of elongation that follow from the rates found: v_x, v_z in the room of what was known. */
static void recover_masses(Condensed *condensed, const double *restrict b, double *restrict delta) {
  const Variation *v = &condensed->problem->variation;
  int k = condensed->problem->layer->k;
  double gamma = condensed->gamma;
  const double *restrict r_x = condensed->r_x, *restrict r_z = condensed->r_z;
  double *restrict v_x = condensed->known_x, *restrict v_z = condensed->known_z;
  EACH(i, k) v_x[i] = v->x_moves[i] * r_x[i];
  EACH(i, k) delta[i] = b[i] + gamma * v_x[i];
  EACH(i, k) delta[k + i] = b[k + i] + gamma * v->z_moves[i] * r_z[i];
  EACH(i, k) delta[2 * k + i] = v->x_moves[i] != 0 ? r_x[i] : b[2 * k + i];
  EACH(i, k) delta[3 * k + i] = v->z_moves[i] != 0 ? r_z[i] : b[3 * k + i];
  EACH(i, k) v_z[i] = v->z_moves[i] * r_z[i] + v->turn[i] * delta[i] + v->slope[i] * v_x[i];
}

static void recover_elements(const Link *link, const Answer *answer, double gamma, int count, const double *restrict rate, const double *restrict b, double *restrict delta) {
  for (int j = 0; j < link->n; j++, b += count, delta += count) {
    double w = answer->w[j];
    EACH(i, count) delta[i] = w * (b[i] + gamma * rate[i]);
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
  double *v_x = condensed->known_x, *v_z = condensed->known_z, *between_x = condensed->f_x, *between_z = condensed->f_z;
  EACH(i, layer->k - 1) between_x[i] = v_x[i + 1] - v_x[i];
  EACH(i, layer->k - 1) between_z[i] = v_z[i + 1] - v_z[i];
  const double *rate[KINDS] = {[VERTICAL] = v_z, [HORIZONTAL] = v_x, [LATERAL_X] = between_x, [LATERAL_Z] = between_z};
  for (int kind = 0; kind < KINDS; kind++)
    recover_elements(&layer->scene.link[kind], &condensed->answer[kind], condensed->gamma, layer->count[kind], rate[kind], b + layer->maxwell[kind], d + layer->maxwell[kind]);
  return 0;
}

static SUNLinearSolver_Type type(SUNLinearSolver solver) {
  (void)solver;
  return SUNLINEARSOLVER_DIRECT;
}

/* The matrix exists for CVODE alone. */
static SUNMatrix_ID id(SUNMatrix matrix) {
  (void)matrix;
  return SUNMATRIX_CUSTOM;
}

static SUNMatrix clone(SUNMatrix matrix) {
  SUNMatrix copy = SUNMatNewEmpty(matrix->sunctx);
  SUNMatCopyOps(matrix, copy);
  return copy;
}

LinearSolver condensed_new(Problem *problem, SUNContext context) {
  Condensed *condensed = problem->linear_data = room(1, sizeof *condensed);
  int k = problem->layer->k;
  condensed->problem = problem;
  Block **blocks[] = {&condensed->inverse, &condensed->lower, &condensed->upper};
  for (unsigned i = 0; i < sizeof blocks / sizeof *blocks; i++) *blocks[i] = room(k, sizeof(Block));
  double **arrays[] = {&condensed->known_x, &condensed->known_v, &condensed->known_z, &condensed->known_vz, &condensed->f_x, &condensed->f_z, &condensed->r_x, &condensed->r_z};
  for (unsigned i = 0; i < sizeof arrays / sizeof *arrays; i++) *arrays[i] = room(k, sizeof(double));
  for (int kind = 0; kind < KINDS; kind++) condensed->known[kind] = room(k, sizeof(double));
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  solver->content = condensed;
  solver->ops->gettype = type;
  solver->ops->setup = factorise;
  solver->ops->solve = solve;
  SUNMatrix matrix = SUNMatNewEmpty(context);
  matrix->ops->getid = id;
  matrix->ops->clone = clone;
  matrix->ops->destroy = SUNMatFreeEmpty;
  return (LinearSolver){solver, matrix, set_up_system};
}
