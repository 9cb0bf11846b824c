#include "ros/bag_tools/recorded_images.h"

#include <algorithm>

#include "omnitag/common/error.h"
#include "ros/bag_tools/progress.h"

namespace omnitag {

void useImages(const BagInput& input, const FrameAssembler& assembler, std::size_t most,
               const std::string& what, const ImageUser& use) {
  constexpr std::size_t kMaxWarnings = 5;
  const std::size_t all = input.imageCount();
  if (all == 0) throw InputError(input.imageTopic() + ": has no images");
  const std::size_t wanted = std::min(all, most);
  Progress progress(wanted, what);
  std::string first_problem;
  std::size_t problems = 0;
  std::size_t index = 0;
  std::size_t done = 0;
  input.forEachImage([&](const rosbag::MessageInstance& message) {
    const bool is_wanted = done < wanted && index++ == done * all / wanted;
    if (!is_wanted) return;
    try {
      use(assembler.assemble(BagInput::grayImageOf(message), input.transforms()), message);
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
      if (problems++ < kMaxWarnings) progress.warn(input.imageTopic() + ": " + error.what());
    }
    progress.show(++done);
  });
  if (problems == wanted) {
    throw InputError(input.imageTopic() + ": no image could be used: " + first_problem);
  }
}

}  // namespace omnitag
