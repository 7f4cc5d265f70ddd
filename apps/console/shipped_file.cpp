#include "apps/console/shipped_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {

namespace fs = std::filesystem;

fs::path shipped_file(const std::string& folder, const fs::path& given) {
  std::error_code failed;
  if (given.filename() != given || given.has_extension() || fs::exists(given, failed)) return given;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(datasets_folder() / folder, failed)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  if (std::find(names.begin(), names.end(), given) != names.end())
    return datasets_folder() / folder / (given.string() + ".yaml");
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += name + ", ";
  const std::string meant = nearest_name(given.string().substr(0, 100), names, 2);
  throw std::invalid_argument("no file and none of the " + folder + " is called " + quote(given.string()) +
                              (meant.empty() ? ": expected " + list + "or the path of a .yaml file"
                                             : "; did you mean '" + meant + "'?"));
}

}  // namespace clearway
