/* The contact model by CVODES: BDF, event driven, a restart after every event.
 *
 *   cvode_contact SCENE.txt OUT.csv RTOL [--solver klu|cond] [--points N] [--length METRES]
 *
 * OUT.csv holds time, F_x, F_z, E_diss at the start and at N (50) even times a phase. On standard output: one line of
 * what the run took, as key=value. Equation numbers are the paper's. */
#include <pmmintrin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#include "events.h"
#include "linear.h"
#include "vectors.h"

typedef struct {
  const char *scene, *output, *solver;
  double rtol, length; /* absolute tolerance of an elongation over the relative one, m */
  int points;
} Options;

typedef struct {
  Layer layer;
  Problem problem;
  Events events;
  void *cvode;
  N_Vector y, energies;
  long steps, failures, iterations;
  FILE *output;
} Run;

static void check(int flag, const char *what) {
  if (flag < 0) fail("%s: %s", what, CVodeGetReturnFlagName(flag));
}

/* ---- what CVODE calls ---- */

static int derivatives(double t, N_Vector y, N_Vector f, void *data) {
  Problem *problem = data;
  problem->forces_known_at = NAN;
  layer_evaluate(problem->layer, t, N_VGetArrayPointer(y));
  layer_derivatives(problem->layer, N_VGetArrayPointer(y), N_VGetArrayPointer(f));
  return 0;
}

/* CVODE asks for the power at the end of a step and then, unless it repeats the step with another end, for the root
 * functions in the same state: the forces are kept for them. */
static int power(double t, N_Vector y, N_Vector channels, void *data) {
  Problem *problem = data;
  layer_evaluate(problem->layer, t, N_VGetArrayPointer(y));
  layer_power(problem->layer, N_VGetArrayPointer(y), N_VGetArrayPointer(channels));
  problem->forces_known_at = t;
  return 0;
}

static void weigh(long count, const double *restrict y, double rtol, double atol, double *restrict weight) {
#pragma GCC ivdep
  for (long i = 0; i < count; i++) weight[i] = 1 / (rtol * fabs(y[i]) + atol);
}

static int weights(N_Vector y_, N_Vector weights_, void *data) {
  const Problem *problem = data;
  const double *y = N_VGetArrayPointer(y_);
  double *weight = N_VGetArrayPointer(weights_);
  long places = 2L * problem->layer->k, moving = 2 * places, order = problem->layer->order;
  weigh(places, y, problem->rtol, problem->atol_place, weight);
  weigh(places, y + places, problem->rtol, problem->atol_rate, weight + places);
  weigh(order - moving, y + moving, problem->rtol, problem->atol_place, weight + moving);
  return 0;
}

/* ---- setting up ---- */

/* Tolerances: elongations rtol times the length given, rates that times the vertical link's glassy frequency, energies
 * what such an elongation stores in all vertical links. */
static void set_tolerances(Run *run, const Options *options) {
  Problem *problem = &run->problem;
  const Scene *scene = &run->layer.scene;
  double stiffness = link_glassy_stiffness(&scene->link[VERTICAL]), frequency = sqrt(stiffness / scene->mass);
  problem->rtol = options->rtol;
  problem->atol_place = options->rtol * options->length;
  problem->atol_rate = problem->atol_place * frequency;
  events_set_margins(problem, problem->atol_place, stiffness, frequency);
  check(CVodeWFtolerances(run->cvode, weights), "CVodeWFtolerances");
  double energy = options->rtol * scene->k * stiffness * options->length * options->length;
  check(CVodeQuadSStolerances(run->cvode, options->rtol, energy), "CVodeQuadSStolerances");
  check(CVodeSetQuadErrCon(run->cvode, 1), "CVodeSetQuadErrCon");
}

static void set_linear_solver(Run *run, const Options *options, SUNContext context) {
  Problem *problem = &run->problem;
  problem->variation = variation_new(run->layer.k);
  if (!strcmp(options->solver, "klu")) problem->linear = klu_new(problem, run->y, context);
  else if (!strcmp(options->solver, "cond")) problem->linear = condensed_new(problem, context);
  else fail("--solver klu or cond, not %s", options->solver);
  check(CVodeSetLinearSolver(run->cvode, problem->linear.solver, problem->linear.matrix), "CVodeSetLinearSolver");
  check(CVodeSetLinSysFn(run->cvode, problem->linear.system), "CVodeSetLinSysFn");
}

