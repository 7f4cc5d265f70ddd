#include "apps/teach/teach_session.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "mapping/system/number_text.hpp"
#include "tests/worlds/taught_planar.hpp"

namespace clearway {
namespace teach_session_test {

using worlds::TeachSessionOf;

TEST_F(TeachSessionOf, EachStateTakesWhatBelongsAndRefusesTheRestWithACure) {
  EXPECT_EQ(session_.state(), TeachState::ready);
  EXPECT_EQ(act(TeachAction::paint_off), "nothing is being painted; 'paint_on' begins a stroke");
  EXPECT_EQ(act(TeachAction::erase_off), "nothing is being erased; 'erase_on' begins that");
  EXPECT_EQ(act(TeachAction::goal, "0,0"), "no start is chosen; 'start' comes first");
  EXPECT_EQ(act(TeachAction::plan), "no start is chosen; 'start' chooses one");
  EXPECT_EQ(act(TeachAction::play), "there is no plan; 'plan' makes one");
  EXPECT_EQ(act(TeachAction::approve), "there is no plan that is proved; 'plan' makes one");
  EXPECT_EQ(act(TeachAction::undo), "nothing was done");
  EXPECT_EQ(act(TeachAction::save, "x"), "this session saves nothing before its end");
  EXPECT_EQ(act(TeachAction::start), "the setup has no gripper to show it with, and the event no 'q'");
  EXPECT_EQ(act(TeachAction::paint_on), "");
  EXPECT_EQ(session_.state(), TeachState::painting);
  for (const TeachAction action : {TeachAction::paint_on, TeachAction::erase_on, TeachAction::start,
                                   TeachAction::plan, TeachAction::volume, TeachAction::robot})
    EXPECT_EQ(act(action, "x"), "a stroke is being painted; 'paint_off' ends it");
  EXPECT_EQ(act(TeachAction::paint_off), "");
  EXPECT_EQ(act(TeachAction::erase_on), "");
  EXPECT_EQ(session_.state(), TeachState::erasing);
  EXPECT_EQ(session_.brush().use, Brush::Use::erases);
  EXPECT_EQ(act(TeachAction::paint_off), "the ball erases; 'erase_off' ends that");
  EXPECT_EQ(act(TeachAction::erase_off), "");
  EXPECT_EQ(act(TeachAction::quit), "");
  EXPECT_EQ(session_.state(), TeachState::ended);
  EXPECT_EQ(act(TeachAction::paint_on), "the session has ended");
}

TEST_F(TeachSessionOf, WhatComesAfterTheLastImageIsDoneAndCounted) {
  EXPECT_EQ(act(TeachAction::paint_on), "");
  for (const double after : {0.5, 3.0, 60.0}) {
    TeachEvent event;
    event.time = time_ + after;
    event.action = after == 60.0 ? TeachAction::paint_on : TeachAction::paint_off;
    due_.push_back(event);
  }
  const double first = time_ + 3.0;
  session_.end();
  EXPECT_EQ(session_.late_events(), (std::vector<double>{first, first + 57.0}));
  EXPECT_EQ(session_.events().size(), 4U);
  EXPECT_EQ(session_.events()[1].refusal, "");
}

TEST_F(TeachSessionOf, StartAndGoalsLieInsideOfThePaintAndAPlanBetweenThemIsApproved) {
  const std::string early = act(TeachAction::start, "0,0");
  EXPECT_TRUE(early.ends_with("mm deep; nothing is painted yet, 'paint_on' begins a stroke")) << early;
  EXPECT_EQ(session_.state(), TeachState::ready);
  paint_everything();
  EXPECT_EQ(act(TeachAction::start, "0").find("q: got 1 value, expected 2"), 0U);
  EXPECT_EQ(act(TeachAction::start, "0,0.3"), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::plan), "no goal is chosen; 'goal' chooses one");
  EXPECT_EQ(act(TeachAction::via, "0.5,0.3"), "");
  EXPECT_EQ(act(TeachAction::goal, "1,1"), "");
  EXPECT_EQ(act(TeachAction::goal, "1,0.5"), "");  // replaces
  EXPECT_EQ(session_.goals().size(), 2u);
  EXPECT_EQ(act(TeachAction::plan, "first"), "");
  EXPECT_EQ(act(TeachAction::plan, "first"),
            "there is a plan or a map 'first' already, expected another name");
  EXPECT_EQ(session_.state(), TeachState::planned);
  ASSERT_EQ(session_.plans().size(), 1u);
  EXPECT_TRUE(session_.plans()[0].plan.is_proved());
  EXPECT_EQ(session_.plans()[0].map_digest, map_sha256(map_.snapshot()));
  EXPECT_EQ(act(TeachAction::play), "");
  EXPECT_EQ(session_.state(), TeachState::playing);
  const Plan& plan = session_.plans()[0].plan;
  EXPECT_EQ(session_.shown_configuration(), plan.waypoints().front());
  ASSERT_TRUE(plan.motion);
  EXPECT_EQ(remark(), "it lasts " + short_text(plan.motion->motion.duration(), 3) + " s");
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.state(), TeachState::approved);
  EXPECT_TRUE(session_.plans()[0].is_approved);
}

