#include "apps/fusion/emptiness.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "apps/console/parse.hpp"
#include "apps/fusion/painter.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Whether a tag was seen that some board of the setup has.
bool saw_a_board(const Fusion& fusion) {
  for (const BoardSetup& board : fusion.setup.boards) {
    for (const TagSetup& tag : board.tags)
      if (fusion.counts.ids_seen.contains(tag.id)) return true;
  }
  return false;
}

/// What the source says it left out, as one clause; "" when it left nothing out.
std::string left_out_of(const Fusion& fusion) {
  std::string clause;
  for (const std::string& warning : fusion.warnings)
    clause += (clause.empty() ? "" : "; ") + warning.substr(0, warning.size() - warning.ends_with('.'));
  return clause;
}

void require_tags(const Fusion& fusion, const std::string& name) {
  if (!fusion.setup.probe || saw_a_board(fusion)) return;
  const FusionCounts& counts = fusion.counts;
  const std::string images = counted(counts.images, "image");
  const std::string left_out = left_out_of(fusion);
  const std::string none =
      left_out.empty() ? "there is no camera image" : "no camera image of it can be used: " + left_out;
  const std::string what = counts.images == 0 ? none
                           : counts.ids_seen.empty()
                               ? "there is no tag in its " + images
                               : "none of the tags in its " + images + " (ids " +
                                     list_of_ids(counts.ids_seen) + ") is on a board of the setup";
  throw std::invalid_argument(name + ": " + what + ", but the setup (" + fusion.setup_source +
                              ") has a probe to paint with: expected tag36h11 tags of boards '" +
                              fixed_board(fusion.setup, "a probe").name + "' and '" +
                              fusion.setup.probe->board + "'");
}

/// Of what the setup says of a scan's points, that which can take some out.
std::string takers_of(const Setup& setup) {
  const MapSetup& map = setup.map;
  std::string takers;
  const auto add = [&](bool is_there, const char* taker) {
    if (is_there) takers += (takers.empty() ? "" : " or ") + std::string(taker);
  };
  add(map.min_range.value_or(0.0) > 0.0, "by `min_range`");
  add(map.crop.has_value(), "by `crop`");
  add(map.outliers.has_value(), "by `outliers`");
  add(setup.robot && (!setup.robot->joints.empty() || !setup.robot->joint_file.empty() ||
                      !setup.robot->joint_topic.empty()),
      "as the robot's own");
  add(setup.probe || setup.gripper, "as the probe's or the hand's");
  return takers.empty() ? "by `thin_to`" : takers;  // which leaves some, unlike the others
}

/// What became of the scans, of which no point is in the map.
std::string fate_of_scans(const FusionCounts& counts, const Setup& setup) {
  std::string fate;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) fate += (fate.empty() ? "" : ", ") + counted(count, one, many);
  };
  const auto add_same = [&](std::size_t count, const std::string& one, const std::string& many,
                            const std::string& rest) { add(count, one + rest, many + rest); };
  const std::string gap = counts.joint_gap.empty() ? "" : " (" + counts.joint_gap + ")";
  add(counts.scans_without_pose, "scan has no pose at its time", "scans have no pose at their time");
  add(counts.scans_without_joints, "scan has no joints of the robot at its time" + gap,
      "scans have no joints of the robot at their time" + gap);
  add_same(counts.scans_refused, "scan starts", "scans start", " outside the map's range");
  add(counts.points.beyond_range, "point lies beyond max_range and only frees the space before it",
      "points lie beyond max_range and only free the space before it");
  add_same(counts.points.dropped_invalid, "point is", "points are",
           " not finite, at the sensor's own origin or outside the map's range");
  add_same(counts.infinite_beams, "beam of laser scans is", "beams of laser scans are", " +inf");
  add_same(counts.points.dropped_filter, "point was", "points were", " taken out " + takers_of(setup));
  const std::string scans = "nothing of its " + counted(counts.scans, "scan") + " got into the map: ";
  return scans + (fate.empty() ? "there is no point in it" : fate);
}

std::string reason_for_nothing(const Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  std::string no_ball = unpainted_reason(fusion);
  if (no_ball.empty() && fusion.setup.probe)
    no_ball = "no ball was painted (" + refusals_of(counts) +
              (counts.ids_seen.empty() ? "" : "; tags seen are " + list_of_ids(counts.ids_seen)) + ")";
  if (counts.scans > 0) return fate_of_scans(counts, fusion.setup) + (no_ball.empty() ? "" : "; " + no_ball);
  if (!no_ball.empty()) return no_ball;
  const std::string left_out = left_out_of(fusion);
  if (counts.images > 0)
    return (left_out.empty() ? "" : left_out + "; ") + "its " + counted(counts.images, "image") +
           " put nothing into a map without a probe in the setup (" + fusion.setup_source + ")";
  return left_out.empty() ? "it holds no image and no scan"
                          : "no image and no scan of it can be used: " + left_out;
}

}  // namespace

