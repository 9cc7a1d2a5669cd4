// Launching element kernels. Private to kernels/cuda; compiled once for each precision.
#pragma once

#include "all.h"
#include "device.h"

/// Start a kernel for n elements on COMPUTE.
typedef cudaError_t cloth_cuda_launcher(cloth_device *d, int n, const void *args,
                                        cudaStream_t stream);

/// How a kernel of kernels.inl is started where a thread for each element would be slow: NULL where
/// it is not. Same arguments, same bits.
cloth_cuda_launcher *cloth_cuda_block_launcher(cloth_kernel k);

cloth_cuda_launcher cloth_cuda_assemble, cloth_cuda_membrane, cloth_cuda_bend,
    cloth_cuda_bend_shape, cloth_cuda_hat_row, cloth_cuda_pair_share, cloth_cuda_pair_large,
    cloth_cuda_zone_solve;
