#include "apps/pages/map_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "apps/console/parse.hpp"
#include "apps/pages/drawn_voxels.hpp"
#include "apps/pages/plan_motion.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "planning/path/path_origins.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot/self_collision.hpp"

namespace clearway {

namespace {

/// Of a path of very many small steps an even choice, ends included.
std::vector<Configuration> thinned(std::vector<Configuration> path) {
  constexpr std::size_t most = 600;
  if (path.size() <= most) return path;
  std::vector<Configuration> chosen;
  for (std::size_t i = 0; i < most; ++i) chosen.push_back(path[i * (path.size() - 1) / (most - 1)]);
  return chosen;
}

/// The least distance of two bodies of the robot that are not exempt from each other, as far as plots show
/// any; not a number for a robot without such bodies.
double between_bodies(const Robot& robot, const std::vector<BodyPair>& pairs, const Configuration& q) {
  constexpr double most = 0.5;  // m, of a robot of usual size
  if (pairs.empty()) return std::numeric_limits<double>::quiet_NaN();
  const LinkPoses poses = forward_kinematics(robot, q);
  double least = most * robot.scale;
  for (const BodyPair& pair : pairs)
    if (!is_apart(robot, pair, poses, least))
      least = std::min(least, pair_distance(robot, pair, poses).lower);
  return least;
}

/// The path with configurations inserted so that no joint moves more than the page can interpolate.
std::vector<Configuration> subdivided(const std::vector<Configuration>& path, const Robot& robot) {
  std::vector<Configuration> dense;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    double pieces = 1.0;
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto index = static_cast<Eigen::Index>(j);
      const double most = robot.joints[j].kind == JointKind::revolute ? 0.052 : 0.02;
      pieces = std::max(pieces, std::ceil(std::abs(path[i + 1][index] - path[i][index]) / most));
    }
    for (double piece = 0.0; piece < pieces; piece += 1.0) {
      dense.push_back(path[i] + (path[i + 1] - path[i]) * (piece / pieces));
    }
  }
  if (!path.empty()) dense.push_back(path.back());
  return dense;
}

/// Of each leg the waypoint of the page at which it ends: of a motion the first that is shown from its knot
/// on, else the one nearest to the plan's.
std::vector<std::size_t> ends_of_legs(const Plan& plan, const std::vector<Configuration>& waypoints,
                                      const std::vector<std::size_t>& shown) {
  std::vector<std::size_t> ends;
  if (plan.motion && !shown.empty()) {
    for (const std::size_t knot : plan.motion->leg_ends)
      ends.push_back(
          static_cast<std::size_t>(std::lower_bound(shown.begin(), shown.end(), knot) - shown.begin()));
    return ends;
  }
  std::size_t from = 0;
  for (const PlanResult& leg : plan.legs) {
    if (leg.waypoints.empty()) break;
    std::size_t best = from;
    for (std::size_t i = from; i < waypoints.size(); ++i)
      if ((waypoints[i] - leg.waypoints.back()).norm() < (waypoints[best] - leg.waypoints.back()).norm())
        best = i;
    ends.push_back(best);
    from = best;
  }
  return ends;
}

/// A load that rides on some legs rests before and after them where it is taken and put down.
void rest_loads(const Plan& plan, std::size_t first_link, const std::vector<std::size_t>& shown,
                PagePlan& page) {
  const std::vector<std::size_t> ends = ends_of_legs(plan, page.waypoints, shown);
  if (ends.empty()) return;
  for (std::size_t i = 0; i < plan.loads.size(); ++i) {
    const std::vector<int>& legs = plan.loads[i].legs;
    if (legs.empty()) continue;
    const auto [first, last] = std::minmax_element(legs.begin(), legs.end());
    const auto end_of = [&](int leg) {
      return leg < 0 ? std::size_t{0} : ends[std::min(static_cast<std::size_t>(leg), ends.size() - 1)];
    };
    const std::size_t link = first_link + i, taken = end_of(*first - 1), put = end_of(*last);
    const Eigen::Isometry3d before = page.link_poses[taken][link], after = page.link_poses[put][link];
    for (std::size_t k = 0; k < page.link_poses.size(); ++k)
      if (k < taken || k > put) page.link_poses[k][link] = k < taken ? before : after;
    if (*first > 0) page.start_poses[link] = before;
    if (!page.goal_poses.empty()) page.goal_poses[link] = after;
  }
}

