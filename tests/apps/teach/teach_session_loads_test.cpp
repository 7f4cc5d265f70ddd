// What is attached to the robot in a session.

#include <gtest/gtest.h>

#include "tests/worlds/taught_planar.hpp"

namespace clearway {
namespace teach_session_loads_test {

using worlds::TeachSessionOf;

TEST_F(TeachSessionOf, ALoadIsAttachedOnceAndDetachedByItsName) {
  EXPECT_EQ(act(TeachAction::detach), "nothing is attached; 'attach' takes a load");
  EXPECT_EQ(act(TeachAction::attach, "can"),
            "the setup has no load 'can', nor any other; the event may bring one with it, as 'load'");
  LoadSetup can;
  can.name = "can", can.shape = LoadSphere{0.1}, can.link = "forearm";
  setup_.loads = {can};
  EXPECT_EQ(act(TeachAction::attach, "cane"), "the setup has no load 'cane', did you mean 'can'?");
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(remark(), "can on forearm");
  EXPECT_EQ(act(TeachAction::attach, "can"), "'can' is attached already; 'detach' comes first");
  EXPECT_EQ(attach(0.3, 1.0), "");
  EXPECT_EQ(session_.shown_loads().size(), 2u);
  EXPECT_EQ(act(TeachAction::detach), "expected the name of a load, one of 'can' and 'rod'");
  EXPECT_EQ(act(TeachAction::detach, "cup"), "no load 'cup' is attached; 'can' and 'rod' are");
  EXPECT_EQ(act(TeachAction::detach, "can"), "");
  EXPECT_EQ(act(TeachAction::detach), "");
  EXPECT_TRUE(session_.shown_loads().empty());
  setup_.loads.front().link = "hand";
  EXPECT_NE(act(TeachAction::attach, "can").find("robot 'planar2' has no link 'hand'"), std::string::npos);
  setup_.loads.front().link = "forearm";
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(act(TeachAction::paint_on), "");
  EXPECT_EQ(act(TeachAction::detach), "a stroke is being painted; 'paint_off' ends it");
  EXPECT_EQ(act(TeachAction::paint_off), "");
  EXPECT_EQ(act(TeachAction::robot, "arm6"), "");  // which holds nothing
  EXPECT_EQ(act(TeachAction::detach), "nothing is attached; 'attach' takes a load");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.shown_loads().size(), 1u);
}

TEST_F(TeachSessionOf, ALoadOfTwoQueriesIsTakenOnlyWhereBothMeanTheSame) {
  LoadSetup can;
  can.name = "can", can.shape = LoadSphere{0.1}, can.link = "forearm";
  setup_.queries.resize(2);
  for (QuerySetup& query : setup_.queries) query.loads = {can};
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(act(TeachAction::detach), "");
  setup_.queries[1].loads[0].shape = LoadSphere{0.2};  // the smaller one would stand for both
  EXPECT_NE(act(TeachAction::attach, "can").find("different loads 'can'"), std::string::npos);
  setup_.loads = {can};  // which says so
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
}

/// The paint is a ball of 3 m, the arm's reach 2.05 m: the load's corners decide whether it stays inside.
TEST_F(TeachSessionOf, PlacesAreRefusedWhereTheLoadLeavesThePaint) {
  paint_everything();
  for (const double length : {0.2, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6}) {
    ASSERT_EQ(act(TeachAction::clear), "");
    ASSERT_EQ(attach(length, 1.0 + 0.5 * length), "");
    const bool is_inside = Eigen::Vector3d(2.0 + length, 0.02, 0.02).norm() < 3.0 - 0.1;
    const bool is_outside = 2.0 + length > 3.0;
    const std::string why = act(TeachAction::start, "0,0");
    if (is_inside) {
      EXPECT_EQ(why, "") << length;
      EXPECT_EQ(remark(), "0, 0; with 'rod'");
    }
    if (is_outside) {
      EXPECT_NE(why.find("rod"), std::string::npos) << length << why;
    }
    EXPECT_EQ(act(TeachAction::start, "0,2.5"), "") << length;  // folded: within reach of any of them
    EXPECT_EQ(act(TeachAction::goal, "0,0") == "", why.empty()) << length;
    ASSERT_EQ(act(TeachAction::detach, "rod"), "");
    EXPECT_EQ(act(TeachAction::start, "0,0"), "") << length;
    EXPECT_EQ(attach(length, 1.0 + 0.5 * length) == "", why.empty()) << length;  // where the leg would begin
    act(TeachAction::detach, "rod");
  }
}

TEST_F(TeachSessionOf, ALegCarriesWhatIsHeldWhenItsEndIsPicked) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::via, "0.3,0.3"), "");
  ASSERT_EQ(attach(0.4, 1.2), "");
  ASSERT_EQ(act(TeachAction::via, "0.6,0.3"), "");
  ASSERT_EQ(attach(0.1, 0.5, "clip"), "");
  ASSERT_EQ(act(TeachAction::via, "0.9,0.3"), "");
  ASSERT_EQ(act(TeachAction::detach, "rod"), "");
  ASSERT_EQ(act(TeachAction::goal, "1.2,0.3"), "");
  ASSERT_EQ(act(TeachAction::plan, "carry"), "");
  ASSERT_EQ(act(TeachAction::play), "");
  const TaughtPlan& taught = session_.plans().back();
  ASSERT_TRUE(taught.plan.is_proved());
  ASSERT_EQ(taught.plan.loads.size(), 2u);
  EXPECT_EQ(taught.plan.loads[0].load.name, "rod");
  EXPECT_EQ(taught.plan.loads[0].legs, (std::vector<int>{1, 2}));
  EXPECT_EQ(taught.plan.loads[1].legs, (std::vector<int>{2, 3}));
  EXPECT_EQ(taught.plan.policies.at("rod"), taught.plan.policies.at("forearm"));
  const auto planned =
      std::find_if(session_.events().begin(), session_.events().end(),
                   [](const auto& entry) { return entry.event.action == TeachAction::plan; });
  EXPECT_NE(planned->remark.find("carries rod on forearm, legs 2, 3"), std::string::npos) << planned->remark;
  // Along what is played, each leg shows its own loads.
  std::vector<std::size_t> seen;
  for (double at = time_; session_.state() == TeachState::playing; session_.before(at += 0.05))
    if (seen.empty() || seen.back() != session_.shown_loads().size())
      seen.push_back(session_.shown_loads().size());
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1, 2, 1}));
}

