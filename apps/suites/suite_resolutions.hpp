#pragma once

#include "datasets/descriptions/suite.hpp"

namespace clearway {

/// Puts an experiment for each of its `resolutions` in the place of one that lists several: "reach" at 0.02 m
/// becomes "reach-0.02", in worlds of that resolution and of the same kind of name. Then marks
/// experiments that differ in their resolution alone (SuiteExperiment::alike): those, and generated ones that
/// state the same but for names, texts and the resolution of `generate`.
/// @throws std::invalid_argument naming the suite and a name that would be given twice.
void expand_resolutions(Suite& suite);

/// The names of the experiments that take the place of one; none for one without `resolutions`.
std::vector<std::string> names_at_resolutions(const SuiteExperiment& experiment);

}  // namespace clearway
