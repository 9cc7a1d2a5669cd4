# Tests of the cloth command, from outside; with check_meshes where it is built.
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND AND TARGET cloth_command)
  set(CLOTH_CHECK_MESHES)
  if(TARGET check_meshes)
    set(CLOTH_CHECK_MESHES $<TARGET_FILE:check_meshes>)
  endif()
  add_test(NAME tool_command COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_command.py
           $<TARGET_FILE:cloth_command> ${CLOTH_CHECK_MESHES})
  add_test(NAME tool_geometry COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_geometry.py
           $<TARGET_FILE:cloth_command> ${CLOTH_CHECK_MESHES})
  add_test(NAME tool_links COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_links.py
           $<TARGET_FILE:cloth_command>)
  add_test(NAME tool_accuracy COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/test_accuracy.py
           $<TARGET_FILE:cloth_command>)
  # the tables of README.md are the code's
  add_test(NAME readme COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/../test_readme.py
           $<TARGET_FILE:cloth_command>)
endif()
