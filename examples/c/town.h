/* The program that wants culling: a town of houses, a camera that walks through it, and a renderer that only
   counts what it is told to draw. */
#ifndef TOWN_H
#define TOWN_H

#include <stddef.h>
#include <stdint.h>

enum { TOWN_SIDE = 40, TOWN_HOUSES = TOWN_SIDE * TOWN_SIDE, HOUSE_VERTICES = 8, HOUSE_INDICES = 36 };

/* The one mesh: a box of 1 m, its floor at y = 0. */
extern const float house_positions[3 * HOUSE_VERTICES];
extern const uint32_t house_indices[HOUSE_INDICES];

/* Where a house stands: world from house, column-major. */
void place_house(uint32_t house, double world_from_house[16]);

/* The camera on its walk at a time: camera from world, and an OpenGL projection of 60 degrees. Column-major.
 */
void camera_at(double time_s, double width_by_height, double view[16], double projection[16]);

/* Seconds of a clock that runs evenly. */
double seconds_now(void);
/* Ends the frame: waits until the next is due, 60 a second. */
void swap_buffers(void);

/* "Draws" one house. */
void draw_house(uint32_t house);
/* How many have been drawn. */
unsigned long houses_drawn(void);

#endif
