#include "tracking/calibration/bundle_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/calibration/straight_edges.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

// Sizes are dynamic although they are known: fixed ones took half a minute to compile.
constexpr int kFirstOfPose = kSharedUnknowns + kTagUnknowns;

int column(int tag) { return kSharedUnknowns + kTagUnknowns * tag; }

Eigen::Matrix3d turned(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

Eigen::Vector3d log_of(const Eigen::Matrix3d& turn) {
  const Eigen::AngleAxisd by(turn);
  return by.angle() * by.axis();
}

void move_camera(Camera& camera, const Eigen::VectorXd& step) {
  camera.fx *= std::exp(step[0] + 0.5 * step[1]);
  camera.fy *= std::exp(step[0] - 0.5 * step[1]);
  camera.cx += step[2];
  camera.cy += step[3];
  for (int i = 0; i < kLensUnknowns; ++i) camera.distortion[static_cast<std::size_t>(i)] += step[4 + i];
}

}  // namespace

/// One tag of one view, whitened: its eight residuals, and their derivatives by what is shared, tag and pose,
/// but for those of how far the lens bends edges, which hardly change.
struct BundleProblem::Block {
  Eigen::VectorXd residual{8};
  Eigen::MatrixXd by{8, kFirstOfPose + 6};
};

BundleProblem::BundleProblem(const Bundle& bundle, const BundlePriors& priors, double noise_px,
                             double edge_bias)
    : bundle_(bundle), size_(kSharedUnknowns + kTagUnknowns * static_cast<int>(bundle.board.tags.size())) {
  for (const auto& [id, tag] : bundle.board.tags) order_.emplace(id, static_cast<int>(order_.size()));
  sigma_.resize(size_);
  for (int i = 0; i < kSharedUnknowns; ++i) sigma_[i] = priors.shared[static_cast<std::size_t>(i)];
  for (std::size_t tag = 0; tag < priors.tags.size(); ++tag)
    for (int i = 0; i < kTagUnknowns; ++i)
      sigma_[column(static_cast<int>(tag)) + i] = priors.tags[tag][static_cast<std::size_t>(i)];
  for (const BoardView& view : bundle.views) {
    whitening_.emplace_back();
    edges_.emplace_back();
    for (const TagDetection& tag : view.tags) {
      whitening_.back().push_back(whitening(view, tag, noise_px, edge_bias));
      double around = 0.0;
      for (std::size_t i = 0; i < 4; ++i) around += (tag.corners[(i + 1) % 4] - tag.corners[i]).norm();
      edges_.back().push_back({outward(tag.corners), std::max(1.0, around / 4.0)});
    }
  }
}

BundleState BundleProblem::start() const {
  BundleState state{bundle_.camera, bundle_.bend, {}, {}};
  state.tags.resize(order_.size(), Eigen::VectorXd::Zero(kTagUnknowns));
  for (const BoardView& view : bundle_.views) state.poses.push_back(view.camera_from_board);
  return state;
}

double BundleProblem::cost(const BundleState& state) const {
  double sum = squares_of_priors(state);
  for (std::size_t v = 0; v < bundle_.views.size(); ++v)
    for (std::size_t t = 0; t < bundle_.views[v].tags.size(); ++t) {
      const auto residual = residual_of(state, v, t);
      if (!residual) return std::numeric_limits<double>::infinity();
      sum += residual->squaredNorm();
    }
  return sum;
}

std::optional<Eigen::VectorXd> BundleProblem::residual_of(const BundleState& state, std::size_t view,
                                                          std::size_t tag) const {
  const auto misses = misses_of(state, view, tag);
  if (!misses) return std::nullopt;
  Eigen::VectorXd residual(8);
  for (int i = 0; i < 4; ++i) residual.segment<2>(2 * i) = (*misses)[static_cast<std::size_t>(i)];
  return product(whitening_[view][tag], residual);
}

