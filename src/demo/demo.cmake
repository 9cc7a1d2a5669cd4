# The demo: its scripts beside the node's programs, its robot, scenes and launch file in the share folder.
# Included by the top CMakeLists.txt after node.cmake; needs catkin.
set(CLOTH_DEMO ${CMAKE_CURRENT_LIST_DIR})
catkin_install_python(PROGRAMS ${CLOTH_DEMO}/fold_motion.py ${CLOTH_DEMO}/fold_steps.py
                      DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES ${CLOTH_DEMO}/arm.py ${CLOTH_DEMO}/fold_path.py ${CLOTH_DEMO}/shapes.py
        DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(FILES ${PROJECT_SOURCE_DIR}/launch/fold.launch DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/launch)
