/* A scene as numbers, read from the flat text that flatten.py writes. SI units throughout. */
#ifndef SCENE_H
#define SCENE_H

/* The kinds of link, in the order of the scene's text. */
enum { VERTICAL, HORIZONTAL, LATERAL_X, LATERAL_Z, KINDS };

/* Most Maxwell elements of one link. */
enum { MOST_ELEMENTS = 32 };

/* F = c e + d ė + Σ_j c_j a_j with the elongations a_j = e - y_j of the Maxwell springs: ȧ_j = ė - a_j/τ_j. */
typedef struct {
  double c, d;
  int n;
  double stiffness[MOST_ELEMENTS], rate[MOST_ELEMENTS]; /* c_j and 1/τ_j */
} Link;

/* One displacement of the carrier since its phase began: rate s + amplitude sin(2 π frequency s). */
typedef struct {
  double rate, amplitude, frequency;
} Path;

typedef struct {
  double duration;
  Path u, w;
} Phase;

typedef struct {
  int k;                   /* number of masses */
  double mass;             /* m of one of them, kg */
  int relaxed;             /* the dashpots start relaxed, y_j = e_j; else undeformed, y_j = 0 */
  double *rest_x, *rest_z; /* X_i and Z_i, m */
  Link link[KINDS];
  double friction, shear; /* μ and A τ_0, N */
  int periodic, points;   /* the profile's data */
  double *x, *z;
  int phases;
  Phase *phase;
} Scene;

/* Reads a scene; ends the program with a message where the file is not one. */
Scene scene_read(const char *path);

/* Stiffness c + Σ c_j of a link to a sudden pull, N/m. */
double link_glassy_stiffness(const Link *link);

/* Zeroed memory on a cache line, or the end of the program. */
void *room(unsigned long count, unsigned long size);

/* Ends the program with a message. */
_Noreturn void fail(const char *format, ...);

#endif
