#include "ros/adjustment_tools/alignment_options.h"

#include <boost/program_options.hpp>
#include <sstream>

#include "omnitag/common/error.h"
#include "ros/bag_tools/command_line.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

AlignPoint parseAlignPoint(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  AlignPoint point;
  bool is_read = colon != std::string::npos && colon > 0;
  if (is_read) {
    point.marker = text.substr(0, colon);
    std::istringstream stream(text.substr(colon + 1));
    char comma = 0;
    stream >> point.place.x() >> comma >> point.place.y();
    is_read =
        !stream.fail() && comma == ',' && (stream >> std::ws).eof() && point.place.allFinite();
  }
  if (!is_read) {
    throw InputError("--align-point: expected MARKER:X,Y, a name or id and metres, found '" + text +
                     "'");
  }
  return point;
}

}  // namespace

void addAlignmentOptions(AlignmentRequest* request, po::options_description* description) {
  description->add_options()(
      "align-to", textOption(&request->frame, "FRAME"),
      "put the map into the frame in which another localizer, say amcl, has the robot in the bags' "
      "tf")("align-point",
            po::value<std::vector<std::string>>()
                ->value_name("MARKER:X,Y")
                ->notifier([request](const std::vector<std::string>& texts) {
                  for (const std::string& text : texts) {
                    request->points.push_back(parseAlignPoint(text));
                  }
                }),
            "put the map where this marker has these coordinates (m); twice or more");
}

void checkAlignment(const AlignmentRequest& request) {
  if (!request.frame.empty() && !request.points.empty()) {
    throw InputError("--align-to: expected either this or --align-point, found both");
  }
  if (request.points.size() == 1) {
    throw InputError("--align-point: expected two or more, found one");
  }
}

}  // namespace omnitag
