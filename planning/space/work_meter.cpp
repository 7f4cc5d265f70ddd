#include "planning/space/work_meter.hpp"

namespace clearway {
namespace {

std::optional<double> sum(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? *a + *b : a ? a : b;
}

}  // namespace

WorkTimes WorkMeter::times(double cpu) const {
  std::array<Clock::duration, 3> spent = spent_;
  spent[place(work_)] += Clock::now() - since_;
  const double whole = std::chrono::duration<double>(spent[0] + spent[1] + spent[2]).count();
  const auto part = [&](PlanWork work) -> std::optional<double> {
    if (!is_known_[place(work)]) return std::nullopt;
    if (!(whole > 0.0)) return work == PlanWork::search ? cpu : 0.0;
    return cpu * (std::chrono::duration<double>(spent[place(work)]).count() / whole);
  };
  return {part(PlanWork::search), part(PlanWork::shortcuts), part(PlanWork::proofs)};
}

WorkTimes operator+(const WorkTimes& a, const WorkTimes& b) {
  return {sum(a.search, b.search), sum(a.shortcuts, b.shortcuts), sum(a.proofs, b.proofs)};
}

}  // namespace clearway
