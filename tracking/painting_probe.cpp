#include "tracking/painting_probe.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>

namespace clearway {
namespace {

void check_error(double metres, const char* name) {
  if (!(std::isfinite(metres) && metres >= 0.0))
    throw std::invalid_argument(std::string("error budget: ") + name + " must be 0 metres or more");
}

}  // namespace

void PaintingProbe::validate() const {
  body.validate();
  if (!ball_in_probe.allFinite())
    throw std::invalid_argument("probe '" + body.name + "': ball_in_probe must be three finite metres");
  if (!(std::isfinite(ball_radius) && ball_radius > 0.0))
    throw std::invalid_argument("probe '" + body.name + "': ball_radius must be > 0 metres");
}

void validate(const ErrorBudget& budget, double ball_radius) {
  check_error(budget.robot, "robot");
  check_error(budget.tracking, "tracking");
  check_error(budget.modelling, "modelling");
  const double least = budget.sum(0.0);
  if (!(std::isfinite(least) && std::isfinite(ball_radius) && ball_radius > least)) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "error budget: robot + " << (budget.constant_tracking ? "tracking + " : "")
         << "modelling = " << least << " m leaves nothing of a ball of " << ball_radius
         << " m (Chong 2008, eq. 3), expected less than its radius";
    throw std::invalid_argument(text.str());
  }
}

double painted_radius(double ball_radius, const ErrorBudget& budget, double bound) {
  validate(budget, ball_radius);
  return std::max(0.0, ball_radius - budget.sum(std::isfinite(bound) ? bound : ball_radius));
}

}  // namespace clearway
