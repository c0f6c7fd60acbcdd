#include <klu.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include "linear.h"

typedef struct {
  long row, column, visit;
} Place;

/* The Jacobian is assembled by a visit that calls `entry` for every entry, always in the same order and whatever the
 * modes. The first visit notes the places and gives each its slot in the compressed columns; later ones add values. */
typedef struct {
  int noting;
  Place *place;
  long *slot, visits, room;
  double *jacobian; /* by slot */
  long *diagonal;   /* slots of the main diagonal */
  long entries;
} Sparse;

static void entry(Sparse *sparse, long row, long column, double value) {
  long visit = sparse->visits++;
  if (!sparse->noting) {
    sparse->jacobian[sparse->slot[visit]] += value;
    return;
  }
  if (visit == sparse->room) {
    sparse->room = 2 * sparse->room + 1024;
    sparse->place = realloc(sparse->place, sparse->room * sizeof *sparse->place);
    if (!sparse->place) fail("out of memory");
  }
  sparse->place[visit] = (Place){row, column, visit};
}

/* factor (c e + d r) of mass j along x and along z, by the state. */
static void entries_of_x(Sparse *sparse, const Problem *problem, long row, double factor, int j, double c, double d) {
  double moves = factor * problem->jacobian->of[j].x_moves;
  entry(sparse, row, j, moves * c);
  entry(sparse, row, 2 * problem->layer->stride + j, moves * d);
}

static void entries_of_z(Sparse *sparse, const Problem *problem, long row, double factor, int j, double c, double d) {
  long stride = problem->layer->stride;
  const Variation *v = &problem->jacobian->of[j];
  entry(sparse, row, j, factor * (c * v->slope + d * v->turn));
  entry(sparse, row, stride + j, factor * c * v->z_moves);
  entry(sparse, row, 2 * stride + j, factor * d * v->slope);
  entry(sparse, row, 3 * stride + j, factor * d * v->z_moves);
}

typedef void Entries(Sparse *, const Problem *, long, double, int, double, double);

static void entries_of_elements(Sparse *sparse, const Layer *layer, long row, double factor, int kind, int i) {
  const Link *link = &layer->scene.link[kind];
  for (int j = 0; j < link->n; j++)
    entry(sparse, row, layer->maxwell[kind] + j * layer->stride + i, factor * link->stiffness[j]);
}

/* factor f_i, (3) or (4). */
static void entries_of_force(Sparse *sparse, const Problem *problem, long row, double factor, int i, int carrier,
                             int lateral) {
  const Layer *layer = problem->layer;
  const Link *own = &layer->scene.link[carrier], *shared = &layer->scene.link[lateral];
  Entries *entries_of = carrier == HORIZONTAL ? entries_of_x : entries_of_z;
  int left = i > 0, right = i < layer->k - 1, neighbours = left + right;
  entries_of(sparse, problem, row, -factor, i, own->c + neighbours * shared->c, own->d + neighbours * shared->d);
  entries_of_elements(sparse, layer, row, -factor, carrier, i);
  if (right) {
    entries_of(sparse, problem, row, factor, i + 1, shared->c, shared->d);
    entries_of_elements(sparse, layer, row, factor, lateral, i);
  }
  if (left) {
    entries_of(sparse, problem, row, factor, i - 1, shared->c, shared->d);
    entries_of_elements(sparse, layer, row, -factor, lateral, i - 1);
  }
}

static void rows_of_mass(Sparse *sparse, const Problem *problem, int i) {
  const Variation *v = &problem->jacobian->of[i];
  long stride = problem->layer->stride, r_x = 2 * stride + i, r_z = 3 * stride + i;
  entry(sparse, i, r_x, v->x_moves);
  entry(sparse, stride + i, r_z, v->z_moves);
  entry(sparse, r_x, i, v->x_of_x);
  entry(sparse, r_x, r_x, v->x_of_v);
  entries_of_force(sparse, problem, r_x, v->x_of_f_x, i, HORIZONTAL, LATERAL_X);
  entries_of_force(sparse, problem, r_x, v->x_of_f_z, i, VERTICAL, LATERAL_Z);
  entries_of_force(sparse, problem, r_z, v->z_of_f_z, i, VERTICAL, LATERAL_Z);
}

