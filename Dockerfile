# Debian 12 with omnitag installed. Nobody has built this image yet: it was only read.
#
#   docker build --tag omnitag .
#   docker run --rm --network host --volume "$PWD:/files" omnitag roslaunch omnitag localize.launch \
#     camera_file:=/files/my_camera.yaml map_file:=/files/my_map.yaml image:=/camera/image

FROM debian:bookworm
COPY . /omnitag
RUN /omnitag/scripts/install
RUN cmake -S /omnitag -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCATKIN_ENABLE_TESTING=OFF \
      -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_INSTALL_PREFIX=/opt/omnitag \
 && cmake --build /build --target install \
 && rm -rf /build
ENTRYPOINT ["bash", "-c", ". /opt/omnitag/setup.bash -- && exec \"$@\"", "omnitag"]
CMD ["bash"]
