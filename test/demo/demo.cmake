# Tests of the demo. Included by test/CMakeLists.txt.
if(CLOTH_SANITIZE) # nothing here is instrumented
  return()
endif()
set(CLOTH_DEMO_TESTS ${CMAKE_CURRENT_LIST_DIR})
set(CLOTH_TEST_PYTHON /usr/bin/python3)
if(Python3_EXECUTABLE)
  set(CLOTH_TEST_PYTHON ${Python3_EXECUTABLE})
endif()
execute_process(COMMAND ${CLOTH_TEST_PYTHON} -c "import yaml" RESULT_VARIABLE missing OUTPUT_QUIET ERROR_QUIET)
if(NOT missing EQUAL 0)
  message(STATUS "robot_cloth: no python3-yaml, the demo's unit tests are left out")
  return()
endif()

foreach(name arm fold_path shapes run_tests)
  add_test(NAME demo_${name} COMMAND ${CLOTH_TEST_PYTHON} ${CLOTH_DEMO_TESTS}/${name}_test.py)
endforeach()

find_program(CHECK_URDF check_urdf)
if(CHECK_URDF)
  add_test(NAME demo_check_urdf COMMAND ${CHECK_URDF} ${PROJECT_SOURCE_DIR}/config/robots/two_arm/two_arm.urdf)
endif()

# under a master: frames, the fold step by step with every mesh checked, the launch file in real time
find_program(ROSTEST NAMES rostest)
if(CLOTH_ROS_FOUND AND ROSTEST)
  foreach(name frames fold)
    add_test(NAME demo_${name}
             COMMAND ${CLOTH_DEMO_TESTS}/../node/run_rostest.sh ${CMAKE_BINARY_DIR} ${CLOTH_TEST_PYTHON}
                     ${ROSTEST} ${CLOTH_DEMO_TESTS}/${name}.test)
    set_tests_properties(demo_${name} PROPERTIES RUN_SERIAL TRUE TIMEOUT 900
                         ENVIRONMENT "CLOTH_CHECK_MESHES=$<$<TARGET_EXISTS:check_meshes>:$<TARGET_FILE:check_meshes>>")
  endforeach()
endif()