static void set_roots(Run *run) {
  int count = events_count(&run->layer), *falling = room(count, sizeof *falling);
  for (int i = 0; i < count; i++) falling[i] = -1;
  check(CVodeRootInit(run->cvode, count, events_roots), "CVodeRootInit");
  check(CVodeSetRootDirection(run->cvode, falling), "CVodeSetRootDirection");
  CVodeSetNoInactiveRootWarn(run->cvode);
  free(falling);
}

static void set_up(Run *run, const Options *options, SUNContext context) {
  run->layer = layer_new(scene_read(options->scene));
  run->problem.layer = &run->layer;
  run->problem.forces_known_at = NAN;
  run->y = N_VNew_Serial(run->layer.order, context);
  check(N_VEnableFusedOps_Serial(run->y, 1), "N_VEnableFusedOps_Serial");
  vectors_replace(run->y);
  run->energies = N_VNew_Serial(CHANNELS, context);
  N_VConst(0, run->energies);
  run->cvode = CVodeCreate(CV_BDF, context);
  check(CVodeInit(run->cvode, derivatives, 0, run->y), "CVodeInit");
  check(CVodeSetUserData(run->cvode, &run->problem), "CVodeSetUserData");
  check(CVodeSetMaxNumSteps(run->cvode, 100000000), "CVodeSetMaxNumSteps");
  check(CVodeQuadInit(run->cvode, power, run->energies), "CVodeQuadInit");
  set_tolerances(run, options);
  set_linear_solver(run, options, context);
  set_roots(run);
}

/* ---- the run ---- */

static void write_row(Run *run, double t) {
  const double *y = N_VGetArrayPointer(run->y), *energy = N_VGetArrayPointer(run->energies);
  layer_evaluate(&run->layer, t, y);
  run->problem.forces_known_at = NAN;
  double dissipated = energy[DAMPER] + energy[MAXWELL] + energy[FRICTION] + run->events.impact;
  fprintf(run->output, "%.12g,%.15g,%.15g,%.15g\n", t, run->layer.F_x, run->layer.F_z, dissipated);
}

/* CVODE counts from the last restart on. */
static void count(Run *run) {
  long steps, failures, iterations;
  CVodeGetNumSteps(run->cvode, &steps);
  CVodeGetNumErrTestFails(run->cvode, &failures);
  CVodeGetNumNonlinSolvIters(run->cvode, &iterations);
  run->steps += steps, run->failures += failures, run->iterations += iterations;
}

static void restart(Run *run, double t, double end) {
  count(run);
  run->problem.forces_known_at = NAN;
  check(CVodeReInit(run->cvode, t, run->y), "CVodeReInit");
  check(CVodeQuadReInit(run->cvode, run->energies), "CVodeQuadReInit");
  check(CVodeSetStopTime(run->cvode, end), "CVodeSetStopTime");
}

/* From one row of the result to the next, at time `row`, in a phase that ends at `end`. */
static void advance(Run *run, double *t, double row, double end, int *found) {
  double *y = N_VGetArrayPointer(run->y), known;
  for (;;) {
    int flag = CVode(run->cvode, row, run->y, t, CV_NORMAL);
    check(flag, "CVode");
    check(CVodeGetQuad(run->cvode, &known, run->energies), "CVodeGetQuad");
    if (flag != CV_ROOT_RETURN) return;
    check(CVodeGetRootInfo(run->cvode, found), "CVodeGetRootInfo");
    run->problem.forces_known_at = NAN;
    if (!events_handle(&run->problem, &run->events, *t, y, found)) continue;
    if (end - *t <= 4e-16 * end) return; /* the phase's end: the next one restarts */
    restart(run, *t, end);
  }
}

