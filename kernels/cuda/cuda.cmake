# CUDA, where nvcc is found: every physics kernel is compiled for the GPU in both precisions, so that a
# header that is C only is found today. The backend itself comes later.
# Options: CMAKE_CUDA_ARCHITECTURES (default 75;90), CMAKE_CUDA_COMPILER.
if(CLOTH_SANITIZE) # nvcc's host code is not instrumented
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
  message(STATUS "CUDA: not found, skipped")
  return()
endif()
enable_language(CUDA)
message(STATUS "CUDA: ${CMAKE_CUDA_COMPILER} ${CMAKE_CUDA_COMPILER_VERSION}, architectures ${CMAKE_CUDA_ARCHITECTURES}")

foreach(precision f32 f64)
  add_library(cloth_cuda_physics_${precision} OBJECT ${CMAKE_CURRENT_LIST_DIR}/physics_check.cu)
  target_include_directories(cloth_cuda_physics_${precision} PRIVATE ${CLOTH_INCLUDES})
  set_target_properties(cloth_cuda_physics_${precision} PROPERTIES CUDA_STANDARD 17 CUDA_STANDARD_REQUIRED ON)
endforeach()
target_compile_definitions(cloth_cuda_physics_f32 PRIVATE CLOTH_SINGLE_PRECISION)

add_executable(cloth_cuda_physics_check ${CMAKE_CURRENT_LIST_DIR}/physics_check_main.cpp
               $<TARGET_OBJECTS:cloth_cuda_physics_f32> $<TARGET_OBJECTS:cloth_cuda_physics_f64>)
target_include_directories(cloth_cuda_physics_check PRIVATE ${CLOTH_INCLUDES})
target_include_directories(cloth_cuda_physics_check SYSTEM PRIVATE ${CMAKE_CUDA_TOOLKIT_INCLUDE_DIRECTORIES})
set_target_properties(cloth_cuda_physics_check PROPERTIES LINKER_LANGUAGE CUDA)
