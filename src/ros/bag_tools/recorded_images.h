#pragma once

#include <rosbag/message_instance.h>

#include <cstddef>
#include <functional>
#include <string>

#include "ros/bag_tools/bag_input.h"
#include "ros/frame_assembler.h"

namespace omnitag {

/// Uses an image of a bag; throws InputError if it cannot.
using ImageUser = std::function<void(const AssembledFrame&, const rosbag::MessageInstance&)>;

/// Passes on the images of a bag in their order, at most `most` of them, evenly spread. Shows its
/// progress, counted in `what`, and warns about images that cannot be used. Throws InputError if
/// none can. An image's message must not outlive the bag.
void useImages(const BagInput& input, const FrameAssembler& assembler, std::size_t most,
               const std::string& what, const ImageUser& use);

}  // namespace omnitag
