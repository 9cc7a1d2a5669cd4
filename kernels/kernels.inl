// Every element kernel, once. CLOTH_KERNEL(name) stands for
//   cloth_name(int i, const cloth_name_args *a)   in kernels/physics/name.h
// Each backend includes this file to build its table; adding a kernel is one header, one line here and
// one include in kernels/physics/all.h.

// motion
CLOTH_KERNEL(body_vertex)
CLOTH_KERNEL(predict)
CLOTH_KERNEL(hold)
CLOTH_KERNEL(correct)
CLOTH_KERNEL(commit_chunk)

// effects
CLOTH_KERNEL(membrane)
CLOTH_KERNEL(membrane_stretch)
CLOTH_KERNEL(bend)
CLOTH_KERNEL(drag)

// pairs
CLOTH_KERNEL(box_chunk)
CLOTH_KERNEL(vertex_box)
CLOTH_KERNEL(vertex_escape)
CLOTH_KERNEL(triangle_box)
CLOTH_KERNEL(cell_count)
CLOTH_KERNEL(cell_fill)
CLOTH_KERNEL(entry_work)
CLOTH_KERNEL(pair_share)
CLOTH_KERNEL(pair_large)

// contacts
CLOTH_KERNEL(contact_find)
CLOTH_KERNEL(contact_build)
CLOTH_KERNEL(contact_entry)
CLOTH_KERNEL(contact_row)
CLOTH_KERNEL(contact_force)
CLOTH_KERNEL(contact_product)
CLOTH_KERNEL(contact_count)
CLOTH_KERNEL(impact_find)
CLOTH_KERNEL(impact_hold_back)

// solve
CLOTH_KERNEL(assemble_row)
CLOTH_KERNEL(coarse_chunk)
CLOTH_KERNEL(coarse_factor)
CLOTH_KERNEL(coarse_solve)
CLOTH_KERNEL(pcg_start)
CLOTH_KERNEL(pcg_product)
CLOTH_KERNEL(pcg_alpha)
CLOTH_KERNEL(pcg_update)
CLOTH_KERNEL(pcg_beta)
CLOTH_KERNEL(pcg_direction)
CLOTH_KERNEL(pcg_residual)
CLOTH_KERNEL(reduce_max)
