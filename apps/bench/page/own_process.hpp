#pragma once

#include <functional>
#include <string>

#include "apps/bench/page/result.hpp"

namespace clearway::bench {

/// What `work` returns in a forked copy of this program, which may write files and speak to stderr.
/// @throws std::runtime_error with the text of its exception, or how the process ended.
std::string in_own_process(const std::function<std::string()>& work);

/// The benchmark in a process of its own. What others left in the heap and in the pools of nodes does not
/// touch it (a map that is loaded into scattered free nodes takes three times as long), and its crash touches
/// no other.
Benchmark isolated(Benchmark run);

}  // namespace clearway::bench
