#include "tests/mutation/costs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace clearway::mutation {
namespace {

std::string whole(double seconds) { return std::to_string(std::lround(seconds)); }

}  // namespace

void Costs::add(const std::string& work, double seconds) {
  const std::lock_guard lock(mutex_);
  seconds_[work] += seconds;
}

std::string Costs::told() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<double, std::string>> parts;
  double sum = 0.0;
  for (const auto& [work, seconds] : seconds_) {
    parts.emplace_back(-seconds, work);
    sum += seconds;
  }
  std::sort(parts.begin(), parts.end());
  std::string text = whole(sum) + " CPU s";
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i == 0 ? ": " : ", ") + parts[i].second + " " + whole(-parts[i].first);
  return text;
}

}  // namespace clearway::mutation
