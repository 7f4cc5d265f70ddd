#include "tracking/calibration/places_scale.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tracking/calibration/upper_median.hpp"

namespace clearway {
namespace {

constexpr std::size_t few_tags = 4;  ///< tags: fewer say little of how they scatter

/// A tag's middle and normal, as measured and as stated.
struct TagPlace {
  int id = 0;
  Eigen::Vector3d from, from_normal, to, to_normal;
  double size = 0.0;
};

struct Similarity {
  double scale = 1.0;  ///< measured over stated
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  double off(const TagPlace& tag) const { return (pose * (tag.from / scale) - tag.to).norm(); }
};

std::vector<TagPlace> places_of(const TagBody& stated, const TagBody& measured) {
  std::vector<TagPlace> places;
  for (const auto& [id, tag] : measured.tags) {
    const MountedTag& other = stated.tags.at(id);
    places.push_back({id, tag.body_from_tag.translation(), tag.body_from_tag.linear().col(2),
                      other.body_from_tag.translation(), other.body_from_tag.linear().col(2), other.size});
  }
  return places;
}

struct Means {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
};

Means means_of(const std::vector<TagPlace>& tags, const std::vector<double>& weights) {
  Means means;
  double sum = 0.0;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    means.from += weights[i] * tags[i].from;
    means.to += weights[i] * tags[i].to;
    sum += weights[i];
  }
  means.from /= sum;
  means.to /= sum;
  return means;
}

/// Least squares (Umeyama 1991), normals as points half a tag's side away.
Similarity fit(const std::vector<TagPlace>& tags, const std::vector<double>& weights, bool has_scale) {
  const Means means = means_of(tags, weights);
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < tags.size(); ++i) {
    cross += weights[i] * (tags[i].to - means.to) * (tags[i].from - means.from).transpose();
    cross +=
        weights[i] * 0.25 * tags[i].size * tags[i].size * tags[i].to_normal * tags[i].from_normal.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool is_mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0;
  Similarity found;
  found.pose.linear() = svd.matrixU() * Eigen::Vector3d(1.0, 1.0, is_mirrored ? -1.0 : 1.0).asDiagonal() *
                        svd.matrixV().transpose();
  if (has_scale) {
    double along = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      along += weights[i] *
               (tags[i].from - means.from).dot(found.pose.linear().transpose() * (tags[i].to - means.to));
      squares += weights[i] * (tags[i].to - means.to).squaredNorm();
    }
    // A scale that turns the board inside out, or nearly, is none.
    if (along > 0.1 * squares) found.scale = along / squares;
  }
  found.pose.translation() = means.to - found.pose.linear() * (means.from / found.scale);
  return found;
}

std::vector<double> cauchy_weights(const std::vector<TagPlace>& tags, const Similarity& similarity,
                                   double place) {
  std::vector<double> weights;
  for (const TagPlace& tag : tags) weights.push_back(1.0 / (1.0 + std::pow(similarity.off(tag) / place, 2)));
  return weights;
}

/// Minus the logarithm of Cauchy's likelihood; tags that are turned about an axis in their plane count too.
double cost_of(const std::vector<TagPlace>& tags, const Similarity& similarity, double place, double size) {
  double cost = std::log1p(std::pow(std::log(similarity.scale) / size, 2));
  for (const TagPlace& tag : tags) {
    const double tip = 0.5 * tag.size * (similarity.pose.linear() * tag.from_normal - tag.to_normal).norm();
    cost += std::log1p((std::pow(similarity.off(tag), 2) + tip * tip) / (place * place));
  }
  return cost;
}

/// The best of the similarities by two tags each, and that of all of them.
Similarity best_by_pairs(const std::vector<TagPlace>& tags, double place, double size) {
  Similarity best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const std::vector<double>& weights, bool has_scale) {
    const Similarity one = fit(tags, weights, has_scale);
    if (const double cost = cost_of(tags, one, place, size); cost < least) {
      least = cost;
      best = one;
    }
  };
  for (std::size_t i = 0; i < tags.size(); ++i)
    for (std::size_t j = i + 1; j < tags.size(); ++j) {
      std::vector<double> weights(tags.size(), 0.0);
      weights[i] = weights[j] = 1.0;
      const bool are_apart = (tags[i].to - tags[j].to).norm() > 0.1 * tags[i].size;
      for (const bool has_scale : {false, true})
        if (are_apart || !has_scale) consider(weights, has_scale);
    }
  consider(std::vector<double>(tags.size(), 1.0), true);
  return best;
}

/// Metres along each axis, as the middle one of the tags is off: of normal errors in the board's plane.
double scatter_of(const std::vector<TagPlace>& tags, const Similarity& similarity) {
  if (tags.size() < few_tags) {  // two of three are where a similarity by two has them
    const Similarity all = fit(tags, std::vector<double>(tags.size(), 1.0), true);
    double squares = 0.0;
    for (const TagPlace& tag : tags) squares += std::pow(all.off(tag), 2);
    return std::sqrt(squares / std::max(1.0, 2.0 * static_cast<double>(tags.size()) - 4.0));
  }
  std::vector<double> off;
  for (const TagPlace& tag : tags) off.push_back(similarity.off(tag));
  const double count = static_cast<double>(tags.size()), freedom = std::max(1.0, count - 2.0);
  return upper_median(off) / std::sqrt(2.0 * std::log(2.0)) * std::sqrt(count / freedom);
}

}  // namespace

Eigen::Isometry3d PlacesScale::scaled(const Eigen::Isometry3d& measured) const {
  Eigen::Isometry3d tag = measured;
  tag.translation() /= scale;
  return stated_from_scaled * tag;
}

PlacesScale scale_of_places(const TagBody& stated, const TagBody& measured, double place, double size) {
  const std::vector<TagPlace> tags = places_of(stated, measured);
  Similarity similarity = best_by_pairs(tags, place, size);
  PlacesScale found;
  found.place = std::max(place, scatter_of(tags, similarity));
  std::vector<double> weights;
  for (int round = 0; round < 20; ++round) {
    weights = cauchy_weights(tags, similarity, found.place);
    similarity = fit(tags, weights, true);
  }
  found.place = std::max(place, scatter_of(tags, similarity));
  found.scale = similarity.scale;
  found.stated_from_scaled = similarity.pose;
  const Means means = means_of(tags, weights);
  double squares = 0.0, stated_squares = 0.0;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    squares += weights[i] * (tags[i].from - means.from).squaredNorm();
    stated_squares += weights[i] * (tags[i].to - means.to).squaredNorm();
  }
  for (std::size_t i = 0; i < tags.size(); ++i)
    found.by_place[tags[i].id] = weights[i] * (tags[i].from - means.from) / std::max(squares, 1e-12);
  found.sigma = found.place / std::sqrt(std::max(stated_squares, 1e-12));
  if (tags.size() < few_tags) found.sigma *= 3.0;  // how they scatter is hardly known itself
  Similarity rigid = fit(tags, weights, false);
  for (int round = 0; round < 20; ++round) rigid = fit(tags, cauchy_weights(tags, rigid, found.place), false);
  found.stated_from_measured = rigid.pose;
  return found;
}

}  // namespace clearway
