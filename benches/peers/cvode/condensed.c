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
  double xx, xz, zx, zz;
} Block;

typedef struct {
  double c, D, w[MOST_ELEMENTS], kept[MOST_ELEMENTS]; /* w_j and c_j w_j */
} Answer;

typedef struct {
  Problem *problem;
  double gamma;
  Answer answer[KINDS];
  /* Factors: inverted diagonal; row i by column i - 1, times the inverse above; row i by column i + 1. */
  Block *inverse, *lower, *upper;
  /* By kind of link, of the right side alone at first, then of the solution: elongations, their rates, forces. */
  double *e[KINDS], *rate[KINDS], *force[KINDS];
  double *f_x, *f_z, *r_x, *r_z; /* of the masses: forces from the right side alone, rates */
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

static int set_up_system(double t, N_Vector y, N_Vector f, SUNMatrix matrix, booleantype jok, booleantype *jcur,
                         double gamma, void *data, N_Vector a, N_Vector b, N_Vector c) {
  (void)f, (void)matrix, (void)a, (void)b, (void)c;
  Problem *problem = data;
  Condensed *condensed = problem->linear_data;
  *jcur = !jok;
  if (!jok) linearise(problem, t, y);
  condensed->gamma = gamma;
  for (int kind = 0; kind < KINDS; kind++)
    condensed->answer[kind] = answer_of(&problem->layer->scene.link[kind], gamma);
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
  return (Block){a.xx * b.xx + a.xz * b.zx, a.xx * b.xz + a.xz * b.zz, a.zx * b.xx + a.zz * b.zx,
                 a.zx * b.xz + a.zz * b.zz};
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
  double c_x = answer[HORIZONTAL].c + neighbours * answer[LATERAL_X].c,
         D_x = answer[HORIZONTAL].D + neighbours * answer[LATERAL_X].D;
  double c_z = answer[VERTICAL].c + neighbours * answer[LATERAL_Z].c,
         D_z = answer[VERTICAL].D + neighbours * answer[LATERAL_Z].D;
  Block d = block(v, i, gamma, -x_by_x(v, i, gamma, c_x, D_x), -z_by_x(v, i, gamma, c_z, D_z),
                  -z_by_z(v, i, gamma, c_z, D_z));
  d.xx += 1 - gamma * (gamma * v->x_of_x[i] + v->x_of_v[i]);
  d.zz += 1;
  return d;
}

/* Row i by column j of a neighbour. */
static inline Block beside(const Condensed *condensed, int i, int j) {
  const Variation *v = &condensed->problem->variation;
  const Answer *x = &condensed->answer[LATERAL_X], *z = &condensed->answer[LATERAL_Z];
  double gamma = condensed->gamma;
  return block(v, i, gamma, x_by_x(v, j, gamma, x->c, x->D), z_by_x(v, j, gamma, z->c, z->D),
               z_by_z(v, j, gamma, z->c, z->D));
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

/* The lateral links' elongations or rates from those of the links to the carrier. */
static void between_masses(double *const by_kind[KINDS], int k) {
  differences(k - 1, by_kind[HORIZONTAL], by_kind[LATERAL_X]);
  differences(k - 1, by_kind[VERTICAL], by_kind[LATERAL_Z]);
}

/* c e + D ė + Σ_j c_j w_j b_a,j of every link of a kind. */
static void answer_force(const Link *link, const Answer *answer, long count, const double *restrict e,
                         const double *restrict rate, const double *restrict b, double *restrict force) {
  double c = answer->c, D = answer->D;
  EACH(i, count) force[i] = c * e[i] + D * rate[i];
  for (int j = 0; j < link->n; j++, b += count) {
    double kept = answer->kept[j];
    EACH(i, count) force[i] += kept * b[i];
  }
}

/* Forces on the masses that follow from the right side alone: as if no rate were to move. */
static void known_forces(Condensed *condensed, const double *restrict b) {
  const Layer *layer = condensed->problem->layer;
  const Variation *v = &condensed->problem->variation;
  int k = layer->k;
  double *restrict e_x = condensed->e[HORIZONTAL], *restrict e_z = condensed->e[VERTICAL];
  double *restrict rate_x = condensed->rate[HORIZONTAL], *restrict rate_z = condensed->rate[VERTICAL];
  EACH(i, k) e_x[i] = v->x_moves[i] * b[i];
  EACH(i, k) e_z[i] = v->slope[i] * e_x[i] + v->z_moves[i] * b[k + i];
  EACH(i, k) rate_x[i] = 0;
  EACH(i, k) rate_z[i] = v->turn[i] * e_x[i];
  between_masses(condensed->e, k);
  between_masses(condensed->rate, k);
  for (int kind = 0; kind < KINDS; kind++)
    answer_force(&layer->scene.link[kind], &condensed->answer[kind], layer->count[kind], condensed->e[kind],
                 condensed->rate[kind], b + layer->maxwell[kind], condensed->force[kind]);
  sum_on_masses(k, condensed->force[HORIZONTAL], condensed->force[LATERAL_X], condensed->f_x);
  sum_on_masses(k, condensed->force[VERTICAL], condensed->force[LATERAL_Z], condensed->f_z);
}

/* The rates: right side, forwards, backwards. A rate that does not move keeps its own right side, 0, whatever comes in.
 */
static void solve_rates(Condensed *condensed, const double *restrict b) {
  const Variation *v = &condensed->problem->variation;
  int k = condensed->problem->layer->k;
  double gamma = condensed->gamma, *restrict r_x = condensed->r_x, *restrict r_z = condensed->r_z;
  const double *restrict f_x = condensed->f_x, *restrict f_z = condensed->f_z;
  EACH(i, k)
  r_x[i] = v->x_moves[i] *
           (b[2 * k + i] + gamma * (v->x_of_f_x[i] * f_x[i] + v->x_of_f_z[i] * f_z[i] + v->x_of_x[i] * b[i]));
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

/* Positions, and the rates of elongation of the links, from the rates found. */
static void recover_masses(Condensed *condensed, const double *restrict b, double *restrict delta) {
  const Variation *v = &condensed->problem->variation;
  int k = condensed->problem->layer->k;
  double gamma = condensed->gamma;
  const double *restrict r_x = condensed->r_x, *restrict r_z = condensed->r_z;
  double *restrict rate_x = condensed->rate[HORIZONTAL], *restrict rate_z = condensed->rate[VERTICAL];
  EACH(i, k) rate_x[i] = v->x_moves[i] * r_x[i];
  EACH(i, k) delta[i] = b[i] + gamma * rate_x[i];
  EACH(i, k) delta[k + i] = b[k + i] + gamma * v->z_moves[i] * r_z[i];
  EACH(i, k) delta[2 * k + i] = v->x_moves[i] != 0 ? r_x[i] : b[2 * k + i];
  EACH(i, k) delta[3 * k + i] = v->z_moves[i] != 0 ? r_z[i] : b[3 * k + i];
  EACH(i, k) rate_z[i] = v->z_moves[i] * r_z[i] + v->turn[i] * delta[i] + v->slope[i] * rate_x[i];
  between_masses(condensed->rate, k);
}

static void recover_elements(const Link *link, const Answer *answer, double gamma, int count,
                             const double *restrict rate, const double *restrict b, double *restrict delta) {
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
  for (int kind = 0; kind < KINDS; kind++)
    recover_elements(&layer->scene.link[kind], &condensed->answer[kind], condensed->gamma, layer->count[kind],
                     condensed->rate[kind], b + layer->maxwell[kind], d + layer->maxwell[kind]);
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
  double **arrays[] = {&condensed->f_x, &condensed->f_z, &condensed->r_x, &condensed->r_z};
  for (unsigned i = 0; i < sizeof arrays / sizeof *arrays; i++) *arrays[i] = room(k, sizeof(double));
  for (int kind = 0; kind < KINDS; kind++) {
    condensed->e[kind] = room(k, sizeof(double));
    condensed->rate[kind] = room(k, sizeof(double));
    condensed->force[kind] = room(k, sizeof(double));
  }
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
