#include "apps/overlay/plan_pictures.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "mapping/system/parallel.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/planned_motion.hpp"

namespace clearway {
namespace {

void add_timed(const Trajectory& trajectory, DrawnMotion& motion) {
  for (const TrajectoryPoint& point : trajectory.points) motion.positions.push_back(point.position);
  motion.period = trajectory.sampling_period;
}

/// Leg by leg where loads change from one to the next.
void add_timed_legs(const Robot& robot, const Plan& plan, DrawnMotion& motion) {
  const std::vector<Trajectory> legs = leg_trajectories(robot, plan);
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    add_timed(legs[leg], motion);
    motion.legs.resize(motion.positions.size(), leg);
  }
}

/// How far the robot is from what is blocked, with what it carries on the leg.
class LegClearance {
 public:
  explicit LegClearance(const ReplayPlan& entry) : entry_(entry) {}

  double at(const Configuration& q, std::size_t leg) {
    if (entry_.plan.loads.empty()) return entry_.space->clearance(q);
    auto& space = spaces_[leg];
    const ConfigurationSpace& bare = *entry_.space;
    if (!space)
      space = std::make_unique<ConfigurationSpace>(
          robot_of_leg(bare.robot(), entry_.plan.loads, static_cast<int>(leg)), bare.map(),
          Policies{.parts = bare.policies(), .other = Policy::not_occupied}, bare.options());
    return space->clearance(q);
  }

 private:
  const ReplayPlan& entry_;
  std::map<std::size_t, std::unique_ptr<ConfigurationSpace>> spaces_;
};

/// What rides on a leg, in the hand that is drawn.
void add_loads(OverlayScene& scene, const ReplayPlan& entry, std::size_t leg, const LinkPoses& poses,
               OverlayLoad::Holder holder) {
  const std::vector<Link>& links = entry.space->robot().links;
  for (const LegLoad& load : entry.plan.loads)
    for (std::size_t i = 0; i < links.size() && load.rides_on(static_cast<int>(leg)); ++i)
      if (links[i].name == load.load.link)
        scene.loads.push_back({mesh_of(load.load.shape), poses[i] * load.load.link_from_load, holder});
}

/// What is picked, before it is lifted and after it is put down.
void add_standing(OverlayScene& scene, const ReplayPlan& entry, std::size_t leg) {
  constexpr int lift = 2, lower = 4;  // as Pick lists its legs
  if (!entry.plan.pick || (leg >= lift && leg <= lower)) return;
  const Pick& pick = *entry.plan.pick;
  scene.loads.push_back({mesh_of(pick.object.shape), leg < lift ? pick.map_from_object : pick.map_from_place,
                         OverlayLoad::Holder::none});
}

void show_start(OverlayScene& scene, const ReplayPlan& entry, const Configuration& q) {
  scene.start_pose = forward_kinematics(entry.space->robot(), q);
  scene.start_tip = tip_pose(entry.space->robot(), q).translation();
  add_loads(scene, entry, 0, scene.start_pose, OverlayLoad::Holder::start);
}

void show_goal(OverlayScene& scene, const ReplayPlan& entry, const Configuration& q) {
  scene.goal_pose = forward_kinematics(entry.space->robot(), q);
  scene.goal_tip = tip_pose(entry.space->robot(), q).translation();
  const std::size_t legs = std::max(entry.plan.goals.size(), entry.plan.legs.size());
  add_loads(scene, entry, legs == 0 ? 0 : legs - 1, scene.goal_pose, OverlayLoad::Holder::goal);
}

/// Of a pick the check says where it is tightest: what touches what at the object is no distance to others.
std::size_t tightest_of_pick(const Plan& plan, const std::vector<Configuration>& positions) {
  const std::vector<Configuration> waypoints = plan.waypoints();
  const std::vector<double>& clearance = plan.validation.clearance;
  if (clearance.size() != waypoints.size() || waypoints.empty()) return 0;
  const Configuration& q = waypoints[static_cast<std::size_t>(
      std::min_element(clearance.begin(), clearance.end()) - clearance.begin())];
  const auto nearest = std::min_element(positions.begin(), positions.end(),
                                        [&](const Configuration& a, const Configuration& b) {
                                          return (a - q).squaredNorm() < (b - q).squaredNorm();
                                        });
  return static_cast<std::size_t>(nearest - positions.begin());
}

}  // namespace

