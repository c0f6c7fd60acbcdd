/* The rigid profile: a cubic spline, natural or periodic. */
#ifndef PROFILE_H
#define PROFILE_H

#include <math.h>

#include "scene.h"

/* The profile at one place: z_r, s = z_r', κ = z_r'', z_r'''. */
typedef struct {
  double height, slope, curvature, third;
} Ground;

/* z = height + t (slope + t (half + t sixth)), t the distance from x. */
typedef struct {
  double x, height, slope, half, sixth;
} Piece;

typedef struct {
  int pieces, periodic;
  double start, length;
  double per_length; /* pieces per length where they are all alike, else 0 */
  double per_period; /* 1/length */
  Piece *piece;      /* and one more: beyond the end, straight */
  double tangent;    /* slope before the start */
} Profile;

Profile profile_new(const Scene *scene);

/* The piece that holds x, by bisection. */
int profile_search(const Profile *profile, double x);

static inline int profile_piece(const Profile *profile, double x) {
  if (profile->per_length == 0) return profile_search(profile, x);
  int i = (int)((x - profile->start) * profile->per_length);
  if (i > profile->pieces - 1) i = profile->pieces - 1;
  if (x < profile->piece[i].x) return i - (i > 0); /* the division was rounded across a data point */
  return i + (i < profile->pieces - 1 && x >= profile->piece[i + 1].x);
}

static inline Ground profile_on(const Piece *piece, double t) {
  double b = piece->half, third = 6 * piece->sixth, c = t * 3 * piece->sixth;
  return (Ground){piece->height + t * (piece->slope + t * (b + t * piece->sixth)), piece->slope + t * (2 * b + c),
                  2 * (b + c), third};
}

/* Whether profile_even_at may be used: without a branch, so that loops over masses become those of vectors. */
static inline int profile_is_even(const Profile *profile) {
  return profile->periodic && profile->per_length > 0;
}

/* The piece that holds x, and the distance from its start into t. Rounding may take a neighbour: the spline goes on. */
static inline const Piece *profile_even_piece(const Profile *profile, double x, double *t) {
  double d = x - profile->start;
  d -= profile->length * floor(d * profile->per_period);
  int last = profile->pieces - 1, i = (int)(d * profile->per_length);
  i = i > last ? last : i < 0 ? 0 : i;
  *t = d - (profile->piece[i].x - profile->start);
  return &profile->piece[i];
}

static inline Ground profile_at(const Profile *profile, double x) {
  double from_start = x - profile->start;
  const Piece *piece;
  if (profile->periodic) {
    if (from_start < 0 || from_start >= profile->length) {
      from_start -= profile->length * floor(from_start / profile->length);
      if (from_start >= profile->length) from_start = 0;
    }
    x = profile->start + from_start;
    piece = &profile->piece[profile_piece(profile, x)];
  } else if (from_start < 0) {
    return (Ground){profile->piece[0].height + from_start * profile->tangent, profile->tangent, 0, 0};
  } else {
    piece = &profile->piece[from_start > profile->length ? profile->pieces : profile_piece(profile, x)];
  }
  return profile_on(piece, x - piece->x);
}

#endif
