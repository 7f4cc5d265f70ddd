#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;
enum class OmplAlgorithm;

// Options of OMPL's sampling planners. Weighted units: see joint_weights.

/// Options of `rrtconnect_ompl`.
struct RrtConnectOmplOptions {
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
  bool simplify = true;          ///< OMPL's path simplification, with certified edges, instead of shortcuts
};
/// Options of `est`.
struct EstOptions {
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
};
/// Options of `prm`.
struct PrmOptions {
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
};
/// Options of `rrtstar`.
struct RrtStarOptions {
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 5000;        ///< drawn to improve the path; without one only time ends the search
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
};
/// Options of `bitstar`.
struct BitStarOptions {
  int batch = 100;               ///< samples of a batch, 1 to 1,000,000
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 5000;        ///< drawn to improve the path; without one only time ends the search
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
};
RrtConnectOmplOptions read_options(OptionReader& reader, RrtConnectOmplOptions initial);
EstOptions read_options(OptionReader& reader, EstOptions initial);
PrmOptions read_options(OptionReader& reader, PrmOptions initial);
RrtStarOptions read_options(OptionReader& reader, RrtStarOptions initial);
BitStarOptions read_options(OptionReader& reader, BitStarOptions initial);

/// A sampling planner of OMPL with our certified edges as its motion validator, then shortcuts, each edge
/// certified again. `rrtstar` and `bitstar` go on to improve on the weighted length of their
/// path until `max_samples` are drawn or time is out. The same seed gives the same path as long as samples,
/// not time, end the search: all that these planners draw comes from generators of the query's own, but for
/// pivots of OMPL's trees of nearest neighbours, whose answers are exact whatever these are.
class OmplPlanner : public Planner {
 public:
  PlanResult plan(const PlanProblem& problem) const override;

 protected:
  /// What all share, and what some have.
  struct Settings {
    OmplAlgorithm algorithm{};
    double range = 0.0;
    int batch = 0;
    double prismatic_scale = 0.0;
    int max_samples = 0, shortcuts = 0;
    bool simplify = false;
  };
  OmplPlanner(std::string_view name, PlannerOptions in_force, const Settings& settings);

 private:
  Settings settings_;
};

// Each throws std::invalid_argument naming the option that is out of range.

/// RRT-Connect (Kuffner and LaValle 2000), as a peer of `rrtconnect`, which is ours.
class RrtConnectOmpl : public OmplPlanner {
 public:
  using Options = RrtConnectOmplOptions;
  static constexpr std::string_view table_name = "rrtconnect_ompl";
  explicit RrtConnectOmpl(const RrtConnectOmplOptions& options = {});
};

/// Expansive space trees (Hsu, Latombe and Motwani 1999).
class Est : public OmplPlanner {
 public:
  using Options = EstOptions;
  static constexpr std::string_view table_name = "est";
  explicit Est(const EstOptions& options = {});
};

/// Probabilistic roadmap (Kavraki et al. 1996).
class Prm : public OmplPlanner {
 public:
  using Options = PrmOptions;
  static constexpr std::string_view table_name = "prm";
  explicit Prm(const PrmOptions& options = {});
};

/// RRT* (Karaman and Frazzoli 2011).
class RrtStar : public OmplPlanner {
 public:
  using Options = RrtStarOptions;
  static constexpr std::string_view table_name = "rrtstar";
  explicit RrtStar(const RrtStarOptions& options = {});
};

/// Batch informed trees (Gammell et al. 2015).
class BitStar : public OmplPlanner {
 public:
  using Options = BitStarOptions;
  static constexpr std::string_view table_name = "bitstar";
  explicit BitStar(const BitStarOptions& options = {});
};

}  // namespace clearway
