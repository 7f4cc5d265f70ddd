#include "planning/beam/via_beam.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/robot/bring_point.hpp"

namespace clearway {
namespace {

struct ViaHead {
  Configuration q;
  double length = 0.0;  ///< weighted, of the path to it
  double rank = 0.0;
  int parent = -1;
};

struct Region {
  Eigen::Vector3d center;
  double play = 0.0;  ///< metres, how far from the centre the hand may be
};

/// Points of the route every `spacing` metres, its ends included.
std::vector<Region> regions_of(const EndEffectorRoute& route, const EndEffector& hand, double spacing) {
  std::vector<Region> regions;
  double left = 0.0;  // to the next region
  const double least_play = 0.1 * hand.outer_radius;
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    const Eigen::Vector3d step = route.points[i] - route.points[i - 1];
    const double length = step.norm();
    for (; left <= length && length > 0.0; left += spacing) {
      const double play = std::max(least_play, 0.5 * (route.radii[i] - hand.outer_radius));
      regions.push_back({route.points[i - 1] + left / length * step, std::min(play, 0.5 * spacing)});
    }
    left -= length;
  }
  regions.push_back({route.points.back(), least_play});
  return regions;
}

class Search {
 public:
  Search(const PlanProblem& problem, const EndEffector& hand, const Eigen::VectorXd& weight,
         const ViaBeamOptions& options)
      : problem_(problem),
        robot_(problem.space.robot()),
        hand_(hand),
        weight_(weight),
        options_(options),
        random_(problem.seed) {
    lower_.resize(weight.size()), upper_.resize(weight.size());
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      lower_[static_cast<Eigen::Index>(j)] = robot_.joints[j].lower;
      upper_[static_cast<Eigen::Index>(j)] = robot_.joints[j].upper;
    }
    heads_.push_back({problem.start, 0.0, 0.0, -1});
    beam_ = {0};
  }

  /// Moves the beam on to the region; false when no head gets there.
  bool advance(const Region& region, double share_of_rest) {
    for (int effort = 1; effort <= options_.effort; effort *= 4) {
      std::vector<ViaHead> found;
      for (const int head : beam_) {
        for (int child = 0; child < effort * options_.children; ++child) {
          if (problem_.out_of_time()) return false;
          try_child(head, region, share_of_rest, child, found);
        }
      }
      if (keep(found)) return true;
    }
    return false;
  }

  /// The path to the goal by the straight edge of the first head that has one; empty when none has.
  std::vector<Configuration> join_goal() {
    for (const int head : beam_) {
      ++edges;
      if (!problem_.space.is_edge_free(heads_[static_cast<std::size_t>(head)].q, problem_.goal)) continue;
      std::vector<Configuration> path = path_to(head);
      if (path.back() != problem_.goal) path.push_back(problem_.goal);
      return path;
    }
    return {};
  }

  std::vector<Configuration> path_to(int head) const {
    std::vector<Configuration> path;
    for (int i = head; i >= 0; i = heads_[static_cast<std::size_t>(i)].parent) {
      path.push_back(heads_[static_cast<std::size_t>(i)].q);
    }
    std::reverse(path.begin(), path.end());
    return path;
  }
  std::vector<Configuration> best_path() const { return path_to(beam_.front()); }

  std::uint64_t configurations = 0, edges = 0;

 private:
  double uniform() { return random_unit(random_); }

