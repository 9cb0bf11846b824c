# What those need, too, who use the libraries.
set(exported_packages
  cv_bridge
  diagnostic_updater
  dynamic_reconfigure
  geometry_msgs
  image_transport
  interactive_markers
  nav_msgs
  nodelet
  roscpp
  sensor_msgs
  std_msgs
  std_srvs
  tf2
  tf2_msgs
  tf2_ros
  visualization_msgs
)
find_package(catkin REQUIRED COMPONENTS
  ${exported_packages} message_generation pluginlib rosbag_storage)
if(POLICY CMP0167)
  cmake_policy(SET CMP0167 NEW)  # Boost's own CMake package: CMake has no other for it any more
endif()
find_package(Boost REQUIRED COMPONENTS program_options)

catkin_python_setup()

add_message_files(FILES
  DetectedMarker.msg
  LocalizationStatus.msg
  MapMarker.msg
  MapMarkerArray.msg
  MarkerDetectionArray.msg
)
add_service_files(FILES
  AddMarker.srv
  ChangeMap.srv
  IgnoreMarkers.srv
  RemoveMarker.srv
)
generate_messages(DEPENDENCIES geometry_msgs std_msgs)

# catkin exports what these variables name; yaml-cpp's own configuration sets others.
set(YAML_CPP_FOUND TRUE)
set(YAML_CPP_INCLUDE_DIRS ${YAML_CPP_INCLUDE_DIR})
set(YAML_CPP_LIBRARIES yaml-cpp)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES omnitag_core omnitag_ros
  CATKIN_DEPENDS ${exported_packages} message_runtime
  DEPENDS EIGEN3 OpenCV YAML_CPP
)
