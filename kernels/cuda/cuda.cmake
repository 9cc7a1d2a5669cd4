# The CUDA backend, where nvcc is found: one object library for both precisions (memory, sort) and one
# for each (kernels), linked into libcloth_f32 and libcloth_f64 and hidden there. Without nvcc none.c
# says that there is none.
# Options: CMAKE_CUDA_ARCHITECTURES (default 75 and 90, code and PTX of each: what lies between is compiled by
# the driver when it first starts), CMAKE_CUDA_COMPILER.
set(CLOTH_CUDA_FOUND FALSE)
if(NOT CLOTH_CUDA OR CLOTH_SANITIZE) # nvcc's host code is not instrumented
  return()
endif()
if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  find_program(CLOTH_NVCC nvcc HINTS $ENV{CUDA_HOME} $ENV{CUDA_PATH} /usr/local/cuda PATH_SUFFIXES bin)
  if(CLOTH_NVCC)
    set(ENV{CUDACXX} ${CLOTH_NVCC}) # check_language() tries it; one that does not work is skipped
  endif()
endif()
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES 75 90)
endif()
include(CheckLanguage)
check_language(CUDA)
if(NOT CMAKE_CUDA_COMPILER)
  cloth_not_found(CLOTH_CUDA "working nvcc was found")
  return()
endif()
enable_language(CUDA)
message(STATUS "CUDA: ${CMAKE_CUDA_COMPILER} ${CMAKE_CUDA_COMPILER_VERSION}, architectures ${CMAKE_CUDA_ARCHITECTURES}")
set(CLOTH_CUDA_FOUND TRUE)
find_package(Threads REQUIRED)
find_library(CLOTH_CUDART cudart_static HINTS ${CMAKE_CUDA_IMPLICIT_LINK_DIRECTORIES} REQUIRED)

# no fused multiply-add: the bits of the CPU
function(cloth_cuda_library target)
  add_library(${target} OBJECT ${ARGN})
  target_include_directories(${target} PRIVATE ${CLOTH_INCLUDES} ${CMAKE_CURRENT_SOURCE_DIR}/kernels/cuda)
  target_compile_options(${target} PRIVATE --fmad=false -Xcompiler=-ffp-contract=off)
  set_target_properties(${target} PROPERTIES CUDA_STANDARD 17 CUDA_STANDARD_REQUIRED ON
                        CUDA_VISIBILITY_PRESET hidden POSITION_INDEPENDENT_CODE ON)
endfunction()

set(CLOTH_CUDA_DIR ${CMAKE_CURRENT_LIST_DIR})
cloth_cuda_library(cloth_cuda_common ${CLOTH_CUDA_DIR}/device.cu ${CLOTH_CUDA_DIR}/range.cu
                   ${CLOTH_CUDA_DIR}/sort_scan.cu)
foreach(precision f32 f64)
  cloth_cuda_library(cloth_cuda_${precision} ${CLOTH_CUDA_DIR}/launch.cu ${CLOTH_CUDA_DIR}/blocks.cu
                     ${CLOTH_CUDA_DIR}/assemble.cu ${CLOTH_CUDA_DIR}/elements.cu ${CLOTH_CUDA_DIR}/pairs.cu
                     ${CLOTH_CUDA_DIR}/solve.cu ${CLOTH_CUDA_DIR}/solve_small.cu
                     ${CLOTH_CUDA_DIR}/solve_parts.cu ${CLOTH_CUDA_DIR}/spring.cu
                     ${CLOTH_CUDA_DIR}/zones.cu)
endforeach()
target_compile_definitions(cloth_cuda_f32 PRIVATE CLOTH_SINGLE_PRECISION)
