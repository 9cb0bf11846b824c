#pragma once

#include <rosbag/message_instance.h>

#include <cstddef>
#include <functional>
#include <string>

#include "bag_input.h"
#include "omnitag/ros/frame_assembler.h"

namespace omnitag {

/// Takes an image of a bag; throws InputError where it is of no use.
using ImageUser = std::function<void(const AssembledFrame&, const rosbag::MessageInstance&)>;

/// Hands out the images of a bag in their order, `most` of them at most, evenly spread. Shows its
/// progress, `what` being what is counted, and warns about images that cannot be used. Throws
/// InputError where none can. An image's message lives no longer than the bag.
void useImages(const BagInput& input, const FrameAssembler& assembler, std::size_t most,
               const std::string& what, const ImageUser& use);

}  // namespace omnitag
