#include "tracking/calibration/calibrate_board.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "tracking/calibration/words.hpp"

namespace clearway {
namespace {

std::string mm_text(double metres) { return words(1e3 * metres, " mm"); }

/// The transform that brings the measured tags onto the stated ones, most of them: iterated Cauchy weights.
Eigen::Isometry3d stated_from_measured(const TagBody& stated, const TagBody& measured, double place) {
  std::vector<Eigen::Vector3d> from, to;
  for (const auto& [id, tag] : measured.tags) {
    const MountedTag& other = stated.tags.at(id);
    for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                        Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, -1, 0)}) {
      from.push_back(tag.body_from_tag * (0.5 * other.size * axis));
      to.push_back(other.body_from_tag * (0.5 * other.size * axis));
    }
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<double> weights(from.size(), 1.0);
  for (int round = 0; round < 20; ++round) {
    Eigen::Vector3d mean_from = Eigen::Vector3d::Zero(), mean_to = mean_from;
    double sum = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      mean_from += weights[i] * from[i];
      mean_to += weights[i] * to[i];
      sum += weights[i];
    }
    mean_from /= sum;
    mean_to /= sum;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i)
      cross += weights[i] * (to[i] - mean_to) * (from[i] - mean_from).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1.0, 1.0,
                          (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0);
    pose.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    pose.translation() = mean_to - pose.linear() * mean_from;
    const double scale = std::max(place, 1e-4);
    for (std::size_t i = 0; i < from.size(); ++i)
      weights[i] = 1.0 / (1.0 + (pose * from[i] - to[i]).squaredNorm() / (scale * scale));
  }
  return pose;
}

/// Sizes held by what is stated over the square root of their weights; the rest free within the board.
BundlePriors priors_of_sizes(const Camera& camera, const TagBody& board, const std::vector<double>& weights) {
  BundlePriors priors;
  priors.shared = camera_priors(camera);
  // One tag stays in its place, so that the board has a frame.
  for (std::size_t i = 0; i < board.tags.size(); ++i) {
    const double size = std::max(board.errors.size, 1e-4) / std::sqrt(weights[i]);
    const double place = i == 0 ? 0.0 : 0.5, turn = i == 0 ? 0.0 : 0.5;
    priors.tags.push_back({size, place, place, place, turn, turn, turn});
  }
  return priors;
}

bool place_views(Bundle& bundle, const BoardCalibrationOptions& options) {
  std::vector<BoardView> placed;
  for (BoardView& view : bundle.views) {
    const auto pose =
        estimate_body_pose(bundle.board, view.tags, bundle.camera, {.pixel_noise = options.pixel_noise});
    if (!pose) continue;
    view.camera_from_board = pose->camera_from_body.pose;
    placed.push_back(view);
  }
  bundle.views = placed;
  return placed.size() >= options.least_views;
}

std::size_t views_of(const Bundle& bundle, int id) {
  return static_cast<std::size_t>(
      std::count_if(bundle.views.begin(), bundle.views.end(), [&](const BoardView& view) {
        return std::any_of(view.tags.begin(), view.tags.end(),
                           [&](const TagDetection& tag) { return tag.id == id; });
      }));
}

/// All tags hang together: from the first, over views that show two, every one is reached.
int tag_apart(const Bundle& bundle) {
  std::vector<int> reached{bundle.board.tags.begin()->first};
  const auto has = [&](int id) { return std::find(reached.begin(), reached.end(), id) != reached.end(); };
  for (bool grows = true; grows;) {
    grows = false;
    for (const BoardView& view : bundle.views) {
      if (std::none_of(view.tags.begin(), view.tags.end(), [&](const TagDetection& t) { return has(t.id); }))
        continue;
      for (const TagDetection& tag : view.tags)
        if (!has(tag.id)) {
          reached.push_back(tag.id);
          grows = true;
        }
    }
  }
  for (const auto& [id, tag] : bundle.board.tags)
    if (!has(id)) return id;
  return -1;
}

double worst_of(const Eigen::VectorXd& variances, int first) {
  return std::sqrt(variances.segment<3>(first).maxCoeff());
}

}  // namespace

BoardCalibration calibrate_board(const Camera& camera, const TagBody& board, std::vector<BoardView> views,
                                 const BoardCalibrationOptions& options) {
  camera.validate();
  board.validate();
  BoardCalibration found;
  found.board = board;
  std::erase_if(views, [](const BoardView& view) { return view.tags.size() < 2; });
  Bundle begun{camera, board, std::move(views)};
  if (board.tags.size() < 3 || !place_views(begun, options)) {
    found.refusal = board.tags.size() < 3
                        ? "the board has " + std::to_string(board.tags.size()) + " tags, expected 3 or more"
                        : std::to_string(begun.views.size()) +
                              " images show a pose by two tags or more, expected " +
                              std::to_string(options.least_views) + " or more";
    return found;
  }
  found.views = begun.views.size();
  if (const int apart = tag_apart(begun); apart >= 0) {
    found.refusal = "tag " + std::to_string(apart) +
                    " is in no image that shows it beside the others: show each tag with its neighbours";
    return found;
  }
  std::vector<double> weights(board.tags.size(), 1.0);
  Bundle bundle;
  BundleFit fit;
  for (int round = 0; round < 6; ++round) {
    bundle = begun;
    fit = adjust_with_noise(bundle, priors_of_sizes(camera, board, weights), options.edge_bias);
    if (!fit.is_converged) {
      found.refusal =
          "no board explains the images: expected a known camera and sharp images from many sides";
      return found;
    }
    std::size_t i = 0;
    for (const auto& [id, tag] : bundle.board.tags) {
      const double off = std::log(tag.size / board.tags.at(id).size) / std::max(board.errors.size, 1e-4);
      weights[i++] = 1.0 / (1.0 + off * off / 9.0);
    }
  }
  found.noise_px = fit.noise_px;
  found.rms_px = fit.rms_px;
  const Eigen::Isometry3d back = stated_from_measured(board, bundle.board, board.errors.place);
  const Eigen::VectorXd variances = fit.covariance.diagonal();
  double place = 0.0, turn = 0.0, size = 0.0;
  std::string blurred;
  int column = kSharedUnknowns;
  for (const auto& [id, measured] : bundle.board.tags) {
    const MountedTag& stated = board.tags.at(id);
    MountedTag& tag = found.board.tags.at(id);
    tag = {measured.size, back * measured.body_from_tag};
    const Vector6d moved = difference(stated.body_from_tag, tag.body_from_tag);
    TagChange change{id,
                     views_of(bundle, id),
                     tag.size / stated.size,
                     std::sqrt(variances[column]),
                     moved.head<3>().norm(),
                     worst_of(variances, column + 1),
                     moved.tail<3>().norm(),
                     worst_of(variances, column + 4)};
    change.is_size_wrong = std::abs(std::log(change.size_ratio)) >
                           5.0 * std::hypot(std::max(board.errors.size, 1e-4), change.size_sigma);
    found.tags.push_back(change);
    place = std::max(place, change.place_sigma);
    turn = std::max(turn, change.turn_sigma);
    size = std::max(size, change.size_sigma);
    if (blurred.empty() && change.place_sigma > options.most_place_sigma)
      blurred = "the place of tag " + std::to_string(id) + " is known to " + mm_text(change.place_sigma) +
                " only, expected " + mm_text(options.most_place_sigma) +
                " or better: take more and nearer images of it beside its neighbours";
    column += kTagUnknowns;
  }
  found.board.errors = {board.errors.scale, size, place, turn};
  found.refusal = blurred;
  return found;
}

}  // namespace clearway
