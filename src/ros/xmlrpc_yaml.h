#pragma once

#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace omnitag {

/// A parameter server's value as YAML, so that the same code checks parameters and files. `path`
/// names the value in errors. Throws InputError for types that YAML lacks (binary, dates).
YAML::Node yamlFromXmlRpc(const XmlRpc::XmlRpcValue& value, const std::string& path);

}  // namespace omnitag
