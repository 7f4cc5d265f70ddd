#pragma once

#include <memory>

#include "apps/compare/problem_server.hpp"

namespace clearway {

/// Of an experiment with a single robot: every path is judged by the independent check, whoever planned it.
std::unique_ptr<ProblemServer> make_robot_server(const Suite& suite, const PreparedExperiment& experiment,
                                                 const CompareChoice& choice);

}  // namespace clearway