  void try_child(int parent, const Region& region, double share, int child, std::vector<ViaHead>& found) {
    const Configuration from = heads_[static_cast<std::size_t>(parent)].q;
    Configuration q = from;
    Eigen::Vector3d target = region.center;
    if (child == 1) q += share * (problem_.goal - from);
    if (child >= 2) {
      const double wild = 0.15 * (1.0 + child / options_.children);  // radians of a revolute joint
      const double drawn_to_goal = child % 2 == 0 ? 2.0 * share * uniform() : 0.0;
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        q[j] += std::min(1.0, drawn_to_goal) * (problem_.goal[j] - from[j]) +
                wild * (2.0 * uniform() - 1.0) / weight_[j];
      }
      for (int k = 0; k < 3; ++k) target[k] += region.play * (2.0 * uniform() - 1.0);
    }
    q = q.cwiseMax(lower_).cwiseMin(upper_);
    if (!bring_point(robot_, {hand_.link, hand_.center, target, 0.1 * region.play}, 8, q, poses_)) return;
    ++configurations;
    if (!problem_.space.is_free(q)) return;
    ViaHead head{q, 0.0, 0.0, parent};
    head.length = heads_[static_cast<std::size_t>(parent)].length + weight_.cwiseProduct(q - from).norm();
    head.rank = 0.5 * head.length + weight_.cwiseProduct(problem_.goal - q).norm();
    found.push_back(std::move(head));
  }

  /// The best of all, then the best of those that are not close to one kept before: the beam must not
  /// crowd into one posture of the arm. Of those that would be kept the edge is asked for. False when there
  /// are none; the beam stays then.
  bool keep(std::vector<ViaHead>& found) {
    std::stable_sort(found.begin(), found.end(),
                     [](const ViaHead& a, const ViaHead& b) { return a.rank < b.rank; });
    std::vector<bool> taken(found.size(), false);  // or refused
    std::vector<int> beam;
    for (const double apart : {0.3, 0.1, 0.0}) {
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (static_cast<int>(beam.size()) == options_.width) break;
        if (taken[i]) continue;
        const bool is_apart = std::all_of(beam.begin(), beam.end(), [&](int other) {
          return weight_.cwiseProduct(heads_[static_cast<std::size_t>(other)].q - found[i].q).norm() >= apart;
        });
        if (!is_apart) continue;
        if (problem_.out_of_time()) return false;
        taken[i] = true;
        ++edges;
        if (!problem_.space.is_edge_free(heads_[static_cast<std::size_t>(found[i].parent)].q, found[i].q))
          continue;
        beam.push_back(static_cast<int>(heads_.size()));
        heads_.push_back(found[i]);
      }
    }
    if (beam.empty()) return false;
    beam_ = std::move(beam);
    std::stable_sort(beam_.begin(), beam_.end(), [this](int a, int b) {
      return heads_[static_cast<std::size_t>(a)].rank < heads_[static_cast<std::size_t>(b)].rank;
    });
    return true;
  }

  const PlanProblem& problem_;
  const Robot& robot_;
  const EndEffector& hand_;
  const Eigen::VectorXd& weight_;
  ViaBeamOptions options_;
  std::mt19937_64 random_;
  Configuration lower_, upper_;
  LinkPoses poses_;
  std::vector<ViaHead> heads_;
  std::vector<int> beam_;
};

}  // namespace

ViaPath search_via_regions(const PlanProblem& problem, const EndEffector& hand, const EndEffectorRoute& route,
                           const Eigen::VectorXd& weight, const ViaBeamOptions& options) {
  ViaPath result;
  double spacing = options.spacing > 0.0 ? options.spacing : 0.5 * hand.outer_radius;
  for (int halving = 0; halving <= options.halvings; ++halving, spacing *= 0.5) {
    const std::vector<Region> regions = regions_of(route, hand, spacing);
    Search search(problem, hand, weight, options);
    std::size_t at = 0;
    while (at < regions.size() &&
           search.advance(regions[at], 1.0 / static_cast<double>(regions.size() - at))) {
      ++at;
    }
    result.regions = regions.size();
    result.reached = at;
    result.farthest = search.best_path();
    if (at < regions.size()) result.stopped_at = regions[at].center;
    if (at == regions.size()) result.waypoints = search.join_goal();
    result.configurations += search.configurations;
    result.edges += search.edges;
    if (!result.waypoints.empty() || problem.out_of_time()) break;
  }
  return result;
}

}  // namespace clearway
