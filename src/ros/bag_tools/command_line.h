#pragma once

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/positional_options.hpp>
#include <string>
#include <utility>
#include <vector>

namespace omnitag {

/// An option's name, and the path that was given; empty for none.
using PathOption = std::pair<std::string, std::string>;

/// A tool's option with one text, which is stored in `*value`. `name`: what the help calls the
/// text.
boost::program_options::typed_value<std::string>* textOption(std::string* value, const char* name);

/// The same for an option that may be repeated.
boost::program_options::typed_value<std::vector<std::string>>* textsOption(
    std::vector<std::string>* values, const char* name);

/// Reads a command line of long options and positional arguments. If help is asked for, prints it
/// (`usage` and the options) and returns false. Throws InputError for an option that is missing,
/// unknown or has a bad value.
bool parseCommandLine(
    int argc, char** argv, const std::string& usage,
    const boost::program_options::options_description& description,
    const boost::program_options::positional_options_description& positional = {});

/// Results may overwrite existing files, but never an input or another result: throws InputError.
void checkOutputs(const std::vector<std::string>& inputs, const std::vector<PathOption>& outputs);

}  // namespace omnitag
