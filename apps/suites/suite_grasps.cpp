#include <cmath>
#include <stdexcept>

#include "apps/suites/suite_cells.hpp"
#include "apps/suites/suite_draws.hpp"
#include "apps/suites/suite_furniture.hpp"
#include "apps/suites/suite_hand.hpp"
#include "apps/suites/suite_reaching.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/goal_configurations.hpp"

namespace clearway {
namespace {

constexpr int most_grasp_draws = 3000;  ///< in a scene, one after the other without a problem
constexpr int most_scenes = 10;
constexpr double widest_lean = 25.0 * degree;
constexpr double farthest_before = 0.08;  ///< of the arm's reach: the tip from the place

/// The shortest turn of z to a direction; straight down, half a turn about x. (Eigen's FromTwoVectors, bit
/// for bit, so that suites stay as they are, without its singular value decomposition, which takes the
/// compiler ten seconds.)
Eigen::Matrix3d turn_of_z(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d to = direction.normalized();
  if (to.z() < -1.0 + Eigen::NumTraits<double>::dummy_precision())
    return Eigen::Vector3d(1, -1, -1).asDiagonal();
  const double twice_cosine = std::sqrt(2.0 * (1.0 + to.z()));  // of half the angle
  const double share = 1.0 / twice_cosine;
  return Eigen::Quaterniond(0.5 * twice_cosine, -to.y() * share, to.x() * share, 0.0).toRotationMatrix();
}

/// Draws problems in one scene.
class GraspDrawer {
 public:
  GraspDrawer(const ConfigurationSpace& space, const std::vector<GraspPlace>& places, double reach,
              SuiteDice dice)
      : space_(space), places_(places), reach_(reach), dice_(dice), hand_(hand_at_tip(space.robot())) {
    if (hand_.axis != Eigen::Vector3d::UnitZ()) hand_from_tip_ = turn_of_z(hand_.axis).transpose();
    if (hand_.depth <= farthest_before * reach) hand_.depth = 0.0;  // the tip is at its end
  }

  std::optional<StageProblem> draw() {
    const int count = static_cast<int>(places_.size()), from = dice_.whole(0, count - 1);
    const Configuration anywhere = draw_configuration(space_.robot(), dice_);
    const auto start = is_carrying_ ? grasp(from, anywhere) : freely(anywhere);
    if (!start) return std::nullopt;
    for (int attempt = 0; attempt < 20; ++attempt) {
      const int to = (from + dice_.whole(1, count - 1)) % count;
      const auto goal = grasp(to, *start);
      if (!goal || (is_straight(*start, *goal) && dice_.whole(1, 10) > 1)) continue;
      is_carrying_ = !is_carrying_;
      return StageProblem{"", *start, {*goal}};
    }
    return std::nullopt;
  }

 private:
  std::optional<Configuration> freely(const Configuration& q) const {
    return space_.is_free(q) ? std::optional(q) : std::nullopt;
  }

  /// Whether the straight edge is free at 63 places: the draw must not depend on how edges are proved.
  bool is_straight(const Configuration& from, const Configuration& to) const {
    for (int i = 1; i < 64; ++i)
      if (!space_.is_free(from + i / 64.0 * (to - from))) return false;
    return true;
  }

  /// A free configuration with the hand at that place.
  std::optional<Configuration> grasp(int index, const Configuration& near) {
    const GraspPlace& place = places_[static_cast<std::size_t>(index)];
    const double lean = dice_.between(0.0, widest_lean), about = dice_.between(0.0, 360.0 * degree);
    const double roll = dice_.between(0.0, 360.0 * degree);
    const double before = reach_ * dice_.between(0.0, farthest_before);
    Eigen::Isometry3d map_from_tip = Eigen::Isometry3d::Identity();
    map_from_tip.linear() = turn_of_z(place.approach);
    map_from_tip = map_from_tip * Eigen::AngleAxisd(about, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
    map_from_tip.translation() = place.at - (hand_.depth + before) * map_from_tip.linear().col(2);
    map_from_tip.linear() *= hand_from_tip_;
    const auto q =
        inverse_kinematics(space_.robot(), map_from_tip, near, {.max_iterations = 60, .restarts = 1});
    return q ? freely(*q) : std::nullopt;
  }

  const ConfigurationSpace& space_;
  const std::vector<GraspPlace>& places_;
  double reach_;
  SuiteDice dice_;
  HandAtTip hand_;
  Eigen::Matrix3d hand_from_tip_ = Eigen::Matrix3d::Identity();  ///< the hand points along its z
  bool is_carrying_ = true;                                      ///< from place to place; else from anywhere
};

}  // namespace

void require_cells(const Robot& robot) {
  if (const std::size_t joints = joints_of_tip(robot); joints < 6)
    throw std::runtime_error("cells: robot '" + robot.name + "' has " + counted(joints, "joint") +
                             ", expected at least 6 to hold its hand as it likes");
}

FurnitureScene draw_cells(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                          const Policies& policies, double padding) {
  require_cells(robot);
  for (int attempt = 0;; ++attempt) {
    FurnitureScene scene = draw_furniture(robot, generator.seed, index, attempt);
    scene.map = map_of_solids(scene.solids, generator.resolution);
    const ConfigurationSpace space(robot, scene.map, policies, {.padding = padding});
    const std::uint64_t stream = 1000 * index + 500 + static_cast<std::uint64_t>(attempt);
    GraspDrawer drawer(space, scene.places, arm_reach(robot).length, SuiteDice(generator.seed, stream));
    try {
      scene.problems = draw_problems(generator, index, problems_of_furniture, most_grasp_draws, scene.name,
                                     space, [&] { return drawer.draw(); });
      return scene;
    } catch (const DrawnInVain&) {
      if (attempt + 1 == most_scenes) throw;
    }
  }
}

}  // namespace clearway