/* Enters a phase at time t: the carrier's rates jump, the masses' velocities do not. */
static void enter(Run *run, const Phase *phase, double t) {
  double *y = N_VGetArrayPointer(run->y);
  int k = run->layer.k;
  layer_evaluate(&run->layer, t, y);
  layer_store_contacts(&run->layer, y);
  Carrier before = run->layer.carrier;
  layer_enter_phase(&run->layer, phase, t);
  Carrier after = layer_carrier(&run->layer, t);
  for (int i = 0; i < k; i++) {
    y[2 * k + i] += before.u_rate - after.u_rate;
    y[3 * k + i] += before.w_rate - after.w_rate;
  }
}

static void follow_phase(Run *run, const Phase *phase, double start, int points, int *found) {
  double t = start, end = start + phase->duration;
  events_settle(&run->problem, &run->events, t, N_VGetArrayPointer(run->y));
  restart(run, t, end);
  for (int i = 1; i <= points; i++) {
    double row = i == points ? end : start + phase->duration * i / points;
    if (t < row) advance(run, &t, row, end, found);
    write_row(run, row);
  }
}

static void follow(Run *run, int points) {
  const Scene *scene = &run->layer.scene;
  int *found = room(events_count(&run->layer), sizeof *found);
  double t = 0;
  for (int i = 0; i < scene->phases; i++) {
    if (i > 0) enter(run, &scene->phase[i], t);
    follow_phase(run, &scene->phase[i], t, points, found);
    t += scene->phase[i].duration;
  }
  free(found);
}

/* What the run took, and what the energy balance misses since `before`, over the energy put in. */
static void report(const Run *run, double before) {
  const Events *events = &run->events;
  const double *energy = N_VGetArrayPointer(run->energies);
  double dissipated = energy[DAMPER] + energy[MAXWELL] + energy[FRICTION] + events->impact;
  double gained = layer_stored_energy(&run->layer, N_VGetArrayPointer(run->y)) - before;
  double residual = (energy[INPUT] - gained - dissipated) / (fabs(energy[INPUT]) + 1e-300);
  long found = events->touch + events->lift + events->stop + events->break_;
  printf("steps=%ld rejected=%ld newton=%ld events=%ld ", run->steps, run->failures, run->iterations, found);
  printf("touch=%ld lift=%ld stop=%ld break=%ld ", events->touch, events->lift, events->stop, events->break_);
  printf("aside=%ld apart=%ld residual=%.3e\n", events->aside, events->apart, residual);
}

static void simulate(Run *run, const Options *options) {
  double *y = N_VGetArrayPointer(run->y);
  layer_enter_phase(&run->layer, run->layer.scene.phase, 0);
  layer_start(&run->layer, y);
  events_settle(&run->problem, &run->events, 0, y);
  double before = layer_stored_energy(&run->layer, y);
  run->output = fopen(options->output, "w");
  if (!run->output) fail("cannot write %s", options->output);
  fputs("time,F_x,F_z,E_diss\n", run->output);
  write_row(run, 0);
  follow(run, options->points);
  fclose(run->output);
  count(run);
  report(run, before);
}

static Options options_of(int count, char **words) {
  if (count < 4) fail("usage: cvode_contact SCENE.txt OUT.csv RTOL [--solver klu|cond] [--points N] [--length METRES]");
  Options options = {
      .scene = words[1], .output = words[2], .rtol = atof(words[3]), .solver = "klu", .length = 1e-6, .points = 50};
  for (int i = 4; i + 1 < count; i += 2) {
    if (!strcmp(words[i], "--solver")) options.solver = words[i + 1];
    else if (!strcmp(words[i], "--points")) options.points = atoi(words[i + 1]);
    else if (!strcmp(words[i], "--length")) options.length = atof(words[i + 1]);
    else fail("no such option: %s", words[i]);
  }
  if (options.rtol <= 0 || options.points < 1 || options.length <= 0)
    fail("RTOL, --points and --length have to be above 0");
  return options;
}

int main(int count, char **words) {
  /* Elements that have relaxed would crawl through the denormal numbers. */
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  Options options = options_of(count, words);
  SUNContext context;
  if (SUNContext_Create(NULL, &context)) fail("SUNContext_Create");
  Run *run = room(1, sizeof *run);
  set_up(run, &options, context);
  simulate(run, &options);
  return 0;
}
