#include "planning/batch/sphere_robot.hpp"

#include <algorithm>
#include <atomic>

#include "mapping/field/byte_field.hpp"
#include "planning/batch/sphere_robot_build.hpp"
#include "planning/robot/last_made.hpp"
#include "planning/robot/same_robot.hpp"

namespace clearway {
namespace {

constexpr double most_excess = 0.25;  ///< voxels that spheres may stand out of a small box

std::atomic<std::uint64_t> robots_made = 0;

/// A sphere about each cell of the box, cut so often along its axes; link frame.
std::vector<Sphere> cells_of(const Body& box, const Eigen::Vector3i& counts) {
  const Eigen::Vector3d cell = box.shape.edges().cwiseQuotient(counts.cast<double>());
  std::vector<Sphere> spheres;
  for (int x = 0; x < counts.x(); ++x) {
    for (int y = 0; y < counts.y(); ++y) {
      for (int z = 0; z < counts.z(); ++z) {
        const Eigen::Vector3d at = cell.cwiseProduct(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5));
        spheres.push_back(
            {box.link_from_shape * (at - box.shape.edges() / 2), cell.norm() / 2 * (1.0 + 1e-9)});
      }
    }
  }
  return spheres;
}

/// The fields that bodies are looked up in, and which one each is.
struct Fields {
  std::vector<SphereRobot::Field> fields;
  std::vector<int> field_of;
  double size = 0.0;  ///< no coordinate is larger, seen from the robot's base, metres

  Fields(const Robot& robot, std::span<const BlockedBody> bodies) {
    for (const BlockedBody& body : bodies) {
      const ByteField* bytes = &body.space->byte_field();
      const auto known = std::find_if(fields.begin(), fields.end(),
                                      [&](const SphereRobot::Field& field) { return field.bytes == bytes; });
      field_of.push_back(static_cast<int>(known - fields.begin()));
      if (known != fields.end()) continue;
      SphereRobot::Field field{bytes, {}};
      const Eigen::Vector3d low = bytes->low - robot.map_from_base.translation();
      for (int i = 0; i < 3; ++i) field.low[i] = static_cast<float>(low[i]);
      size = std::max(size, low.norm() + (bytes->size.cast<double>() * bytes->resolution).norm());
      fields.push_back(field);
    }
  }
};

SphereGround ground_of(const Robot& robot, std::span<const BlockedBody> bodies, const Fields& fields) {
  SphereGround ground{std::vector<int>(robot.bodies.size(), -1),
                      fields.field_of,
                      bodies.empty() ? 0.0 : bodies.front().space->resolution(),
                      {}};
  for (const Body& body : robot.bodies) ground.covers.push_back(lane_cover(body, ground.resolution).size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
      if (bodies[i].body == &robot.bodies[body]) ground.members[body] = static_cast<int>(i);
    }
  }
  return ground;
}

}  // namespace

std::vector<Sphere> lane_cover(const Body& body, double resolution) {
  if (!body.shape.fills_its_box()) return body.cover;
  Eigen::Vector3i counts = Eigen::Vector3i::Ones();
  while (counts.prod() < static_cast<int>(body.cover.size())) {
    const Eigen::Vector3d cell = body.shape.edges().cwiseQuotient(counts.cast<double>());
    const double stands_out = (cell.norm() - cell.minCoeff()) / 2;
    if (stands_out < most_excess * resolution) return cells_of(body, counts);
    int longest = 0;
    cell.maxCoeff(&longest);
    ++counts[longest];
  }
  return body.cover;
}

std::unique_ptr<const SphereRobot> sphere_robot(const Robot& robot, std::span<const BlockedBody> bodies,
                                                std::span<const BodyPair> pairs, double padding) {
  static LastMade<BareSphereRobot> last;
  const Fields fields(robot, bodies);
  const SphereGround ground = ground_of(robot, bodies, fields);
  const std::shared_ptr<const BareSphereRobot> spheres = last.get(
      [&](const BareSphereRobot& made) { return made.ground == ground && is_same(*made.robot.robot, robot); },
      [&] { return build_sphere_robot(std::make_shared<const Robot>(robot), ground, pairs); });
  if (!spheres->is_small || !spheres->is_covered || !(fields.size < largest_sphere_robot)) return nullptr;
  auto out = std::make_unique<SphereRobot>(spheres->robot);
  out->id = ++robots_made;
  out->fields = fields.fields;
  out->padding = static_cast<float>(padding * (1.0 + 2.0 * rounding_of_float));
  // Each frame's rotation and translation is rounded a dozen times, and so are values, sums and velocities.
  out->slack = static_cast<float>(64.0 * rounding_of_float * static_cast<double>(out->frames.size() + 2) *
                                  std::max({spheres->size, fields.size, 1e-3}));
  return out;
}

}  // namespace clearway
