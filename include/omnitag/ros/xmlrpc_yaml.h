#pragma once

#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace omnitag {

/// A parameter server's value as YAML, so that parameters and files are checked by the same code.
/// `path` names the value in errors. Throws InputError for types that YAML has not (binary, dates).
YAML::Node yamlFromXmlRpc(const XmlRpc::XmlRpcValue& value, const std::string& path);

}  // namespace omnitag
