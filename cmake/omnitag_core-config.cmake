# What the public headers include. The core's other libraries are found by itself when it is loaded.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
find_dependency(OpenCV COMPONENTS core)

# Where one workspace builds both, the target is there already.
if(NOT TARGET omnitag::core)
  include("${CMAKE_CURRENT_LIST_DIR}/omnitag_core-targets.cmake")
endif()
