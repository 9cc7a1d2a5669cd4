// Every element kernel, once. CLOTH_KERNEL(name) stands for
//   cloth_name(int i, const cloth_name_args *a)   in kernels/physics/name.h
// Each backend includes this file to build its table; adding a kernel is one header and one line here
// and one include in kernels/physics/all.h.
CLOTH_KERNEL(membrane)
CLOTH_KERNEL(bend)
CLOTH_KERNEL(drag)