/// Separation where loads ride: on each leg of the robot with its own.
void separate_loaded(const Plan& plan, const ConfigurationSpace& space, const std::vector<std::size_t>& shown,
                     PagePlan& page) {
  const std::vector<std::size_t> ends = ends_of_legs(plan, page.waypoints, shown);
  std::size_t next = 0;
  for (std::size_t leg = 0; leg < ends.size(); ++leg) {
    Policies policies{.parts = space.policies(), .other = Policy::not_occupied};
    for (const LegLoad& load : plan.loads)
      if (const auto own = plan.policies.find(load.load.name);
          load.rides_on(static_cast<int>(leg)) && own != plan.policies.end())
        policies.parts.insert(*own);
    const ConfigurationSpace loaded(robot_of_leg(space.robot(), plan.loads, static_cast<int>(leg)),
                                    space.map(), policies, space.options());
    const std::vector<BodyPair> pairs = self_collision_pairs(loaded.robot());
    for (; next < page.waypoints.size() && (next <= ends[leg] || leg + 1 == ends.size()); ++next) {
      page.clearance.push_back(loaded.clearance(page.waypoints[next]));
      page.between_bodies.push_back(between_bodies(loaded.robot(), pairs, page.waypoints[next]));
    }
  }
}

/// A phase and what is followed in it, in the words of the page's legend.
std::string words_of(const WaypointOrigin& origin) {
  switch (origin.phase) {
    case PathPhase::free_motion:
      return "free motion";
    case PathPhase::boundary:
      return "boundary" + (origin.constraint.empty() ? "" : ": " + origin.constraint);
    case PathPhase::start_tree:
      return "tree from the start";
    case PathPhase::goal_tree:
      return "tree from the goal";
    case PathPhase::lattice:
      return "step of the beam";
    case PathPhase::last_segment:
      return "last segment";
    case PathPhase::shortened:
      return "shortcut";
    case PathPhase::unknown:
      break;
  }
  return "not known";
}

/// How the planner got to each waypoint of the page, by those of the path that lie ahead.
void show_origins(PagePlan& page, const std::vector<Configuration>& path,
                  const std::vector<WaypointOrigin>& origins) {
  const bool is_known = std::any_of(origins.begin(), origins.end(), [](const WaypointOrigin& origin) {
    return origin.phase != PathPhase::unknown;
  });
  if (!is_known || path.size() != origins.size() || path.size() < 2) return;
  for (const std::size_t ahead : waypoints_ahead(path, page.waypoints)) {
    const std::string words = words_of(origins[ahead]);
    const auto found = std::find(page.phase_names.begin(), page.phase_names.end(), words);
    page.phases.push_back(static_cast<int>(found - page.phase_names.begin()));
    if (found == page.phase_names.end()) page.phase_names.push_back(words);
    page.search_steps.push_back(origins[ahead].search_step);
  }
}

}  // namespace

PageShape page_shape(const Shape& s) {
  PageShape shape;
  const std::vector<double> sizes = s.sizes();
  std::copy(sizes.begin(), sizes.end(), shape.size.begin());
  if (!sizes.empty()) {
    shape.kind = s.name();
  } else {
    ShapeSurface surface = s.surface();
    shape.kind = PageShape::mesh;
    shape.vertices = std::move(surface.corners);
    shape.triangles = std::move(surface.triangles);
  }
  return shape;
}

namespace {

/// Whether the middle of a leaf lies outside of a box that is not empty.
bool is_beyond(const MapLeaf& leaf, double resolution, const Eigen::AlignedBox3d& box) {
  return !box.isEmpty() &&
         !box.contains((resolution * (leaf.corner.cast<double>().array() + 0.5 * leaf.edge)).matrix());
}

}  // namespace