std::string list_of_ids(const std::set<int>& ids) {
  constexpr std::size_t enough = 10;
  std::string list;
  std::size_t count = 0;
  for (const int id : ids) {
    if (++count > enough) return list + ", ...";
    list += (list.empty() ? "" : ", ") + std::to_string(id);
  }
  return list;
}

std::string refusals_of(const FusionCounts& counts) {
  std::vector<std::pair<std::int64_t, std::string>> sorted;
  for (const auto& [reason, count] : counts.samples)
    if (count > 0) sorted.emplace_back(-count, reason);
  std::sort(sorted.begin(), sorted.end());
  std::string text;
  for (const auto& [count, reason] : sorted)
    text += (text.empty() ? "" : ", ") + reason + " " + std::to_string(-count);
  if (sorted.empty()) return "no image";
  // That the probe is out of sight now and then explains nothing where it is seen and refused.
  const auto telling = std::find_if(sorted.begin(), sorted.end(), [](const auto& refusal) {
    return refusal.second != to_string(Refusal::probe_not_seen);
  });
  const bool is_front = telling == sorted.end() || telling == sorted.begin();
  const auto first = counts.first_refusals.find(is_front ? sorted.front().second : telling->second);
  if (first == counts.first_refusals.end()) return text;
  return text + (is_front ? "; the first: " : "; the first " + first->first + ": ") + first->second;
}

std::string unpainted_reason(const Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  if (counts.spheres + counts.body_spheres == 0 || counts.erasers > 0) return "";
  const VoxelCounts voxels = fusion.map.snapshot().counts();
  if (voxels.painted + voxels.conflict > 0) return "";
  const bool is_by_bodies = counts.body_spheres > 0 && counts.body_radius >= counts.painted_radius;
  const double radius = 1000.0 * (is_by_bodies ? counts.body_radius : counts.painted_radius);
  const double holds_one_anywhere = radius / std::sqrt(3.0);
  if (1000.0 * fusion.map.options().resolution <= holds_one_anywhere) return "";  // strokes were undone
  const double unit = std::pow(10.0, std::floor(std::log10(holds_one_anywhere)) - 1.0);
  return "none of the " + counted(counts.spheres + counts.body_spheres, "ball") +
         (is_by_bodies ? " of the robot's bodies, of radius " + significant(radius, 3) + " mm at most"
                       : ", of mean radius " + significant(radius, 3) + " mm") +
         ", holds a whole voxel of " + significant(1000.0 * fusion.map.options().resolution, 3) +
         " mm; expected `resolution` (--resolution) of at most " +
         significant(unit * std::floor(holds_one_anywhere / unit), 2) +
         (is_by_bodies ? " mm, or `joint_error` and `place_error` that leave more of the bodies"
                       : " mm, a larger ball, or a better known one");
}

void require_sensors(Fusion& fusion, const std::filesystem::path& recording) {
  const FusionCounts& counts = fusion.counts;
  std::vector<std::string> scans;
  for (const auto& [label, kind] : counts.unplaced_scans)
    scans.push_back(label.empty() ? "kind " + quote(kind) : quote(label) + " (kind " + quote(kind) + ")");
  const std::string others =
      scans.empty() ? "" : "; the scans that no sensor of it places are of " + listed(scans);
  const bool is_none_placed = counts.placed_sensors.empty() && !scans.empty() && !counts.has_poses_of_scans;
  for (const SensorSetup& sensor : fusion.setup.sensors) {
    if (counts.placed_sensors.contains(sensor.name)) continue;
    if (is_none_placed)
      throw std::invalid_argument(recording.string() + ": the setup (" + fusion.setup_source +
                                  ") places no scan of it: none that was used is of sensor " +
                                  quote(sensor.name) + others +
                                  ": expected the label or kind of scans that there are");
    fusion.warnings.push_back("the setup's sensor " + quote(sensor.name) +
                              " placed nothing: no scan is of it" + others);
  }
}

bool has_content(const Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  return counts.points.inserted > 0 || counts.points.cleared > 0 ||
         (counts.spheres + counts.body_spheres > 0 &&
          unpainted_reason(fusion).empty());  // last: it walks the map
}

void require_content(const Fusion& fusion, const std::filesystem::path& recording) {
  require_tags(fusion, recording.string());
  if (has_content(fusion)) return;
  throw std::invalid_argument(recording.string() + ": " + reason_for_nothing(fusion));
}

}  // namespace clearway