TEST_F(TeachSessionOf, APlanWhoseLoadWasChangedIsNotApprovedAndUndoBringsItBack) {
  paint_everything();
  ASSERT_EQ(attach(0.4, 1.2), "");
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::detach), "");
  EXPECT_EQ(act(TeachAction::approve), "'rod' was detached since it was planned; plan again");
  EXPECT_NE(attach(0.5, 1.2).find("another load 'rod' rides on a leg before"), std::string::npos);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "detach is undone");
  EXPECT_EQ(session_.shown_loads().size(), 1u);
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.state(), TeachState::approved);
  ASSERT_EQ(attach(0.1, 0.5, "clip"), "");
  EXPECT_EQ(act(TeachAction::plan), "'clip' was attached after the goal was chosen; 'goal' chooses it anew");
  EXPECT_EQ(act(TeachAction::goal, "1,0.5"), "");
  EXPECT_EQ(act(TeachAction::plan), "");
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.plans().back().plan.loads.size(), 2u);
}

/// A post that only the load meets: the plan is refused with it, and holds without.
TEST_F(TeachSessionOf, WhatOnlyTheLoadWouldHitIsHeldAgainstThePlan) {
  for (const bool is_loaded : {true, false}) {
    if (is_loaded) {
      paint_everything();
      ASSERT_EQ(attach(0.4, 1.2), "");
    } else {
      ASSERT_EQ(act(TeachAction::detach), "");
    }
    ASSERT_EQ(act(TeachAction::start, "0,0.01"), "");
    ASSERT_EQ(act(TeachAction::goal, "1,0.01"), "");
    ASSERT_EQ(act(TeachAction::plan), "");
    ASSERT_EQ(act(TeachAction::play), "");
    if (is_loaded) {
      Scan scan;
      scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
      const Eigen::Vector3d post = 2.3 * Eigen::Vector3d(std::cos(0.5), std::sin(0.5), 0.0);
      for (double z = -0.1; z <= 0.1; z += 0.02)
        scan.points.push_back((post + Eigen::Vector3d(0, 0, z - 2)).cast<float>());
      map_.insert(scan);
      ++counts_.scans_inserted;
    }
    const std::string why = act(TeachAction::approve);
    if (is_loaded) {
      EXPECT_NE(why.find("the map has changed since it was planned: "), std::string::npos) << why;
      EXPECT_NE(why.find("rod"), std::string::npos) << why;
      EXPECT_EQ(act(TeachAction::plan), "");  // with the elbow bent
      EXPECT_EQ(act(TeachAction::approve), "");
      EXPECT_GT(session_.plans().back().plan.waypoints().size(), 2u);
    } else {
      EXPECT_EQ(why, "");
    }
  }
}

}  // namespace teach_session_loads_test
}  // namespace clearway
