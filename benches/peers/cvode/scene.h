/* A scene as numbers, read from the flat text that flatten.py writes. SI units throughout. */
#ifndef SCENE_H
#define SCENE_H

/* The kinds of link, in the order of the scene's text. */
enum { VERTICAL, HORIZONTAL, LATERAL_X, LATERAL_Z, KINDS };

/* Most Maxwell elements of one link. */
enum { MOST_ELEMENTS = 32 };

/* F = c e + d e' + sum_j c_j a_j with the elongations a_j = e - y_j of the Maxwell springs: a_j' = e' - a_j/tau_j. */
typedef struct {
  double c, d;
  int n;
  double stiffness[MOST_ELEMENTS], rate[MOST_ELEMENTS]; /* c_j and 1/tau_j */
} Link;

/* One displacement of the carrier since its phase began: rate s + amplitude sin(2 pi frequency s). */
typedef struct {
  double rate, amplitude, frequency;
} Path;

typedef struct {
  double duration;
  Path u, w;
} Phase;

typedef struct {
  int k;                           /* number of masses */
  double mass;                     /* m of one of them, kg */
  int relaxed;                     /* the dashpots start relaxed, y_j = e_j; else undeformed, y_j = 0 */
  double *rest_x, *rest_z;         /* X_i and Z_i, m */
  Link link[KINDS];
  double friction, shear;          /* mu and A tau_0, N */
  int periodic, points;            /* the profile's data */
  double *x, *z;
  int phases;
  Phase *phase;
} Scene;

/* Reads a scene; ends the program with a message where the file is not one. */
Scene scene_read(const char *path);

/* Stiffness c + sum c_j of a link to a sudden pull, N/m. */
double link_glassy_stiffness(const Link *link);

/* Zeroed memory on a cache line, or the end of the program. */
void *room(unsigned long count, unsigned long size);

/* Ends the program with a message. */
_Noreturn void fail(const char *format, ...);

#endif
