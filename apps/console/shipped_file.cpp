#include "apps/console/shipped_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {

namespace fs = std::filesystem;

std::vector<std::string> shipped_names(const std::string& folder) {
  std::error_code failed;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(datasets_folder() / folder, failed))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

fs::path shipped_file(const std::string& folder, const fs::path& given) {
  std::error_code failed;
  if (given.filename() != given || given.has_extension() || fs::is_regular_file(given, failed)) return given;
  const std::vector<std::string> names = shipped_names(folder);
  if (std::find(names.begin(), names.end(), given) != names.end())
    return datasets_folder() / folder / (given.string() + ".yaml");
  if (fs::exists(given, failed)) return given;  // refused by its reader, in a sentence
  const std::string start = "no file and none of the " + folder + " is called " + quote(given.string());
  if (names.empty()) {
    throw std::invalid_argument(start + ": there are none at " +
                                quote_path((datasets_folder() / folder).string()) +
                                ", CLEARWAY_DATASETS may name another folder");
  }
  const bool is_near = !nearest_name(given.string(), names).empty();
  throw std::invalid_argument(start + "; " + suggestion(given.string(), names) +
                              (is_near ? "" : ", or the path of a .yaml file"));
}

}  // namespace clearway
