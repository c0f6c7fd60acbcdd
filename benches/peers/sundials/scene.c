#include "scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fail(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fputs("sundials_contact: ", stderr);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  exit(1);
}

void *room(unsigned long count, unsigned long size) {
  enum { LINE = 64 };
  unsigned long bytes = (count * size + LINE) / LINE * LINE;
  void *memory = aligned_alloc(LINE, bytes);
  if (!memory) fail("out of memory");
  return memset(memory, 0, bytes);
}

/* The next word has to be `word`. */
static void expect(FILE *file, const char *word) {
  char found[32] = "the end of the file";
  if (fscanf(file, "%31s", found) != 1 || strcmp(found, word))
    fail("the scene: expected `%s`, found `%s`", word, found);
}

static double number(FILE *file) {
  double value;
  if (fscanf(file, "%lf", &value) != 1) fail("the scene: expected a number");
  return value;
}

static int whole(FILE *file) {
  int value;
  if (fscanf(file, "%d", &value) != 1) fail("the scene: expected a whole number");
  return value;
}

static Link read_link(FILE *file, const char *name) {
  expect(file, name);
  Link link = {0};
  link.c = number(file);
  link.d = number(file);
  link.n = whole(file);
  if (link.n > MOST_ELEMENTS) fail("%s: at most %d Maxwell elements", name, MOST_ELEMENTS);
  for (int j = 0; j < link.n; j++) {
    link.stiffness[j] = number(file);
    link.rate[j] = 1 / number(file);
  }
  return link;
}

static Path read_path(FILE *file) {
  Path path;
  path.rate = number(file);
  path.amplitude = number(file);
  path.frequency = number(file);
  return path;
}

static void read_pairs(FILE *file, int count, double **first, double **second) {
  *first = room(count, sizeof **first);
  *second = room(count, sizeof **second);
  for (int i = 0; i < count; i++) {
    (*first)[i] = number(file);
    (*second)[i] = number(file);
  }
}

static void read_layer(FILE *file, Scene *scene) {
  static const char *const names[KINDS] = {"vertical", "horizontal", "lateral_x", "lateral_z"};
  expect(file, "mass");
  scene->mass = number(file);
  expect(file, "relaxed");
  scene->relaxed = whole(file);
  for (int kind = 0; kind < KINDS; kind++) scene->link[kind] = read_link(file, names[kind]);
  expect(file, "masses");
  scene->k = whole(file);
  read_pairs(file, scene->k, &scene->rest_x, &scene->rest_z);
}

static void read_surface(FILE *file, Scene *scene) {
  expect(file, "friction");
  scene->friction = number(file);
  scene->shear = number(file);
  expect(file, "profile");
  scene->periodic = whole(file);
  scene->points = whole(file);
  read_pairs(file, scene->points, &scene->x, &scene->z);
}

static void read_phases(FILE *file, Scene *scene) {
  expect(file, "phases");
  scene->phases = whole(file);
  if (scene->phases < 1) fail("the scene has no excitation");
  scene->phase = room(scene->phases, sizeof *scene->phase);
  for (int i = 0; i < scene->phases; i++) {
    Phase *phase = &scene->phase[i];
    phase->duration = number(file);
    phase->u = read_path(file);
    phase->w = read_path(file);
  }
}

Scene scene_read(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) fail("cannot read %s", path);
  Scene scene = {0};
  read_layer(file, &scene);
  read_surface(file, &scene);
  read_phases(file, &scene);
  fclose(file);
  return scene;
}

double link_glassy_stiffness(const Link *link) {
  double sum = link->c;
  for (int j = 0; j < link->n; j++) sum += link->stiffness[j];
  return sum;
}
