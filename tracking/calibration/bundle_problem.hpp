#pragma once

#include <array>
#include <map>
#include <optional>

#include "tracking/calibration/bundle.hpp"

namespace clearway {

/// What the unknowns of camera and tags have become, and the poses.
struct BundleState {
  Camera camera;
  BoardBend bend;
  std::vector<Eigen::VectorXd> tags;  ///< from where they were given
  std::vector<Eigen::Isometry3d> poses;
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(kSharedUnknowns);
};

/// The least squares of a bundle adjustment (adjust): residuals, their cost and their normal equations, with
/// what never changes in them.
class BundleProblem {
 public:
  /// @param bundle outlives this one @pre as adjust
  BundleProblem(const Bundle& bundle, const BundlePriors& priors, double noise_px, double edge_bias);

  BundleState start() const;

  /// The sum of all squares; infinity where a corner is out of sight.
  double cost(const BundleState& state) const;

  /// The eight coordinates of a tag's corners in a view, whitened; none where a corner is out of sight.
  std::optional<Eigen::VectorXd> residual_of(const BundleState& state, std::size_t view,
                                             std::size_t tag) const;

  /// The normal equations at a state: those of the shared unknowns, and what eliminating the poses needs.
  struct Equations {
    Eigen::MatrixXd shared;
    Eigen::VectorXd pull;
    std::vector<Eigen::MatrixXd> mixed, pose;
    std::vector<Eigen::VectorXd> pose_pull;
    std::vector<Eigen::VectorXd> focal;  ///< what each view has in the focal length's column of `shared`
    std::vector<double> focal_pull;      ///< and in its pull
  };
  /// None where a corner is out of sight.
  std::optional<Equations> equations(const BundleState& state) const;

  /// The step that the damped equations ask for. The last 6 x views entries are the poses'.
  Eigen::VectorXd step(const Equations& e, double damping) const;
  BundleState moved(const BundleState& from, const Eigen::VectorXd& step) const;

  /// Of the shared unknowns, poses eliminated; empty where these are not determined.
  Eigen::MatrixXd covariance(const Equations& e) const;

  /// See BundleFit.
  static std::vector<BundleFit::FocalStep> focal_steps(const Equations& e);
  static Eigen::MatrixXd by_own_focal(const Equations& e, const Eigen::MatrixXd& covariance);

  MountedTag mounted_of(const BundleState& state, int id) const;

  /// How far from where a tag's corners were found in a view they should be by the state, pixels; none where
  /// one is out of sight.
  std::optional<std::array<Eigen::Vector2d, 4>> misses_of(const BundleState& state, std::size_t view,
                                                          std::size_t tag) const;

  int unknowns() const;
  int priors() const;

 private:
  struct Block;
  Eigen::MatrixXd whitening(const BoardView& view, const TagDetection& tag, double noise_px,
                            double edge_bias) const;
  /// How far the state has the corner outside of where camera and pose put it, pixels.
  Eigen::Vector2d growth_of(const BundleState& state, std::size_t view, std::size_t tag,
                            std::size_t corner) const;
  double off(const BundleState& state, int i) const;
  double squares_of_priors(const BundleState& state) const;
  void add_priors(const BundleState& state, Equations& e) const;
  std::optional<Block> block_of(const BundleState& state, std::size_t view, std::size_t tag) const;
  static void add_block(const Block& block, int own, Equations& e);

  const Bundle& bundle_;
  int size_;
  std::map<int, int> order_;
  Eigen::VectorXd sigma_;
  std::vector<std::vector<Eigen::MatrixXd>> whitening_;
  struct Edges {
    std::array<Eigen::Vector2d, 4> outward;
    double side = 1.0;  ///< pixels
  };
  std::vector<std::vector<Edges>> edges_;
};

}  // namespace clearway
