#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "apps/teach/teach_session.hpp"

namespace clearway::worlds {

/// A session without pictures: a setup with a probe, spheres painted as the fusion would.
class TeachSessionOf : public testing::Test {
 protected:
  explicit TeachSessionOf(double resolution = 0.05) : map_(MapOptions{.resolution = resolution}) {
    setup_.probe.emplace();
    setup_.volumes = {{.label = "free", .critical_parts = {}}};
    map_.add_volume("free", {});
    RobotSetup robot;
    robot.name = "planar2";
    setup_.robot = robot;
    session_.begin(setup_, map_, counts_);
  }
  /// Does it now and says why not; empty when it was done.
  std::string act(TeachAction action, const std::string& text = "") {
    TeachEvent event;
    event.time = time_ += 1.0;
    event.action = action;
    if (action == TeachAction::start || action == TeachAction::via || action == TeachAction::goal ||
        action == TeachAction::place)
      event.q = text;
    else if (action == TeachAction::robot)
      event.robot.robot = text;
    else
      event.name = text;
    if (action == TeachAction::plan) event.planner = "rrtconnect";
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  /// All that the arm can reach.
  void paint_everything() {
    EXPECT_EQ(act(TeachAction::paint_on), "");
    EXPECT_EQ(session_.brush().use, Brush::Use::paints);
    map_.paint(session_.brush().volume, {Eigen::Vector3d::Zero(), 3.0}, time_);
    ++counts_.spheres;
    EXPECT_EQ(act(TeachAction::paint_off), "");
  }
  /// A rod along the forearm, its middle so far from the elbow; also under the name of another.
  std::string attach(double length, double middle, const std::string& name = "rod") {
    TeachEvent event;
    event.time = time_ += 1.0;
    event.action = TeachAction::attach;
    event.name = name;
    event.load.emplace();
    event.load->setup.name = name;
    event.load->setup.shape = LoadBox{{length, 0.04, 0.04}};
    event.load->setup.link = "forearm";
    event.load->setup.link_from_load.translation().x() = middle;
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  std::string remark() const { return session_.events().back().remark; }

  double time_ = 0.0;
  std::vector<TeachEvent> due_;
  clearway::Setup setup_;
  FreeSpaceMap map_;
  FusionCounts counts_;
  TeachSession session_{[this](double) { return std::exchange(due_, {}); }, TeachOptions{.seed = 3}};
};

}  // namespace clearway::worlds
