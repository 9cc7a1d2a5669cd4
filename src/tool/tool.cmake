# The `cloth` command. The target is not called cloth: that is the library.
file(GLOB CLOTH_TOOL_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.c)
add_executable(cloth_command ${CLOTH_TOOL_SOURCES})
cloth_c_target(cloth_command)
target_link_libraries(cloth_command PRIVATE cloth OpenMP::OpenMP_C m)
# _GNU_SOURCE: POSIX files, signals and clocks beside strict C11
target_compile_definitions(cloth_command PRIVATE _GNU_SOURCE CLOTH_VERSION="${PROJECT_VERSION}")
set_target_properties(cloth_command PROPERTIES OUTPUT_NAME cloth RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
# work-precision plots of cloth accuracy
install(PROGRAMS ${CMAKE_CURRENT_LIST_DIR}/plot_accuracy.py DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME cloth_plot_accuracy)
install(TARGETS cloth_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