ReportPage page_of_map(const MapLeaves& map, const std::string& title, bool is_whole) {
  ReportPage page;
  page.title = title;
  page.resolution = map.resolution();
  if (!is_whole && map.main_bounds().volume() < map.bounds().volume()) page.first_look = map.main_bounds();
  EvidenceGrid evidence(map);
  page.voxels = drawn_voxels(map, most_faces_shown, false, [&](const MapLeaf& leaf) {
    evidence.add(leaf);
    if (leaf.state == VoxelState::occupied && is_beyond(leaf, map.resolution(), page.first_look))
      page.occupied_beyond += static_cast<std::size_t>(leaf.edge) * static_cast<std::size_t>(leaf.edge) *
                              static_cast<std::size_t>(leaf.edge);
  });
  page.evidence = evidence.take();
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    page.volume_labels.push_back(map.volumes()[v].label);
    for (const Sphere& sphere : map.volumes()[v].spheres) {
      page.spheres.push_back({sphere.center, sphere.radius, static_cast<int>(v)});
    }
  }
  return page;
}

namespace {

/// The middle of some places, each as much as it weighs.
struct Middle {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  void add(const Eigen::Vector3d& place, double weighs) { sum += weighs * place, weight += weighs; }
};

void look_from(ReportPage& page, const Eigen::AlignedBox3d& bounds, const Middle& occupied,
               const Eigen::Vector3d& from) {
  if (occupied.weight == 0.0) return;
  const Eigen::Vector2d aside = (from - occupied.sum / occupied.weight).head<2>();
  if (aside.norm() < 0.1 * bounds.sizes().head<2>().norm()) return;
  page.iso_azimuth_deg = std::atan2(aside.x(), -aside.y()) * 180.0 / std::numbers::pi + 25.0;
}

/// From the side of what is free, on which whoever saw it stood.
void look_from_free(ReportPage& page, const MapLeaves& map) {
  Middle occupied, free;
  const Eigen::AlignedBox3d bounds = map.bounds();
  map.visit([&](const MapLeaf& leaf) {
    const double volume = std::pow(leaf.edge, 3);
    const Eigen::Vector3d center =
        map.resolution() * (leaf.corner.cast<double>() + Eigen::Vector3d::Constant(0.5 * leaf.edge));
    if (leaf.state == VoxelState::occupied) occupied.add(center, (center.z() - bounds.min().z()) * volume);
    if (leaf.state == VoxelState::painted || leaf.state == VoxelState::seen_free) free.add(center, volume);
  });
  if (free.weight > 0.0) look_from(page, bounds, occupied, free.sum / free.weight);
}

}  // namespace

void look_from(ReportPage& page, const Snapshot& map, const Eigen::Vector3d& from) {
  Middle occupied;
  const double floor = map.bounds().min().z();
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state == VoxelState::occupied)
      occupied.add(leaf.center, leaf.center.z() - floor);  // what is high hides more than what is low
  });
  look_from(page, map.bounds(), occupied, from);
}

void show_robot(ReportPage& page, const Robot& robot, const Configuration& home) {
  page.robot.clear();
  for (const Body& body : robot.bodies) {
    PageShape& shape = page.robot.emplace_back(page_shape(body.shape));
    shape.link_from_shape = body.link_from_shape;
    shape.link = body.link;
    shape.part = body.part;
    shape.critical = std::find(robot.critical_parts.begin(), robot.critical_parts.end(), body.part) !=
                     robot.critical_parts.end();
  }
  page.robot_home = forward_kinematics(robot, home);
}

