#include "tracking/calibration/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/calibration/straight_edges.hpp"
#include "tracking/pose_refinement.hpp"

namespace clearway {
namespace {

/// Where the corners are in the image: not quite where they were found (corners_by_straight_edges).
std::vector<CornerMatch> matches(const Bundle& bundle, const BoardView& view) {
  std::vector<CornerMatch> corners;
  for (const TagDetection& tag : view.tags) {
    const MountedTag& mounted = bundle.board.tags.at(tag.id);
    const auto points = corners_on_board(mounted, bundle.bend);
    const auto found = corners_by_straight_edges(bundle.camera, mounted, bundle.bend, view.camera_from_board);
    for (std::size_t i = 0; i < 4; ++i) {
      Eigen::Vector2d at = tag.corners[i];
      if (found) at += *bundle.camera.project(view.camera_from_board * points[i]) - (*found)[i];
      corners.push_back({points[i], at});
    }
  }
  return corners;
}

/// Sums over views that a calibration has not seen.
struct Sums {
  double squared_px = 0.0, squared_mm = 0.0, freedom = 0.0;

  void add(const Bundle& bundle, const BoardView& view) {
    const Camera& camera = bundle.camera;
    const std::vector<CornerMatch> corners = matches(bundle, view);
    const auto pose = refine_pose(camera, corners, view.camera_from_board);
    if (!pose || corners.size() < 4) return;
    for (const CornerMatch& corner : corners) {
      const Eigen::Vector3d at = pose->camera_from_body * corner.in_body;
      const auto pixel = camera.project(at);
      if (!pixel) return;
      const double squared = (*pixel - corner.pixel).squaredNorm();
      squared_px += squared;
      const double distance = camera.lens == LensDistortion::Model::fisheye ? at.norm() : at.z();
      squared_mm += squared * std::pow(1e3 * distance / std::sqrt(camera.fx * camera.fy), 2);
    }
    freedom += static_cast<double>(corners.size()) - 3.0;  // corners, less half the pose's unknowns
  }
};

}  // namespace

HeldOut test_held_out(const Bundle& fitted, const TagBody& reported, const BundlePriors& priors,
                      double noise_px, double edge_bias, int folds) {
  Sums sums;
  const std::size_t parts = static_cast<std::size_t>(std::max(2, folds));
  for (std::size_t part = 0; part < parts; ++part) {
    Bundle others = fitted;
    others.board = reported;
    others.bend = {fitted.bend.board_from_plane};
    others.views.clear();
    for (std::size_t v = 0; v < fitted.views.size(); ++v)
      if (v % parts != part) others.views.push_back(fitted.views[v]);
    if (!adjust(others, priors, noise_px, edge_bias).is_converged) continue;
    for (std::size_t v = part; v < fitted.views.size(); v += parts) sums.add(others, fitted.views[v]);
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (sums.freedom <= 0.0) return {infinity, infinity};
  return {std::sqrt(sums.squared_px / sums.freedom), std::sqrt(sums.squared_mm / sums.freedom)};
}

}  // namespace clearway
