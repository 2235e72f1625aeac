/* Names of what is compiled twice; a function that is missing here is defined twice for the linker. */
#ifndef AUTOBALANCER_LANE_NAMES_H
#define AUTOBALANCER_LANE_NAMES_H

#define SIDE_BY_SIDE

#define machine_allocate lane_machine_allocate
#define machine_constants lane_machine_constants
#define machine_coupled lane_machine_coupled
#define machine_expand lane_machine_expand
#define machine_reshape lane_machine_reshape
#define machine_results lane_machine_results
#define machine_set_carrier lane_machine_set_carrier
#define machine_shape lane_machine_shape
#define machine_solve lane_machine_solve
#define machine_start lane_machine_start
#define machine_state lane_machine_state
#define machine_take_pull lane_machine_take_pull
#define machine_take_weight lane_machine_take_weight
#define machine_times_speed lane_machine_times_speed
#define series_weight_advance lane_series_weight_advance
#define series_weight_finish lane_series_weight_finish
#define series_weight_force lane_series_weight_force
#define series_weight_start lane_series_weight_start
#define shaft_push lane_shaft_push
#define shaft_take lane_shaft_take

#endif