std::optional<std::array<Eigen::Vector2d, 4>> BundleProblem::misses_of(const BundleState& state,
                                                                       std::size_t view,
                                                                       std::size_t tag) const {
  const TagDetection& seen = bundle_.views[view].tags[tag];
  auto corners =
      corners_by_straight_edges(state.camera, mounted_of(state, seen.id), state.bend, state.poses[view]);
  for (std::size_t i = 0; corners && i < 4; ++i)
    (*corners)[i] += growth_of(state, view, tag, i) - seen.corners[i];
  return corners;
}

std::optional<BundleProblem::Equations> BundleProblem::equations(const BundleState& state) const {
  Equations e;
  e.shared = Eigen::MatrixXd::Zero(size_, size_);
  e.pull = Eigen::VectorXd::Zero(size_);
  add_priors(state, e);
  for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
    e.mixed.emplace_back(Eigen::MatrixXd::Zero(size_, 6));
    e.pose.emplace_back(Eigen::MatrixXd::Zero(6, 6));
    e.pose_pull.emplace_back(Eigen::VectorXd::Zero(6));
    e.focal.emplace_back(Eigen::VectorXd::Zero(size_));
    e.focal_pull.push_back(0.0);
    for (std::size_t t = 0; t < bundle_.views[v].tags.size(); ++t) {
      const auto block = block_of(state, v, t);
      if (!block) return std::nullopt;
      add_block(*block, column(order_.at(bundle_.views[v].tags[t].id)), e);
    }
  }
  return e;
}

Eigen::VectorXd BundleProblem::step(const Equations& e, double damping) const {
  Eigen::MatrixXd reduced = e.shared;
  reduced.diagonal() *= 1.0 + damping;
  Eigen::VectorXd pull = e.pull;
  std::vector<Cholesky> solvers;
  for (std::size_t v = 0; v < e.pose.size(); ++v) {
    Eigen::MatrixXd pose = e.pose[v];
    pose.diagonal() *= 1.0 + damping;
    solvers.emplace_back(pose);
    reduced -= product(e.mixed[v], solvers.back().solve(e.mixed[v].transpose()));
    pull -= product(e.mixed[v], solvers.back().solve(e.pose_pull[v]));
  }
  Eigen::VectorXd step(size_ + 6 * static_cast<int>(e.pose.size()));
  step.head(size_) = -solve_symmetric(reduced, pull);
  for (std::size_t v = 0; v < e.pose.size(); ++v)
    step.segment(size_ + 6 * static_cast<int>(v), 6) =
        -solvers[v].solve(e.pose_pull[v] + transposed_product(e.mixed[v], step.head(size_)));
  return step;
}

BundleState BundleProblem::moved(const BundleState& from, const Eigen::VectorXd& step) const {
  BundleState to = from;
  move_camera(to.camera, step);
  to.bend.curvatures += step.segment<kBendUnknowns>(kFirstOfBend);
  to.bend.stretch += step[kStretchUnknown];
  to.shift += step.head(kSharedUnknowns);
  for (std::size_t t = 0; t < to.tags.size(); ++t) {
    const Eigen::VectorXd by = step.segment(column(static_cast<int>(t)), kTagUnknowns);
    to.tags[t].head(4) += by.head(4);
    to.tags[t].tail<3>() = log_of(turned(to.tags[t].tail<3>()) * turned(by.tail<3>()));
  }
  for (std::size_t v = 0; v < to.poses.size(); ++v)
    to.poses[v] = clearway::moved(to.poses[v], step.segment<6>(size_ + 6 * static_cast<int>(v)));
  return to;
}

Eigen::MatrixXd BundleProblem::covariance(const Equations& e) const {
  Eigen::MatrixXd reduced = e.shared;
  for (std::size_t v = 0; v < e.pose.size(); ++v)
    reduced -= product(e.mixed[v], Cholesky(e.pose[v]).solve(e.mixed[v].transpose()));
  const Cholesky solver(reduced);
  if (!solver.is_positive()) return {};
  Eigen::MatrixXd covariance = solver.inverse();
  for (int i = 0; i < size_; ++i)
    if (sigma_[i] == 0.0) {
      covariance.row(i).setZero();
      covariance.col(i).setZero();
    }
  return covariance;
}

