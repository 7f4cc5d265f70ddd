#include "tracking/calibration/calibrate_board.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/calibration/places_scale.hpp"
#include "tracking/calibration/words.hpp"

namespace clearway {
namespace {

std::string mm_text(double metres) { return words(1e3 * metres, " mm"); }

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

/// How well the images know the scale of the places, sizes held by what is stated: relative.
double scale_sigma(const PlacesScale& places, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd by = Eigen::VectorXd::Zero(covariance.rows());
  int column = kSharedUnknowns + 1;
  for (const auto& [id, by_place] : places.by_place) {
    by.segment<3>(column) = by_place;
    column += kTagUnknowns;
  }
  return std::sqrt(by.dot(covariance * by));
}

/// A sentence, when stated sizes and stated places cannot both be right.
std::string contradiction(const BoardCalibration& found) {
  if (!found.is_scale_contradicted) return "";
  const auto percent = [](double ratio) {
    return words(100.0 * std::abs(ratio - 1.0), ratio < 1.0 ? " % smaller" : " % larger");
  };
  return "stated sizes and stated places of the tags contradict each other: if the sizes are right, "
         "distances "
         "between tags are " +
         percent(found.places_scale) + " than stated, if the distances are, the tags are " +
         percent(1.0 / found.places_scale) + ", expected agreement within " +
         words(100.0 * found.scale_tolerance, " %") +
         ": measure a tag's side and the distance between two tags, and state what is measured";
}

/// "tags 3, 5"
std::string tags_text(std::vector<int> ids) {
  std::sort(ids.begin(), ids.end());
  std::string text;
  for (const int id : ids) text += (text.empty() ? (ids.size() == 1 ? "tag " : "tags ") : ", ") + words(id);
  return text;
}

/// A sentence, when no more than half of the tags are of one size over the stated one, within `limit`: then
/// no majority says which are as stated.
std::string divided(std::vector<TagChange> tags, double limit) {
  std::sort(tags.begin(), tags.end(),
            [](const TagChange& a, const TagChange& b) { return a.size_ratio < b.size_ratio; });
  std::size_t most = 0, first = 0;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    std::size_t end = i;
    while (end < tags.size() && std::log(tags[end].size_ratio / tags[i].size_ratio) <= limit) ++end;
    if (end - i > most) {
      most = end - i;
      first = i;
    }
  }
  if (2 * most > tags.size()) return "";
  std::vector<int> ids, others;
  double sum = 0.0, other_sum = 0.0;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const bool is_one = i >= first && i < first + most;
    (is_one ? ids : others).push_back(tags[i].id);
    (is_one ? sum : other_sum) += tags[i].size_ratio;
  }
  const double ratio =
      sum / static_cast<double>(ids.size()) / (other_sum / static_cast<double>(others.size()));
  return tags_text(ids) + " are " +
         words(100.0 * std::abs(ratio - 1.0), ratio < 1.0 ? " % smaller" : " % larger") + " than " +
         tags_text(others) +
         ", compared with their stated sizes, and neither group has more than half of the tags: the images "
         "do not tell which are as stated; measure a tag of each with a ruler, and state what is measured";
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
  // Printed and glued boards are never better than these.
  const double stated_place = std::max(board.errors.place, 1e-4),
               stated_turn = std::max(board.errors.turn, 1e-3),
               stated_size = std::max(board.errors.size, 1e-4);
  const PlacesScale places = scale_of_places(board, bundle.board, stated_place, stated_size);
  constexpr double sigmas = 5.0;
  found.places_scale = places.scale;
  found.scale_tolerance = sigmas * std::hypot(places.sigma, scale_sigma(places, fit.covariance));
  found.is_scale_contradicted = std::abs(std::log(places.scale)) > found.scale_tolerance;
  const Eigen::VectorXd variances = fit.covariance.diagonal();
  double place = 0.0, turn = 0.0, size = 0.0;
  std::string blurred;
  int column = kSharedUnknowns;
  for (const auto& [id, measured] : bundle.board.tags) {
    const MountedTag& stated = board.tags.at(id);
    MountedTag& tag = found.board.tags.at(id);
    tag = {measured.size, places.stated_from_measured * measured.body_from_tag};
    const Vector6d moved = difference(stated.body_from_tag, places.scaled(measured.body_from_tag));
    TagChange change{id,
                     views_of(bundle, id),
                     tag.size / stated.size,
                     std::sqrt(variances[column]),
                     moved.head<3>().norm(),
                     worst_of(variances, column + 1),
                     moved.tail<3>().norm(),
                     worst_of(variances, column + 4)};
    change.is_size_wrong =
        std::abs(std::log(change.size_ratio)) > sigmas * std::hypot(stated_size, change.size_sigma);
    change.is_turn_wrong = change.turned > sigmas * std::hypot(stated_turn, change.turn_sigma);
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
  // Which tag has the frame, and is known exactly, is arbitrary: places hold as well as the worst one.
  for (TagChange& tag : found.tags) tag.is_place_wrong = tag.moved > sigmas * std::hypot(stated_place, place);
  found.board.errors = {board.errors.scale, size, place, turn};
  found.refusal = divided(found.tags, sigmas * std::hypot(std::sqrt(2.0) * stated_size, size));
  if (found.refusal.empty()) found.refusal = found.is_scale_contradicted ? contradiction(found) : blurred;
  return found;
}

}  // namespace clearway
