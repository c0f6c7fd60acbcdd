#include "integrator.h"

#include <arkode/arkode_arkstep.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "vectors.h"

enum { MOST_STEPS = 100000000 };

static void check(int flag, const char *what) {
  if (flag < 0) fail("%s: flag %d", what, flag);
}

/* ---- what SUNDIALS calls ---- */

/* Whether the derivatives asked for into f are there already. */
static int is_known(Integrator *integrator, double t, const double *f) {
  KnownDerivatives *known = &integrator->known;
  if (f == known->of_stage && t == integrator->problem.layer->known_at) {
    known->of_stage = NULL;
    return 1;
  }
  if (!known->first) known->first = f;
  if (f != known->first) return 0;
  if (t == known->first_at) return 1;
  known->first_at = t;
  return 0;
}

static int derivatives(double t, N_Vector y_, N_Vector f_, void *data) {
  Integrator *integrator = data;
  Layer *layer = integrator->problem.layer;
  const double *y = N_VGetArrayPointer(y_);
  double *f = N_VGetArrayPointer(f_);
  if (integrator->variant->family == DIRK && is_known(integrator, t, f)) return 0;
  layer_evaluate(layer, t, y);
  layer_derivatives(layer, y, f);
  if (integrator->stage) stage_know_accelerations(integrator->stage, f);
  return 0;
}

static int roots(double t, N_Vector y, double *values, void *data) {
  Integrator *integrator = data;
  events_roots(integrator->events, t, N_VGetArrayPointer(y), values);
  return 0;
}

static void weigh(long count, const double *restrict y, double rtol, double atol, double *restrict weight) {
  EACH(i, count) weight[i] = 1 / (rtol * fabs(y[i]) + atol);
}

/* Energies take no part in the error test. */
static int weights(N_Vector y_, N_Vector weights_, void *data) {
  const Integrator *integrator = data;
  const Layer *layer = integrator->problem.layer;
  const double *y = N_VGetArrayPointer(y_), place = integrator->atol_place;
  double *weight = N_VGetArrayPointer(weights_), rtol = integrator->variant->constant_weights ? 0 : integrator->rtol;
  long motion = 2 * layer->stride;
  if (rtol == 0 && weight[0] == 1 / place) return 0; /* they are there */
  weigh(motion, y, rtol, place, weight);
  weigh(motion, y + motion, rtol, integrator->atol_rate, weight + motion);
  weigh(layer->energy - 2 * motion, y + 2 * motion, rtol, place, weight + 2 * motion);
  for (long i = layer->energy; i < layer->order; i++) weight[i] = 1e-30;
  return 0;
}

/* ---- the nonlinear solver as SUNDIALS takes it ---- */

/* A stage of ARKODE: z = z_p + s + γ f(t, z), its prediction z_p being the state at the step's start. */
static int solve_stage(Integrator *integrator, N_Vector weights, N_Vector correction, double tolerance, void *memory) {
  double t, gamma;
  N_Vector prediction, z, f, s;
  void *data;
  check(ARKStepGetNonlinearSystemData(memory, &t, &prediction, &z, &f, &gamma, &s, &data), "a stage's data");
  if (!shortcuts.copy) shortcuts.original = NV_DATA_S(prediction);
  shortcuts.copy = NV_DATA_S(prediction);
  shortcuts.correction = NV_DATA_S(correction);
  System system = {.t = t,
                   .gamma = gamma,
                   .factor = 1,
                   .p = shortcuts.original,
                   .q = NV_DATA_S(s),
                   .weights = NV_DATA_S(weights),
                   .tolerance = tolerance,
                   .z = NV_DATA_S(z),
                   .beside = NV_DATA_S(f)};
  int flag = stage_solve(integrator->stage, &system);
  shortcuts.solution = flag ? NULL : system.z;
  integrator->known.of_stage = system.beside;
  return flag;
}

/* A step of CVODES: y = z_0 - z_1/l_1 + γ f(t, y), z_0 and z_1 being predicted. */
static int solve_step(Integrator *integrator, N_Vector weights, N_Vector correction, double tolerance, void *memory) {
  double t, gamma, rl1;
  N_Vector z0, z1, y, f;
  void *data;
  check(CVodeGetNonlinearSystemData(memory, &t, &z0, &y, &f, &gamma, &rl1, &z1, &data), "a step's data");
  shortcuts.correction = NV_DATA_S(correction);
  stage_forget_factors(integrator->stage);
  System system = {.t = t,
                   .gamma = gamma,
                   .factor = -rl1,
                   .p = NV_DATA_S(z0),
                   .q = NV_DATA_S(z1),
                   .weights = NV_DATA_S(weights),
                   .tolerance = tolerance,
                   .guess_from_p = 1,
                   .correction_wanted = 1,
                   .z = NV_DATA_S(y),
                   .beside = NV_DATA_S(correction)};
  int flag = stage_solve(integrator->stage, &system);
  shortcuts.solution = flag ? NULL : system.z;
  return flag;
}

