#include "ros/xmlrpc_yaml.h"

#include "omnitag/common/error.h"

namespace omnitag {

YAML::Node yamlFromXmlRpc(const XmlRpc::XmlRpcValue& value, const std::string& path) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<const bool&>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<const int&>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return YAML::Node(static_cast<const double&>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return YAML::Node(static_cast<const std::string&>(value));
    case XmlRpc::XmlRpcValue::TypeArray: {
      YAML::Node list(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) {
        list.push_back(yamlFromXmlRpc(value[i], path + "[" + std::to_string(i) + "]"));
      }
      return list;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      YAML::Node mapping(YAML::NodeType::Map);
      const std::string parent = path + "/";
      for (const auto& [key, child] : value) mapping[key] = yamlFromXmlRpc(child, parent + key);
      return mapping;
    }
    default:
      throw InputError(path + ": expected a number, text, list or mapping, found binary data");
  }
}

}  // namespace omnitag
