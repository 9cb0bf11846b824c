# Releases before 3.1.5 write outside of their own memory in images of less than 51,200 pixels, and
# the first ones turn what they read. Not all of them tell their number: 3.2 is the first sure one.
find_package(apriltag 3.2 QUIET)
if(NOT apriltag_FOUND)
  message(FATAL_ERROR "omnitag needs release 3.2 or later of the AprilTag library, with its CMake "
    "package; found: ${apriltag_CONSIDERED_VERSIONS}. Where Debian's is older, as in Debian 11, "
    "scripts/install builds a later one.")
endif()
