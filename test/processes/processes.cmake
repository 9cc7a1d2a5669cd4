# One process per part, started by mpirun; without MPI the cases say that they are skipped.
if(Python3_FOUND AND TARGET cloth_command)
  set(CLOTH_MPIRUN)
  if(CLOTH_MPI_FOUND)
    set(CLOTH_MPIRUN ${MPIEXEC_EXECUTABLE})
  endif()
  add_test(NAME tool_processes COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_processes.py
           $<TARGET_FILE:cloth_command> ${CLOTH_MPIRUN})
  set_tests_properties(tool_processes PROPERTIES TIMEOUT 900)
  if(CLOTH_SANITIZE)
    set_tests_properties(tool_processes PROPERTIES ENVIRONMENT "CLOTH_TEST_SHORT=1")
  endif()
endif()