TEST_F(TeachSessionOf, AStrokeThroughAnObstacleSaysSoAsItEnds) {
  paint_everything();
  EXPECT_EQ(remark(), "");
  ASSERT_EQ(act(TeachAction::undo), "");
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  scan.points = {{0.51F, 0.51F, -2.0F}, {0.71F, 0.51F, -2.0F}};
  map_.insert(scan);
  ++counts_.scans_inserted;
  paint_everything();
  EXPECT_TRUE(remark().starts_with("2 painted voxels are where a sensor saw an obstacle")) << remark();
  paint_everything();  // once more: these are known
  EXPECT_EQ(remark(), "");
}

TEST_F(TeachSessionOf, BallsThatHoldNoVoxelArePaintOfNoUse) {
  ASSERT_EQ(act(TeachAction::paint_on), "");
  map_.paint(0, {Eigen::Vector3d(1.0, 0.0, 0.0), 0.03}, time_);
  ++counts_.spheres;
  ASSERT_EQ(act(TeachAction::paint_off), "");
  const std::string why = act(TeachAction::start, "0,0");
  EXPECT_NE(why.find("; the balls are too small to hold a voxel of 50 mm"), std::string::npos) << why;
}

TEST_F(TeachSessionOf, TimesOfTheSetupsVolumesAreReportedAsUnused) {
  setup_.volumes = {{.label = "free", .critical_parts = {}, .from = 0.0, .to = 3.0}};
  ASSERT_EQ(act(TeachAction::paint_on), "");
  EXPECT_EQ(
      remark(),
      "into volume 'free', whatever `from` and `to` of the setup's volumes say; 'volume' chooses another");
}

TEST_F(TeachSessionOf, AllThatWasDoneIsUndoneStepByStep) {
  const std::string empty = map_sha256(map_.snapshot());
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(act(TeachAction::approve), "the plan is approved already; undo takes that back");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "approval is undone");
  EXPECT_EQ(session_.state(), TeachState::planned);
  EXPECT_FALSE(session_.plans()[0].is_approved);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_TRUE(session_.goals().empty());
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::ready);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "stroke is undone");
  EXPECT_EQ(map_.snapshot().counts().painted, 0u);
  EXPECT_NE(act(TeachAction::start, "0,0.3"), "");  // no paint is left
  EXPECT_EQ(act(TeachAction::undo), "nothing was done");
}

