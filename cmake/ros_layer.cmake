# Where messages meet the core; nodelet, node and tools stand on it.
add_library(omnitag_ros SHARED
  src/ros/camera_info.cpp
  src/ros/conversions.cpp
  src/ros/debug_image.cpp
  src/ros/debug_image_layout.cpp
  src/ros/debug_images.cpp
  src/ros/frame_assembler.cpp
  src/ros/frame_markers.cpp
  src/ros/health_monitor.cpp
  src/ros/image_conversion.cpp
  src/ros/image_input.cpp
  src/ros/image_localizer.cpp
  src/ros/live_tuning.cpp
  src/ros/localizer_requests.cpp
  src/ros/localizer_server.cpp
  src/ros/localizer_settings.cpp
  src/ros/localizer_starter.cpp
  src/ros/map_markers.cpp
  src/ros/map_publisher.cpp
  src/ros/map_services.cpp
  src/ros/marker_dragging.cpp
  src/ros/parameters.cpp
  src/ros/parent_watch.cpp
  src/ros/path_recorder.cpp
  src/ros/pose_keeper.cpp
  src/ros/result_messages.cpp
  src/ros/rviz_marker.cpp
  src/ros/stamp_timeline.cpp
  src/ros/transform_input.cpp
  src/ros/xmlrpc_yaml.cpp
)
add_dependencies(omnitag_ros ${PROJECT_NAME}_generate_messages_cpp ${catkin_EXPORTED_TARGETS})
target_include_directories(omnitag_ros SYSTEM PUBLIC
  ${CATKIN_DEVEL_PREFIX}/include ${catkin_INCLUDE_DIRS})
target_link_libraries(omnitag_ros
  PUBLIC omnitag_internal ${catkin_LIBRARIES}
  PRIVATE opencv_imgcodecs
)

add_library(omnitag_nodelet SHARED src/ros/localizer_nodelet.cpp)
target_link_libraries(omnitag_nodelet PRIVATE omnitag_ros)

add_executable(localizer_node src/ros/localizer_node.cpp)
target_link_libraries(localizer_node PRIVATE omnitag_ros)

# What the tools that read a bag share: its images and transforms, their options, their progress.
add_library(omnitag_bag_tools STATIC
  src/ros/bag_tools/bag_input.cpp
  src/ros/bag_tools/command_line.cpp
  src/ros/bag_tools/mounting_option.cpp
  src/ros/bag_tools/progress.cpp
  src/ros/bag_tools/recorded_images.cpp
)
target_link_libraries(omnitag_bag_tools PUBLIC omnitag_ros Boost::program_options)

add_executable(localize_bag
  src/ros/localize_bag/main.cpp
  src/ros/localize_bag/options.cpp
  src/ros/localize_bag/result_bag.cpp
  src/ros/localize_bag/result_files.cpp
)
target_link_libraries(localize_bag PRIVATE omnitag_bag_tools)

# What build_map and calibrate_camera share: two faces of one adjustment.
add_library(omnitag_adjustment_tools STATIC
  src/ros/adjustment_tools/alignment_options.cpp
  src/ros/adjustment_tools/camera_output.cpp
  src/ros/adjustment_tools/drive.cpp
  src/ros/adjustment_tools/joint_run.cpp
  src/ros/adjustment_tools/map_output.cpp
  src/ros/adjustment_tools/step_log.cpp
)
target_link_libraries(omnitag_adjustment_tools PUBLIC omnitag_bag_tools opencv_imgcodecs)

add_executable(build_map
  src/ros/build_map/main.cpp
  src/ros/build_map/options.cpp
)
target_link_libraries(build_map PRIVATE omnitag_adjustment_tools)

add_executable(calibrate_camera
  src/ros/calibrate_camera/main.cpp
  src/ros/calibrate_camera/options.cpp
  src/ros/calibrate_camera/parameter_output.cpp
)
target_link_libraries(calibrate_camera PRIVATE omnitag_adjustment_tools)

add_executable(convert_camera src/ros/convert_camera/main.cpp)
target_link_libraries(convert_camera PRIVATE omnitag_bag_tools)

add_executable(plan_markers
  src/ros/plan_markers/main.cpp
  src/ros/plan_markers/options.cpp
)
target_link_libraries(plan_markers PRIVATE omnitag_bag_tools opencv_imgcodecs)

set(programs localizer_node localize_bag build_map calibrate_camera convert_camera plan_markers)
omnitag_flags(omnitag_ros omnitag_nodelet omnitag_bag_tools omnitag_adjustment_tools ${programs})

# Shared libraries and programs cannot share them: their code is compiled for different places.
set(precompiled_ros_headers ${precompiled_headers}
  <cv_bridge/cv_bridge.h>
  <diagnostic_updater/diagnostic_updater.h>
  <image_transport/image_transport.h>
  <nav_msgs/Odometry.h>
  <nav_msgs/Path.h>
  <ros/ros.h>
  <tf2/buffer_core.h>
  <visualization_msgs/MarkerArray.h>
)
if(OMNITAG_PCH AND NOT OMNITAG_PCH STREQUAL TESTS)
  # CMake would give each library a macro of its own, which no header reads.
  set_target_properties(omnitag_ros omnitag_nodelet PROPERTIES DEFINE_SYMBOL "")
  target_precompile_headers(omnitag_ros PRIVATE ${precompiled_ros_headers})
  target_precompile_headers(omnitag_nodelet REUSE_FROM omnitag_ros)
  target_precompile_headers(omnitag_bag_tools PRIVATE ${precompiled_ros_headers})
  foreach(program localize_bag build_map calibrate_camera convert_camera plan_markers)
    target_precompile_headers(${program} REUSE_FROM omnitag_bag_tools)
  endforeach()
endif()

install(TARGETS omnitag_ros omnitag_nodelet
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION}
)
install(TARGETS ${programs}
  RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
install(DIRECTORY bags config launch maps meshes urdf worlds
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
)
install(FILES nodelet_plugins.xml
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
)
catkin_install_python(PROGRAMS
  tools/convert_map
  tools/disturb_files
  tools/evaluate_map
  tools/evaluate_trajectory
  tools/make_film
  tools/make_pattern
  tools/merge_maps
  tools/mirror_mesh
  tools/print_markers
  tools/random_route
  tools/record_trajectory
  tools/relay_detections
  tools/render_sequence
  tools/start_if_installed
  tools/take_back_sim_time
  tools/world_floor
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