static void rows_of_elements(Sparse *sparse, const Problem *problem, int kind) {
  const Layer *layer = problem->layer;
  Entries *entries_of = kind == HORIZONTAL || kind == LATERAL_X ? entries_of_x : entries_of_z;
  int lateral = is_lateral(kind);
  for (int j = 0; j < layer->scene.link[kind].n; j++)
    for (int i = 0; i < layer->count[kind]; i++) {
      long row = layer->maxwell[kind] + j * layer->stride + i;
      entry(sparse, row, row, -layer->scene.link[kind].rate[j]);
      entries_of(sparse, problem, row, 1, i + lateral, 0, 1);
      if (lateral) entries_of(sparse, problem, row, -1, i, 0, 1);
    }
}

static void visit(Sparse *sparse, const Problem *problem) {
  sparse->visits = 0;
  for (int i = 0; i < problem->layer->k; i++) rows_of_mass(sparse, problem, i);
  for (int kind = 0; kind < KINDS; kind++) rows_of_elements(sparse, problem, kind);
}

static int by_column(const void *a, const void *b) {
  const Place *p = a, *q = b;
  if (p->column != q->column) return p->column < q->column ? -1 : 1;
  return (p->row > q->row) - (p->row < q->row);
}

/* Notes the pattern, the main diagonal included, and gives a matrix that has it. */
static SUNMatrix note_pattern(Sparse *sparse, const Problem *problem, SUNContext context) {
  long order = problem->layer->order;
  sparse->noting = 1;
  visit(sparse, problem);
  for (long i = 0; i < order; i++) entry(sparse, i, i, 0);
  qsort(sparse->place, sparse->visits, sizeof *sparse->place, by_column);
  SUNMatrix matrix = SUNSparseMatrix(order, order, sparse->visits, CSC_MAT, context);
  sunindextype *start = SM_INDEXPTRS_S(matrix), *row = SM_INDEXVALS_S(matrix);
  sparse->slot = room(sparse->visits, sizeof *sparse->slot);
  sparse->diagonal = room(order, sizeof *sparse->diagonal);
  long slot = -1;
  for (long i = 0; i < sparse->visits; i++) {
    const Place *place = &sparse->place[i];
    if (i == 0 || by_column(place, place - 1) != 0) row[++slot] = place->row;
    sparse->slot[place->visit] = slot;
    if (place->row == place->column) sparse->diagonal[place->row] = slot;
    start[place->column + 1] = slot + 1;
  }
  sparse->entries = slot + 1;
  sparse->jacobian = room(sparse->entries, sizeof *sparse->jacobian);
  free(sparse->place);
  sparse->noting = 0;
  return matrix;
}

/* I - γ J in the slots of the matrix, whose pattern stays. */
static int set_up_system(double t, N_Vector y, N_Vector f, SUNMatrix matrix, booleantype jok, booleantype *jcur,
                         double gamma, void *data, N_Vector a, N_Vector b, N_Vector c) {
  (void)f, (void)a, (void)b, (void)c;
  Problem *problem = data;
  Sparse *sparse = problem->linear_data;
  *jcur = !jok;
  if (!jok) {
    layer_evaluate(problem->layer, t, N_VGetArrayPointer(y));
    jacobian_linearise(problem->jacobian);
    memset(sparse->jacobian, 0, sparse->entries * sizeof *sparse->jacobian);
    visit(sparse, problem);
  }
  double *values = SM_DATA_S(matrix);
  for (long i = 0; i < sparse->entries; i++) values[i] = -gamma * sparse->jacobian[i];
  for (long i = 0; i < problem->layer->order; i++) values[sparse->diagonal[i]] += 1;
  return 0;
}

/* SUNDIALS would have KLU analyse the pattern anew after every restart: it never changes. */
static int keep_analysis(SUNLinearSolver solver) {
  (void)solver;
  return 0;
}

LinearSolver klu_new(Problem *problem, N_Vector y, SUNContext context) {
  Sparse *sparse = problem->linear_data = room(1, sizeof *sparse);
  SUNMatrix matrix = note_pattern(sparse, problem, context);
  SUNLinearSolver solver = SUNLinSol_KLU(y, matrix, context);
  solver->ops->initialize = keep_analysis;
  /* Nor are the rows scaled: pivots stand on the main diagonal, where the matrix is near the identity or above it. */
  SUNLinSol_KLUGetCommon(solver)->scale = -1;
  return (LinearSolver){solver, matrix, set_up_system};
}