TEST_F(TeachSessionOf, APlanIsNotApprovedOnceWhatItRestsOnIsBlocked) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  // A scan that sees something right where the arm goes.
  const Robot& robot = session_.robot()->robot();
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  const Eigen::Vector3d tip = tip_pose(robot, session_.plans()[0].plan.waypoints().back()).translation();
  for (double dx = -0.1; dx <= 0.1; dx += 0.02)
    for (double dy = -0.1; dy <= 0.1; dy += 0.02)
      scan.points.push_back((tip + Eigen::Vector3d(dx, dy, -2)).cast<float>());
  ++counts_.scans;  // taken, and waits for the place of its sensor
  ASSERT_EQ(act(TeachAction::approve), "");
  ASSERT_EQ(act(TeachAction::undo), "");
  map_.insert(scan);
  ++counts_.scans_inserted;
  const std::string why = act(TeachAction::approve);
  EXPECT_NE(why.find("the map has changed since it was planned: "), std::string::npos) << why;
  EXPECT_EQ(session_.state(), TeachState::planned);
  EXPECT_FALSE(session_.plans()[0].is_approved);
}

TEST_F(TeachSessionOf, ARobotThatIsChosenBetweenImagesStandsWhereTheProbeWasSeenLast) {
  setup_.gripper.emplace();
  paint_everything();
  const Robot& robot = session_.robot()->robot();
  const Eigen::Isometry3d map_from_tip = tip_pose(robot, Eigen::Vector2d(0.4, 0.6));
  const Frame frame;
  const std::vector<TagDetection> tags;
  session_.see({frame, tags, nullptr, map_from_tip, time_, {}});
  time_ -= 0.9;  // both events come before the next image
  ASSERT_EQ(act(TeachAction::robot, "planar2"), "");
  time_ -= 0.9;
  EXPECT_EQ(act(TeachAction::start), "");
  EXPECT_TRUE(tip_pose(session_.robot()->robot(), session_.robot()->q()).isApprox(map_from_tip, 1e-6));
  EXPECT_EQ(act(TeachAction::goal), "the gripper probe was not seen for 1.2 s");
  ASSERT_EQ(act(TeachAction::robot, "planar2"), "");  // by now the pose says nothing
  EXPECT_EQ(act(TeachAction::start), "the gripper probe was not seen yet, since this robot was chosen");
}

TEST_F(TeachSessionOf, ABaseBoardThatIsNotSeenIsNamedAndNotTheProbe) {
  setup_.gripper.emplace();
  BoardSetup board;
  board.name = "table";
  board.map_from_board.emplace(Eigen::Isometry3d::Identity());
  board.tags = {{.id = 7}};
  setup_.boards = {board};
  session_.begin(setup_, map_, counts_);
  paint_everything();
  const Frame frame;
  std::vector<TagDetection> table(1), gripper(1);
  table.front().id = 7;
  gripper.front().id = 9;
  session_.see({frame, gripper, nullptr, {}, time_, {}});
  EXPECT_EQ(act(TeachAction::start), "the base board 'table' was not seen yet");
  session_.see({frame, table, nullptr, {}, time_, {}});
  EXPECT_EQ(act(TeachAction::start), "the gripper probe was not seen yet, since this robot was chosen");
  const Eigen::Isometry3d map_from_tip = tip_pose(session_.robot()->robot(), Eigen::Vector2d(0.4, 0.6));
  session_.see({frame, table, nullptr, map_from_tip, time_, {}});
  session_.see({frame, table, nullptr, {}, time_ + 0.2, {}});
  EXPECT_EQ(act(TeachAction::start), "the gripper probe was not seen for 1 s");
  session_.see({frame, gripper, nullptr, {}, time_, {}});
  EXPECT_EQ(act(TeachAction::start), "the base board 'table' was not seen for 1.8 s");
}

