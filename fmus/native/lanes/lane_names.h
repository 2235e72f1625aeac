/* Names of what is compiled once more; a function that is missing here is defined twice for the linker. */
#ifndef AUTOBALANCER_LANE_NAMES_H
#define AUTOBALANCER_LANE_NAMES_H

#if defined(SIDE_BY_SIDE) && defined(WIDE_VECTORS)
#define LANE_NAME(name) wide_##name
#elif defined(SIDE_BY_SIDE)
#define LANE_NAME(name) lane_##name
#elif defined(WIDE_VECTORS)
#define LANE_NAME(name) wide_copy_##name
#else
#define LANE_NAME(name) copy_##name
#endif

#ifdef WIDE_VECTORS
#define copies_expand_simple wide_copies_expand_simple
#define copies_go_through wide_copies_go_through
#define copies_reach_end wide_copies_reach_end
#endif

#define machine_advance_weight LANE_NAME(machine_advance_weight)
#define machine_allocate LANE_NAME(machine_allocate)
#define machine_carried_along LANE_NAME(machine_carried_along)
#define machine_constants LANE_NAME(machine_constants)
#define machine_coupled LANE_NAME(machine_coupled)
#define machine_coupled_shaft LANE_NAME(machine_coupled_shaft)
#define machine_coupled_station LANE_NAME(machine_coupled_station)
#define machine_expand LANE_NAME(machine_expand)
#define machine_factorise LANE_NAME(machine_factorise)
#define machine_factorise_planar LANE_NAME(machine_factorise_planar)
#define machine_push_track LANE_NAME(machine_push_track)
#define machine_reshape LANE_NAME(machine_reshape)
#define machine_results LANE_NAME(machine_results)
#define machine_set_carrier LANE_NAME(machine_set_carrier)
#define machine_shape LANE_NAME(machine_shape)
#define machine_solve LANE_NAME(machine_solve)
#define machine_solve_factors LANE_NAME(machine_solve_factors)
#define machine_start LANE_NAME(machine_start)
#define machine_state LANE_NAME(machine_state)
#define machine_take_pull LANE_NAME(machine_take_pull)
#define machine_take_weight LANE_NAME(machine_take_weight)
#define machine_times_speed LANE_NAME(machine_times_speed)
#define machine_weight_force LANE_NAME(machine_weight_force)
#define series_race_advance LANE_NAME(series_race_advance)
#define series_race_allocate LANE_NAME(series_race_allocate)
#define series_race_blow LANE_NAME(series_race_blow)
#define series_race_finish LANE_NAME(series_race_finish)
#define series_race_inertia LANE_NAME(series_race_inertia)
#define series_race_known LANE_NAME(series_race_known)
#define series_race_push LANE_NAME(series_race_push)
#define series_race_start LANE_NAME(series_race_start)
#define series_race_swept LANE_NAME(series_race_swept)
#define series_race_take LANE_NAME(series_race_take)
#define series_race_torque LANE_NAME(series_race_torque)
#define series_race_turning LANE_NAME(series_race_turning)
#define series_weight_advance LANE_NAME(series_weight_advance)
#define series_weight_finish LANE_NAME(series_weight_finish)
#define series_weight_force LANE_NAME(series_weight_force)
#define series_weight_pulled LANE_NAME(series_weight_pulled)
#define series_weight_start LANE_NAME(series_weight_start)
#define series_weight_take LANE_NAME(series_weight_take)
#define shaft_push LANE_NAME(shaft_push)
#define shaft_take LANE_NAME(shaft_take)

#endif