std::vector<BundleFit::FocalStep> BundleProblem::focal_steps(const Equations& e) {
  std::vector<BundleFit::FocalStep> steps(e.pose.size());
  for (std::size_t v = 0; v < steps.size(); ++v) {
    const Eigen::VectorXd by_pose = e.mixed[v].row(0);
    const Cholesky pose(e.pose[v]);
    if (!pose.is_positive()) continue;
    const double information = e.focal[v][0] - pose.squared(by_pose);
    if (!(information > 1e-9 * e.focal[v][0])) continue;
    const double pull = e.focal_pull[v] - by_pose.dot(pose.solve(e.pose_pull[v]).col(0));
    steps[v] = {-pull / information, 1.0 / std::sqrt(information)};
  }
  return steps;
}

Eigen::MatrixXd BundleProblem::by_own_focal(const Equations& e, const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd pull(e.pull.size(), static_cast<int>(e.focal.size()));
  for (std::size_t v = 0; v < e.focal.size(); ++v)
    pull.col(static_cast<int>(v)) =
        e.focal[v] - product(e.mixed[v], Cholesky(e.pose[v]).solve(e.mixed[v].row(0).transpose()));
  return product(covariance, pull);
}

MountedTag BundleProblem::mounted_of(const BundleState& state, int id) const {
  MountedTag tag = bundle_.board.tags.at(id);
  const auto& off = state.tags[static_cast<std::size_t>(order_.at(id))];
  tag.size *= std::exp(off[0]);
  tag.body_from_tag.translation() += off.segment<3>(1);
  tag.body_from_tag.linear() *= turned(off.tail<3>());
  return tag;
}

Eigen::Vector2d BundleProblem::growth_of(const BundleState& state, std::size_t view, std::size_t tag,
                                         std::size_t corner) const {
  const Edges& edges = edges_[view][tag];
  return (state.shift[kFirstOfGrowth] + state.shift[kFirstOfGrowth + 1] / edges.side) * edges.outward[corner];
}

int BundleProblem::unknowns() const {
  return static_cast<int>((sigma_.array() > 0.0).count() + 6 * bundle_.views.size());
}
int BundleProblem::priors() const {
  return static_cast<int>((sigma_.array() > 0.0 && sigma_.array().isFinite()).count());
}

/// W with W^T W the inverse of the covariance of a tag's corners.
Eigen::MatrixXd BundleProblem::whitening(const BoardView& view, const TagDetection& tag, double noise_px,
                                         double edge_bias) const {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  const MountedTag& mounted = bundle_.board.tags.at(tag.id);
  if (const auto seen = view_tag(bundle_.camera, mounted.size, mounted.body_from_tag, {}, edge_bias,
                                 tag.corners, view.camera_from_board)) {
    covariance = squared(seen->by_own.rightCols<4>());
  }
  covariance.diagonal().array() += noise_px * noise_px;
  return Cholesky(covariance).whitening();
}

double BundleProblem::off(const BundleState& state, int i) const {
  if (i < kSharedUnknowns) return state.shift[i];
  const int tag = (i - kSharedUnknowns) / kTagUnknowns;
  return state.tags[static_cast<std::size_t>(tag)][(i - kSharedUnknowns) % kTagUnknowns];
}

double BundleProblem::squares_of_priors(const BundleState& state) const {
  double sum = 0.0;
  for (int i = 0; i < size_; ++i)
    if (sigma_[i] > 0.0 && std::isfinite(sigma_[i])) sum += std::pow(off(state, i) / sigma_[i], 2);
  return sum;
}

void BundleProblem::add_priors(const BundleState& state, Equations& e) const {
  for (int i = 0; i < size_; ++i) {
    if (sigma_[i] == 0.0) e.shared(i, i) = 1.0;
    if (!(sigma_[i] > 0.0) || !std::isfinite(sigma_[i])) continue;
    e.shared(i, i) = 1.0 / (sigma_[i] * sigma_[i]);
    e.pull[i] = off(state, i) / (sigma_[i] * sigma_[i]);
  }
}