TEST_F(TeachSessionOf, TheBallShowsWhereARobotIsToStand) {
  BoardSetup board;
  board.name = "table";
  board.map_from_board.emplace(Eigen::Translation3d(0.0, 0.0, 0.5));
  setup_.boards = {board};
  setup_.probe->ball_radius = 0.02;
  setup_.robot->map_from_base.linear() =
      Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();  // its z is the map's -y
  session_.begin(setup_, map_, counts_);
  const auto at_ball = [&](double after) {
    TeachEvent event;
    event.time = time_ + after;
    event.action = TeachAction::robot;
    event.robot.robot = "planar2";
    event.base_at_ball = true;
    return event;
  };
  const auto take = [&](double after) {
    due_ = {at_ball(after)};
    session_.before(time_ + after);
    return session_.events().back().refusal;
  };
  EXPECT_EQ(take(0.0), "the ball has not been accepted yet; hold it where the base is to stand");
  const Frame frame;
  PaintingSample sample;
  sample.sphere.center = {0.3, 0.2, 0.1};
  session_.see({frame, {}, &sample, {}, time_, {}});
  EXPECT_EQ(take(0.1), "the ball has not been accepted yet; hold it where the base is to stand");
  sample.accepted = true;
  sample.bound.total = 0.004;
  session_.see({frame, {}, &sample, {}, time_, {}});
  EXPECT_EQ(take(1.5), "the ball has not been accepted for 1.5 s; hold it where the base is to stand");
  ASSERT_EQ(take(0.2), "");
  EXPECT_EQ(remark(), "its base is at 0.3, 0.22, 0.6 m, within 4 mm");
  const Eigen::Isometry3d base = session_.robot()->robot().map_from_base;
  EXPECT_TRUE(base.translation().isApprox(Eigen::Vector3d(0.3, 0.22, 0.6), 1e-12));
  EXPECT_TRUE(base.linear().isApprox(setup_.robot->map_from_base.linear(), 1e-12));
  ASSERT_EQ(act(TeachAction::undo), "");
  EXPECT_TRUE(session_.robot()->robot().map_from_base.isApprox(setup_.robot->map_from_base));
  setup_.probe.reset();
  EXPECT_EQ(take(0.2), "the setup has no probe whose ball could show the base");
}

TEST_F(TeachSessionOf, PartsThatTheRobotHasNotAreNamedAsTheVolumeOrTheRobotIsChosen) {
  TeachEvent volume;
  volume.time = ++time_;
  volume.action = TeachAction::volume;
  volume.name = "hold";
  volume.critical_parts = {"forearm", "griper"};
  due_ = {volume};
  session_.before(time_);
  const std::string note =
      "robot 'planar2' has no part griper, which volume 'hold' is for; it has forearm, upper_arm";
  EXPECT_EQ(remark(), note);
  EXPECT_EQ(act(TeachAction::robot, "planar2"), "");
  EXPECT_EQ(remark(), note);
  TeachEvent robot;
  robot.time = ++time_;
  robot.action = TeachAction::robot;
  robot.robot.robot = "planar2";
  robot.robot.policies = {"griper=painted"};
  due_ = {robot};
  session_.before(time_);
  EXPECT_EQ(session_.events().back().refusal,
            "policies: robot 'planar2' has no part 'griper' (it has forearm, upper_arm)");
}

/// What the session does next waits for its next event, however fast the planner is.
TEST(TeachSession, APlansAnswerIsReportedBeforeTheNextEvent) {
  clearway::Setup setup;
  setup.probe.emplace();
  setup.robot.emplace();
  setup.robot->name = "planar2";
  FreeSpaceMap map(MapOptions{.resolution = 0.05});
  map.paint(map.add_volume("free", {}), {Eigen::Vector3d::Zero(), 3.0}, 0.0);
  FusionCounts counts;
  counts.spheres = 1;
  std::vector<TeachEvent> due(3);
  due[0].action = TeachAction::start;
  due[1].action = TeachAction::goal;
  due[2].action = TeachAction::plan;
  due[0].q = "0,0.3";
  due[1].q = "1,0.5";
  std::vector<TaughtEvent> reports;
  TeachSession session([&](double) { return std::exchange(due, {}); },
                       {.report = [&](const TaughtEvent& event) { reports.push_back(event); }});
  session.begin(setup, map, counts);
  while (reports.size() < 4) session.before(1.0);
  EXPECT_EQ(reports.back().state, TeachState::planned);
  EXPECT_TRUE(reports.back().remark.starts_with("solved and proved by ")) << reports.back().remark;
  EXPECT_EQ(session.state(), TeachState::planning);
  EXPECT_EQ(session.events().back().remark, "");
  session.end();
  EXPECT_EQ(reports.size(), 4U);
  EXPECT_EQ(session.events().back().remark, reports.back().remark);
}