static int solve(SUNNonlinearSolver solver, N_Vector start, N_Vector correction, N_Vector weights, realtype tolerance,
                 booleantype set_up, void *memory) {
  (void)start, (void)set_up;
  Integrator *integrator = solver->content;
  int is_stage = integrator->variant->family == DIRK;
  return (is_stage ? solve_stage : solve_step)(integrator, weights, correction, tolerance, memory);
}

static SUNNonlinearSolver_Type type(SUNNonlinearSolver solver) {
  (void)solver;
  return SUNNONLINEARSOLVER_ROOTFIND;
}

/* The system is known to the solver in parts. */
static int set_function(SUNNonlinearSolver solver, SUNNonlinSolSysFn function) {
  (void)solver, (void)function;
  return 0;
}

/* Counted by the stages themselves. */
static int count_none(SUNNonlinearSolver solver, long *count) {
  (void)solver;
  *count = 0;
  return 0;
}

static SUNNonlinearSolver whole_solver(Integrator *integrator, SUNContext context) {
  SUNNonlinearSolver solver = SUNNonlinSolNewEmpty(context);
  solver->content = integrator;
  solver->ops->gettype = type;
  solver->ops->solve = solve;
  solver->ops->setsysfn = set_function;
  solver->ops->getnumiters = count_none;
  solver->ops->getnumconvfails = count_none;
  return solver;
}

/* ---- setting up ---- */

static void set_library_events(Integrator *integrator) {
  int count = events_count(integrator->problem.layer), *falling = room(count, sizeof *falling);
  for (int i = 0; i < count; i++) falling[i] = -1;
  check(CVodeRootInit(integrator->memory, count, roots), "CVodeRootInit");
  check(CVodeSetRootDirection(integrator->memory, falling), "CVodeSetRootDirection");
  CVodeSetNoInactiveRootWarn(integrator->memory);
  free(falling);
}

static void set_linear_solver(Integrator *integrator, SUNContext context) {
  Problem *problem = &integrator->problem;
  int sparse = integrator->variant->solver == BY_KLU;
  LinearSolver linear = sparse ? klu_new(problem, integrator->y, context) : condensed_new(problem, context);
  check(CVodeSetLinearSolver(integrator->memory, linear.solver, linear.matrix), "CVodeSetLinearSolver");
  check(CVodeSetLinSysFn(integrator->memory, linear.system), "CVodeSetLinSysFn");
}

static void set_up_cvodes(Integrator *integrator, SUNContext context) {
  const Variant *variant = integrator->variant;
  void *memory = integrator->memory = CVodeCreate(variant->family == ADAMS ? CV_ADAMS : CV_BDF, context);
  check(CVodeInit(memory, derivatives, 0, integrator->y), "CVodeInit");
  check(CVodeSetUserData(memory, integrator), "CVodeSetUserData");
  check(CVodeWFtolerances(memory, weights), "CVodeWFtolerances");
  check(CVodeSetMaxNumSteps(memory, MOST_STEPS), "CVodeSetMaxNumSteps");
  check(CVodeSetMaxHnilWarns(memory, 0), "CVodeSetMaxHnilWarns");
  if (variant->solver == WHOLE)
    check(CVodeSetNonlinearSolver(memory, whole_solver(integrator, context)), "CVodeSetNonlinearSolver");
  else set_linear_solver(integrator, context);
  if (!variant->own_events) set_library_events(integrator);
}

static void set_up_arkode(Integrator *integrator, SUNContext context) {
  const Variant *variant = integrator->variant;
  void *memory = integrator->memory = ARKStepCreate(NULL, derivatives, 0, integrator->y, context);
  check(ARKStepSetTableName(memory, variant->table, "ARKODE_ERK_NONE"), "ARKStepSetTableName");
  check(ARKStepSetUserData(memory, integrator), "ARKStepSetUserData");
  check(ARKStepWFtolerances(memory, weights), "ARKStepWFtolerances");
  check(ARKStepSetMaxNumSteps(memory, MOST_STEPS), "ARKStepSetMaxNumSteps");
  check(ARKStepSetMaxHnilWarns(memory, 0), "ARKStepSetMaxHnilWarns");
  check(ARKStepSetPredictorMethod(memory, 0), "ARKStepSetPredictorMethod");
  check(ARKStepSetDeduceImplicitRhs(memory, 0), "ARKStepSetDeduceImplicitRhs");
  check(ARKStepSetInterpolantDegree(memory, variant->interpolant_degree), "ARKStepSetInterpolantDegree");
  check(ARKStepSetNonlinearSolver(memory, whole_solver(integrator, context)), "ARKStepSetNonlinearSolver");
  shortcuts.trivial_prediction = 1;
}

