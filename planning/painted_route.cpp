#include "planning/painted_route.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_map>
#include <utility>

namespace clearway {
namespace {

/// Radius of the circle in which two spheres meet, squared; that of the lesser one when it lies inside the
/// other, negative when they are apart.
double passage_squared(const Sphere& a, const Sphere& b) {
  const double d = (a.center - b.center).norm();
  if (d >= a.radius + b.radius) return -1.0;
  const double lesser = std::min(a.radius, b.radius);
  if (d <= std::abs(a.radius - b.radius)) return lesser * lesser;
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2.0 * d);
  // Of two balls whose middles lie on one side of the circle, the lesser one's equator is the narrowest
  // place.
  if (along < 0.0 || along > d) return lesser * lesser;
  return a.radius * a.radius - along * along;
}

/// Middle of the lens in which two balls overlap.
Eigen::Vector3d meeting_point(const Sphere& a, const Sphere& b) {
  const Eigen::Vector3d way = b.center - a.center;
  const double d = way.norm();
  if (d == 0.0) return a.center;
  return a.center + std::clamp(0.5 * (d + a.radius - b.radius) / d, 0.0, 1.0) * way;
}

/// Cells as large as the largest ball is wide: neighbours lie in cells that touch.
class BallGrid {
 public:
  explicit BallGrid(const std::vector<Sphere>& balls) {
    for (const Sphere& ball : balls) edge_ = std::max(edge_, 2.0 * ball.radius);
    for (std::size_t i = 0; i < balls.size(); ++i) {
      cells_[key(cell(balls[i].center))].push_back(static_cast<int>(i));
    }
  }
  template <typename Visit>
  void visit_near(const Eigen::Vector3d& point, Visit visit) const {
    const auto at = cell(point);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = cells_.find(key({at[0] + x, at[1] + y, at[2] + z}));
          if (found == cells_.end()) continue;
          for (const int i : found->second) visit(i);
        }
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell(const Eigen::Vector3d& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / edge_)),
            static_cast<std::int64_t>(std::floor(p.y() / edge_)),
            static_cast<std::int64_t>(std::floor(p.z() / edge_))};
  }
  static std::uint64_t key(const Cell& c) {  // 21 bits an axis: balls lie in a map of 2^16 voxels
    const auto bits = [](std::int64_t v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffffu; };
    return bits(c[0]) << 42u | bits(c[1]) << 21u | bits(c[2]);
  }
  double edge_ = 1e-6;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace

PaintedGraph::PaintedGraph(const Snapshot& map, std::uint16_t volumes, double passage) {
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    if ((volumes >> v & 1u) == 0) continue;
    const std::vector<Sphere>& balls = map.volumes()[v].balls;
    balls_.insert(balls_.end(), balls.begin(), balls.end());
  }
  connect(passage);
  number_pieces();
}

void PaintedGraph::connect(double passage) {
  neighbours_.resize(balls_.size());
  const BallGrid grid(balls_);
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    grid.visit_near(balls_[i].center, [&](int j) {
      if (static_cast<std::size_t>(j) == i) return;
      const double squared = passage_squared(balls_[i], balls_[static_cast<std::size_t>(j)]);
      if (squared >= passage * passage) neighbours_[i].push_back(j);
    });
    std::sort(neighbours_[i].begin(), neighbours_[i].end());
  }
}

void PaintedGraph::number_pieces() {
  pieces_.assign(balls_.size(), -1);
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    if (pieces_[i] >= 0) continue;
    std::vector<int> open{static_cast<int>(i)};
    pieces_[i] = piece_count_;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int next : neighbours_[static_cast<std::size_t>(at)]) {
        if (int& piece = pieces_[static_cast<std::size_t>(next)]; piece < 0) {
          piece = piece_count_;
          open.push_back(next);
        }
      }
    }
    ++piece_count_;
  }
}

std::vector<int> PaintedGraph::holding(const Eigen::Vector3d& point) const {
  std::vector<std::pair<double, int>> found;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const double depth = balls_[i].radius - (point - balls_[i].center).norm();
    if (depth >= 0.0) found.emplace_back(-depth, static_cast<int>(i));
  }
  std::sort(found.begin(), found.end());
  std::vector<int> indices;
  for (const auto& [depth, i] : found) indices.push_back(i);
  return indices;
}

HandRoute PaintedGraph::route(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                              const RoutePrice& price) const {
  std::vector<double> length(balls_.size(), std::numeric_limits<double>::infinity());
  std::vector<int> before(balls_.size(), -1);
  std::vector<double> last_leg(balls_.size(), -1.0);  // to the goal, for balls that hold it
  for (const int i : holding(to)) {
    last_leg[static_cast<std::size_t>(i)] = (ball(static_cast<std::size_t>(i)).center - to).norm();
  }
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const int i : holding(from)) {
    length[static_cast<std::size_t>(i)] = (ball(static_cast<std::size_t>(i)).center - from).norm();
    open.emplace(length[static_cast<std::size_t>(i)], i);
  }
  double best = std::numeric_limits<double>::infinity();
  int end = -1;
  while (!open.empty() && open.top().first < best) {
    const auto [so_far, number] = open.top();
    open.pop();
    const auto i = static_cast<std::size_t>(number);
    if (so_far > length[i]) continue;
    if (last_leg[i] >= 0.0 && so_far + last_leg[i] < best) best = so_far + last_leg[i], end = number;
    for (const int next : neighbours_[i]) {
      const auto n = static_cast<std::size_t>(next);
      const double longer =
          so_far + (balls_[n].center - balls_[i].center).norm() * price(meeting_point(balls_[i], balls_[n]));
      if (longer >= length[n]) continue;
      length[n] = longer;
      before[n] = number;
      open.emplace(longer, next);
    }
  }
  HandRoute route;
  if (end < 0) return route;
  route.points.push_back(to);
  for (int i = end; i >= 0; i = before[static_cast<std::size_t>(i)]) {
    route.points.push_back(balls_[static_cast<std::size_t>(i)].center);
    route.radii.push_back(balls_[static_cast<std::size_t>(i)].radius);
  }
  route.radii.insert(route.radii.begin(), route.radii.front());
  route.points.push_back(from);
  route.radii.push_back(route.radii.back());
  std::reverse(route.points.begin(), route.points.end());
  std::reverse(route.radii.begin(), route.radii.end());
  return route;
}

}  // namespace clearway
