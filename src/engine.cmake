# libcloth, libcloth_f32, libcloth_f64; see CMakeLists.txt.
find_package(OpenMP REQUIRED COMPONENTS C)
find_package(PkgConfig REQUIRED)
pkg_check_modules(YAML REQUIRED IMPORTED_TARGET yaml-0.1)

file(GLOB CLOTH_HOST_SOURCES CONFIGURE_DEPENDS src/*.c src/scene/*.c src/links/*.c src/geometry/*.c)
file(GLOB CLOTH_ENGINE_SOURCES CONFIGURE_DEPENDS src/engine/*.c src/state/*.c src/effect/*.c
     src/contact/*.c src/solve/*.c src/ccd/*.c src/spring/*.c src/transport/*.c kernels/cpu/*.c)
list(REMOVE_ITEM CLOTH_HOST_SOURCES ${CMAKE_CURRENT_SOURCE_DIR}/src/step.c ${CMAKE_CURRENT_SOURCE_DIR}/src/substep.c)
list(APPEND CLOTH_ENGINE_SOURCES src/step.c src/substep.c)
if(NOT CLOTH_CUDA_FOUND)
  list(APPEND CLOTH_ENGINE_SOURCES kernels/cuda/none.c)
endif()
# small host files that the engine calls; hidden inside each engine library
set(CLOTH_SHARED_SOURCES src/status.c src/report.c src/scene/motion.c src/links/links.c)

# the two that are off warn of what cannot happen: lengths and values that a returned status rules out
set(CLOTH_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Wno-format-truncation
    -Wno-maybe-uninitialized -Werror)
# no contraction: the same sums on every compiler, and bit equality with a CUDA build without fused
# multiply-add; no traps or errno, so that loops vectorise
set(CLOTH_C_FLAGS -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CLOTH_NATIVE)
  list(APPEND CLOTH_C_FLAGS -march=native)
endif()
if(CLOTH_SANITIZE)
  set(CLOTH_SANITIZE_FLAGS -fsanitize=${CLOTH_SANITIZE} -fno-omit-frame-pointer -g
      -fno-sanitize-recover=all)
endif()
function(cloth_c_target target)
  target_include_directories(${target} PRIVATE ${CLOTH_INCLUDES})
  target_compile_options(${target} PRIVATE ${CLOTH_WARNINGS} ${CLOTH_C_FLAGS} ${CLOTH_SANITIZE_FLAGS})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL "OBJECT_LIBRARY")
    target_link_options(${target} PRIVATE ${CLOTH_SANITIZE_FLAGS})
  endif()
endfunction()

# the backend's objects and what they need, into a library or program that holds an engine
function(cloth_link_cuda target precision)
  if(CLOTH_CUDA_FOUND)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:cloth_cuda_common> $<TARGET_OBJECTS:cloth_cuda_${precision}>)
    target_link_libraries(${target} PRIVATE ${CLOTH_CUDART} Threads::Threads ${CMAKE_DL_LIBS} rt stdc++)
    target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE C)
  endif()
endfunction()

foreach(precision f32 f64)
  add_library(cloth_engine_${precision} OBJECT ${CLOTH_ENGINE_SOURCES})
  cloth_c_target(cloth_engine_${precision})
  target_link_libraries(cloth_engine_${precision} PRIVATE OpenMP::OpenMP_C)
  set_target_properties(cloth_engine_${precision} PROPERTIES C_VISIBILITY_PRESET hidden)

  add_library(cloth_${precision} SHARED $<TARGET_OBJECTS:cloth_engine_${precision}> ${CLOTH_SHARED_SOURCES})
  cloth_c_target(cloth_${precision})
  set_target_properties(cloth_${precision} PROPERTIES C_VISIBILITY_PRESET hidden)
  target_link_libraries(cloth_${precision} PRIVATE OpenMP::OpenMP_C m)
  cloth_link_cuda(cloth_${precision} ${precision})
endforeach()
target_compile_definitions(cloth_engine_f32 PRIVATE CLOTH_SINGLE_PRECISION)

# config/presets/*.yaml as a table, {"NAME", "TEXT"},
set(CLOTH_PRESETS "")
file(GLOB presets CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/config/presets/*.yaml)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${presets})
foreach(preset ${presets})
  get_filename_component(name ${preset} NAME_WE)
  file(READ ${preset} text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  string(REPLACE "\n" "\\n" text "${text}")
  string(APPEND CLOTH_PRESETS "{\"${name}\", \"${text}\"},\n")
endforeach()
file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/generated/presets.inl CONTENT "${CLOTH_PRESETS}")

add_library(cloth SHARED ${CLOTH_HOST_SOURCES})
target_include_directories(cloth PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
cloth_c_target(cloth)
target_link_libraries(cloth PRIVATE cloth_f32 cloth_f64 PkgConfig::YAML OpenMP::OpenMP_C m ${CMAKE_DL_LIBS})
target_include_directories(cloth INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/src>
                           $<INSTALL_INTERFACE:include>)
