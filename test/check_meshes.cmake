# check_meshes: the independent check of written meshes, and its own tests; where CGAL is installed.
find_package(CGAL QUIET)
if(CGAL_FOUND)
  add_library(check_meshes_core STATIC ${CMAKE_CURRENT_LIST_DIR}/check_meshes.cpp)
  target_link_libraries(check_meshes_core PUBLIC CGAL::CGAL)
  target_include_directories(check_meshes_core PUBLIC ${CMAKE_CURRENT_LIST_DIR})
  target_compile_options(check_meshes_core PRIVATE -O2)
  add_executable(check_meshes ${CMAKE_CURRENT_LIST_DIR}/check_meshes_main.cpp)
  target_link_libraries(check_meshes PRIVATE check_meshes_core)

  find_package(GTest QUIET)
  if(GTest_FOUND)
    add_executable(test_check_meshes ${CMAKE_CURRENT_LIST_DIR}/test_check_meshes.cpp)
    target_link_libraries(test_check_meshes PRIVATE check_meshes_core GTest::gtest GTest::gtest_main)
    add_test(NAME check_meshes COMMAND test_check_meshes)

    # the command's own predicates against CGAL's
    add_executable(test_triangle_test ${CMAKE_CURRENT_LIST_DIR}/geometry/test_triangle_test.cpp)
    target_include_directories(test_triangle_test PRIVATE ${CMAKE_CURRENT_LIST_DIR}/../src)
    target_compile_options(test_triangle_test PRIVATE -O1)
    target_link_libraries(test_triangle_test PRIVATE cloth check_meshes_core GTest::gtest GTest::gtest_main)
    target_link_options(test_triangle_test PRIVATE ${CLOTH_SANITIZE_FLAGS}) # as the library it links
    add_test(NAME geometry_triangle_test COMMAND test_triangle_test)

    add_executable(test_tangle ${CMAKE_CURRENT_LIST_DIR}/test_tangle.cpp)
    target_link_libraries(test_tangle PRIVATE cloth check_meshes_core GTest::gtest GTest::gtest_main)
    target_link_options(test_tangle PRIVATE ${CLOTH_SANITIZE_FLAGS})
    add_test(NAME engine_tangle_exact COMMAND test_tangle)
    set_tests_properties(engine_tangle_exact PROPERTIES TIMEOUT 300 ENVIRONMENT "OMP_WAIT_POLICY=passive")
  endif()
else()
  message(STATUS "CGAL not found: no check_meshes (Debian: libcgal-dev)")
endif()
