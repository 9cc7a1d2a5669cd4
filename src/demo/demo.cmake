# The demo's scripts, beside the node's programs. (config/ and launch/ are installed with the node.)
# Included by the top CMakeLists.txt after node.cmake; needs catkin.
set(CLOTH_DEMO ${CMAKE_CURRENT_LIST_DIR})
catkin_install_python(PROGRAMS ${CLOTH_DEMO}/fold_motion.py ${CLOTH_DEMO}/fold_steps.py
                      DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES ${CLOTH_DEMO}/arm.py ${CLOTH_DEMO}/fold_path.py ${CLOTH_DEMO}/shapes.py
        DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
