#include <tinyxml2.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mapping/system/input_file.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/urdf_document.hpp"

namespace clearway::check {
namespace {

using Names = std::pair<std::string, std::string>;

constexpr int sampled = 200;           ///< configurations
constexpr double nearly_always = 0.9;  ///< of them; the planner's own samples are others, and 95 % of them
constexpr int most_looks = 100;        ///< what they leave open is tested along the path

/// What the SRDF says of pairs of links, read again.
class SrdfPairs {
 public:
  explicit SrdfPairs(const Robot& robot) {
    if (robot.srdf.empty()) return;
    const std::string text = read_text(robot.srdf);
    xml_.Parse(text.data(), text.size());
    const tinyxml2::XMLElement* root = xml_.FirstChildElement("robot");
    if (xml_.Error() || !root) disagree(robot, robot.srdf.string() + " is no robot's XML");
    const auto names = [](const tinyxml2::XMLElement& entry) {
      return Names(std::minmax(word_of(entry, "link1"), word_of(entry, "link2")));
    };
    const auto read = [&](const char* kind, const auto& use) {
      for (const auto* entry = root->FirstChildElement(kind); entry; entry = entry->NextSiblingElement(kind))
        use(*entry);
    };
    read("disable_collisions", [&](const auto& entry) { disabled_.insert(names(entry)); });
    read("enable_collisions", [&](const auto& entry) { enabled_.insert(names(entry)); });
    read("disable_default_collisions", [&](const auto& entry) { links_.insert(word_of(entry, "link")); });
  }

  /// Whether it wants them tested, neighbours or not.
  bool demand(const std::string& first, const std::string& second) const {
    const Names pair = std::minmax(first, second);
    return enabled_.contains(pair) && !disabled_.contains(pair);
  }

  bool allow(const std::string& first, const std::string& second) const {
    const Names pair = std::minmax(first, second);
    if (disabled_.contains(pair)) return true;
    return !enabled_.contains(pair) && (links_.contains(first) || links_.contains(second));
  }

 private:
  tinyxml2::XMLDocument xml_;
  std::set<Names> disabled_, enabled_;
  std::set<std::string> links_;  ///< against all others
};

/// Pairs of parts that the robot's settings exempt, read again.
std::set<Names> exempt_parts(const Robot& robot) {
  const std::filesystem::path file =
      is_urdf_name(robot.source) ? beside_urdf(robot.source, ".yaml") : robot.source;
  std::set<Names> pairs;
  if (!is_input_there(file)) return pairs;
  try {
    constexpr std::size_t largest = 256U << 10U;
    const YAML::Node settings = YAML::Load(read_input(file, "robot settings", largest));
    for (const YAML::Node& pair : settings["exempt"])
      pairs.insert(std::minmax(pair[0].as<std::string>(), pair[1].as<std::string>()));
  } catch (const YAML::Exception&) {
    disagree(robot, file.string() + " is no settings file");
  }
  return pairs;
}

/// Each joint at a share of its range; at 0 where that has no end.
template <class Share>
Configuration within_ranges(const Robot& robot, const KdlArm& arm, Share&& share) {
  Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto [lower, upper] = arm.range(robot.joints[j], j);
    if (std::isfinite(upper - lower)) q[static_cast<Eigen::Index>(j)] = lower + share() * (upper - lower);
  }
  return q;
}

struct Pair {
  std::size_t a, b;
};

/// Whether two bodies with one joint between them stay apart wherever it stands: halves of its range are
/// looked at until the distance in the middle of each is more than the joint can close on the way to its
/// ends.
bool stay_apart(const Robot& robot, const KdlArm& arm, const FclBodies& bodies, const Pair& pair) {
  const KdlLink* const link = arm.only_joint_between(pair.a, pair.b);
  if (!link || link->joint < 0) return false;
  const auto j = static_cast<std::size_t>(link->joint);
  const auto [lower, upper] = arm.range(robot.joints[j], j);
  if (!std::isfinite(lower) || !std::isfinite(upper)) return false;
  Configuration q = within_ranges(robot, arm, [] { return 0.5; });
  const double rate = arm.approach(pair.a, pair.b, Configuration::Unit(q.size(), link->joint));
  std::vector<std::pair<double, double>> open{{lower, upper}};
  for (int looks = 0; !open.empty(); ++looks) {
    if (looks == most_looks) return false;
    const auto [from, to] = open.back();
    open.pop_back();
    const double half = (to - from) / 2.0, way = (1.0 + 1e-9) * rate * half + 1e-9;
    q[link->joint] = from + half;
    const double apart =
        bodies.distance(pair.a, arm.place(q, pair.a), pair.b, arm.place(q, pair.b), 1.01 * way);
    if (apart > way) continue;
    if (apart <= 0.0) return false;
    open.emplace_back(from, from + half);
    open.emplace_back(from + half, to);
  }
  return true;
}

/// Over the whole range of all joints, from a fixed seed.
bool touch_nearly_always(const Robot& robot, const KdlArm& arm, const FclBodies& bodies, const Pair& pair) {
  std::mt19937_64 random(2);
  int apart = 0;
  for (int i = 0; i < sampled && apart <= (1.0 - nearly_always) * sampled; ++i) {
    const Configuration q = within_ranges(robot, arm, [&] { return random_unit(random); });
    apart += !bodies.touch(pair.a, arm.place(q, pair.a), pair.b, arm.place(q, pair.b));
  }
  return apart <= (1.0 - nearly_always) * sampled;
}

}  // namespace

std::set<std::pair<std::size_t, std::size_t>> justified_exemptions(const Robot& robot, const KdlArm& arm,
                                                                   const FclBodies& bodies) {
  std::set<std::pair<std::size_t, std::size_t>> justified;
  std::vector<Pair> open;
  const SrdfPairs srdf(robot);
  const auto link_of = [&](std::size_t body) {
    return robot.links[static_cast<std::size_t>(robot.bodies[body].link)].name;
  };
  for (const auto& [first, second] : robot.exempt) {
    const Pair pair{static_cast<std::size_t>(first), static_cast<std::size_t>(second)};
    if (std::max(pair.a, pair.b) >= robot.bodies.size()) continue;
    if (!arm.may_touch(pair.a, pair.b)) continue;
    if (robot.source.empty() ||
        (arm.are_neighbours(pair.a, pair.b) && !srdf.demand(link_of(pair.a), link_of(pair.b))))
      justified.emplace(pair.a, pair.b);
    else
      open.push_back(pair);
  }
  if (open.empty()) return justified;
  const std::set<Names> parts = exempt_parts(robot);
  for (const Pair& pair : open) {
    const Names names = std::minmax(robot.bodies[pair.a].part, robot.bodies[pair.b].part);
    if (parts.contains(names) || srdf.allow(link_of(pair.a), link_of(pair.b)) ||
        stay_apart(robot, arm, bodies, pair) || touch_nearly_always(robot, arm, bodies, pair))
      justified.emplace(pair.a, pair.b);
  }
  return justified;
}

}  // namespace clearway::check
