/* Which weights move together, how, and with what force.

   n weights that touch share one rate.  The mean of their forcings (angles 2 alpha apart about the
   middle t) is that of one weight at t times sin(n alpha)/(n sin alpha), so a group moves like one
   weight with a smaller gain.  Which contacts last follows from Gauss's principle of least
   constraint: the accelerations y of a chain are

       min sum m_k ((y_k - g_k)^2/2 + f_k |y_k|),     y_1 <= y_2 <= ... <= y_n,

   with masses m_k, free accelerations g_k and, for weights at rest, limits f_k of rolling
   resistance.  It has one solution, pooling of adjacent violators finds it exactly, and a contact
   between two pools opens. */
#ifndef AUTOBALANCER_GROUPS_H
#define AUTOBALANCER_GROUPS_H

#include "weights/centre.h"
#include "contact/resistance.h"
#include "contact/ring.h"

#define PULL 1e-12 /* of the largest forcing: tension that is rounding */

/* Set `forcings` and `limits`: m g of a run of weights, m f of those at rest. */
void fill_forcings(WeightsInOrder *weights, int first, int size, const Instant *now);

/* Set `groups`: who moves together now; contacts that are pulled open are dropped. */
void find_groups(WeightsInOrder *weights, const Instant *now);

/* Group i as one that slides. */
SlidingGroup sliding_group(const WeightsInOrder *weights, int i);

/* Middle and rate of group i after `step`; on failure the weights' failure is set. */
void move_group(WeightsInOrder *weights, int i, const Instant *now, const Instant *later,
                double step, double *middle, double *rate);

/* Angle acceleration of group i at `middle` and its time derivative [rad/s^2, rad/s^3]. */
void find_group_acceleration(WeightsInOrder *weights, int i, double middle, double angle_rate,
                             const Instant *now, double *accelerations);

/* As weights_unhindered, of weights that touch and stick [rad/s^2, rad/s^3]. */
void ring_turning(WeightsInOrder *weights, const Instant *now, double *turned);

/* As weights_reaction: a group counts as its factor times one weight at its middle. */
void ring_reaction(WeightsInOrder *weights, const Instant *now, Complex *force);

#endif
