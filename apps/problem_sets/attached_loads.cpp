#include "apps/problem_sets/attached_loads.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "apps/problem_sets/file_words.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::optional<std::size_t> index_of(const Robot& robot, const std::string& link) {
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == link) return i;
  return std::nullopt;
}

std::set<std::string> names_of(const Robot& robot) {
  std::set<std::string> names;
  for (const Link& link : robot.links) names.insert(link.name);
  for (const Body& body : robot.bodies) names.insert(body.part);
  return names;
}

/// Letters, digits, '_', '-' and '.' alone.
std::string load_name(const std::string& word) {
  std::string name = word;
  std::replace(name.begin(), name.end(), '=', '_');
  return name;
}

/// A mesh counts as its convex hull. @throws std::invalid_argument for one of many points, before the hull of
/// so many takes long
Shape solid_shape(const ForeignSolid& piece, const std::string& body) {
  if (piece.triangles.empty()) return piece.shape;
  std::vector<Eigen::Vector3d> points = piece.triangles;
  const auto key = [](const Eigen::Vector3d& at) { return std::tuple(at.x(), at.y(), at.z()); };
  std::sort(points.begin(), points.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  constexpr std::size_t most_points = 50'000;
  if (points.size() > most_points)
    throw std::invalid_argument("attached body " + quote(body) + ": its mesh has " +
                                std::to_string(points.size()) + " points, expected at most 50000");
  return Shape::convex(std::move(points));
}

class LoadMaker {
 public:
  LoadMaker(const Robot& robot, const Configuration& start)
      : robot_(robot), map_from_(forward_kinematics(robot, start)), words_(names_of(robot)) {}

  void add(const ForeignAttached& body) {
    const auto leave = [&](const std::string& why) {
      made_.left_out.push_back("attached body " + quote(body.name) + why);
    };
    if (body.pieces.empty()) return leave(", of which it shows no shape");
    const auto link = index_of(robot_, body.link);
    const auto frame = index_of(robot_, body.frame);
    if (!body.frame.empty() && body.frame != body.link && !frame)
      return leave(" in frame " + quote(body.frame) + ", which is no link of the robot");
    for (const ForeignSolid& piece : body.pieces) {
      Load load;
      load.name = words_.of(load_name(body.name));
      load.link = body.link;
      load.link_from_load = piece.map_from_shape;
      if (link && body.frame.empty()) load.link_from_load = map_from_[*link].inverse() * piece.map_from_shape;
      if (link && frame && frame != link)
        load.link_from_load = map_from_[*link].inverse() * map_from_[*frame] * piece.map_from_shape;
      load.shape = solid_shape(piece, body.name);
      load.mass = body.weight / static_cast<double>(body.pieces.size());
      constexpr std::size_t most_corners = 20'000;  // as of a robot's meshes
      if (load.shape.vertices().size() > most_corners)
        throw std::invalid_argument("attached body " + quote(body.name) + ": its convex hull has " +
                                    std::to_string(load.shape.vertices().size()) +
                                    " corners, expected at most 20000");
      for (const std::string& name : std::set<std::string>(body.touches.begin(), body.touches.end()))
        if (name != body.link && index_of(robot_, name)) load.touches.push_back(name);
      with_load(robot_, load);  // has it the link?
      made_.loads.push_back({std::move(load), {}});
    }
  }

  AttachedLoads made() { return std::move(made_); }

 private:
  const Robot& robot_;
  LinkPoses map_from_;
  FileWords words_;
  AttachedLoads made_;
};

}  // namespace

std::vector<ForeignAttached> standing_bodies(const ForeignWorld& world, const std::string& root) {
  std::vector<ForeignAttached> bodies;
  for (const auto& [object, links] : world.touched) {
    ForeignAttached body{object, root, {}, links, {}};
    std::copy_if(world.solids.begin(), world.solids.end(), std::back_inserter(body.pieces),
                 [&](const ForeignSolid& solid) { return solid.object == object; });
    if (!body.pieces.empty()) bodies.push_back(std::move(body));
  }
  return bodies;
}

AttachedLoads loads_of(const std::vector<ForeignAttached>& attached, const Robot& robot,
                       const Configuration& start) {
  LoadMaker maker(robot, start);
  for (const ForeignAttached& body : attached) maker.add(body);
  return maker.made();
}

}  // namespace clearway
