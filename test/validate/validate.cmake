# The validation of doc/validation.md: `make validate` runs all of it, the tests a short part.
file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.c)
add_executable(cloth_validate ${sources})
cloth_c_target(cloth_validate)
target_include_directories(cloth_validate PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(cloth_validate PRIVATE _GNU_SOURCE
                           CLOTH_MATERIALS="${CMAKE_SOURCE_DIR}/config/materials"
                           CLOTH_SHARED="${CMAKE_SOURCE_DIR}/../shared/data")
target_link_libraries(cloth_validate PRIVATE cloth m)
add_test(NAME validate COMMAND cloth_validate --short)
set_tests_properties(validate PROPERTIES TIMEOUT 300 ENVIRONMENT "OMP_WAIT_POLICY=passive")