/// A motion leaves the plan's edges at corners: it is what a person approves, so it has to hold as well.
TEST_F(TeachSessionOf, TheCheckOfATaughtPlanIsOfItsMotionToo) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::via, "0.5,0.9"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  TaughtPlan taught = session_.plans().at(0);
  ASSERT_TRUE(taught.plan.motion);
  EXPECT_TRUE(check_taught(taught, map_.snapshot()).valid);
  for (Eigen::VectorXd& velocity : taught.plan.motion->motion.velocities) velocity *= 1.5;
  const PathVerdict verdict = check_taught(taught, map_.snapshot());
  EXPECT_FALSE(verdict.valid);
  EXPECT_NE(verdict.first_contact.find("motion"), std::string::npos) << verdict.first_contact;
}

TEST_F(TeachSessionOf, APlanRestsOnAMapWithTheVolumesThatThereAre) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::volume, "another"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  EXPECT_EQ(session_.plans()[0].map_digest, map_sha256(map_.snapshot()));
}

TEST_F(TeachSessionOf, AVolumeThatIsUndoneLeavesTheMapAsItWas) {
  paint_everything();
  const std::string digest = map_sha256(map_.snapshot());
  const std::size_t version = session_.map_version();
  for (int i = 0; i < 20; ++i) {  // more than a map has
    ASSERT_EQ(act(TeachAction::volume, "another"), "");
    EXPECT_GT(session_.map_version(), version);
    ASSERT_EQ(act(TeachAction::undo), "");
  }
  EXPECT_EQ(map_sha256(map_.snapshot()), digest);
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");  // in the volume that there was before
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::volume, map_.volumes().front().label), "");  // chosen, not new
  ASSERT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(map_sha256(map_.snapshot()), digest);
}

TEST_F(TeachSessionOf, ARobotStandsWhereTheSetupHasIt) {
  setup_.robot->map_from_base.translation() = Eigen::Vector3d(0, 0, 0.1);
  setup_.robot->scale = 0.5;
  ASSERT_EQ(act(TeachAction::robot, "planar2"), "");
  EXPECT_EQ(session_.robot()->robot().map_from_base.translation().z(), 0.1);
  EXPECT_EQ(session_.robot()->robot().scale, 0.5);
  ASSERT_EQ(act(TeachAction::robot, "arm6"), "");
  EXPECT_EQ(session_.robot()->robot().map_from_base.translation().z(), 0.1);
  EXPECT_NE(session_.robot()->robot().scale, 0.5);
  setup_.robot->terms.fixed = {{"elbow", 0.3}};
  ASSERT_EQ(act(TeachAction::robot, "planar2"), "");
  EXPECT_EQ(session_.robot()->robot().dof(), 1U);
}

TEST_F(TeachSessionOf, AFailedPlanSaysWhyAndTheChoiceStays) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  TeachEvent event;
  event.time = ++time_;
  event.action = TeachAction::plan;
  event.planner = "nosuch";
  due_ = {event};
  session_.before(time_);
  EXPECT_NE(session_.events().back().refusal.find("nosuch"), std::string::npos);
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_NE(act(TeachAction::robot, "nosuch"), "");
  EXPECT_EQ(act(TeachAction::robot, "arm6"), "");
  EXPECT_EQ(session_.state(), TeachState::ready);  // another robot: start and goals are gone
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
}

}  // namespace teach_session_test
}  // namespace clearway
