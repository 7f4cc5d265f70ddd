#include "planning/robot_files/load_robot.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/allowed_collisions.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/urdf_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// The .yaml or .urdf that a user's word means.
fs::path find_robot(const std::string& name_or_path) {
  const fs::path path = name_or_path;
  if (path.extension() == ".urdf" || path.extension() == ".yaml") return path;
  const fs::path known = datasets_folder() / "robots" / (name_or_path + ".yaml");
  if (!name_or_path.empty() && path.filename() == path && fs::is_regular_file(known)) return known;
  std::string names;
  for (const auto& [name, description] : available_robots()) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument("unknown robot " + quote(name_or_path) + ": expected one of " + names +
                              ", or the path of a .urdf or .yaml file");
}

std::vector<std::pair<int, int>> exempt_pairs(const Robot& robot, const RobotSettings& settings,
                                              const fs::path& settings_file, const fs::path& srdf) {
  std::vector<std::pair<int, int>> pairs = adjacent_bodies(robot);
  const auto append = [&](const std::vector<std::pair<int, int>>& more) {
    pairs.insert(pairs.end(), more.begin(), more.end());
  };
  const bool has_srdf = fs::is_regular_file(srdf);
  if (has_srdf) append(bodies_of_parts(robot, read_srdf(srdf), srdf));
  if (settings.exempt) append(bodies_of_parts(robot, *settings.exempt, settings_file));
  if (!has_srdf && !settings.exempt) append(always_colliding_bodies(robot));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Spheres that hold each body, in the frame of its link.
void cover_bodies(Robot& robot) {
  for (Body& body : robot.bodies) {
    body.cover = body.shape.sphere_cover();
    for (Sphere& sphere : body.cover) sphere.center = body.link_from_shape * sphere.center;
  }
}

}  // namespace

fs::path datasets_folder() {
  const char* chosen = std::getenv("CLEARWAY_DATASETS");
  if (chosen && *chosen) {
    if (fs::is_directory(fs::path(chosen) / "robots")) return chosen;
    throw std::invalid_argument("CLEARWAY_DATASETS is " + quote_path(chosen) +
                                ": expected a folder that holds a folder 'robots'");
  }
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const fs::path beside = program.parent_path().parent_path() / "share" / "clearway";
  if (!failed && fs::is_directory(beside / "robots", failed)) return fs::canonical(beside);
  const fs::path installed = CLEARWAY_FALLBACK_DATASETS;
  return fs::is_directory(installed / "robots", failed) ? installed : fs::path("/usr/share/clearway");
}

std::vector<std::pair<std::string, std::string>> available_robots() {
  std::vector<std::pair<std::string, std::string>> robots;
  const fs::path folder = datasets_folder() / "robots";
  if (!fs::is_directory(folder))
    throw std::invalid_argument("no folder of robots at " + quote_path(folder.string()) +
                                ": expected it there, or CLEARWAY_DATASETS to name the folder that holds it");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    robots.emplace_back(entry.path().stem().string(), read_robot_settings(entry.path()).description);
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

Robot load_robot(const std::string& name_or_path) {
  const fs::path file = find_robot(name_or_path);
  const bool is_urdf = file.extension() == ".urdf";
  const fs::path settings_file = is_urdf ? fs::path(file).replace_extension(".yaml") : file;
  RobotSettings settings;
  if (!is_urdf || fs::is_regular_file(settings_file)) settings = read_robot_settings(settings_file);
  const fs::path urdf = urdf_of(file, settings);

  Robot robot = read_urdf(urdf);
  apply_settings(settings, settings_file, robot);
  robot.name = file.stem().string();
  robot.source = file;
  robot.exempt = exempt_pairs(robot, settings, settings_file, fs::path(urdf).replace_extension(".srdf"));
  cover_bodies(robot);
  return settings.scale == 1.0 ? robot : scaled(robot, settings.scale);
}

}  // namespace clearway
