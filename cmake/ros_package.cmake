find_package(catkin REQUIRED COMPONENTS
  cv_bridge
  diagnostic_updater
  dynamic_reconfigure
  geometry_msgs
  image_transport
  interactive_markers
  message_generation
  nav_msgs
  nodelet
  pluginlib
  rosbag_storage
  roscpp
  sensor_msgs
  std_msgs
  std_srvs
  tf2
  tf2_msgs
  tf2_ros
  visualization_msgs
)
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

# The messages alone, so that who exchanges them needs none of the libraries. The core has a CMake
# package of its own, omnitag_core; the ROS layer's headers are for the nodelet and the tools.
catkin_package(CATKIN_DEPENDS geometry_msgs message_runtime std_msgs)