PagePlan page_of_plan(const Plan& plan, const ConfigurationSpace& space, const Configuration& start,
                      const std::string& name) {
  const Robot& robot = space.robot();
  PagePlan shown_plan;
  shown_plan.name = name;
  shown_plan.planner = plan.planner;
  shown_plan.status = to_string(plan.status());
  shown_plan.explanation = plan.explanation();
  if (plan.status() == PlanStatus::solved && !plan.validation.valid) {
    shown_plan.status = "refused by the check";
    shown_plan.explanation = plan.validation.first_contact;
  }
  for (auto& figure : plan_figures(plan)) {  // the page shows these two by themselves
    if (figure.first != "status" && figure.first != "explanation") shown_plan.figures.push_back(figure);
  }
  shown_plan.joints = plan.joints;
  for (const Joint& joint : robot.joints)
    shown_plan.is_prismatic.push_back(joint.kind == JointKind::prismatic);

  std::vector<Configuration> path = plan.waypoints();
  std::vector<WaypointOrigin> origins = plan.origins();
  if (plan.status() != PlanStatus::solved && !plan.legs.empty()) {
    const std::vector<Configuration>& explored = plan.legs.back().explored;
    path.insert(path.end(), explored.begin(), explored.end());
    std::vector<WaypointOrigin> of_explored = plan.legs.back().origins;
    of_explored.resize(explored.size());
    origins.insert(origins.end(), of_explored.begin(), of_explored.end());
  }
  const std::vector<Configuration> whole = path;
  const bool has_loads = !plan.loads.empty() || plan.pick;
  const auto shown =
      plan.motion ? show_smooth_motion(shown_plan, robot, *plan.motion, load_of(plan, robot), plan.loads)
      : has_loads && plan.is_proved() ? show_trajectory(shown_plan, robot, trajectory_of(robot, plan))
                                      : show_motion(shown_plan, robot, path);
  if (shown.empty()) shown_plan.waypoints = subdivided(thinned(std::move(path)), robot);
  for (const PlanResult& leg : plan.legs)
    if (const auto kept = leg.statistics.find("security_distance_m"); kept != leg.statistics.end())
      shown_plan.security_distance = kept->second;
  const Robot loaded = with_all_loads(robot, plan.loads);
  const std::vector<BodyPair> pairs = self_collision_pairs(robot);
  for (const Configuration& q : shown_plan.waypoints) {
    shown_plan.link_poses.push_back(forward_kinematics(loaded, q));
    if (plan.loads.empty()) {  // of the robot alone
      shown_plan.clearance.push_back(space.clearance(q));
      shown_plan.between_bodies.push_back(between_bodies(robot, pairs, q));
    }
    shown_plan.tip_path.push_back(tip_pose(robot, q).translation());
  }
  show_origins(shown_plan, whole, origins);
  for (const PaintHint& hint : plan.paint) shown_plan.to_paint.push_back(hint.sphere);
  shown_plan.start_poses = forward_kinematics(loaded, start);
  if (!plan.goals.empty()) shown_plan.goal_poses = forward_kinematics(loaded, plan.goals.back());
  rest_loads(plan, robot.links.size(), shown, shown_plan);
  if (plan.pick)
    shown_plan.figures.emplace_back(
        "separation", "not drawn: a picked object touches what holds it and stands on what it stood on");
  else if (!plan.loads.empty())
    separate_loaded(plan, space, shown, shown_plan);
  return shown_plan;
}

std::string difference_page(const MapLeaves& difference, const std::string& name) {
  ReportPage page;
  page.title = name;
  page.subtitle = "what differs, voxels of " + significant(difference.resolution() * 1000.0, 4) + " mm";
  page.resolution = difference.resolution();
  page.voxels = drawn_voxels(difference, most_faces_shown, true);
  page.state_labels = {{"conflict", "newly blocked"},
                       {"painted", "blocked no more"},
                       {"occupied", "blocked in both"},
                       {"seen_free", "other change"}};
  const VoxelCounts counts = difference.counts();
  page.figures = {{"newly blocked", grouped(counts.conflict)},
                  {"blocked no more", grouped(counts.painted)},
                  {"blocked in both", grouped(counts.occupied)},
                  {"other change", grouped(counts.seen_free)}};
  if (counts.conflict + counts.painted == 0) page.opens = "layers=conflict,painted,occupied,seen_free";
  return render_report_page(page);
}

std::string map_page(const MapLeaves& map, const std::string& name, const std::optional<std::string>& place,
                     bool is_whole) {
  ReportPage page = page_of_map(map, name.empty() ? "map" : name, is_whole);
  page.map_place = place;
  look_from_free(page, map);
  const VoxelCounts counts = map.counts();
  page.subtitle = "voxel map, " + significant(map.resolution() * 1000.0, 4) + " mm";
  page.figures = {{"resolution", significant(map.resolution() * 1000.0, 4) + " mm"},
                  {"painted", grouped(counts.painted)},
                  {"seen free", grouped(counts.seen_free)},
                  {"occupied", grouped(counts.occupied)},
                  {"conflict", grouped(counts.conflict)}};
  return render_report_page(page);
}

}  // namespace clearway
