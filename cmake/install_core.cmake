# The core as a CMake package of its own, omnitag_core, with ROS and without.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# catkin's libraries are always in lib.
set(library_folder ${CMAKE_INSTALL_LIBDIR})
if(OMNITAG_ROS)
  set(library_folder ${CATKIN_PACKAGE_LIB_DESTINATION})
endif()
set(package_folder ${library_folder}/cmake/omnitag_core)

install(TARGETS omnitag_core EXPORT omnitag_core
  LIBRARY DESTINATION ${library_folder} COMPONENT core NAMELINK_COMPONENT core
)
install(DIRECTORY include/omnitag DESTINATION include COMPONENT core)
install(EXPORT omnitag_core NAMESPACE omnitag:: FILE omnitag_core-targets.cmake
  DESTINATION ${package_folder} COMPONENT core
)

write_basic_package_version_file(${PROJECT_BINARY_DIR}/omnitag_core-config-version.cmake
  COMPATIBILITY SameMajorVersion
)
set(package_files
  ${PROJECT_SOURCE_DIR}/cmake/omnitag_core-config.cmake
  ${PROJECT_BINARY_DIR}/omnitag_core-config-version.cmake
)
#catkin_lint: ignore_once missing_file
install(FILES ${package_files} DESTINATION ${package_folder} COMPONENT core)

if(OMNITAG_ROS)
  # Other packages of the workspace find it in the devel space.
  set(devel_folder ${CATKIN_DEVEL_PREFIX}/lib/cmake/omnitag_core)
  export(EXPORT omnitag_core NAMESPACE omnitag:: FILE ${devel_folder}/omnitag_core-targets.cmake)
  file(COPY ${package_files} DESTINATION ${devel_folder})
endif()
