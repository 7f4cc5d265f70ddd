#include "planning/constraint/live_control.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {

struct LiveControl::Map {
  Map(ConfigurationSpace ready, const DamperOptions& damper, Time when)
      : space(std::move(ready)),
        control(space, damper),
        taken(when),
        left_at(Configuration::Zero(static_cast<Eigen::Index>(space.robot().dof()))) {}

  ConfigurationSpace space;
  ControlStep control;
  Time taken;
  std::uint64_t number = 0;
  Configuration left_at;  ///< where the robot was when the loop gave it back
  Map* next = nullptr;    ///< given back before
};

namespace {

/// More constraints than an arm between obstacles has.
constexpr int constraints_foreseen = 256;

/// So that the loop finds the program's memory large enough, and the cubes about the robot remembered.
void run_once(ControlStep& control, const Configuration& q) {
  control.look(q);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(q.size()), gradient = Eigen::VectorXd::Ones(q.size());
  for (int i = 0; i < constraints_foreseen; ++i)
    control.add({gradient.data(), static_cast<std::size_t>(gradient.size())}, 1.0);
  control.solve(nothing);
  control.stand_still();  // until the loop has looked
}

}  // namespace

LiveControl::LiveControl(DamperOptions damper, const LiveOptions& options)
    : damper_(std::move(damper)), options_(options) {
  if (!(options_.max_age > Duration::zero()))
    throw std::invalid_argument("live control: expected max_age above 0");
  if (!(options_.brake > 0.0)) throw std::invalid_argument("live control: expected brake above 0");
  for (Eigen::VectorXd* vector : {&expected_, &last_, &braked_}) vector->setZero(damper_.weight.size());
}

LiveControl::~LiveControl() {
  collect();
  delete newest_.load();
  delete current_;
}

void LiveControl::TakeApart::operator()(Map* map) const { delete map; }

LiveControl::ReadyMap LiveControl::prepare(ConfigurationSpace space, Time taken) {
  collect();
  std::vector<std::string> joints = joint_names(space.robot());
  if (!joints_.empty() && joints != joints_)
    throw std::invalid_argument("live control: robot " + quote(space.robot().name) +
                                " has other joints than that of the maps before");
  space.renew();
  ReadyMap map(new Map(std::move(space), damper_, taken));
  run_once(map->control, expected_);
  joints_ = std::move(joints);
  return map;
}

std::uint64_t LiveControl::publish(ReadyMap map) {
  if (!map) throw std::invalid_argument("live control: expected a map that prepare made, got none");
  map->number = ++published_;
  delete newest_.exchange(map.release(), std::memory_order_acq_rel);
  collect();
  return published_;
}

std::uint64_t LiveControl::publish(ConfigurationSpace space, Time taken) {
  return publish(prepare(std::move(space), taken));
}

std::size_t LiveControl::collect() {
  std::size_t count = 0;
  Map* map = returned_.exchange(nullptr, std::memory_order_acquire);
  if (map != nullptr) expected_ = map->left_at;  // the last one given back is the first
  for (; map != nullptr; ++count) delete std::exchange(map, map->next);
  return count;
}

void LiveControl::require(const Eigen::VectorXd& values, const char* name) const {
  const Eigen::Index joints = damper_.weight.size();
  if (values.size() != joints)
    throw std::invalid_argument("live control: expected " + counted(joints, "value") + " of " + name +
                                ", one for each joint, got " + std::to_string(values.size()));
  if (!values.allFinite())
    throw std::invalid_argument(std::string("live control: ") + name + " holds a number that is not finite");
}

bool LiveControl::fetch(const Configuration& q) {
  require(q, "q");
  if (newest_.load(std::memory_order_relaxed) == nullptr) return false;
  Map* const next = newest_.exchange(nullptr, std::memory_order_acquire);  // others only put one there
  if (current_ != nullptr) {
    current_->left_at = q;
    current_->next = returned_.load(std::memory_order_relaxed);
    // Fails at most once more than the mapping thread empties the list in between.
    while (!returned_.compare_exchange_weak(current_->next, current_, std::memory_order_release,
                                            std::memory_order_relaxed)) {
    }
  }
  current_ = next;
  return true;
}

std::uint64_t LiveControl::number() const { return has_map() ? current_->number : 0; }

LiveControl::Duration LiveControl::age(Time now) const {
  return has_map() ? now - current_->taken : Duration::max();
}

bool LiveControl::is_too_old(Time now) const {
  return !has_map() || current_->taken < now - options_.max_age || current_->taken > now;
}

const ConfigurationSpace& LiveControl::space() const { return current_->space; }
ControlStep& LiveControl::control() { return current_->control; }

const Eigen::VectorXd& LiveControl::step(const Configuration& q, const Eigen::VectorXd& wanted, Time now) {
  require(wanted, "wanted");
  fetch(q);
  if (has_map()) control().look(q);
  return solve(wanted, now);
}

const Eigen::VectorXd& LiveControl::solve(const Eigen::VectorXd& wanted, Time now) {
  require(wanted, "wanted");
  is_braking_ = is_too_old(now);
  if (!has_map()) return last_;  // it has not moved yet
  if (is_braking_) {
    const double fastest = last_.cwiseAbs().maxCoeff();
    braked_ = last_ * std::max(0.0, 1.0 - options_.brake / fastest);
  }
  last_ = control().solve(is_braking_ ? braked_ : wanted);
  return last_;
}

}  // namespace clearway
