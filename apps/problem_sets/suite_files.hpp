#pragma once

#include <string>
#include <vector>

#include "apps/problem_sets/import_suite.hpp"
#include "apps/problem_sets/ready_problem.hpp"

namespace clearway {

/// Writes OUT/suite.yaml, OUT/problems/EXPERIMENT.yaml and OUT/hulls/LOAD.txt, and names each problem's place
/// in them. @return the number of experiments @throws std::runtime_error when a file cannot be written
std::size_t write_suite_files(const ForeignSet& set, const SuiteImport& import, ReadySuite& suite);

/// Writes OUT/import.json: worlds with their objects, problems with their places in the suite, what was left
/// out.
/// @throws std::runtime_error when it cannot be written
void write_import_record(const ForeignSet& set, const SuiteImport& import, const ReadySuite& suite,
                         const std::vector<std::string>& left_out);

}  // namespace clearway
