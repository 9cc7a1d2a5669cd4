# The stability catalogue's handful and some random scenes; `make stability` runs all. Left out under a sanitizer: the
# engine's own tests run there.
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND AND TARGET cloth_command AND NOT CLOTH_SANITIZE)
  add_test(NAME stability COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/run.py $<TARGET_FILE:cloth_command>
           --quick --seeds 30)
  set_tests_properties(stability PROPERTIES TIMEOUT 600 ENVIRONMENT
                       "OMP_WAIT_POLICY=passive;OMP_NUM_THREADS=1;PYTHONDONTWRITEBYTECODE=1")
endif()
