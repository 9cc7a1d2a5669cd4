# The ROS side: messages, services, the node, the nodelet, their installation. Included by the top
# CMakeLists.txt; without ROS it says so and leaves the engine alone.

# catkin runs generators with PYTHON_EXECUTABLE, ament and newer modules with Python3_EXECUTABLE. The
# first python on PATH may be a pyenv's or conda's that knows neither catkin_pkg nor empy: take one
# that does. A choice of the user (or of catkin_make) stays if it works.
function(cloth_python_for_ros out)
  find_program(CLOTH_PYTHON_ON_PATH NAMES python3)
  foreach(python ${PYTHON_EXECUTABLE} ${Python3_EXECUTABLE} /usr/bin/python3 ${CLOTH_PYTHON_ON_PATH})
    execute_process(COMMAND ${python} -c "import catkin_pkg, em" RESULT_VARIABLE missing
                    OUTPUT_QUIET ERROR_QUIET)
    if(missing EQUAL 0)
      set(${out} ${python} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${out} "" PARENT_SCOPE)
endfunction()

set(CLOTH_ROS_FOUND FALSE)
cloth_python_for_ros(CLOTH_PYTHON)
if(CLOTH_PYTHON)
  set(PYTHON_EXECUTABLE ${CLOTH_PYTHON} CACHE FILEPATH "python with catkin_pkg and empy" FORCE)
  set(Python3_EXECUTABLE ${CLOTH_PYTHON} CACHE FILEPATH "python with catkin_pkg and empy" FORCE)
  set(CLOTH_ROS_MESSAGES std_msgs geometry_msgs sensor_msgs shape_msgs)
  find_package(catkin QUIET COMPONENTS message_generation roscpp roslib nodelet pluginlib tf2 tf2_ros
               urdf resource_retriever visualization_msgs diagnostic_msgs rosgraph_msgs std_srvs
               ${CLOTH_ROS_MESSAGES})
  find_package(Eigen3 QUIET)
  find_package(fcl QUIET)
  find_package(assimp QUIET)
  pkg_check_modules(TINYXML2 QUIET IMPORTED_TARGET tinyxml2)
  if(catkin_FOUND AND Eigen3_FOUND AND fcl_FOUND AND assimp_FOUND AND TINYXML2_FOUND)
    set(CLOTH_ROS_FOUND TRUE)
  endif()
endif()
if(NOT CLOTH_ROS_FOUND)
  message(STATUS "robot_cloth: no ROS node (python for catkin: '${CLOTH_PYTHON}', "
                 "catkin: '${catkin_FOUND}', fcl: '${fcl_FOUND}', assimp: '${assimp_FOUND}')")
  return()
endif()

# ---- messages and services ----
add_message_files(DIRECTORY msg FILES
  ClothMesh.msg ContactPoint.msg Contacts.msg CrossCheck.msg Event.msg GraspCommand.msg
  GraspState.msg Grasps.msg State.msg Topology.msg VertexGroup.msg)
add_service_files(DIRECTORY srv FILES
  GetInfo.srv GetState.srv Grasp.srv LoadState.srv Release.srv RunCrossCheck.srv SaveState.srv
  SetObstacle.srv SetState.srv Step.srv)
generate_messages(DEPENDENCIES ${CLOTH_ROS_MESSAGES})

# <robot_cloth/cloth.h> in the devel space, too
foreach(header ${CLOTH_PUBLIC_HEADERS})
  configure_file(src/${header} ${CATKIN_DEVEL_PREFIX}/include/robot_cloth/${header} COPYONLY)
endforeach()

# catkin redirects the output of every later target to the devel space; tests and tools stay where they were
foreach(kind RUNTIME LIBRARY ARCHIVE)
  set(CLOTH_KEEP_${kind} ${CMAKE_${kind}_OUTPUT_DIRECTORY})
endforeach()
catkin_package(INCLUDE_DIRS ${CATKIN_DEVEL_PREFIX}/include LIBRARIES cloth robot_cloth_node
               CATKIN_DEPENDS message_runtime roscpp tf2_ros ${CLOTH_ROS_MESSAGES})
set(CLOTH_DEVEL_LIB ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_LIB_DESTINATION})
set(CLOTH_DEVEL_BIN ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
foreach(kind RUNTIME LIBRARY ARCHIVE)
  set(CMAKE_${kind}_OUTPUT_DIRECTORY ${CLOTH_KEEP_${kind}})
endforeach()

# ---- node ----
file(GLOB CLOTH_NODE_SOURCES CONFIGURE_DEPENDS src/node/*.cpp)
list(FILTER CLOTH_NODE_SOURCES EXCLUDE REGEX "/(main|nodelet)\\.cpp$")
add_library(robot_cloth_node SHARED ${CLOTH_NODE_SOURCES})
target_include_directories(robot_cloth_node PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/src/node ${CMAKE_CURRENT_SOURCE_DIR}/src)
# SYSTEM: warnings are for our headers
target_include_directories(robot_cloth_node SYSTEM PUBLIC ${CATKIN_DEVEL_PREFIX}/include ${catkin_INCLUDE_DIRS}
                           ${ASSIMP_INCLUDE_DIRS})
target_link_libraries(robot_cloth_node PUBLIC cloth ${catkin_LIBRARIES} Eigen3::Eigen
                      PRIVATE assimp::assimp fcl PkgConfig::TINYXML2)
add_dependencies(robot_cloth_node ${PROJECT_NAME}_generate_messages_cpp)
add_executable(robot_cloth_exe src/node/main.cpp)
target_link_libraries(robot_cloth_exe PRIVATE robot_cloth_node)
add_library(robot_cloth_nodelet MODULE src/node/nodelet.cpp)
target_link_libraries(robot_cloth_nodelet PRIVATE robot_cloth_node)
foreach(target robot_cloth_node robot_cloth_exe robot_cloth_nodelet)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Werror)
endforeach()
set_target_properties(robot_cloth_node robot_cloth_nodelet PROPERTIES
                      LIBRARY_OUTPUT_DIRECTORY ${CLOTH_DEVEL_LIB} INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
set_target_properties(robot_cloth_exe PROPERTIES OUTPUT_NAME cloth_node
                      RUNTIME_OUTPUT_DIRECTORY ${CLOTH_DEVEL_BIN} INSTALL_RPATH "$ORIGIN/..;$ORIGIN/../../${CMAKE_INSTALL_LIBDIR}")

# ---- install ----
install(TARGETS robot_cloth_node robot_cloth_nodelet LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
install(TARGETS robot_cloth_exe RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
# the rostests, to run them from the install space: rostest robot_cloth lockstep.test
install(DIRECTORY test/node test/demo DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/test USE_SOURCE_PERMISSIONS
        FILES_MATCHING PATTERN "*.test" PATTERN "*.py" PATTERN "data/*")
