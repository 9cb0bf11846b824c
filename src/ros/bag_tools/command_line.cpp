#include "ros/bag_tools/command_line.h"

#include <boost/program_options.hpp>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

[[noreturn]] void refuseOutput(const PathOption& output, const std::string& why) {
  throw InputError(output.first + ": " + output.second + " " + why);
}

}  // namespace

po::typed_value<std::string>* textOption(std::string* value, const char* name) {
  return po::value<std::string>(value)->value_name(name);
}

po::typed_value<std::vector<std::string>>* textsOption(std::vector<std::string>* values,
                                                       const char* name) {
  return po::value<std::vector<std::string>>(values)->value_name(name);
}

bool parseCommandLine(int argc, char** argv, const std::string& usage,
                      const po::options_description& description,
                      const po::positional_options_description& positional) {
  const auto style = static_cast<int>(po::command_line_style::default_style) &
                     ~static_cast<int>(po::command_line_style::allow_guessing);
  try {
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv)
                  .options(description)
                  .positional(positional)
                  .style(style)
                  .run(),
              values);
    if (values.count("help") > 0) {
      std::cout << usage << '\n' << description;
      return false;
    }
    po::notify(values);
  } catch (const po::error& error) {
    throw InputError(error.what());
  }
  return true;
}

void checkOutputs(const std::vector<std::string>& inputs, const std::vector<PathOption>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& path = outputs[i].second;
    if (path.empty()) continue;
    for (const std::string& input : inputs) {
      if (isSameFile(path, input)) {
        refuseOutput(outputs[i], "is an input and would be overwritten");
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (path == outputs[j].second) refuseOutput(outputs[i], "is given twice");
    }
  }
}

}  // namespace omnitag
