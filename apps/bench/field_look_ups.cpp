#include "apps/bench/field_look_ups.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/field_points.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t looked_up = 1 << 20;  ///< points of each kind

/// Points handed over a body's worth at a time, in arrays that are in the cache, as whoever has just computed
/// them has them.
class PointLookUps {
 public:
  explicit PointLookUps(Points points) : points_(std::move(points)) {}

  /// Look-ups a second: median of the runs. `look(begin, end)` looks up points of `at`, x, y, z into `out`.
  template <class Look>
  double rate(int runs, const Look& look) {
    std::vector<double> rates;
    for (int run = 0; run < runs; ++run) {
      double seconds = 0.0;
      for (std::size_t from = 0; from + block <= points_.size(); from += block) {
        std::copy_n(points_.begin() + static_cast<std::ptrdiff_t>(from), block, at.begin());
        for (std::size_t i = 0; i < block; ++i) {
          x[i] = at[i].x();
          y[i] = at[i].y();
          z[i] = at[i].z();
        }
        seconds += cpu_seconds([&] {
          for (std::size_t i = 0; i < block; i += body) look(i, i + body);
        });
        if (*std::min_element(out.begin(), out.end()) < 0.0) throw std::logic_error("a distance is negative");
      }
      rates.push_back(static_cast<double>(points_.size() / block * block) / seconds);
    }
    return median(rates);
  }
  PointArrays arrays(std::size_t from, std::size_t end) const {
    const std::size_t count = end - from;
    return {{&x[from], count}, {&y[from], count}, {&z[from], count}};
  }
  std::span<double> outs(std::size_t from, std::size_t end) { return {&out[from], end - from}; }

  static constexpr std::size_t body = 64, block = 128 * body;
  Points at{block};
  std::vector<double> x = std::vector<double>(block), y = x, z = x, out = x;

 private:
  Points points_;
};

/// The distance between the voxel of the point and the nearest blocked one, centre to centre.
double peer_distance(const DynamicEDTOctomap& field, const Eigen::Vector3d& point) {
  const Eigen::Vector3f at = point.cast<float>();
  // Below 0 it says that the point lies beyond its map.
  return std::max(0.0, static_cast<double>(field.getDistance(octomap::point3d(at.x(), at.y(), at.z()))));
}

/// Points per second.
struct Rates {
  double clearance = 0.0, coarse = 0.0, peer = 0.0;  ///< a call per point
  double clearances = 0.0, coarses = 0.0;            ///< a call per 64 points

  nlohmann::ordered_json json() const {
    return {{"clearance_one_by_one", clearance},
            {"coarse_clearance_one_by_one", coarse},
            {"dynamicEDT3D_one_by_one", peer},
            {"clearances_of_64", clearances},
            {"coarse_clearances_of_64", coarses}};
  }
};

Rates measure_rates(const BlockedField& ours, const DynamicEDTOctomap& theirs, Points points, int runs) {
  PointLookUps all(std::move(points));
  const auto one_by_one = [&](const auto& look) {
    return all.rate(runs, [&](std::size_t from, std::size_t end) {
      for (std::size_t i = from; i < end; ++i) all.out[i] = look(all.at[i]);
    });
  };
  Rates rates;
  rates.clearance = one_by_one([&](const Eigen::Vector3d& point) { return ours.clearance(point); });
  rates.peer = one_by_one([&](const Eigen::Vector3d& point) { return peer_distance(theirs, point); });
  rates.coarse = one_by_one([&](const Eigen::Vector3d& point) { return ours.coarse_clearance(point); });
  rates.clearances = all.rate(
      runs, [&](std::size_t i, std::size_t end) { ours.clearances(all.arrays(i, end), all.outs(i, end)); });
  rates.coarses = all.rate(runs, [&](std::size_t i, std::size_t end) {
    ours.coarse_clearances(all.arrays(i, end), all.outs(i, end));
  });
  return rates;
}

/// Sum, extremes and overestimates of an answer's errors, in voxels.
struct Errors {
  double below = 0.0, most_below = 0.0, most_above = 0.0;
  std::size_t count = 0, too_large = 0;

  void add(double gap) {
    ++count;
    below += gap;
    most_below = std::max(most_below, gap);
    most_above = std::max(most_above, -gap);
    too_large += gap < 0.0 ? 1 : 0;
  }
  double mean() const { return below / static_cast<double>(count); }
  double share_too_large() const { return static_cast<double>(too_large) / static_cast<double>(count); }
  std::vector<std::string> row(const std::string& name) const {
    return {name, figure(mean()), figure(most_below), percent(share_too_large()), figure(most_above)};
  }
  nlohmann::ordered_json json() const {
    return {{"points", count},
            {"mean_voxels_below", mean()},
            {"most_voxels_below", most_below},
            {"most_voxels_above", most_above},
            {"overestimates", too_large}};
  }
};

}  // namespace

std::vector<Table> look_up_tables(const BlockedField& ours, const DynamicEDTOctomap& theirs, int runs,
                                  nlohmann::ordered_json& detail) {
  const Eigen::AlignedBox3d& box = ours.region();
  Table single{"One point per call, million per second on one core:",
               {"points", "`clearance`", "`coarse_clearance`", "dynamicEDT3D", "ratio of `clearance`",
                "ratio of `coarse_clearance`"},
               {}};
  Table batches{"64 points per call, million per second on one core; dynamicEDT3D has no such call:",
                {"points", "`clearances`", "`coarse_clearances`"},
                {}};
  const auto millions = [](double rate) { return figure(1e-6 * rate); };
  for (const auto& [name, points] : {std::pair{"moving body", body_points(box, looked_up)},
                                     {"lines of 200", look_up_points(box, looked_up, 200)},
                                     {"random", look_up_points(box, looked_up, 1)}}) {
    const Rates rates = measure_rates(ours, theirs, points, runs);
    detail[name] = rates.json();
    single.rows.push_back({name, millions(rates.clearance), millions(rates.coarse), millions(rates.peer),
                           figure(rates.clearance / rates.peer), figure(rates.coarse / rates.peer)});
    batches.rows.push_back({name, millions(rates.clearances), millions(rates.coarses)});
  }
  return {single, batches};
}

Table error_table(const BlockedField& ours, const DynamicEDTOctomap& theirs, nlohmann::ordered_json& detail) {
  Errors fine, coarse, peer;
  for (const Eigen::Vector3d& point : look_up_points(ours.region(), 200'000, 1)) {
    const NearestBlocked nearest = ours.nearest(point, ours.max_distance());
    const double exact = nearest.found ? nearest.distance : ours.max_distance();
    const auto gap = [&](double reported) { return (exact - reported) / ours.resolution(); };
    fine.add(gap(ours.clearance(point)));
    coarse.add(gap(ours.coarse_clearance(point)));
    peer.add(gap(peer_distance(theirs, point)));
  }
  detail = {{"clearance", fine.json()}, {"coarse_clearance", coarse.json()}, {"dynamicEDT3D", peer.json()}};
  return {
      "What the answers are worth: below the exact distance to the nearest blocked cube, in voxels, at "
      "200,000 "
      "random points:",
      {"answer", "mean", "most below", "too large", "most above"},
      {fine.row("`clearance`"), coarse.row("`coarse_clearance`"),
       peer.row("dynamicEDT3D, centre to centre")}};
}

}  // namespace clearway::bench