std::optional<BundleProblem::Block> BundleProblem::block_of(const BundleState& state, std::size_t view,
                                                            std::size_t tag) const {
  const auto residual = residual_of(state, view, tag);
  if (!residual) return std::nullopt;
  Block block{*residual};
  const TagDetection& seen = bundle_.views[view].tags[tag];
  const MountedTag mounted = mounted_of(state, seen.id);
  const Eigen::Isometry3d& pose = state.poses[view];
  const Eigen::Matrix3d turn = mounted.body_from_tag.linear();
  const auto corners = tag_corners(mounted.size);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d& in_tag = corners[static_cast<std::size_t>(i)];
    const Eigen::Vector3d flat = mounted.body_from_tag * in_tag, in_board = state.bend.bent(flat);
    const Eigen::Vector3d in_camera = pose * in_board;
    Eigen::Matrix<double, 2, 3> by_point;
    state.camera.project(in_camera, by_point);
    by_point = by_point * pose.linear();
    const Eigen::Matrix<double, 2, 3> by_flat = by_point * state.bend.by_point(flat);
    const auto corner = static_cast<std::size_t>(i);
    const Edges& edges = edges_[view][tag];
    block.by.block(2 * i, 0, 2, kSharedUnknowns) = pixel_by_camera(state.camera, in_camera);
    block.by.block<2, 1>(2 * i, kFirstOfGrowth) = edges.outward[corner];
    block.by.block<2, 1>(2 * i, kFirstOfGrowth + 1) = edges.outward[corner] / edges.side;
    block.by.block<2, kBendUnknowns>(2 * i, kFirstOfBend) = by_point * state.bend.by_curvatures(flat);
    block.by.block<2, 1>(2 * i, kStretchUnknown) = by_point * state.bend.by_stretch(flat);
    block.by.block<2, 1>(2 * i, kSharedUnknowns) = by_flat * (turn * in_tag);
    block.by.block<2, 3>(2 * i, kSharedUnknowns + 1) = by_flat;
    block.by.block<2, 3>(2 * i, kSharedUnknowns + 4) = -by_flat * turn * cross_matrix(in_tag);
    block.by.block<2, 3>(2 * i, kFirstOfPose) = by_point;
    block.by.block<2, 3>(2 * i, kFirstOfPose + 3) = -by_point * cross_matrix(in_board);
  }
  block.by = product(whitening_[view][tag], block.by);
  const int own = column(order_.at(seen.id));
  for (int i = 0; i < kFirstOfPose; ++i)
    if (sigma_[i < kSharedUnknowns ? i : own + i - kSharedUnknowns] == 0.0) block.by.col(i).setZero();
  return block;
}

void BundleProblem::add_block(const Block& block, int own, Equations& e) {
  constexpr int shared = kSharedUnknowns, tag = kTagUnknowns;
  const Eigen::MatrixXd square = transposed_product(block.by, block.by);
  const Eigen::VectorXd pull = transposed_product(block.by, block.residual);
  e.shared.topLeftCorner(shared, shared) += square.topLeftCorner(shared, shared);
  e.shared.block(0, own, shared, tag) += square.block(0, shared, shared, tag);
  e.shared.block(own, 0, tag, shared) += square.block(shared, 0, tag, shared);
  e.shared.block(own, own, tag, tag) += square.block(shared, shared, tag, tag);
  e.pull.head(shared) += pull.head(shared);
  e.pull.segment(own, tag) += pull.segment(shared, tag);
  e.mixed.back().topRows(shared) += square.topRightCorner(shared, 6);
  e.mixed.back().middleRows(own, tag) += square.block(shared, kFirstOfPose, tag, 6);
  e.pose.back() += square.bottomRightCorner(6, 6);
  e.pose_pull.back() += pull.tail(6);
  e.focal.back().head(shared) += square.block(0, 0, shared, 1);
  e.focal.back().segment(own, tag) += square.block(shared, 0, tag, 1);
  e.focal_pull.back() += pull[0];
}

}  // namespace clearway
