#include "apps/bench/worlds/panda_variants.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <locale>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/bench/page/bench_folder.hpp"
#include "planning/geometry/convex_hull.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

/// A folder that goes when the robot is loaded.
struct RobotFolder : BenchFolder {
  RobotFolder() : BenchFolder("robot") {}

  void write(const std::string& name, const std::string& text) const {
    std::ofstream file(path / name);
    file << text;
    if (!file.flush()) throw std::runtime_error("cannot write " + (path / name).string());
  }
};

std::ostringstream text_stream() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  return text;
}

std::string numbers(const Eigen::Vector3d& values) {
  std::ostringstream text = text_stream();
  text << values.x() << " " << values.y() << " " << values.z();
  return text.str();
}

std::string origin(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d ypr = pose.linear().eulerAngles(2, 1, 0);
  return "<origin xyz=\"" + numbers(pose.translation()) + "\" rpy=\"" + numbers(ypr.reverse()) + "\"/>";
}

/// <collision> elements of a link.
using Collisions = std::function<std::string(const Robot&, int link)>;

std::string urdf_of(const Robot& robot, const Collisions& collisions) {
  std::ostringstream text = text_stream();
  text << "<robot name=\"panda\">\n";
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    text << "<link name=\"" << link.name << "\">" << collisions(robot, static_cast<int>(i)) << "</link>\n";
    if (link.parent < 0) continue;
    const bool is_fixed = link.joint < 0;
    text << "<joint name=\"to_" << link.name << "\" type=\"" << (is_fixed ? "fixed" : "revolute")
         << "\"><parent link=\"" << robot.links[static_cast<std::size_t>(link.parent)].name
         << "\"/><child link=\"" << link.name << "\"/>" << origin(link.parent_from_link);
    if (!is_fixed) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
      text << "<axis xyz=\"" << numbers(joint.axis) << "\"/><limit effort=\"1\" lower=\"" << joint.lower
           << "\" upper=\"" << joint.upper << "\" velocity=\"" << joint.max_velocity << "\"/>";
    }
    text << "</joint>\n";
  }
  text << "</robot>\n";
  return text.str();
}

/// What the built-in Panda's .yaml says.
std::string settings() {
  return "tip: {link: hand, xyz: [0, 0, 0.1034]}\n"
         "critical_parts: [hand]\n"
         "exempt:\n  - [link1, link3]\n  - [link5, link7]\n  - [link6, hand]\n";
}

Robot loaded(const RobotFolder& folder, const Robot& robot, const Collisions& collisions) {
  folder.write("panda.urdf", urdf_of(robot, collisions));
  folder.write("panda.yaml", settings());
  return load_robot((folder.path / "panda.urdf").string());
}

/// Half of the shape's extent along each of its axes.
Eigen::Vector3d half_extent(const Shape& shape) {
  return shape.bounds(Eigen::Isometry3d::Identity()).sizes() / 2;
}

/// The shape cut across its longest axis into so many slices, a sphere around each.
std::vector<Sphere> slices(const Shape& shape, int count) {
  const Eigen::Vector3d half = half_extent(shape);
  int longest = 0;
  half.maxCoeff(&longest);
  const bool is_round = shape.is_rounded(), is_disc = shape.is_axial() && longest == 2;
  const double end = half[longest] - (is_round ? shape.radius() : 0.0);  // of the caps' middles
  Eigen::Vector3d flat = half;
  flat[longest] = 0.0;
  const double across = is_round || is_disc ? shape.radius() : flat.norm();
  std::vector<Sphere> spheres;
  const int gaps = is_round ? std::max(count - 1, 1) : count;
  const double step = 2.0 * end / gaps;
  const double radius = is_round && count == 1 ? half[longest] : std::hypot(across, step / 2);
  for (int i = 0; i < count; ++i) {
    const double at = count == 1 ? 0.0 : -end + step * (is_round ? i : i + 0.5);
    spheres.push_back({at * Eigen::Vector3d::Unit(longest), radius});
  }
  return spheres;
}

/// How far the slices' spheres stand out of the shape, metres.
double excess(const Shape& shape, int count) {
  double most = 0.0;
  for (const Sphere& sphere : slices(shape, count))
    most = std::max(most, sphere.radius + shape.signed_distance(sphere.center));
  return most;
}

}  // namespace

Robot panda_of_spheres(int spheres) {
  const Robot robot = load_robot("panda");
  std::vector<int> counts(robot.bodies.size(), 1);
  const auto stands_out = [&](std::size_t body) {
    return robot.bodies[body].link == 0 ? 0.0 : excess(robot.bodies[body].shape, counts[body]);
  };
  const auto moved = std::count_if(robot.bodies.begin(), robot.bodies.end(),
                                   [](const Body& body) { return body.link != 0; });
  for (auto made = static_cast<int>(moved); made < spheres; ++made) {
    std::size_t worst = 0;
    double most = 0.0;
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const double gained = stands_out(i) - excess(robot.bodies[i].shape, counts[i] + 1);
      if (robot.bodies[i].link == 0 || !(gained > 0.0) || stands_out(i) <= most) continue;
      most = stands_out(i);
      worst = i;
    }
    ++counts[worst];
  }
  const RobotFolder folder;
  return loaded(folder, robot, [&](const Robot& of, int link) {
    std::ostringstream text = text_stream();
    for (std::size_t i = 0; i < of.bodies.size(); ++i) {
      const Body& body = of.bodies[i];
      if (body.link != link) continue;
      if (link == 0) {
        text << "<collision>" << origin(body.link_from_shape) << "<geometry><box size=\""
             << numbers(body.shape.edges()) << "\"/></geometry></collision>";
        continue;
      }
      for (const Sphere& sphere : slices(body.shape, counts[i]))
        text << "<collision><origin xyz=\"" << numbers(body.link_from_shape * sphere.center)
             << "\"/><geometry><sphere radius=\"" << sphere.radius << "\"/></geometry></collision>";
    }
    return text.str();
  });
}

namespace {

/// Points of the surfaces of the link's bodies, farthest in directions that are spread evenly (Fibonacci).
std::vector<Eigen::Vector3d> skin(const Robot& robot, int link) {
  constexpr int directions = 250;
  std::vector<Eigen::Vector3d> points;
  for (const Body& body : robot.bodies) {
    if (body.link != link) continue;
    for (int i = 0; i < directions; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / directions, around = std::sqrt(1.0 - z * z);
      const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
      const Eigen::Vector3d way(around * std::cos(angle), around * std::sin(angle), z);
      points.push_back(body.link_from_shape * body.shape.support(way));
    }
  }
  return points;
}

std::string stl_of(const std::vector<Eigen::Vector3d>& points) {
  std::ostringstream text = text_stream();
  text << "solid link\n";
  for (const std::array<int, 3>& triangle : hull_triangles(points)) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : triangle)
      text << "vertex " << numbers(points[static_cast<std::size_t>(corner)]) << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid link\n";
  return text.str();
}

}  // namespace

Robot panda_of_meshes() {
  const RobotFolder folder;
  return loaded(folder, load_robot("panda"), [&](const Robot& of, int link) -> std::string {
    const std::string& name = of.links[static_cast<std::size_t>(link)].name;
    folder.write(name + ".stl", stl_of(hull_corners(skin(of, link))));
    return "<collision><geometry><mesh filename=\"" + name + ".stl\"/></geometry></collision>";
  });
}

}  // namespace clearway::bench
