#include "planning/batch/sphere_robot.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>

#include "mapping/field/byte_field.hpp"
#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/turn_between.hpp"
#include "planning/robot/same_robot.hpp"

namespace clearway {
namespace {

constexpr double largest_length = 100.0;  ///< metres; there rounding takes some mm from what can be proved
constexpr double rounding_of_float = 6e-8;
constexpr int spheres_per_cluster = 8;
constexpr std::size_t most_cores = 12;  ///< of a body
constexpr double most_excess = 0.25;    ///< voxels that spheres may stand out of a small box

using FloatSphere = SphereRobot::FloatSphere;

std::atomic<std::uint64_t> robots_made = 0;

/// A rotation that takes z to the axis.
Eigen::Matrix3d turned_to(const Eigen::Vector3d& axis) {
  return turn_between(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

void store(const Eigen::Matrix3d& rotation, float* rows) {
  for (int i = 0; i < 9; ++i) rows[i] = static_cast<float>(rotation(i / 3, i % 3));
}

Eigen::Vector3d center(const FloatSphere& sphere) { return {sphere.x, sphere.y, sphere.z}; }

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

/// What the spheres of a robot depend on but for where the map is.
struct Ground {
  std::vector<int> members;   ///< of each body of the robot: which of those that the map can block; -1: none
  std::vector<int> field_of;  ///< of each of these: which field it is looked up in
  double resolution = 0.0;    ///< of the map, metres
  std::vector<std::size_t> covers;  ///< how many spheres cover each body at that resolution
  bool operator==(const Ground& other) const {
    return members == other.members && field_of == other.field_of && covers == other.covers;
  }
};

/// Spheres without fields and padding.
struct Spheres {
  Ground ground;
  SphereRobot robot;
  double size = 0.0;       ///< no coordinate of the robot is larger, metres
  bool is_small = true;    ///< nor larger than is of use
  bool is_covered = true;  ///< all bodies, by spheres
};

/// Makes them step by step.
class Maker {
 public:
  Maker(std::shared_ptr<const Robot> robot, Ground ground, std::span<const BodyPair> pairs)
      : robot_(*robot), ground_(std::move(ground)), pairs_(pairs) {
    out_.robot = std::move(robot);
    out_.joints = robot_.dof();
    out_.members = ground_.field_of.size() + pairs.size();
    store(robot_.map_from_base.linear(), out_.base);
  }

  Spheres made() {
    place_frames();
    place_spheres();
    bound_levers();
    if (is_small_ && is_covered_) {
      pair_up();
      grow_trees();
    }
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
      const Joint& joint = robot_.joints[static_cast<std::size_t>(link.joint)];
      const Eigen::Matrix3d turned = turned_to(joint.axis);
      SphereRobot::Frame frame;
      frame.parent = parent_frame;
      frame.joint = link.joint;
      frame.turns = joint.kind == JointKind::revolute;
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
    if (!body.shape.has_exact_distance()) planes.emplace(body.shape.vertices());
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
      is_small_ =
          is_small_ && length < largest_length && size_ < largest_length;  // false for what is no number
    }
  }

  int meeting(int a, int b) const {
    while (a != b) {  // parents come first
      int& later = a > b ? a : b;
      later = out_.frames[static_cast<std::size_t>(later)].parent;
    }
    return a;
  }

  void pair_up() {
    struct FramePair {
      SphereRobot::Pair pair;
      int a, b;
    };
    std::vector<FramePair> all;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      SphereRobot::Pair pair{pairs_[i].first, pairs_[i].second,
                             static_cast<int>(ground_.field_of.size() + i)};
      const auto frame = [&](int body) {
        return frame_of_link_[static_cast<std::size_t>(robot_.bodies[static_cast<std::size_t>(body)].link)];
      };
      if (frame(pair.a) < frame(pair.b)) std::swap(pair.a, pair.b);
      all.push_back({pair, frame(pair.a), frame(pair.b)});
    }
    std::stable_sort(all.begin(), all.end(), [](const FramePair& x, const FramePair& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    for (const FramePair& entry : all) {
      const int index = static_cast<int>(out_.body_pairs.size());
      if (out_.frame_pairs.empty() || out_.frame_pairs.back().a != entry.a ||
          out_.frame_pairs.back().b != entry.b)
        out_.frame_pairs.push_back({entry.a, entry.b, meeting(entry.a, entry.b), index, index, nullptr});
      ++out_.frame_pairs.back().last;
      out_.body_pairs.push_back(entry.pair);
    }
  }

  /// The spheres in trees: one for each frame and field, the last frames first.
  void grow_trees() {
    std::vector<int> body_of(out_.clusters.size());
    for (std::size_t body = 0; body < out_.bodies.size(); ++body) {
      for (int i = out_.bodies[body].first; i < out_.bodies[body].last; ++i)
        body_of[static_cast<std::size_t>(i)] = static_cast<int>(body);
    }
    std::vector<std::vector<BallTree::Leaf>> leaves;  // of each branch
    for (std::size_t i = out_.clusters.size(); i-- > 0;) {
      const SphereRobot::Cluster& cluster = out_.clusters[i];
      for (int k = cluster.first; k < cluster.last; ++k) {
        const auto sphere = static_cast<std::size_t>(k);
        const std::size_t branch = branch_of(sphere);
        if (branch == leaves.size()) leaves.emplace_back();
        leaves[branch].push_back({out_.spheres[sphere], out_.inner[sphere], body_of[i], out_.member[sphere]});
      }
    }
    for (std::size_t i = 0; i < leaves.size(); ++i) out_.branches[i].root = out_.tree.add(leaves[i]);
    pair_branches();
  }

  /// Of each two branches that hold bodies of a pair, and which pair two bodies are.
  void pair_branches() {
    const std::size_t count = out_.bodies.size();
    out_.pair_member.assign(count * count, -1);
    std::vector<std::size_t> branches(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto cluster = static_cast<std::size_t>(out_.bodies[i].first);
      branches[i] = branch_of(static_cast<std::size_t>(out_.clusters[cluster].first));
    }
    std::vector<std::vector<BodyPair>> bodies;  // of each pair of branches
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto a = static_cast<std::size_t>(pairs_[i].first),
                 b = static_cast<std::size_t>(pairs_[i].second);
      out_.pair_member[a * count + b] = out_.pair_member[b * count + a] =
          static_cast<int>(ground_.field_of.size() + i);
      const int first = static_cast<int>(std::max(branches[a], branches[b]));
      const int second = static_cast<int>(std::min(branches[a], branches[b]));
      std::size_t known = 0;
      while (known < bodies.size() &&
             (out_.branch_pairs[known].a != first || out_.branch_pairs[known].b != second))
        ++known;
      if (known == bodies.size()) {
        bodies.emplace_back();
        out_.branch_pairs.push_back({first, second, nullptr});
      }
      bodies[known].push_back(pairs_[i]);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i)
      out_.branch_pairs[i].table = PairTable::of(robot_, std::move(bodies[i]));
    share_tables();
  }

  /// Two frames that are one branch each have the table of these.
  void share_tables() {
    const auto branches_at = [&](int frame) {
      return std::count_if(out_.branches.begin(), out_.branches.end(),
                           [&](const SphereRobot::Branch& branch) { return branch.frame == frame; });
    };
    for (const SphereRobot::BranchPair& pair : out_.branch_pairs) {
      const int a = out_.branches[static_cast<std::size_t>(pair.a)].frame;
      const int b = out_.branches[static_cast<std::size_t>(pair.b)].frame;
      if (branches_at(a) != 1 || branches_at(b) != 1) continue;
      for (SphereRobot::FramePair& frames : out_.frame_pairs) {
        if (std::minmax({frames.a, frames.b}) == std::minmax({a, b})) frames.table = pair.table;
      }
    }
  }

  std::size_t branch_of(std::size_t sphere) {
    const int frame = out_.frame_of[sphere], member = out_.member[sphere];
    const int field = member < 0 ? -1 : ground_.field_of[static_cast<std::size_t>(member)];
    std::size_t i = 0;
    while (i < out_.branches.size() && (out_.branches[i].frame != frame || out_.branches[i].field != field))
      ++i;
    if (i == out_.branches.size()) out_.branches.push_back({frame, field, 0});
    return i;
  }

  const Robot& robot_;
  Ground ground_;
  std::span<const BodyPair> pairs_;
  SphereRobot out_;
  std::vector<Eigen::Isometry3d> frame_from_link_;
  std::vector<int> frame_of_link_;
  double size_ = 0.0;       ///< no coordinate is larger, metres
  bool is_small_ = true;    ///< nor larger than is of use
  bool is_covered_ = true;  ///< all bodies, by spheres
};

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

namespace {

/// Those made last, in this process.
class MadeSpheres {
 public:
  std::shared_ptr<const Spheres> of(const Robot& robot, const Ground& ground,
                                    std::span<const BodyPair> pairs) {
    if (auto known = find(robot, ground)) return known;
    auto made =
        std::make_shared<const Spheres>(Maker(std::make_shared<const Robot>(robot), ground, pairs).made());
    const std::lock_guard lock(mutex_);
    made_.insert(made_.begin(), made);
    if (made_.size() > most) made_.pop_back();
    return made;
  }

 private:
  static constexpr std::size_t most = 8;

  std::shared_ptr<const Spheres> find(const Robot& robot, const Ground& ground) {
    const std::lock_guard lock(mutex_);
    const auto known = std::find_if(made_.begin(), made_.end(), [&](const auto& spheres) {
      return spheres->ground == ground && is_same(*spheres->robot.robot, robot);
    });
    if (known == made_.end()) return nullptr;
    std::rotate(made_.begin(), known, known + 1);
    return made_.front();
  }

  std::mutex mutex_;
  std::vector<std::shared_ptr<const Spheres>> made_;  ///< the last asked for first
};

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

Ground ground_of(const Robot& robot, std::span<const BlockedBody> bodies, const Fields& fields) {
  Ground ground{std::vector<int>(robot.bodies.size(), -1),
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

std::unique_ptr<const SphereRobot> sphere_robot(const Robot& robot, std::span<const BlockedBody> bodies,
                                                std::span<const BodyPair> pairs, double padding) {
  static MadeSpheres made;
  const Fields fields(robot, bodies);
  const std::shared_ptr<const Spheres> spheres = made.of(robot, ground_of(robot, bodies, fields), pairs);
  if (!spheres->is_small || !spheres->is_covered || !(fields.size < largest_length)) return nullptr;
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
