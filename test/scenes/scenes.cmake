# The hard scenes, each run at its small size from outside and judged by checks that are not the engine's.
# table.py says what each must keep to. Left out under a sanitizer: the engine's own tests run there.
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND AND TARGET cloth_command AND NOT CLOTH_SANITIZE)
  set(CLOTH_SCENE_CHECK)
  if(TARGET check_meshes)
    set(CLOTH_SCENE_CHECK --check $<TARGET_FILE:check_meshes>)
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/table.py)
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import table; print(';'.join(table.SCENES), end='')"
                  WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR} OUTPUT_VARIABLE CLOTH_SCENES)
  foreach(scene ${CLOTH_SCENES})
    add_test(NAME scene_${scene} COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/run_scene.py
             $<TARGET_FILE:cloth_command> ${scene} ${CLOTH_SCENE_CHECK})
    set_tests_properties(scene_${scene} PROPERTIES TIMEOUT 600 ENVIRONMENT
                         "OMP_WAIT_POLICY=passive;OMP_NUM_THREADS=1;PYTHONDONTWRITEBYTECODE=1")
  endforeach()
endif()
