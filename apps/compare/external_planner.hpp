#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "planning/problem/planner.hpp"

namespace clearway {

/// A planner in a program of somebody else, by JSON lines (YOUR_PLANNER.md). Files cannot name one: whoever
/// opens a suite must not run a program by that. Its paths are promised nothing and checked as all are.
class ExternalPlanner : public Planner {
 public:
  static constexpr std::string_view planner_name = "external";
  static constexpr double patience = 60.0;  ///< s that it may take to start and to read a world

  /// @param command for `sh`
  explicit ExternalPlanner(const std::string& command);
  ~ExternalPlanner() override;

  /// Starts the program and sends it the world. @throws std::runtime_error when it ends or says nonsense.
  void prepare(const ConfigurationSpace& space) const override;

  /// @throws std::runtime_error as prepare(). One query at a time.
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
