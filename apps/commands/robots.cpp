#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <set>

#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/number_or_null.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/path/motion.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;
using Table = std::vector<std::vector<std::string>>;

const char* kind_name(JointKind kind) { return kind == JointKind::revolute ? "revolute" : "prismatic"; }

Json list_entry(const std::string& name, const std::string& description, const Robot& robot) {
  Json entry{{"name", name}, {"description", description}, {"scale", robot.scale}};
  for (const Joint& joint : robot.joints)
    entry["joints"].push_back({{"name", joint.name},
                               {"kind", kind_name(joint.kind)},
                               {"lower", number_or_null(joint.lower)},
                               {"upper", number_or_null(joint.upper)}});
  entry["critical_parts"] = robot.critical_parts;
  return entry;
}

int list_robots(Console& console) {
  Table rows{{"robot", "joints", "scale", "description"}};
  Json json = Json::array();
  for (const auto& [name, description] : available_robots()) {
    const Robot robot = load_robot(name);
    rows.push_back({name, std::to_string(robot.dof()), significant(robot.scale), description});
    json.push_back(list_entry(name, description, robot));
  }
  if (console.json)
    console.out() << Json{{"robots", json}}.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print_table(console.out(), rows);
  return exit_done;
}

/// m^3. What is not round by the divergence theorem, over the triangles of its surface.
double volume_of(const Shape& shape) {
  const double r = shape.radius(), pi = std::numbers::pi;
  if (shape.is_rounded()) return pi * r * r * (shape.length() + 4.0 / 3.0 * r);
  if (shape.is_axial()) return pi * r * r * shape.length();
  const ShapeSurface surface = shape.surface();
  const auto corner = [&](int i) { return surface.corners[static_cast<std::size_t>(i)]; };
  double sum = 0.0;
  for (const auto& [a, b, c] : surface.triangles) sum += corner(a).dot(corner(b).cross(corner(c)));
  return std::abs(sum) / 6.0;
}

std::string vector_text(const Eigen::Vector3d& v) {
  const auto part = [](double x) { return significant(std::abs(x) < 5e-10 ? 0.0 : x); };
  return part(v.x()) + "," + part(v.y()) + "," + part(v.z());
}

std::string size_text(const Shape& shape) {
  if (!shape.vertices().empty())
    return "hull of " + counted(shape.vertices().size(), "corner") + ", in " + vector_text(shape.edges());
  std::string text = std::string(shape.name());
  for (const double size : shape.sizes()) text += " " + significant(size);
  return text;
}

std::string say_source(HoldSource source) {
  switch (source) {
    case HoldSource::asked:
      return "--fix";
    case HoldSource::settings:
      return "settings";
    case HoldSource::default_state:
      return "SRDF state default";
    case HoldSource::zero:
      return "nobody: 0, or the limit nearest to it";
  }
  return "";
}

std::string say_source(TipSource source) {
  if (source == TipSource::joints) return "joints";
  return source == TipSource::srdf ? "SRDF" : "settings";
}

/// What the program makes of a robot: all that `plan` and `check` rest on.
class Description {
 public:
  Description(const RobotsOptions& options, Console& console)
      : console_(console), robot_(choose_robot(options.robot)) {
    const std::vector<LegLoad> loads = choose_loads(options.attach, robot_);
    notes_ = robot_notes(robot_, robot_request(options.robot).packages);
    for (const std::string& note : hold_notes(robot_, loads)) notes_.push_back(note);
    if (const std::string doubt = tip_doubt(robot_); !doubt.empty()) notes_.push_back(doubt);
    for (const std::string& link : robot_.only_seen)
      notes_.push_back("link " + quote(link) + " has a shape to look at and none to collide: not checked");
    robot_ = with_all_loads(robot_, loads);
    q_ = options.at.empty() ? resting_configuration(robot_)
                            : choose_configuration(options.at, "--at", robot_, options.degrees);
    limits_ = limit_violation(robot_, q_);
    poses_ = forward_kinematics(robot_, q_);
    for (const BodyPair& pair : self_collision_pairs(robot_)) {
      ++tested_pairs_;
      if (pair_distance(robot_, pair, poses_).lower > 0.0) continue;
      const std::string parts = part(pair.first) + " and " + part(pair.second);  // of several bodies each
      if (std::find(touching_.begin(), touching_.end(), parts) == touching_.end()) touching_.push_back(parts);
    }
  }

  void print() const {
    print_rows(console_.out(), summary());
    print_section(joint_table());
    print_section(held_table());
    print_section(body_table());
    console_.note(notes_);
  }

