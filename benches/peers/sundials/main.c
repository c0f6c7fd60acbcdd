/* The contact model by SUNDIALS: CVODES and ARKODE, event driven, a restart after every event.
 *
 *   sundials_contact SCENE.txt OUT.csv RTOL --variant NAME [--points N] [--length METRES]
 *
 * OUT.csv holds time, F_x, F_z, E_diss at the start and at N (50) even times a phase. On standard output: one line of
 * what the run took, as key=value. The variants are those of variant.c. Equation numbers are the paper's. */
#include <pmmintrin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#include "integrator.h"
#include "locate.h"
#include "vectors.h"

typedef struct {
  const char *scene, *output, *variant;
  double rtol, length; /* absolute tolerance of an elongation over the relative one, m */
  int points;
} Options;

typedef struct {
  const Variant *variant;
  Layer layer;
  Events events;
  Integrator *integrator;
  Locator locator;
  N_Vector state, row;
  double *y; /* the state's numbers */
  FILE *output;
} Run;

/* The rows of a phase: `next` of `count`, and their times. */
typedef struct {
  int next, count;
  double start, duration, end;
} Rows;

/* ---- setting up ---- */

static void set_up(Run *run, const Options *options, SUNContext context) {
  run->variant = variant_of(options->variant);
  run->layer = layer_new(scene_read(options->scene));
  const Scene *scene = &run->layer.scene;
  double stiffness = link_glassy_stiffness(&scene->link[VERTICAL]), frequency = sqrt(stiffness / scene->mass);
  double tolerance = options->rtol * options->length;
  run->state = vector_new(run->layer.order, context);
  run->row = N_VClone(run->state);
  run->y = N_VGetArrayPointer(run->state);
  run->events = events_new(&run->layer, tolerance, stiffness, frequency);
  layer_enter_phase(&run->layer, scene->phase, 0);
  layer_start(&run->layer, run->y);
  run->integrator = integrator_new(run->variant, &run->layer, &run->events, run->state, options->rtol, options->length,
                                   frequency, context);
  run->locator = locator_new(&run->events, integrator_interpolate, run->integrator, run->state);
  run->locator.passed = run->variant->passed;
  run->locator.tolerance = (Margins){tolerance, tolerance * stiffness, tolerance * frequency};
}

/* ---- rows ---- */

static void write_row(Run *run, double t, const double *y) {
  const double *energy = y + run->layer.energy;
  double F_x, F_z, dissipated = energy[DAMPER] + energy[MAXWELL] + energy[FRICTION] + run->events.impact;
  layer_evaluate(&run->layer, t, y);
  layer_carrier_forces(&run->layer, &F_x, &F_z);
  fprintf(run->output, "%.12g,%.15g,%.15g,%.15g\n", t, F_x, F_z, dissipated);
}

static double row_time(const Rows *rows) {
  return rows->next == rows->count ? rows->end : rows->start + rows->duration * rows->next / rows->count;
}

/* The rows up to time t, which the run has reached: by interpolation, but where it stands. */
static void write_rows(Run *run, Rows *rows, double t) {
  for (; rows->next <= rows->count && row_time(rows) <= t * (1 + 1e-15); rows->next++) {
    double row = row_time(rows);
    int here = run->variant->own_events && fabs(row - t) < 1e-13 * rows->end;
    if (!here) integrator_interpolate(run->integrator, row, run->row);
    write_row(run, row, here ? run->y : N_VGetArrayPointer(run->row));
  }
}

/* ---- the run ---- */

/* Where a step shall end at the latest. */
static double stop_of(Run *run, double t, double end) {
  if (!run->variant->foresees) return end;
  layer_evaluate_unless_known(&run->layer, t, run->y);
  double ahead = 1.01 * locator_foresee(&run->locator); /* a little beyond the touch, so that it is seen */
  return ahead > 1e-9 * end ? fmin(t + ahead, end) : end;
}

/* One step; whether it ended at events, which are noted as found. */
static int step(Run *run, double *t, double end, int *ends_phase) {
  double start = *t;
  StepEnd how = integrator_step(run->integrator, stop_of(run, start, end), t);
  *ends_phase = how == AT_STOP && *t >= end * (1 - 1e-15);
  if (how == AT_ROOT) integrator_roots_found(run->integrator, run->locator.found);
  if (!run->variant->own_events) return how == AT_ROOT;
  double event = locator_first(&run->locator, start, *t, run->y);
  if (event == INFINITY) return 0;
  *ends_phase = 0;
  if (event < *t) {
    N_VScale(1, run->locator.state, run->state);
    *t = event;
  }
  return 1;
}