DrawnMotion drawn_motion(const ReplayPlan& entry) {
  const Robot& robot = entry.space->robot();
  DrawnMotion motion;
  try {
    if (entry.plan.loads.empty())
      add_timed(trajectory_of(robot, entry.plan), motion);
    else
      add_timed_legs(robot, entry.plan, motion);
  } catch (const std::invalid_argument&) {  // too long to be given time
    motion.positions = entry.plan.waypoints();
    motion.legs.clear();
    motion.period = 0.1;
  }
  LegClearance clearances(entry);
  constexpr std::size_t shown = 240;
  const std::size_t last = motion.positions.size() - 1, pieces = std::min(last, shown);
  for (std::size_t i = 0; i <= pieces; ++i) {
    const std::size_t at = pieces == 0 ? 0 : i * last / pieces;
    const double clearance = clearances.at(motion.positions[at], motion.legs.empty() ? 0 : motion.legs[at]) +
                             entry.space->options().padding;  // as plans have it
    motion.path.points.push_back(tip_pose(robot, motion.positions[at]).translation());
    motion.path.clearance.push_back(clearance);
    if (i > 0 && !(clearance < motion.least_clearance)) continue;
    motion.least_clearance = clearance;
    motion.tightest = at;
  }
  if (entry.plan.pick) motion.tightest = tightest_of_pick(entry.plan, motion.positions);
  return motion;
}

cv::Mat PlanPictures::solved(const ReplayPlan& entry, const DrawnMotion& motion, std::size_t at,
                             const std::string& moment) {
  OverlayScene scene = scene_of(entry);
  scene.robot_pose = forward_kinematics(entry.space->robot(), motion.positions[at]);
  scene.path = motion.path;
  if (!motion.legs.empty())
    add_loads(scene, entry, motion.legs[at], scene.robot_pose, OverlayLoad::Holder::hand);
  if (!motion.legs.empty()) add_standing(scene, entry, motion.legs[at]);
  const std::size_t last = motion.positions.size() - 1;
  if (at != 0) show_start(scene, entry, motion.positions.front());
  if (at != last) show_goal(scene, entry, motion.positions.back());
  scene.strip = Strip{entry.query + ", " + entry.plan.planner + ": " + moment, "", "", "", 0.0};
  return draw(scene);
}

cv::Mat PlanPictures::painted(const Snapshot& map) const {
  OverlayScene scene;
  scene.map = &map_;
  std::size_t balls = 0;
  for (const PaintedVolume& volume : map.volumes()) balls += volume.spheres.size();
  scene.strip = Strip{
      counted(balls, "ball") + " painted, " + counted(map.counts().conflict, "voxel") + " of them occupied",
      "", "", "", 0.0};
  return draw(scene);
}

cv::Mat PlanPictures::failed(const ReplayPlan& entry) {
  OverlayScene scene = scene_of(entry);
  show_start(scene, entry, entry.start);
  add_standing(scene, entry, 0);
  if (!entry.plan.goals.empty()) show_goal(scene, entry, entry.plan.goals.back());
  for (const PaintHint& hint : entry.plan.paint) scene.to_paint.push_back(hint.sphere);
  const bool is_refused = entry.plan.status() == PlanStatus::solved;
  const std::string cure = PaintAdvice{entry.plan.paint}.sentence();
  std::string why = is_refused ? entry.plan.validation.first_contact : entry.plan.explanation();
  if (const std::size_t at = why.find(cure); !cure.empty() && at != std::string::npos)
    why.erase(at);  // it stands below
  scene.strip = Strip{entry.query + ", " + entry.plan.planner + ": " +
                          (is_refused ? "refused by the check" : std::string(to_string(entry.plan.status()))),
                      why,
                      cure,
                      "",
                      0.0,
                      5};  // nobody waits for this picture
  return draw(scene);
}

OverlayScene PlanPictures::scene_of(const ReplayPlan& entry) {
  OverlayScene scene;
  scene.map = &map_;
  scene.robot = &surfaces_.try_emplace(entry.space, entry.space->robot()).first->second;
  return scene;
}

cv::Mat PlanPictures::draw(const OverlayScene& scene) const {
  return draw_overlay(view_.image, view_.camera, view_.camera_from_map, scene, thread_count());
}

}  // namespace clearway
