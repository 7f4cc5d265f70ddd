#include "datasets/bags/bag_metadata.hpp"

#include <yaml-cpp/yaml.h>

#include <stdexcept>

#include "datasets/descriptions/yaml_gate.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

std::vector<std::string> listed_parts(const std::filesystem::path& folder) {
  constexpr std::size_t largest = 4U << 20U;
  std::error_code unknown;
  if (!std::filesystem::exists(folder / "metadata.yaml", unknown)) return {};
  const std::string text = read_input(folder / "metadata.yaml", "metadata", largest);
  const std::string name = "metadata " + quote_path((folder / "metadata.yaml").string());
  require_yaml(text, name);
  std::vector<std::string> parts;
  try {
    const YAML::Node bag = YAML::Load(text)["rosbag2_bagfile_information"];
    if (!bag || bag.IsNull()) return parts;
    if (!bag.IsMap())
      throw std::invalid_argument(name + ": expected keys and values in 'rosbag2_bagfile_information'.");
    const YAML::Node list = bag["relative_file_paths"];
    if (!list) return parts;
    if (!list.IsSequence()) throw std::invalid_argument(name + ": expected a list as 'relative_file_paths'.");
    for (const YAML::Node& part : list)
      parts.push_back(std::filesystem::path(part.as<std::string>()).filename().string());
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(name + ", line " + std::to_string(error.mark.line + 1) +
                                ": expected what `ros2 bag record` writes.");
  }
  return parts;
}

}  // namespace clearway
