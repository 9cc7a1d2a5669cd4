// Sort and scan by CUB; their temporary memory is the device's scratch, kept from call to call.
#include "device.h"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

cloth_status cloth_cuda_sort(cloth_device *d, int n, int bits, uint64_t *key, uint32_t *value,
                             uint64_t *key_spare, uint32_t *value_spare, cloth_error *err)
{
  if (n <= 1) return CLOTH_OK;
  CUDA_TRY(err, cudaSetDevice(d->index));
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  cub::DoubleBuffer<uint64_t> keys(key, key_spare);
  cub::DoubleBuffer<uint32_t> values(value, value_spare);
  size_t bytes = 0;
  void *scratch = nullptr;
  for (int pass = 0; pass < 2; pass++) { // ask for the size, then sort
    if (value != nullptr)
      CUDA_TRY(err,
               cub::DeviceRadixSort::SortPairs(scratch, bytes, keys, values, n, 0, bits, stream));
    else
      CUDA_TRY(err, cub::DeviceRadixSort::SortKeys(scratch, bytes, keys, n, 0, bits, stream));
    if (pass == 0) CLOTH_TRY(cloth_cuda_scratch(d, bytes ? bytes : 1, &scratch, err));
  }
  size_t count = (size_t)n;
  if (keys.Current() != key)
    CUDA_TRY(err, cudaMemcpyAsync(key, key_spare, sizeof *key * count, cudaMemcpyDeviceToDevice,
                                  stream));
  if (value != nullptr && values.Current() != value)
    CUDA_TRY(err, cudaMemcpyAsync(value, value_spare, sizeof *value * count,
                                  cudaMemcpyDeviceToDevice, stream));
  return CLOTH_OK;
}

cloth_status cloth_cuda_scan(cloth_device *d, int n, uint32_t *array, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  size_t bytes = 0;
  void *scratch = nullptr;
  for (int pass = 0; pass < 2; pass++) { // exclusive over n + 1: the last becomes the total
    CUDA_TRY(err, cub::DeviceScan::ExclusiveSum(scratch, bytes, array, array, n + 1, stream));
    if (pass == 0) CLOTH_TRY(cloth_cuda_scratch(d, bytes ? bytes : 1, &scratch, err));
  }
  return CLOTH_OK;
}
