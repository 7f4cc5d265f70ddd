#include "datasets/bags/bag_metadata.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <stdexcept>

#include "datasets/bags/bag_source.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

namespace {

bool is_zstd(const YAML::Node& format) {
  return format && format.IsScalar() && format.as<std::string>() == "zstd";
}

/// Gives `take` what metadata.yaml says of the bag, if it is there.
void read_metadata(const std::filesystem::path& folder,
                   const std::function<void(const YAML::Node& bag, const std::string& name)>& take) {
  constexpr std::size_t largest = 4U << 20U;
  std::error_code unknown;
  if (!std::filesystem::exists(folder / "metadata.yaml", unknown)) return;
  const std::string text = read_input(folder / "metadata.yaml", "metadata", largest);
  const std::string name = "metadata " + quote_path((folder / "metadata.yaml").string());
  require_yaml(text, name);
  try {
    const YAML::Node bag = YAML::Load(text)["rosbag2_bagfile_information"];
    if (!bag || bag.IsNull()) return;
    if (!bag.IsMap())
      throw std::invalid_argument(name + ": expected keys and values in 'rosbag2_bagfile_information'.");
    take(bag, name);
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(name + ", line " + std::to_string(error.mark.line + 1) +
                                ": expected what `ros2 bag record` writes.");
  }
}

}  // namespace

std::vector<std::string> listed_parts(const std::filesystem::path& folder) {
  std::vector<std::string> parts;
  read_metadata(folder, [&](const YAML::Node& bag, const std::string& name) {
    const YAML::Node list = bag["relative_file_paths"];
    if (!list) return;
    if (!list.IsSequence()) throw std::invalid_argument(name + ": expected a list as 'relative_file_paths'.");
    for (const YAML::Node& part : list)
      parts.push_back(std::filesystem::path(part.as<std::string>()).filename().string());
  });
  return parts;
}

void require_unpacked(const std::filesystem::path& folder) {
  read_metadata(folder, [&](const YAML::Node& bag, const std::string&) {
    const YAML::Node mode_node = bag["compression_mode"], format = bag["compression_format"];
    std::string mode = mode_node && mode_node.IsScalar() ? mode_node.as<std::string>() : "";
    std::transform(mode.begin(), mode.end(), mode.begin(), [](unsigned char c) { return std::toupper(c); });
    if (mode != "FILE" && mode != "MESSAGE") return;
    const bool are_files = mode == "FILE";
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".mcap" && (are_files || is_zstd(format))) return;
      if (is_sqlite_bag(entry.path()) && (are_files || is_zstd(format))) return;
    }
    throw std::invalid_argument("bag " + quote_path(folder.string()) + " has compressed " +
                                (are_files ? "files" : "messages") + " (" +
                                (format && format.IsScalar() ? quote(format.as<std::string>()) : "unknown") +
                                "), as its metadata.yaml says, which are not read here: expected " +
                                (are_files ? "them unpacked (`zstd -d` of each), or " : "") +
                                "what `ros2 bag convert` makes without compression_mode");
  });
}

}  // namespace clearway
