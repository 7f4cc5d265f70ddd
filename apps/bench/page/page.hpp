#pragma once

#include "apps/bench/page/run.hpp"

namespace clearway::bench {

/// Where the figures come from.
struct Origin {
  std::string commit, date;  ///< date: 2026-11-23
  Machine machine;
};

/// The commit that this program was built from, today, this machine.
Origin this_origin();

/// One benchmark: what is compared, its tables, how long it took on how busy a machine.
std::string section(const Outcome& outcome);

/// BENCHMARKS.md, all of it.
std::string whole_page(const Origin& origin, const std::vector<Outcome>& outcomes);

/// What stands at the page's end and no benchmark measures: commands of suites, figures without a command.
std::string closing_text();

}  // namespace clearway::bench
