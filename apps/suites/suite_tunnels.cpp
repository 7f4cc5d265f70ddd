#include "apps/suites/suite_tunnels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_draws.hpp"
#include "apps/suites/suite_hand.hpp"
#include "apps/suites/suite_world.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr int most_tunnel_draws = 2000;
constexpr double widest_turn = 1.2;  ///< rad (or share of m), of a joint between two turns of a way

class TunnelDrawer {
 public:
  TunnelDrawer(const SuiteGenerator& generator, std::size_t index, const Robot& robot, double padding)
      : resolution_(generator.resolution),
        padding_(padding),
        robot_(robot),
        hand_(robot, generator.kind),
        bare_(robot, Snapshot(), {.parts = {}, .critical_by_default = false}),
        dice_(generator.seed, index) {}

  /// A winding way that the robot can go where nothing is; empty when this draw gave none.
  std::vector<Configuration> way() {
    const int turns = dice_.whole(3, 6);
    std::vector<Configuration> way{anywhere()};
    if (!bare_.is_free(way.front())) return {};
    while (static_cast<int>(way.size()) < turns + 2) {
      const auto next = next_turn(way.back());
      if (!next) return {};
      way.push_back(*next);
    }
    return way;
  }

  /// The spheres along the hand's way, a stroke for each straight piece.
  std::vector<std::vector<SuiteSphere>> strokes(const std::vector<Configuration>& way) {
    std::vector<std::vector<SuiteSphere>> strokes;
    for (std::size_t i = 1; i < way.size(); ++i) {
      auto& stroke = strokes.emplace_back();
      Eigen::Vector3d last = hand_.sphere(way[i - 1]).center;
      stroke.push_back(painted(hand_.sphere(way[i - 1])));
      for (const Configuration& q : finely(way[i - 1], way[i], 0.1 * degree)) {
        const Sphere sphere = hand_.sphere(q);
        if ((sphere.center - last).norm() < painted_radius(sphere) / 3.0) continue;
        stroke.push_back(painted(sphere));
        last = sphere.center;
      }
    }
    strokes.back().push_back(painted(hand_.sphere(way.back())));
    return strokes;
  }

 private:
  Configuration anywhere() {
    Configuration q(static_cast<Eigen::Index>(robot_.dof()));
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      const double low = std::max(robot_.joints[j].lower, -std::numbers::pi);
      const double high = std::min(robot_.joints[j].upper, std::numbers::pi);
      q[static_cast<Eigen::Index>(j)] = low + dice_.between(0.1, 0.9) * (high - low);
    }
    return q;
  }

  /// A configuration a straight edge away, with the hand clear of where it was painted before.
  std::optional<Configuration> next_turn(const Configuration& from) {
    const Sphere hand = hand_.sphere(from);
    for (int attempt = 0; attempt < 30; ++attempt) {
      Configuration next = from;
      for (Eigen::Index j = 0; j < next.size(); ++j) {
        const Joint& joint = robot_.joints[static_cast<std::size_t>(j)];
        const double most = std::min(widest_turn, 0.3 * (joint.upper - joint.lower));
        next[j] += dice_.between(-most, most);
      }
      if ((hand_.sphere(next).center - hand.center).norm() < 2.0 * painted_radius(hand)) continue;
      if (bare_.is_edge_free(from, next)) return next;
    }
    return std::nullopt;
  }

  double jitter() const { return resolution_ / 2.0; }

  /// Of a sphere that holds the hand with a voxel to spare when it is up to a sixth of its radius, and the
  /// jitter, off the hand; voxels are painted when they lie inside as a whole.
  double painted_radius(const Sphere& hand) const {
    return 1.2 * (hand.radius + padding_ + jitter() + (1.0 + std::sqrt(3.0)) * resolution_);
  }

  SuiteSphere painted(const Sphere& hand) {
    const double most = jitter() / std::sqrt(3.0);
    const Eigen::Vector3d aside(dice_.between(-most, most), dice_.between(-most, most),
                                dice_.between(-most, most));
    return {hand.center + aside, painted_radius(hand)};
  }

  double resolution_, padding_;
  const Robot& robot_;
  SuiteHand hand_;
  ConfigurationSpace bare_;
  SuiteDice dice_;
};

bool is_free_all_along(const ConfigurationSpace& space, const std::vector<Configuration>& way) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const auto fine = finely(way[i - 1], way[i], degree);
    for (std::size_t k = 1; k < fine.size(); ++k)
      if (!space.is_edge_free(fine[k - 1], fine[k])) return false;
  }
  return true;
}

}  // namespace

Tunnel draw_tunnel(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                   const Policies& policies, double padding) {
  TunnelDrawer drawer(generator, index, robot, padding);
  std::string drawn = "for robot " + quote(robot.name);  // with its policies once a map is made
  for (int draw = 0; draw < most_tunnel_draws; ++draw) {
    Tunnel tunnel;
    tunnel.way = drawer.way();
    if (tunnel.way.empty()) continue;
    tunnel.world.name = "tunnel " + std::to_string(index + 1);
    tunnel.world.resolution = generator.resolution;
    tunnel.world.volumes.push_back({"tube", {}, drawer.strokes(tunnel.way)});
    tunnel.map = make_map(tunnel.world, robot.critical_parts);
    const ConfigurationSpace space(robot, tunnel.map, policies, {.padding = padding});
    drawn = drawn_for(space);
    const Configuration &start = tunnel.way.front(), &goal = tunnel.way.back();
    if (!space.is_free(start) || !space.is_free(goal) || space.is_edge_free(start, goal)) continue;
    if (is_free_all_along(space, tunnel.way)) return tunnel;
  }
  throw DrawnInVain("tunnels: no tunnel found " + drawn + " in " + grouped(most_tunnel_draws) + " draws");
}

}  // namespace clearway