Integrator *integrator_new(const Variant *variant, Layer *layer, Events *events, N_Vector y, double rtol, double length,
                           double frequency, SUNContext context) {
  Integrator *integrator = room(1, sizeof *integrator);
  Jacobian *jacobian = jacobian_new(layer);
  *integrator = (Integrator){.problem = {layer, jacobian, NULL},
                             .variant = variant,
                             .events = events,
                             .y = y,
                             .rtol = rtol,
                             .atol_place = rtol * length,
                             .atol_rate = rtol * length * frequency,
                             .stiffly_accurate = -1,
                             .known = {NULL, NULL, NAN}};
  if (variant->solver == WHOLE) integrator->stage = stage_new(layer, jacobian);
  (variant->family == DIRK ? set_up_arkode : set_up_cvodes)(integrator, context);
  return integrator;
}

/* ---- running ---- */

static void set_stop(Integrator *integrator, double stop) {
  if (integrator->variant->family == DIRK) check(ARKStepSetStopTime(integrator->memory, stop), "ARKStepSetStopTime");
  else check(CVodeSetStopTime(integrator->memory, stop), "CVodeSetStopTime");
}

void integrator_begin(Integrator *integrator, double t, double end) {
  integrator->end = end;
  if (integrator->stage) stage_forget_factors(integrator->stage); /* the speeds jump */
  if (t > 0) integrator_restart(integrator, t);
  else set_stop(integrator, end);
}

static void restart_cvodes(Integrator *integrator, double t) {
  double last, share = integrator->variant->first_step;
  integrator_count(integrator);
  check(CVodeGetLastStep(integrator->memory, &last), "CVodeGetLastStep");
  check(CVodeReInit(integrator->memory, t, integrator->y), "CVodeReInit");
  if (share > 0) CVodeSetInitStep(integrator->memory, fmin(share * last, (integrator->end - t) * 0.999));
}

void integrator_restart(Integrator *integrator, double t) {
  integrator->known.first_at = NAN;
  if (integrator->variant->family == DIRK) check(ARKStepReset(integrator->memory, t, integrator->y), "ARKStepReset");
  else restart_cvodes(integrator, t);
  set_stop(integrator, integrator->end);
}

static int is_stiffly_accurate(void *memory) {
  ARKodeButcherTable implicit, explicit;
  check(ARKStepGetCurrentButcherTables(memory, &implicit, &explicit), "ARKStepGetCurrentButcherTables");
  for (int j = 0; j < implicit->stages; j++)
    if (fabs(implicit->A[implicit->stages - 1][j] - implicit->b[j]) > 1e-14) return 0;
  return 1;
}

/* Forces and derivatives of a stiffly accurate method's last stage are those of the step's end. */
static void note_end_of_step(Integrator *integrator) {
  if (integrator->stiffly_accurate < 0) integrator->stiffly_accurate = is_stiffly_accurate(integrator->memory);
  if (integrator->stiffly_accurate) ARKStepGetCurrentTime(integrator->memory, &integrator->known.first_at);
  else integrator->problem.layer->known_at = integrator->known.first_at = NAN;
}

StepEnd integrator_step(Integrator *integrator, double stop, double *t) {
  int flag;
  if (integrator->variant->family == DIRK) {
    if (integrator->variant->foresees) set_stop(integrator, stop);
    flag = ARKStepEvolve(integrator->memory, integrator->end, integrator->y, t, ARK_ONE_STEP);
    check(flag, "ARKStepEvolve");
    note_end_of_step(integrator);
    return flag == ARK_TSTOP_RETURN ? AT_STOP : STEPPED;
  }
  flag = CVode(integrator->memory, integrator->end, integrator->y, t, CV_ONE_STEP);
  check(flag, "CVode");
  return flag == CV_TSTOP_RETURN ? AT_STOP : flag == CV_ROOT_RETURN ? AT_ROOT : STEPPED;
}

void integrator_interpolate(void *data, double t, N_Vector state) {
  Integrator *integrator = data;
  if (integrator->variant->family == DIRK) check(ARKStepGetDky(integrator->memory, t, 0, state), "ARKStepGetDky");
  else check(CVodeGetDky(integrator->memory, t, 0, state), "CVodeGetDky");
}

void integrator_roots_found(Integrator *integrator, int *found) {
  check(CVodeGetRootInfo(integrator->memory, found), "CVodeGetRootInfo");
}

/* CVODES counts from the last restart on, ARKODE from the start. */
void integrator_count(Integrator *integrator) {
  long steps, failures, iterations;
  if (integrator->variant->family == DIRK) {
    ARKStepGetNumSteps(integrator->memory, &integrator->steps);
    ARKStepGetNumErrTestFails(integrator->memory, &integrator->failures);
    return;
  }
  CVodeGetNumSteps(integrator->memory, &steps);
  CVodeGetNumErrTestFails(integrator->memory, &failures);
  CVodeGetNumNonlinSolvIters(integrator->memory, &iterations);
  integrator->steps += steps, integrator->failures += failures, integrator->iterations += iterations;
}
