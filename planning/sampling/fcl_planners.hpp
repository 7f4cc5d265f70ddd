#pragma once

#include <memory>

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;
enum class OmplAlgorithm;

// Options of OMPL's planners with FCL. Weighted units: see joint_weights.

/// Options of `rrtconnect_fcl`.
struct RrtConnectFclOptions {
  double resolution = 0.01;      ///< of the space's extent between two looks at an edge, 1e-6 to 1
  bool simplify = true;          ///< OMPL's path simplification
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
};
/// Options of `kpiece_fcl`.
struct KpieceFclOptions {
  double resolution = 0.01;      ///< of the space's extent between two looks at an edge, 1e-6 to 1
  bool simplify = true;          ///< OMPL's path simplification
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
};
/// Options of `prm_fcl`.
struct PrmFclOptions {
  double resolution = 0.01;      ///< of the space's extent between two looks at an edge, 1e-6 to 1
  bool simplify = true;          ///< OMPL's path simplification
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
};
/// Options of `bitstar_fcl`.
struct BitStarFclOptions {
  double resolution = 0.01;      ///< of the space's extent between two looks at an edge, 1e-6 to 1
  bool simplify = true;          ///< OMPL's path simplification
  int batch = 100;               ///< samples of a batch, 1 to 1,000,000
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 5000;        ///< drawn to improve the path; without one only time ends the search
};
RrtConnectFclOptions read_options(OptionReader& reader, RrtConnectFclOptions initial);
KpieceFclOptions read_options(OptionReader& reader, KpieceFclOptions initial);
PrmFclOptions read_options(OptionReader& reader, PrmFclOptions initial);
BitStarFclOptions read_options(OptionReader& reader, BitStarFclOptions initial);

/// OMPL's planners as most people run them, for comparison: FCL's shapes on an fcl::OcTree, edges looked at
/// every `resolution` of the space's extent, then OMPL's path simplification. What lies between the looks is
/// not checked, so that their paths are NOT certified; have them checked. Start and goal are judged by our
/// space, as for every planner. The same seed gives the same path as long as samples, not time, end the
/// search.
///
/// The tree of blocked voxels is made at the first query in a map and kept for the next ones.
class FclPlanner : public Planner {
 public:
  ~FclPlanner() override;
  PlanResult plan(const PlanProblem& problem) const override;

 protected:
  /// What all share, and what some have.
  struct Settings {
    OmplAlgorithm algorithm{};
    double resolution = 0.0;
    bool simplify = true;
    double range = 0.0;
    int batch = 0;
    double prismatic_scale = 0.0;
    int max_samples = 0;
  };
  FclPlanner(std::string_view name, PlannerOptions in_force, const Settings& settings);

 private:
  class Scenes;
  Settings settings_;
  std::unique_ptr<Scenes> scenes_;
};

// Each throws std::invalid_argument naming the option that is out of range.

/// RRT-Connect (Kuffner and LaValle 2000).
class RrtConnectFcl : public FclPlanner {
 public:
  using Options = RrtConnectFclOptions;
  static constexpr std::string_view table_name = "rrtconnect_fcl";
  explicit RrtConnectFcl(const RrtConnectFclOptions& options = {});
};

/// KPIECE (Sucan and Kavraki 2009), on the first two joints' grid.
class KpieceFcl : public FclPlanner {
 public:
  using Options = KpieceFclOptions;
  static constexpr std::string_view table_name = "kpiece_fcl";
  explicit KpieceFcl(const KpieceFclOptions& options = {});
};

/// Probabilistic roadmap (Kavraki et al. 1996).
class PrmFcl : public FclPlanner {
 public:
  using Options = PrmFclOptions;
  static constexpr std::string_view table_name = "prm_fcl";
  explicit PrmFcl(const PrmFclOptions& options = {});
};

/// Batch informed trees (Gammell et al. 2015).
class BitStarFcl : public FclPlanner {
 public:
  using Options = BitStarFclOptions;
  static constexpr std::string_view table_name = "bitstar_fcl";
  explicit BitStarFcl(const BitStarFclOptions& options = {});
};

}  // namespace clearway
