#define _POSIX_C_SOURCE 200112L

#include "town.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* clang-format off */
const float house_positions[3 * HOUSE_VERTICES] = {
  -.5f, 0, -.5f,  .5f, 0, -.5f,  .5f, 0, .5f,  -.5f, 0, .5f,
  -.5f, 1, -.5f,  .5f, 1, -.5f,  .5f, 1, .5f,  -.5f, 1, .5f};
const uint32_t house_indices[HOUSE_INDICES] = {
  0, 1, 2, 0, 2, 3,  4, 7, 6, 4, 6, 5,  0, 4, 5, 0, 5, 1,
  1, 5, 6, 1, 6, 2,  2, 6, 7, 2, 7, 3,  3, 7, 4, 3, 4, 0};
/* clang-format on */

static unsigned long drawn;

void place_house(uint32_t house, double world_from_house[16]) {
  const uint32_t row = house / TOWN_SIDE, column = house % TOWN_SIDE;
  memset(world_from_house, 0, 16 * sizeof(double));
  world_from_house[0] = 9.0;
  world_from_house[5] = 6.0 + (double)((house * 2654435761u) >> 28); /* 6 m to 21 m high */
  world_from_house[10] = 9.0;
  world_from_house[12] = 15.0 * ((double)column - 0.5 * TOWN_SIDE);
  world_from_house[14] = 15.0 * ((double)row - 0.5 * TOWN_SIDE);
  world_from_house[15] = 1.0;
}

void camera_at(double time_s, double width_by_height, double view[16], double projection[16]) {
  /* Down a street between two rows of houses, looking a little left and right. */
  const double yaw = 0.4 * sin(0.5 * time_s), c = cos(yaw), s = sin(yaw);
  const double x = 7.5, y = 1.7, z = 100.0 - 1.4 * time_s;
  const double near_m = 0.1, far_m = 2000.0, f = 1.0 / tan(0.5 * 1.0471975511965976);
  /* clang-format off */
  const double camera[16] = {c, 0, s, 0,   0, 1, 0, 0,   -s, 0, c, 0,   -c * x + s * z, -y, -s * x - c * z, 1};
  const double clip[16] = {f / width_by_height, 0, 0, 0,   0, f, 0, 0,
                           0, 0, -(far_m + near_m) / (far_m - near_m), -1,
                           0, 0, -2.0 * far_m * near_m / (far_m - near_m), 0};
  /* clang-format on */
  memcpy(view, camera, sizeof camera);
  memcpy(projection, clip, sizeof clip);
}

double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void swap_buffers(void) {
  const struct timespec frame = {0, 16666667};
  nanosleep(&frame, NULL);
}

void draw_house(uint32_t house) {
  (void)house;
  ++drawn;
}

unsigned long houses_drawn(void) {
  return drawn;
}
