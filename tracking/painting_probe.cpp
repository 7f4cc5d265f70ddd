#include "tracking/painting_probe.hpp"

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

double painted_radius(double ball_radius, const ErrorBudget& budget) {
  check_error(budget.robot, "robot");
  check_error(budget.tracking, "tracking");
  check_error(budget.modelling, "modelling");
  const double r0 = ball_radius - budget.sum();
  if (!(std::isfinite(r0) && r0 > 0.0)) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "error budget: robot + tracking + modelling = " << budget.sum()
         << " m leaves nothing of a ball of " << ball_radius << " m (eq. 3), expected less than its radius";
    throw std::invalid_argument(text.str());
  }
  return r0;
}

}  // namespace clearway
