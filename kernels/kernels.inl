// Every element kernel, once. CLOTH_KERNEL(name, serial) stands for
//   cloth_name(int i, const cloth_name_args *a)   in kernels/physics/name.h
// serial: a CPU leaves fewer elements than this to one thread, because waking another costs more (a few
// microseconds); it never changes a result.
// Each backend includes this file to build its table; adding a kernel is one header, one line here and
// one include in kernels/physics/all.h. CLOTH_KERNEL_UNEVEN: some elements cost much more than others.
#ifndef CLOTH_KERNEL_UNEVEN
#define CLOTH_KERNEL_UNEVEN(name, serial) CLOTH_KERNEL(name, serial)
#define CLOTH_KERNEL_UNEVEN_DEFAULT
#endif

// motion
CLOTH_KERNEL(body_vertex, 1024)
CLOTH_KERNEL(predict, 2048)
CLOTH_KERNEL(bdf2_start, 2048)
CLOTH_KERNEL(hold, 1024)
CLOTH_KERNEL(hold_jump, 1024)
CLOTH_KERNEL(hold_measure, 1024)
CLOTH_KERNEL(hold_pull, 1024)
CLOTH_KERNEL(fly_chunk, 128)
CLOTH_KERNEL(correct, 64)
CLOTH_KERNEL(motion_chunk, 64)
CLOTH_KERNEL(commit_chunk, 64)
CLOTH_KERNEL(shift_chunk, 64)
CLOTH_KERNEL(balance_chunk, 64)
CLOTH_KERNEL(balance_mean, 64)
CLOTH_KERNEL(balance_shift, 4096)

// effects
CLOTH_KERNEL(membrane, 64)
CLOTH_KERNEL(membrane_stretch, 256)
CLOTH_KERNEL(bend, 128)
CLOTH_KERNEL(bend_quadratic, 128)
CLOTH_KERNEL(bend_shape, 64)
CLOTH_KERNEL(drag, 128)

// pairs
CLOTH_KERNEL(box_chunk, 64)
CLOTH_KERNEL(box_merge, 64)
CLOTH_KERNEL(vertex_box, 1024)
CLOTH_KERNEL(vertex_escape, 1024)
CLOTH_KERNEL(triangle_box, 1024)
CLOTH_KERNEL(flat_triangle, 1024)
CLOTH_KERNEL(flat_tile, 256)
CLOTH_KERNEL(flat_merge, 256)
CLOTH_KERNEL(flat_square, 128)
CLOTH_KERNEL(cell_mark, 512)
CLOTH_KERNEL(chunk_near, 64)
CLOTH_KERNEL(cell_count, 512)
CLOTH_KERNEL(cell_fill, 256)
CLOTH_KERNEL_UNEVEN(entry_work, 1024)
CLOTH_KERNEL_UNEVEN(pair_share, 4)
CLOTH_KERNEL_UNEVEN(pair_large, 8)
CLOTH_KERNEL(tangle_find, 64)

// contacts
CLOTH_KERNEL(watch_stray, 1024)
CLOTH_KERNEL_UNEVEN(watch_find, 256)
CLOTH_KERNEL_UNEVEN(contact_find, 256)
CLOTH_KERNEL(contact_build, 128)
CLOTH_KERNEL(contact_entry, 1024)
CLOTH_KERNEL(contact_place, 4096)
CLOTH_KERNEL(contact_row, 512)
CLOTH_KERNEL(contact_force, 256)
CLOTH_KERNEL(contact_product, 512)
CLOTH_KERNEL(contact_count, 1024)
CLOTH_KERNEL(friction_recall, 256)
CLOTH_KERNEL(friction_check, 512)
CLOTH_KERNEL(friction_keep, 256)
CLOTH_KERNEL_UNEVEN(impact_find, 128)
CLOTH_KERNEL(carrier_start, 2048)
CLOTH_KERNEL_UNEVEN(impact_limit, 128)
CLOTH_KERNEL(impact_hold_back, 2048)
CLOTH_KERNEL(impact_pin, 2048)
CLOTH_KERNEL(zone_build, 64)
CLOTH_KERNEL(zone_mark, 2048)
CLOTH_KERNEL_UNEVEN(zone_solve, 2)

// solve
CLOTH_KERNEL(assemble_row, 32)
CLOTH_KERNEL(halo_contact, 1024)
CLOTH_KERNEL(halo_chunk, 64)
CLOTH_KERNEL(halo_group, 1024)
CLOTH_KERNEL(halo_order, 1024)
CLOTH_KERNEL(coarse_chunk, 4)
CLOTH_KERNEL(coarse_sum, 8)
CLOTH_KERNEL(coarse_factor, 2)
CLOTH_KERNEL(coarse_inverse, 32)
CLOTH_KERNEL(coarse_rest, 256)
CLOTH_KERNEL(coarse_solve, 256)
CLOTH_KERNEL(hat_row, 64)
CLOTH_KERNEL(hat_matrix, 16)
CLOTH_KERNEL(hat_upper, 16)
CLOTH_KERNEL(hat_rest, 8)
CLOTH_KERNEL(hat_rest_upper, 16)
CLOTH_KERNEL(hat_spread, 256)
CLOTH_KERNEL(pcg_start, 64)
CLOTH_KERNEL(pcg_product, 8)
CLOTH_KERNEL(pcg_alpha, 2)
CLOTH_KERNEL(pcg_update, 96)
CLOTH_KERNEL(pcg_beta, 2)
CLOTH_KERNEL(pcg_direction, 256)
CLOTH_KERNEL(pcg_residual, 128)
CLOTH_KERNEL(pcg_finish, 2)
CLOTH_KERNEL(reduce_max, 256)

// mass-spring
CLOTH_KERNEL(bin_key, 2048)
CLOTH_KERNEL(bin_search, 128)
CLOTH_KERNEL(spring_step, 64)
CLOTH_KERNEL(spring_chunk, 64)

#ifdef CLOTH_KERNEL_UNEVEN_DEFAULT
#undef CLOTH_KERNEL_UNEVEN_DEFAULT
#undef CLOTH_KERNEL_UNEVEN
#endif
