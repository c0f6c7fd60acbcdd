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
  double t = x - piece->x, b = piece->half, c = piece->sixth;
  return (Ground){piece->height + t * (piece->slope + t * (b + t * c)), piece->slope + t * (2 * b + t * 3 * c),
                  2 * b + t * 6 * c, 6 * c};
}

#endif
