# Tests of the running node. Included by test/CMakeLists.txt where ROS is.
set(CLOTH_NODE_TESTS ${CMAKE_CURRENT_LIST_DIR})

# ---- without a master ----
set(CLOTH_WITH_ROS ${PROJECT_SOURCE_DIR}/src/demo/with_ros.sh ${CMAKE_BINARY_DIR} ${PYTHON_EXECUTABLE})
add_test(NAME node_files COMMAND ${CLOTH_WITH_ROS} ${CLOTH_NODE_TESTS}/test_files.py)
set_tests_properties(node_files PROPERTIES TIMEOUT 60)

# ---- rostest: each finds a port of its own for its master ----
find_program(ROSTEST NAMES rostest)
if(NOT ROSTEST)
  return()
endif()
add_library(lose_device MODULE ${CLOTH_NODE_TESTS}/lose_device.c)
target_include_directories(lose_device PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(lose_device PRIVATE ${CMAKE_DL_LIBS})
foreach(name towel lockstep time inputs start lost nodelet)
  # --text: rostest would hide the names of the single tests; its exit code is then no good, the text is
  add_test(NAME node_${name} COMMAND ${CLOTH_NODE_TESTS}/run_rostest.sh ${CMAKE_BINARY_DIR} ${PYTHON_EXECUTABLE}
           ${ROSTEST} ${CLOTH_NODE_TESTS}/${name}.test)
  set_tests_properties(node_${name} PROPERTIES RUN_SERIAL TRUE TIMEOUT 240)
endforeach()

set_tests_properties(node_lost PROPERTIES ENVIRONMENT CLOTH_LOSE_DEVICE=$<TARGET_FILE:lose_device>)

# everything once more from an installed tree
add_test(NAME node_install COMMAND ${CLOTH_NODE_TESTS}/install_space.sh ${CMAKE_BINARY_DIR} ${PYTHON_EXECUTABLE} ${ROSTEST})
set_tests_properties(node_install PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