static void begin_locating(Run *run, double t) {
  if (run->variant->own_events) locator_begin(&run->locator, t, run->y);
}

static void follow_phase(Run *run, Rows rows) {
  double t = rows.start, end = rows.end;
  int ended = 0;
  events_settle(&run->events, t, run->y);
  integrator_begin(run->integrator, t, end);
  begin_locating(run, t);
  while (!ended && end - t > 4e-16 * end) {
    int at_events = step(run, &t, end, &ended);
    write_rows(run, &rows, t);
    if (!at_events || !events_handle(&run->events, t, run->y, run->locator.found)) continue;
    integrator_restart(run->integrator, t);
    begin_locating(run, t);
  }
  write_rows(run, &rows, end);
}

/* Enters a phase at time t: the carrier's rates jump, the masses' velocities do not. */
static void enter(Run *run, const Phase *phase, double t) {
  Layer *layer = &run->layer;
  long stride = layer->stride;
  layer_evaluate(layer, t, run->y);
  layer_store_contacts(layer, run->y);
  Carrier before = layer->carrier;
  layer_enter_phase(layer, phase, t);
  Carrier after = layer_carrier(layer, t);
  for (int i = 0; i < layer->k; i++) {
    run->y[2 * stride + i] += before.u_rate - after.u_rate;
    run->y[3 * stride + i] += before.w_rate - after.w_rate;
  }
}

static void follow(Run *run, int points) {
  const Scene *scene = &run->layer.scene;
  double t = 0;
  for (int i = 0; i < scene->phases; i++) {
    const Phase *phase = &scene->phase[i];
    if (i > 0) enter(run, phase, t);
    follow_phase(run, (Rows){1, points, t, phase->duration, t + phase->duration});
    t += phase->duration;
  }
}

/* What the run took, and what the energy balance misses since `before`, over the energy put in. */
static void report(Run *run, double before) {
  const Events *events = &run->events;
  const Integrator *integrator = run->integrator;
  const Stage *stage = integrator->stage;
  const double *energy = run->y + run->layer.energy;
  double dissipated = energy[DAMPER] + energy[MAXWELL] + energy[FRICTION] + events->impact;
  double gained = layer_stored_energy(&run->layer, run->y) - before;
  double residual = (energy[INPUT] - gained - dissipated) / (fabs(energy[INPUT]) + 1e-300);
  long found = events->touch + events->lift + events->stop + events->break_;
  printf("steps=%ld rejected=%ld stages=%ld ", integrator->steps, integrator->failures, stage ? stage->solved : 0);
  printf("newton=%ld ", stage ? stage->iterations : integrator->iterations);
  printf("factorisations=%ld ", integrator->problem.jacobian->factorisations);
  printf("events=%ld touch=%ld lift=%ld ", found, events->touch, events->lift);
  printf("stop=%ld break=%ld aside=%ld ", events->stop, events->break_, events->aside);
  printf("apart=%ld interpolations=%ld residual=%.3e\n", events->apart, run->locator.interpolations, residual);
}

static void simulate(Run *run, const Options *options) {
  events_settle(&run->events, 0, run->y);
  double before = layer_stored_energy(&run->layer, run->y);
  run->output = fopen(options->output, "w");
  if (!run->output) fail("cannot write %s", options->output);
  fputs("time,F_x,F_z,E_diss\n", run->output);
  write_row(run, 0, run->y);
  follow(run, options->points);
  fclose(run->output);
  integrator_count(run->integrator);
  report(run, before);
}

static Options options_of(int count, char **words) {
  if (count < 4) fail("usage: sundials_contact SCENE.txt OUT.csv RTOL --variant NAME [--points N] [--length METRES]");
  Options options = {
      .scene = words[1], .output = words[2], .rtol = atof(words[3]), .variant = "klu", .length = 1e-6, .points = 50};
  for (int i = 4; i + 1 < count; i += 2) {
    if (!strcmp(words[i], "--variant")) options.variant = words[i + 1];
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