  Json json() const {
    Json json = list_entry(robot_.name, "", robot_);
    json.erase("description");
    json["source"] = robot_.source.string();
    json["srdf"] = robot_.srdf.string();
    json["group"] = robot_.group;
    json["base"] = numbers_from_pose(robot_.map_from_base);
    json["tip"] = {{"link", tip_link().name},
                   {"link_from_tip", numbers_from_pose(robot_.link_from_tip)},
                   {"by", say_source(robot_.tip_choice.source)}};
    json["position_accuracy_m"] = robot_.position_accuracy;
    const RateLimits used = rate_limits(robot_);
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      const Joint& joint = robot_.joints[j];
      const auto at = static_cast<Eigen::Index>(j);
      Json& entry = json["joints"][j];
      entry["usual"] = Json::array();  // limits that nobody states
      const auto say = [&](const char* key, double stated, double limit) {
        entry[key] = limit;
        if (!(stated > 0.0)) entry["usual"].push_back(key);
      };
      say("max_velocity", joint.max_velocity, used.velocity[at]);
      say("max_acceleration", joint.max_acceleration, used.acceleration[at]);
      say("max_jerk", joint.max_jerk, used.jerk[at]);
    }
    json["held"] = Json::array();
    for (const HeldJoint& joint : robot_.held)
      json["held"].push_back(
          {{"name", joint.name}, {"value", joint.value}, {"by", say_source(joint.source)}});
    json["states"] = Json::object();
    for (const NamedState& state : robot_.states) json["states"][state.name] = state.values;
    json["at"] = std::vector<double>(q_.begin(), q_.end());
    json["limit_violation"] = limits_;
    json["tip_pose"] = numbers_from_pose(tip_pose(robot_, q_));
    for (std::size_t i = 0; i < robot_.links.size(); ++i) json["links"].push_back(link_json(i));
    json["bodies"] = Json::array();
    for (const Body& body : robot_.bodies) json["bodies"].push_back(body_json(body));
    json["tested_pairs"] = tested_pairs_;
    json["exempt_pairs"] = Json::array();
    std::map<std::string, std::size_t> bodies;  // of each part
    for (const Body& body : robot_.bodies) ++bodies[body.part];
    std::map<std::pair<std::string, std::string>, std::size_t> exempt;
    for (const auto& [a, b] : robot_.exempt) ++exempt[std::minmax(part(a), part(b))];
    for (const auto& [parts, pairs] : exempt)
      if (pairs == bodies[parts.first] * bodies[parts.second])  // of the others some bodies are tested
        json["exempt_pairs"].push_back({parts.first, parts.second});
    json["touching"] = touching_;
    json["notes"] = notes_;
    return json;
  }

  std::string page() const {
    ReportPage page;
    page.title = robot_.name;
    page.subtitle = "robot as plan and check have it, at " + to_text(q_);
    for (const auto& row : summary())
      if (row.first != "robot" && row.first != "at") page.figures.push_back(row);
    show_robot(page, robot_, q_);
    for (const auto& [name, table] :
         {std::pair{"Joints", joint_table()}, std::pair{"Joints held still", held_table()},
          std::pair{"Bodies", body_table()}})
      if (table.size() > 1) page.tables.push_back({name, table.front(), {table.begin() + 1, table.end()}});
    page.warnings = notes_;
    return render_report_page(page);
  }

 private:
  const Link& tip_link() const { return robot_.links[static_cast<std::size_t>(robot_.tip_link)]; }
  const std::string& part(int body) const { return robot_.bodies[static_cast<std::size_t>(body)].part; }
  Eigen::AlignedBox3d bounds(const Body& body) const {
    return body.shape.bounds(poses_[static_cast<std::size_t>(body.link)] * body.link_from_shape);
  }

  std::vector<std::pair<std::string, std::string>> summary() const {
    std::vector<std::pair<std::string, std::string>> rows{{"robot", shortened(robot_.name)},
                                                          {"file", quote_path(robot_.source.string())}};
    if (!robot_.srdf.empty()) rows.emplace_back("SRDF", quote_path(robot_.srdf.string()));
    if (!robot_.group.empty()) rows.emplace_back("group", shortened(robot_.group));
    rows.emplace_back("scale, base", significant(robot_.scale) + ", " + to_text(robot_.map_from_base));
    rows.emplace_back("tip",
                      shortened(tip_link().name) +
                          (robot_.link_from_tip.isApprox(Eigen::Isometry3d::Identity())
                               ? ""
                               : ", then " + to_text(robot_.link_from_tip)) +
                          (robot_.tip_choice.source == TipSource::joints ? " (as its joints have it)" : ""));
    rows.emplace_back("accuracy", significant(1e3 * robot_.position_accuracy) + " mm: the padding `auto`");
    if (!robot_.critical_parts.empty()) rows.emplace_back("critical parts", listed(robot_.critical_parts));
    std::vector<std::string> states;
    for (const NamedState& state : robot_.states) states.push_back(state.name);
    if (!states.empty()) rows.emplace_back("states", listed(states));
    rows.emplace_back("pairs of bodies", std::to_string(tested_pairs_) + " tested against each other, " +
                                             std::to_string(robot_.exempt.size()) +
                                             " never (--json names them)");
    rows.emplace_back("at", to_text(q_) + (limits_.empty() ? "" : ": " + limits_));
    rows.emplace_back("tip there", to_text(tip_pose(robot_, q_)) + " (m; roll, pitch, yaw)");
    rows.emplace_back("touching there", touching_.empty() ? "no pair" : listed(touching_));
    return rows;
  }

  void print_section(const Table& table) const {
    if (table.size() < 2) return;
    console_.out() << '\n';
    print_table(console_.out(), table);
  }

  Table joint_table() const {
    Table rows{{"joint", "kind", "lower", "upper", "velocity", "acceleration", "jerk"}};
    const RateLimits used = rate_limits(robot_);
    const auto said = [](double stated, double limit) {
      return significant(limit) + (stated > 0.0 ? "" : " (usual)");
    };
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      const Joint& joint = robot_.joints[j];
      const auto at = static_cast<Eigen::Index>(j);
      rows.push_back({shortened(joint.name), kind_name(joint.kind), significant(joint.lower),
                      significant(joint.upper), said(joint.max_velocity, used.velocity[at]),
                      said(joint.max_acceleration, used.acceleration[at]),
                      said(joint.max_jerk, used.jerk[at])});
    }
    return rows;
  }

  Table held_table() const {
    Table rows{{"joint held still", "at (full size)", "says who"}};
    for (const HeldJoint& joint : robot_.held)
      rows.push_back({shortened(joint.name), significant(joint.value), say_source(joint.source)});
    return rows;
  }

  Table body_table() const {
    Table rows{{"part", "shape (m)", "litres", "from, map frame (m)", "to"}};
    for (const Body& body : robot_.bodies) {
      const Eigen::AlignedBox3d box = bounds(body);
      rows.push_back({shortened(body.part), size_text(body.shape),
                      significant(1e3 * volume_of(body.shape), 3), vector_text(box.min()),
                      vector_text(box.max())});
    }
    return rows;
  }

  Json link_json(std::size_t i) const {
    const Link& link = robot_.links[i];
    Json json{{"name", link.name},
              {"parent", link.parent < 0 ? Json(nullptr)
                                         : Json(robot_.links[static_cast<std::size_t>(link.parent)].name)},
              {"joint", link.joint_name},
              {"mass_kg", link.mass},
              {"map_from_link", numbers_from_pose(poses_[i])}};
    if (link.joint >= 0) {
      json["moved_by"] = robot_.joints[static_cast<std::size_t>(link.joint)].name;
      json["kind"] = kind_name(kind_of(robot_, link));
      json["multiplier"] = link.multiplier;
      json["offset"] = link.offset;
    }
    return json;
  }

  Json body_json(const Body& body) const {
    const auto numbers = [](const Eigen::Vector3d& v) { return std::vector<double>(v.begin(), v.end()); };
    const Eigen::AlignedBox3d box = bounds(body);
    Json json{{"part", body.part},
              {"link", robot_.links[static_cast<std::size_t>(body.link)].name},
              {"shape", body.shape.name()},
              {"sizes", body.shape.sizes()},
              {"link_from_shape", numbers_from_pose(body.link_from_shape)},
              {"volume_m3", volume_of(body.shape)},
              {"map_from", numbers(box.min())},
              {"map_to", numbers(box.max())}};
    for (const Eigen::Vector3d& vertex : body.shape.vertices()) json["vertices"].push_back(numbers(vertex));
    return json;
  }

  Console& console_;
  Robot robot_;
  std::vector<std::string> notes_{};
  Configuration q_{};
  std::string limits_{};
  LinkPoses poses_{};
  std::size_t tested_pairs_ = 0;
  std::vector<std::string> touching_{};
};

std::vector<NamedPlace> places_read(const RobotsOptions& options) {
  std::vector<NamedPlace> places = places_of_robot("ROBOT", options.robot.robot);
  places.push_back({"--srdf", options.robot.srdf});
  for (const auto& file : options.attach) places.push_back({"--attach", file});
  return places;
}

}  // namespace

int run_robots(const RobotsOptions& options, Console& console) {
  if (options.robot.robot.empty()) return list_robots(console);
  if (!options.view.empty()) {
    require_apart({{"--view", options.view}}, places_read(options));
    require_writable(options.view);
  }
  const Description description(options, console);
  if (!options.view.empty()) save_file(options.view, description.page());
  if (console.json)
    console.out() << description.json().dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    description.print();
  if (!options.view.empty() && !console.json) console.out() << "  page: " << options.view.string() << '\n';
  return exit_done;
}

}  // namespace clearway
