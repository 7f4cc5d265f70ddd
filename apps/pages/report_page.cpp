#include "apps/pages/report_page.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/pages/page_arrays.hpp"
#include "apps/pages/page_template.hpp"
#include "apps/pages/page_timeline.hpp"
#include "apps/viewer/page_templates.hpp"

namespace clearway {
namespace {

using nlohmann::json;
using Poses = std::vector<Eigen::Isometry3d>;

[[noreturn]] void refuse(const std::string& field, const std::string& expected) {
  throw std::invalid_argument("report page: " + field + " " + expected);
}

json place(const ArrayPlace& at) { return {{"type", at.type}, {"offset", at.offset}, {"count", at.count}}; }

json vector3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// x, y, z, then the quaternion's x, y, z, w, as three.js orders it.
void append_pose(std::vector<float>& out, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond rotation(pose.linear());
  for (int a = 0; a < 3; ++a) out.push_back(static_cast<float>(pose.translation()[a]));
  for (int a = 0; a < 4; ++a) out.push_back(static_cast<float>(rotation.coeffs()[a]));
}

json place_poses(PageArrays& arrays, const Poses& poses) {
  std::vector<float> values;
  for (const Eigen::Isometry3d& pose : poses) append_pose(values, pose);
  return place(arrays.add(std::span<const float>(values)));
}

json place_points(PageArrays& arrays, const std::vector<Eigen::Vector3d>& points) {
  std::vector<float> values;
  for (const Eigen::Vector3d& point : points)
    for (int a = 0; a < 3; ++a) values.push_back(static_cast<float>(point[a]));
  return place(arrays.add(std::span<const float>(values)));
}

json figures_json(const std::vector<PageFigure>& figures) {
  json rows = json::array();
  for (const auto& [name, value] : figures) rows.push_back({name, value});
  return rows;
}

/// The quads as five columns, each as differences (modulo 2^16) to the row before: neighbouring quads are
/// alike, so this deflates to a fraction.
json quads_json(PageArrays& arrays, const PageVoxels& voxels) {
  const std::vector<VoxelQuad> quads = exposed_faces(voxels);
  std::array<std::vector<std::uint16_t>, 5> columns;
  for (auto& column : columns) column.reserve(quads.size());
  std::array<std::uint16_t, 5> last{};
  std::array<std::size_t, 6> per_direction{};
  std::uint64_t area = 0;
  for (const VoxelQuad& quad : quads) {
    const std::array<std::uint16_t, 5> row{quad.layer, quad.u, quad.v,
                                           static_cast<std::uint16_t>(quad.width - 1),
                                           static_cast<std::uint16_t>(quad.height - 1)};
    for (std::size_t c = 0; c < 5; ++c) columns[c].push_back(static_cast<std::uint16_t>(row[c] - last[c]));
    last = row;
    ++per_direction[quad.direction];
    area += std::uint64_t{quad.width} * quad.height;
  }
  json places = json::array();
  for (const auto& column : columns)
    places.push_back(place(arrays.add(std::span<const std::uint16_t>(column))));
  return {{"state", voxels.state}, {"count", voxels.count},       {"cell", 1 << voxels.cells.cell_level()},
          {"faces", area},         {"directions", per_direction}, {"columns", places}};
}

/// With a coarser set beside it, for a browser that cannot draw the fine one as fast as one turns it.
json voxels_json(PageArrays& arrays, PageVoxels voxels) {
  constexpr std::uint64_t most_faces_turned = 40'000;
  voxels.cells.sort();
  json set = quads_json(arrays, voxels);
  const int finest = voxels.cells.cell_level();
  while (count_faces(voxels.cells) > most_faces_turned && voxels.cells.cell_level() < 8)
    voxels.cells.coarsen(voxels.any);
  if (voxels.cells.cell_level() > finest) set["turned"] = quads_json(arrays, voxels);
  return set;
}

json all_voxels_json(PageArrays& arrays, const ReportPage& page) {
  json sets = json::array();
  for (const PageVoxels& voxels : page.voxels) {
    if (voxels.count == 0) continue;
    if (voxels.state != "painted" && voxels.state != "occupied" && voxels.state != "conflict" &&
        voxels.state != "seen_free")
      refuse("voxels.state", "must be painted, occupied, conflict or seen_free, not '" + voxels.state + "'");
    if (std::abs(voxels.size - page.resolution) > 1e-9 * page.resolution)
      refuse("voxels '" + voxels.state + "'", "must have the map's resolution as their size");
    sets.push_back(voxels_json(arrays, voxels));
  }
  return sets;
}

json spheres_json(PageArrays& arrays, const ReportPage& page) {
  std::vector<float> values;
  for (const PageSphere& sphere : page.spheres) {
    if (sphere.volume < 0 || static_cast<std::size_t>(sphere.volume) >= page.volume_labels.size())
      refuse("balls.volume", "must be an index into volume_labels");
    for (int a = 0; a < 3; ++a) values.push_back(static_cast<float>(sphere.center[a]));
    values.push_back(static_cast<float>(sphere.radius));
    values.push_back(static_cast<float>(sphere.volume));
  }
  return place(arrays.add(std::span<const float>(values)));
}

json shape_json(PageArrays& arrays, const PageShape& shape) {
  json out{{"kind", shape.kind},
           {"size", vector3(shape.size)},
           {"link", shape.link},
           {"part", shape.part},
           {"critical", shape.critical},
           {"group", shape.group},
           {"pose", place_poses(arrays, {shape.link_from_shape})}};
  if (shape.link < 0) refuse("robot.link", "must not be negative");
  if (shape.kind != PageShape::mesh) return out;
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : shape.triangles)
    for (const int corner : triangle) {
      if (corner < 0 || static_cast<std::size_t>(corner) >= shape.vertices.size())
        refuse("robot.triangles", "must be indices into the shape's vertices");
      corners.push_back(static_cast<std::uint32_t>(corner));
    }
  out["vertices"] = place_points(arrays, shape.vertices);
  out["triangles"] = place(arrays.add(std::span<const std::uint32_t>(corners)));
  return out;
}

std::size_t link_count(const ReportPage& page) {
  int last = -1;
  for (const PageShape& shape : page.robot) last = std::max(last, shape.link);
  return static_cast<std::size_t>(last + 1);
}

/// Empty, or a pose for every link that has a shape.
void require_links(const Poses& poses, std::size_t links, const std::string& field) {
  if (!poses.empty() && poses.size() < links) refuse(field, "must have a pose for each link with a shape");
}

void require_sizes(const PagePlan& plan, std::size_t links) {
  const std::string of = "plan '" + plan.name + "': ";
  const std::size_t waypoints = plan.waypoints.size();
  if (plan.is_prismatic.size() != plan.joints.size())
    refuse(of + "is_prismatic", "must have one entry per joint");
  for (const Eigen::VectorXd& q : plan.waypoints)
    if (static_cast<std::size_t>(q.size()) != plan.joints.size())
      refuse(of + "waypoints", "must have one value per joint");
  if (!plan.clearance.empty() && plan.clearance.size() != waypoints)
    refuse(of + "clearance", "must have one entry per waypoint");
  if (!plan.between_bodies.empty() && plan.between_bodies.size() != waypoints)
    refuse(of + "between_bodies", "must have one entry per waypoint");
  for (const auto* rates : {&plan.speeds, &plan.accelerations}) {
    if (rates->size() != (plan.period > 0.0 ? waypoints : 0))
      refuse(of + "speeds and accelerations", "must have one entry per waypoint of a plan with time");
    for (const Eigen::VectorXd& rate : *rates)
      if (static_cast<std::size_t>(rate.size()) != plan.joints.size())
        refuse(of + "speeds and accelerations", "must have one value per joint");
  }
  for (const auto* limits : {&plan.max_speed, &plan.max_acceleration})
    if (limits->size() != (plan.period > 0.0 ? plan.joints.size() : 0))
      refuse(of + "max_speed and max_acceleration", "must have one entry per joint of a plan with time");
  const auto require_known = [&](const std::string& name, const std::vector<Eigen::VectorXd>& values,
                                 const std::vector<double>& limits) {
    if (values.size() != (limits.empty() ? 0 : waypoints) ||
        (!limits.empty() && (plan.period <= 0.0 || limits.size() != plan.joints.size())))
      refuse(of + name + "s",
             "must have one entry per waypoint of a plan with time, and max_" + name + " one per joint");
    for (const Eigen::VectorXd& value : values)
      if (static_cast<std::size_t>(value.size()) != plan.joints.size())
        refuse(of + name + "s", "must have one value per joint");
  };
  require_known("jerk", plan.jerks, plan.max_jerk);
  require_known("torque", plan.torques, plan.max_torque);
  for (const auto* values : {&plan.map_age, &plan.true_separation})
    if (values->size() != (plan.seen.empty() ? 0 : waypoints))
      refuse(of + "map_age and true_separation", "must have one entry per waypoint while the map changes");
  if (!plan.seen.empty() && !(plan.seen_voxel > 0.0 && plan.period > 0.0))
    refuse(of + "seen", "must have voxels of some size, and the plan time");
  if (!plan.link_poses.empty() && plan.link_poses.size() != waypoints)
    refuse(of + "link_poses", "must have one entry per waypoint");
  for (const Poses& poses : plan.link_poses)
    if (poses.size() != plan.link_poses.front().size() || poses.size() < links)
      refuse(of + "link_poses", "must have a pose for each link with a shape at every waypoint");
  if (plan.phases.size() != (plan.phase_names.empty() ? 0 : waypoints) ||
      plan.search_steps.size() != plan.phases.size())
    refuse(of + "phases and search_steps", "must have one entry per waypoint where phase_names has any");
  for (const int phase : plan.phases)
    if (phase < 0 || static_cast<std::size_t>(phase) >= plan.phase_names.size())
      refuse(of + "phases", "must be indices into phase_names");
  require_links(plan.start_poses, links, of + "start_poses");
  require_links(plan.goal_poses, links, of + "goal_poses");
}

/// Joint by joint.
json place_joints(PageArrays& arrays, const std::vector<Eigen::VectorXd>& rows, std::size_t joints) {
  std::vector<float> values;
  for (std::size_t j = 0; j < joints; ++j)
    for (const Eigen::VectorXd& row : rows)
      values.push_back(static_cast<float>(row[static_cast<Eigen::Index>(j)]));
  return place(arrays.add(std::span<const float>(values)));
}

json place_numbers(PageArrays& arrays, const std::vector<double>& values) {
  const std::vector<float> floats(values.begin(), values.end());
  return place(arrays.add(std::span<const float>(floats)));
}

json place_whole(PageArrays& arrays, const std::vector<int>& values) {
  std::vector<std::uint32_t> numbers;
  for (const int value : values) numbers.push_back(static_cast<std::uint32_t>(std::max(value, 0)));
  return place(arrays.add(std::span<const std::uint32_t>(numbers)));
}

/// Octree coordinates of the voxels of each change, axis by axis.
json seen_json(PageArrays& arrays, const PagePlan& plan) {
  std::vector<double> times;
  std::vector<std::uint32_t> counts;
  std::vector<std::uint16_t> cells;
  for (const PageSeen& seen : plan.seen) {
    times.push_back(seen.time);
    counts.push_back(static_cast<std::uint32_t>(seen.centers.size()));
    for (int axis = 0; axis < 3; ++axis)
      for (const Eigen::Vector3d& center : seen.centers)
        cells.push_back(
            static_cast<std::uint16_t>(std::floor(center[axis] / plan.seen_voxel) + kOriginVoxel));
  }
  return {{"voxel", plan.seen_voxel},
          {"times", place_numbers(arrays, times)},
          {"counts", place(arrays.add(std::span<const std::uint32_t>(counts)))},
          {"cells", place(arrays.add(std::span<const std::uint16_t>(cells)))}};
}

/// Of the page's sphere colours the orange one, so that spheres to paint stand out of those that are painted.
constexpr float kPaintColour = 2.0F;

json plan_json(PageArrays& arrays, const PagePlan& plan, std::size_t links) {
  require_sizes(plan, links);
  std::vector<float> poses, clearance, paint;
  const std::size_t joints = plan.joints.size();
  for (const Sphere& sphere : plan.to_paint) {
    for (const double value : {sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius})
      paint.push_back(static_cast<float>(value));
    paint.push_back(kPaintColour);
  }
  for (const Poses& at : plan.link_poses)
    for (const Eigen::Isometry3d& pose : at) append_pose(poses, pose);
  for (const double c : plan.clearance)
    clearance.push_back(std::isfinite(c) ? static_cast<float>(c) : std::numeric_limits<float>::quiet_NaN());
  return {{"name", plan.name},
          {"planner", plan.planner},
          {"status", plan.status},
          {"explanation", plan.explanation},
          {"joints", plan.joints},
          {"prismatic", plan.is_prismatic},
          {"period", plan.period},
          {"duration", plan.duration},
          {"maxSpeed", plan.max_speed},
          {"maxAcceleration", plan.max_acceleration},
          {"maxJerk", plan.max_jerk},
          {"maxTorque", plan.max_torque},
          {"security", plan.security_distance},
          {"waypoints", plan.waypoints.size()},
          {"links", plan.link_poses.empty() ? 0 : plan.link_poses.front().size()},
          {"values", place_joints(arrays, plan.waypoints, joints)},
          {"speeds", place_joints(arrays, plan.speeds, joints)},
          {"accelerations", place_joints(arrays, plan.accelerations, joints)},
          {"jerks", place_joints(arrays, plan.jerks, joints)},
          {"torques", place_joints(arrays, plan.torques, joints)},
          {"poses", place(arrays.add(std::span<const float>(poses)))},
          {"clearance", place(arrays.add(std::span<const float>(clearance)))},
          {"betweenBodies", place_numbers(arrays, plan.between_bodies)},
          {"trueSeparation", place_numbers(arrays, plan.true_separation)},
          {"mapAge", place_numbers(arrays, plan.map_age)},
          {"seen", seen_json(arrays, plan)},
          {"phaseNames", plan.phase_names},
          {"phases", place_whole(arrays, plan.phases)},
          {"searchSteps", place_whole(arrays, plan.search_steps)},
          {"figures", figures_json(plan.figures)},
          {"tip", place_points(arrays, plan.tip_path)},
          {"start", place_poses(arrays, plan.start_poses)},
          {"goal", place_poses(arrays, plan.goal_poses)},
          {"paint", place(arrays.add(std::span<const float>(paint)))}};
}

json box_json(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return nullptr;
  return {{box.min().x(), box.min().y(), box.min().z()}, {box.max().x(), box.max().y(), box.max().z()}};
}

json page_json(PageArrays& arrays, const ReportPage& page) {
  const std::size_t links = link_count(page);
  require_links(page.robot_home, links, "robot_home");
  json robot = json::array(), plans = json::array(), tables = json::array(), pictures = json::array();
  for (const PagePicture& picture : page.pictures)
    pictures.push_back(
        {{"caption", picture.caption}, {"jpeg", place(arrays.add(std::string_view(picture.jpeg)))}});
  for (const PageShape& shape : page.robot) robot.push_back(shape_json(arrays, shape));
  for (const PagePlan& plan : page.plans) plans.push_back(plan_json(arrays, plan, links));
  for (const PageTable& table : page.tables)
    tables.push_back({{"name", table.name}, {"header", table.header}, {"rows", table.rows}});
  return {{"title", page.title},
          {"subtitle", page.subtitle},
          {"figures", figures_json(page.figures)},
          {"opens", page.opens},
          {"isoAzimuth", page.iso_azimuth_deg},
          {"firstLook", box_json(page.first_look)},
          {"occupiedBeyond", page.occupied_beyond},
          {"resolution", page.resolution},
          {"origin", kOriginVoxel},
          {"stateLabels", figures_json(page.state_labels)},
          {"voxels", all_voxels_json(arrays, page)},
          {"balls", spheres_json(arrays, page)},
          {"volumes", page.volume_labels},
          {"evidence", evidence_json(arrays, page.evidence)},
          {"mapPlace", page.map_place ? json(*page.map_place) : json()},
          {"timeline", timeline_json(arrays, page.recording, page.provenance)},
          {"robot", robot},
          {"home", place_poses(arrays, page.robot_home)},
          {"plans", plans},
          {"tables", tables},
          {"pictures", pictures},
          {"warnings", page.warnings},
          {"report", place(arrays.add(std::string_view(page.json)))}};
}

}  // namespace

std::string render_report_page(const ReportPage& page) {
  PageArrays arrays;
  const std::string described = page_json(arrays, page).dump(-1, ' ', false, json::error_handler_t::replace);
  return fill_page_template(report_template(), page.title,
                            "<script type=\"application/json\" id=\"page\">" + script_json(described) +
                                "</script>\n" + "<script type=\"text/plain\" id=\"arrays\">" +
                                arrays.encode() + "</script>\n");
}

}  // namespace clearway
