# Tests of the cloth command, from outside; with check_meshes where it is built.
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND AND TARGET cloth_command)
  set(CLOTH_CHECK_MESHES)
  if(TARGET check_meshes)
    set(CLOTH_CHECK_MESHES $<TARGET_FILE:check_meshes>)
  endif()
  add_test(NAME tool_command COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_command.py
           $<TARGET_FILE:cloth_command> ${CLOTH_CHECK_MESHES})
endif()
