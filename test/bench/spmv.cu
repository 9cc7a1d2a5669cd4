// How fast can q = A x be? Block rows like those of a cloth (13 blocks of 3x3 floats a row) in the
// engine's layout with 8 and with 32 rows in a group, beside cuSPARSE's BSR, against the bandwidth
// of a copy measured in the same run. Prints a CSV table; every result is checked against a loop in
// double on the host.
//
//   spmv [ROWS]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cuda_runtime.h>
#include <cusparse.h>
#include <vector>

namespace {

enum { WIDTH = 13, REPEATS = 60 };

#define CHECK(call)                                                                                \
  do {                                                                                             \
    if ((int)(call) != 0) {                                                                        \
      std::printf("%s failed: %d\n", #call, (int)(call));                                          \
      std::exit(1);                                                                                \
    }                                                                                              \
  } while (0)

template <int Group, int Unroll>
__global__ void __launch_bounds__(64)
    rows_kernel(int n, const int *first, const int *col, const float *val, const float *x, float *q)
{
  int row = (int)(blockIdx.x * blockDim.x + threadIdx.x);
  if (row >= n) return;
  int group = row / Group, lane = row % Group;
  float y0 = 0, y1 = 0, y2 = 0;
#pragma unroll Unroll
  for (int s = first[group]; s < first[group + 1]; s++) {
    const float *from = x + 3 * col[(size_t)s * Group + lane];
    const float *a = val + (size_t)s * 9 * Group + lane;
    float x0 = from[0], x1 = from[1], x2 = from[2];
    y0 += a[0] * x0 + a[Group] * x1 + a[2 * Group] * x2;
    y1 += a[3 * Group] * x0 + a[4 * Group] * x1 + a[5 * Group] * x2;
    y2 += a[6 * Group] * x0 + a[7 * Group] * x1 + a[8 * Group] * x2;
  }
  q[3 * row] = y0, q[3 * row + 1] = y1, q[3 * row + 2] = y2;
}

struct matrix { // on the host, row by row
  int n;
  std::vector<int> col;
  std::vector<float> val, x;
};

// a grid's neighbours: six around, six beyond the edges
matrix make(int n)
{
  matrix m = {n, std::vector<int>((size_t)n * WIDTH), std::vector<float>((size_t)n * WIDTH * 9),
              std::vector<float>((size_t)n * 3)};
  int w = (int)std::sqrt((double)n);
  int offset[WIDTH] = {0, 1, -1, w, -w, w + 1, -w - 1, 2, -2, 2 * w, -2 * w, w + 2, -w - 2};
  unsigned seed = 1;
  auto roll = [&] {
    return (float)((seed = seed * 1664525u + 1013904223u) >> 8) / (1 << 24) - 0.5f;
  };
  for (int i = 0; i < n; i++)
    for (int s = 0; s < WIDTH; s++)
      m.col[(size_t)i * WIDTH + s] = std::clamp(i + offset[s], 0, n - 1);
  for (float &v : m.val) v = roll();
  for (float &v : m.x) v = roll();
  return m;
}

template <typename T> T *upload(const std::vector<T> &v)
{
  T *d;
  CHECK(cudaMalloc(&d, sizeof(T) * v.size()));
  CHECK(cudaMemcpy(d, v.data(), sizeof(T) * v.size(), cudaMemcpyHostToDevice));
  return d;
}

template <typename Call> double median_us(Call call)
{
  cudaEvent_t a, b;
  CHECK(cudaEventCreate(&a));
  CHECK(cudaEventCreate(&b));
  std::vector<float> us;
  for (int i = 0; i < REPEATS; i++) {
    CHECK(cudaEventRecord(a));
    call();
    CHECK(cudaEventRecord(b));
    CHECK(cudaEventSynchronize(b));
    float ms;
    CHECK(cudaEventElapsedTime(&ms, a, b));
    if (i >= 10) us.push_back(1e3f * ms);
  }
  CHECK(cudaGetLastError());
  std::sort(us.begin(), us.end());
  return us[us.size() / 2];
}

double worst_error(const matrix &m, const float *q)
{
  std::vector<float> got((size_t)m.n * 3);
  CHECK(cudaMemcpy(got.data(), q, sizeof(float) * got.size(), cudaMemcpyDeviceToHost));
  double worst = 0;
  for (int i = 0; i < m.n; i += 997)
    for (int r = 0; r < 3; r++) {
      double sum = 0;
      for (int s = 0; s < WIDTH; s++)
        for (int c = 0; c < 3; c++)
          sum += (double)m.val[((size_t)i * WIDTH + s) * 9 + 3 * r + c] *
                 m.x[3 * (size_t)m.col[(size_t)i * WIDTH + s] + c];
      worst = std::max(worst, std::fabs(sum - got[3 * (size_t)i + r]));
    }
  return worst;
}

double bytes_of(int n) { return (double)n * WIDTH * (9 * 4 + 4) + (double)n * 2 * 12; }

void print(const char *name, int n, double us, double copy, double error)
{
  double rate = bytes_of(n) / us * 1e-6;
  std::printf("%s,%d,%.1f,%.3f,%.1f,%.2g\n", name, n, us, rate, 100 * rate / copy, error);
}

template <int Group> void ours(const matrix &m, double copy)
{
  int groups = (m.n + Group - 1) / Group;
  std::vector<int> first(groups + 1), col((size_t)groups * Group * WIDTH);
  std::vector<float> val((size_t)groups * Group * WIDTH * 9);
  for (int g = 0; g <= groups; g++) first[g] = g * WIDTH;
  for (int i = 0; i < m.n; i++)
    for (int s = 0; s < WIDTH; s++) {
      size_t slot = (size_t)(i / Group) * WIDTH + s;
      col[slot * Group + i % Group] = m.col[(size_t)i * WIDTH + s];
      for (int e = 0; e < 9; e++)
        val[(slot * 9 + e) * Group + i % Group] = m.val[((size_t)i * WIDTH + s) * 9 + e];
    }
  int *dfirst = upload(first), *dcol = upload(col);
  float *dval = upload(val), *dx = upload(m.x), *dq = upload(std::vector<float>(m.x.size(), NAN));
  char name[64];
  auto run = [&](auto kernel, int unroll) {
    double us =
        median_us([&] { kernel<<<(m.n + 63) / 64, 64>>>(m.n, dfirst, dcol, dval, dx, dq); });
    std::snprintf(name, sizeof name, "groups of %d rows unrolled %d", Group, unroll);
    print(name, m.n, us, copy, worst_error(m, dq));
  };
  run(rows_kernel<Group, 1>, 1);
  run(rows_kernel<Group, 2>, 2);
  run(rows_kernel<Group, 4>, 4);
  for (void *p : {(void *)dfirst, (void *)dcol, (void *)dval, (void *)dx, (void *)dq})
    CHECK(cudaFree(p));
}

void bsr(const matrix &m, double copy)
{
  std::vector<int> first(m.n + 1);
  for (int i = 0; i <= m.n; i++) first[i] = i * WIDTH;
  int *dfirst = upload(first), *dcol = upload(m.col);
  float *dval = upload(m.val), *dx = upload(m.x), *dq = upload(std::vector<float>(m.x.size(), NAN));
  cusparseHandle_t handle;
  cusparseConstSpMatDescr_t a;
  cusparseConstDnVecDescr_t x;
  cusparseDnVecDescr_t q;
  float one = 1, zero = 0;
  size_t bytes = 0;
  void *work = nullptr;
  CHECK(cusparseCreate(&handle));
  CHECK(cusparseCreateConstBsr(&a, m.n, m.n, (int64_t)m.n * WIDTH, 3, 3, dfirst, dcol, dval,
                               CUSPARSE_INDEX_32I, CUSPARSE_INDEX_32I, CUSPARSE_INDEX_BASE_ZERO,
                               CUDA_R_32F, CUSPARSE_ORDER_ROW));
  CHECK(cusparseCreateConstDnVec(&x, 3 * (int64_t)m.n, dx, CUDA_R_32F));
  CHECK(cusparseCreateDnVec(&q, 3 * (int64_t)m.n, dq, CUDA_R_32F));
  cusparseStatus_t s =
      cusparseSpMV_bufferSize(handle, CUSPARSE_OPERATION_NON_TRANSPOSE, &one, a, x, &zero, q,
                              CUDA_R_32F, CUSPARSE_SPMV_ALG_DEFAULT, &bytes);
  if (s != CUSPARSE_STATUS_SUCCESS) {
    std::printf("cuSPARSE BSR,%d,refused: %s\n", m.n, cusparseGetErrorString(s));
    return;
  }
  CHECK(cudaMalloc(&work, bytes + 1));
  double us = median_us([&] {
    CHECK(cusparseSpMV(handle, CUSPARSE_OPERATION_NON_TRANSPOSE, &one, a, x, &zero, q, CUDA_R_32F,
                       CUSPARSE_SPMV_ALG_DEFAULT, work));
  });
  print("cuSPARSE BSR", m.n, us, copy, worst_error(m, dq));
  for (void *p : {(void *)dfirst, (void *)dcol, (void *)dval, (void *)dx, (void *)dq, work})
    CHECK(cudaFree(p));
}

double copy_rate()
{
  size_t bytes = (size_t)1 << 29;
  void *a, *b;
  CHECK(cudaMalloc(&a, bytes));
  CHECK(cudaMalloc(&b, bytes));
  CHECK(cudaMemset(a, 1, bytes));
  double us = median_us([&] { CHECK(cudaMemcpyAsync(b, a, bytes, cudaMemcpyDeviceToDevice)); });
  CHECK(cudaFree(a));
  CHECK(cudaFree(b));
  return 2 * (double)bytes / us * 1e-6;
}

} // namespace

int main(int argc, char **argv)
{
  int n = argc > 1 ? std::atoi(argv[1]) : 500000, devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::printf("no CUDA device\n");
    return 0;
  }
  double copy = copy_rate();
  std::printf("what,rows,us,TB/s,percent of copy,worst error\ncopy,,,%.3f,100,\n", copy);
  matrix m = make(n);
  ours<8>(m, copy);
  ours<32>(m, copy);
  bsr(m, copy);
  return 0;
}
