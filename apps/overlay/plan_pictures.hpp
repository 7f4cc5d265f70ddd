#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/overlay/overlay_scene.hpp"
#include "apps/overlay/view.hpp"
#include "apps/pages/report.hpp"

namespace clearway {

/// How a solved plan moves, and how near it comes to things.
struct DrawnMotion {
  std::vector<Configuration> positions;
  std::vector<std::size_t> legs{};  ///< of each of them; empty: nothing rides on the robot
  double period = 0.0;              ///< s between two of them
  OverlayPath path;                 ///< of some of them
  std::size_t tightest = 0;
  double least_clearance = 0.0;
};

DrawnMotion drawn_motion(const ReplayPlan& entry);

/// Draws plans into one view. View and map must live on.
class PlanPictures {
 public:
  PlanPictures(const View& view, const OverlayMap& map) : view_(view), map_(map) {}

  /// The robot at one place of the motion. @param moment in words, for the strip
  cv::Mat solved(const ReplayPlan& entry, const DrawnMotion& motion, std::size_t at,
                 const std::string& moment);
  cv::Mat painted(const Snapshot& map) const;
  cv::Mat failed(const ReplayPlan& entry);

 private:
  OverlayScene scene_of(const ReplayPlan& entry);
  cv::Mat draw(const OverlayScene& scene) const;

  const View& view_;
  const OverlayMap& map_;
  std::map<const ConfigurationSpace*, RobotSurface> surfaces_;
};

}  // namespace clearway
