/* rays.c -- what rays-in-c.lisp compares with: a rotating fan over a grid of octets. */

#include <math.h>
#include <stdint.h>

enum { WALL = 1, OBSVIEW = 4, OCCUPIED = 8, SEEN = 128, OPAQUE = WALL | OBSVIEW };

struct walk { double at_x, at_y, per_x, per_y; int64_t cell, step_x, step_y; };

static inline struct walk start(int64_t width, double x, double y, double dx, double dy)
{
    int64_t cell_x = x, cell_y = y;
    double per_x = fabs(1 / dx), per_y = fabs(1 / dy);
    return (struct walk){ per_x * (dx < 0 ? x - cell_x : cell_x + 1 - x),
                          per_y * (dy < 0 ? y - cell_y : cell_y + 1 - y),
                          per_x, per_y, cell_y * width + cell_x,
                          dx < 0 ? -1 : 1, dy < 0 ? -width : width };
}

static inline void step(struct walk *w)
{
    if (w->at_x < w->at_y) w->at_x += w->per_x, w->cell += w->step_x;
    else w->at_y += w->per_y, w->cell += w->step_y;
}

/* Return the sum of the cells in which the rays of a fan end; walls have to surround the place. */
int64_t cast(uint8_t *flags, int64_t width, double x, double y, double angle, double fan,
             int64_t count, int32_t *found)
{
    double spacing = fan / count, first = angle - (fan - spacing) / 2;
    double c = cos(spacing), s = sin(spacing), dx = cos(first), dy = sin(first);
    int64_t sum = 0;
    while (count-- > 0) {
        struct walk w = start(width, x, y, dx, dy);
        do step(&w); while (!(flags[w.cell] & OPAQUE));
        sum += w.cell;
        double turned = dx * c - dy * s;
        dy = dx * s + dy * c, dx = turned;
    }
    return sum;
}

/* Write the cells with things that a fan meets to FOUND; return how many. */
int64_t scan(uint8_t *flags, int64_t width, double x, double y, double angle, double fan,
             int64_t count, int32_t *found)
{
    double spacing = fan / count, first = angle - (fan - spacing) / 2;
    double c = cos(spacing), s = sin(spacing), dx = cos(first), dy = sin(first);
    int64_t size = 0;
    while (count-- > 0) {
        struct walk w = start(width, x, y, dx, dy);
        uint8_t flag;
        do {
            step(&w);
            flag = flags[w.cell];
            if ((flag & (OCCUPIED | SEEN)) == OCCUPIED)
                flags[w.cell] |= SEEN, found[size++] = w.cell;
        } while (!(flag & OPAQUE));
        double turned = dx * c - dy * s;
        dy = dx * s + dy * c, dx = turned;
    }
    for (int64_t i = 0; i < size; i++) flags[found[i]] &= ~SEEN;
    return size;
}
