#include "planning/batch/sphere_robot_build.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planning/batch/sphere_robot_pairs.hpp"
#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/turn_between.hpp"

namespace clearway {
namespace {

constexpr int spheres_per_cluster = 8;
constexpr std::size_t most_cores = 12;  ///< of a body

using FloatSphere = SphereRobot::FloatSphere;

/// A rotation that takes z to the axis.
Eigen::Matrix3d turned_to(const Eigen::Vector3d& axis) {
  return turn_between(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

void store(const Eigen::Matrix3d& rotation, float* rows) {
  for (int i = 0; i < 9; ++i) rows[i] = static_cast<float>(rotation(i / 3, i % 3));
}

Eigen::Vector3d center(const FloatSphere& sphere) { return {sphere.x, sphere.y, sphere.z}; }

/// Makes them step by step.
class Maker {
 public:
  Maker(std::shared_ptr<const Robot> robot, SphereGround ground, std::span<const BodyPair> pairs)
      : robot_(*robot), ground_(std::move(ground)), pairs_(pairs) {
    out_.robot = std::move(robot);
    out_.joints = robot_.dof();
    out_.members = ground_.field_of.size() + pairs.size();
    store(robot_.map_from_base.linear(), out_.base);
  }

  BareSphereRobot made() {
    place_frames();
    place_spheres();
    bound_levers();
    if (is_small_ && is_covered_) pair_spheres(out_, ground_, pairs_);
    return {std::move(ground_), std::move(out_), size_, is_small_, is_covered_};
  }

 private:
  void place_frames() {
    out_.frames.emplace_back();
    for (const Link& link : robot_.links) {
      const bool is_root = link.parent < 0;
      const Eigen::Isometry3d parent =
          is_root ? Eigen::Isometry3d::Identity() : frame_from_link_[static_cast<std::size_t>(link.parent)];
      const int parent_frame = is_root ? 0 : frame_of_link_[static_cast<std::size_t>(link.parent)];
      const Eigen::Isometry3d here = parent * link.parent_from_link;
      if (link.joint < 0) {
        frame_from_link_.push_back(here);
        frame_of_link_.push_back(parent_frame);
        continue;
      }
      const Eigen::Matrix3d turned = turned_to(axis_of(robot_, link));
      SphereRobot::Frame frame;
      frame.parent = parent_frame;
      frame.joint = link.joint;
      frame.turns = kind_of(robot_, link) == JointKind::revolute;
      frame.multiplier = link.multiplier;
      frame.offset = link.offset;
      out_.steepest = std::max(out_.steepest, std::abs(link.multiplier));
      out_.farthest_offset = std::max(out_.farthest_offset, std::abs(link.offset));
      store(here.linear() * turned, frame.rotation);
      for (int i = 0; i < 3; ++i) frame.translation[i] = static_cast<float>(here.translation()[i]);
      frame_of_link_.push_back(static_cast<int>(out_.frames.size()));
      Eigen::Isometry3d own = Eigen::Isometry3d::Identity();
      own.linear() = turned.transpose();
      frame_from_link_.push_back(own);
      out_.frames.push_back(frame);
    }
  }

  void place_spheres() {
    const std::size_t count = robot_.bodies.size();
    const std::vector<int>& members = ground_.members;
    std::vector<int> order(count);
    const auto frame = [&](int body) {
      return frame_of_link_[static_cast<std::size_t>(robot_.bodies[static_cast<std::size_t>(body)].link)];
    };
    const auto field = [&](int body) {
      const int member = members[static_cast<std::size_t>(body)];
      return member < 0 ? -1 : ground_.field_of[static_cast<std::size_t>(member)];
    };
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return std::pair(frame(a), field(a)) < std::pair(frame(b), field(b));
    });
    out_.bodies.resize(count);
    out_.body_bounds.resize(count);
    for (const int body : order)
      add(static_cast<std::size_t>(body), frame(body), members[static_cast<std::size_t>(body)]);
    group(ground_.field_of);
    for (std::size_t i = 0; i < out_.frames.size(); ++i) {
      const auto first = std::lower_bound(out_.frame_of.begin(), out_.frame_of.end(), static_cast<int>(i));
      const auto last = std::upper_bound(first, out_.frame_of.end(), static_cast<int>(i));
      out_.bounds.push_back(
          sphere_around(std::span(out_.spheres)
                            .subspan(static_cast<std::size_t>(first - out_.frame_of.begin()),
                                     static_cast<std::size_t>(last - first))));
    }
  }

  void add(std::size_t index, int frame, int member) {
    const Body& body = robot_.bodies[index];
    const std::vector<Sphere> cover = lane_cover(body, ground_.resolution);
    is_covered_ = is_covered_ && !cover.empty();
    const Eigen::Isometry3d& frame_from_link = frame_from_link_[static_cast<std::size_t>(body.link)];
    const Eigen::Isometry3d shape_from_link = body.link_from_shape.inverse();
    const int first = static_cast<int>(out_.spheres.size());
    std::optional<HullPlanes> planes;
    if (!body.shape.has_exact_distance()) planes.emplace(body.shape.surface());
    for (const Sphere& sphere : cover) {
      const Eigen::Vector3f at = (frame_from_link * sphere.center).cast<float>();
      out_.spheres.push_back(
          {at.x(), at.y(), at.z(), static_cast<float>(sphere.radius * (1.0 + 2.0 * rounding_of_float))});
      out_.member.push_back(member);
      out_.frame_of.push_back(frame);
      const Eigen::Vector3d point = shape_from_link * sphere.center;
      const double inner = planes ? planes->inner_radius(point) : -body.shape.signed_distance(point);
      out_.inner.push_back(static_cast<float>(inner * (1.0 - 2.0 * rounding_of_float)));
    }
    const int last = static_cast<int>(out_.spheres.size());
    out_.body_bounds[index] = sphere_around(spheres_of({first, last}));
    out_.bodies[index].first = static_cast<int>(out_.clusters.size());
    for (int sphere = first; sphere < last; sphere += spheres_per_cluster) {
      const int end = std::min(sphere + spheres_per_cluster, last);
      out_.clusters.push_back({sphere, end, sphere_around(spheres_of({sphere, end}))});
    }
    out_.bodies[index].last = static_cast<int>(out_.clusters.size());
  }

  std::span<const FloatSphere> spheres_of(const SphereRobot::Range& range) const {
    return std::span(out_.spheres)
        .subspan(static_cast<std::size_t>(range.first), static_cast<std::size_t>(range.last - range.first));
  }

  void group(const std::vector<int>& field_of) {
    const auto field = [&](int sphere) {
      const int member = out_.member[static_cast<std::size_t>(sphere)];
      return member < 0 ? -1 : field_of[static_cast<std::size_t>(member)];
    };
    const auto frame = [&](int sphere) { return out_.frame_of[static_cast<std::size_t>(sphere)]; };
    const auto sphere = [&](int cluster) { return out_.clusters[static_cast<std::size_t>(cluster)].first; };
    const int count = static_cast<int>(out_.clusters.size());
    for (int first = 0, last = 0; first < count; first = last) {
      const int of = sphere(first);
      while (last < count && frame(sphere(last)) == frame(of) && field(sphere(last)) == field(of)) ++last;
      if (field(of) < 0) continue;
      const int end = out_.clusters[static_cast<std::size_t>(last - 1)].last;
      out_.groups.push_back({frame(of), field(of), first, last, sphere_around(spheres_of({of, end})), 0, 0});
    }
    std::reverse(out_.groups.begin(), out_.groups.end());
    for (SphereRobot::Group& group : out_.groups) add_cores(group);
  }

  /// Of each body of the group the largest spheres that lie in it, none with its middle near that of another.
  void add_cores(SphereRobot::Group& group) {
    group.first_core = static_cast<int>(out_.cores.size());
    const int first = out_.clusters[static_cast<std::size_t>(group.first)].first;
    const int last = out_.clusters[static_cast<std::size_t>(group.last - 1)].last;
    const auto member = [&](int sphere) { return out_.member[static_cast<std::size_t>(sphere)]; };
    for (int sphere = first, end = first; sphere < last; sphere = end) {
      while (end < last && member(end) == member(sphere)) ++end;
      std::vector<int> inside(static_cast<std::size_t>(end - sphere));
      std::iota(inside.begin(), inside.end(), sphere);
      const auto inner = [&](int i) { return out_.inner[static_cast<std::size_t>(i)]; };
      std::stable_sort(inside.begin(), inside.end(), [&](int a, int b) { return inner(a) > inner(b); });
      const std::size_t known = out_.cores.size();
      for (const int i : inside) {
        if (!(inner(i) > 0.0F) || out_.cores.size() == known + most_cores) break;
        FloatSphere core = out_.spheres[static_cast<std::size_t>(i)];
        core.radius = inner(i);
        const bool is_known =
            std::any_of(out_.cores.begin() + static_cast<std::ptrdiff_t>(known), out_.cores.end(),
                        [&](const FloatSphere& other) {
                          return (center(core) - center(other)).norm() < 0.5F * other.radius;
                        });
        if (!is_known) out_.cores.push_back(core);
      }
    }
    group.last_core = static_cast<int>(out_.cores.size());
  }

  /// How far what slides on a link of this frame may be from where it is at 0, metres.
  double travel(const SphereRobot::Frame& frame) const {
    if (frame.turns || frame.joint < 0) return 0.0;
    const Joint& joint = robot_.joints[static_cast<std::size_t>(frame.joint)];
    return std::max(std::abs(frame.multiplier * joint.lower + frame.offset),
                    std::abs(frame.multiplier * joint.upper + frame.offset));
  }

  /// Of each frame how far the middle of any sphere, or of a sphere around some, is from its origin, metres.
  std::vector<double> farthest_middles() const {
    std::vector<double> farthest(out_.frames.size(), 0.0);
    const auto extend = [&](int frame, const FloatSphere& sphere) {
      double& most = farthest[static_cast<std::size_t>(frame)];
      most = std::max(most, center(sphere).norm());
    };
    for (std::size_t i = 0; i < out_.spheres.size(); ++i) extend(out_.frame_of[i], out_.spheres[i]);
    for (const SphereRobot::Group& group : out_.groups) extend(group.frame, group.bound);
    for (const SphereRobot::Cluster& cluster : out_.clusters)
      extend(out_.frame_of[static_cast<std::size_t>(cluster.first)], cluster.bound);
    for (std::size_t i = 0; i < out_.bodies.size(); ++i) {
      if (out_.bodies[i].first == out_.bodies[i].last) continue;
      const SphereRobot::Cluster& first = out_.clusters[static_cast<std::size_t>(out_.bodies[i].first)];
      extend(out_.frame_of[static_cast<std::size_t>(first.first)], out_.body_bounds[i]);
    }
    for (std::size_t i = 0; i < farthest.size(); ++i) extend(static_cast<int>(i), out_.bounds[i]);
    return farthest;
  }

  void bound_levers() {
    const std::size_t count = out_.frames.size();
    const std::vector<double> farthest = farthest_middles();
    out_.lever.assign(count * count, 0.0F);
    for (std::size_t frame = 0; frame < count; ++frame) {
      double length = farthest[frame];
      for (int mover = static_cast<int>(frame); mover >= 0;
           mover = out_.frames[static_cast<std::size_t>(mover)].parent) {
        const SphereRobot::Frame& at = out_.frames[static_cast<std::size_t>(mover)];
        length += travel(at);
        out_.lever[frame * count + static_cast<std::size_t>(mover)] =
            at.turns ? static_cast<float>(length * (1.0 + 1e-6)) : 1.0F;
        length += Eigen::Map<const Eigen::Vector3f>(at.translation).cast<double>().norm();
      }
      length += std::max(0.0F, out_.bounds[frame].radius);
      size_ = std::max(size_, length);
      is_small_ = is_small_ && length < largest_sphere_robot &&
                  size_ < largest_sphere_robot;  // false for what is no number
    }
  }

  const Robot& robot_;
  SphereGround ground_;
  std::span<const BodyPair> pairs_;
  SphereRobot out_;
  std::vector<Eigen::Isometry3d> frame_from_link_;
  std::vector<int> frame_of_link_;
  double size_ = 0.0;       ///< no coordinate is larger, metres
  bool is_small_ = true;    ///< nor larger than is of use
  bool is_covered_ = true;  ///< all bodies, by spheres
};

}  // namespace

BareSphereRobot build_sphere_robot(std::shared_ptr<const Robot> robot, SphereGround ground,
                                   std::span<const BodyPair> pairs) {
  return Maker(std::move(robot), std::move(ground), pairs).made();
}

}  // namespace clearway
