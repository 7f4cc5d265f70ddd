// Objects that are marked, picked and placed in a session.

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "tests/worlds/taught_planar.hpp"

namespace clearway {
namespace teach_session_picks_test {

using worlds::TeachSessionOf;

/// A can on a table before the six-joint arm, all seen by sensors; a stroke goes round the can.
class TeachPick : public TeachSessionOf {
 protected:
  TeachPick() : TeachSessionOf(0.02) {
    BoardSetup board;
    board.name = "base";
    board.map_from_board = Eigen::Isometry3d::Identity();
    setup_.boards = {board};
    setup_.probe->ball_radius = 0.0225;
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.42, 0.0, 1.5);
    add_box(scan, {0.25, -0.45, 0.05}, {0.69, 0.45, 0.1});
    add_box(scan, {0.41, 0.15, 0.11}, {0.44, 0.18, 0.22});
    see(scan);
    map_.paint(0, {Eigen::Vector3d(0.0, 0.0, 0.5), 1.6}, time_);  // so that the map knows of all places
    ++counts_.spheres;
    TeachEvent robot;
    robot.time = ++time_;
    robot.action = TeachAction::robot;
    robot.robot.robot = "arm6";
    robot.robot.policies = {"not_occupied"};
    EXPECT_EQ(act(robot), "");
  }
  static void add_box(Scan& scan, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    for (double x = low.x(); x <= high.x(); x += 0.02)
      for (double y = low.y(); y <= high.y(); y += 0.02)
        for (double z = low.z(); z <= high.z(); z += 0.02)
          scan.points.push_back((scan.map_from_sensor.inverse() * Eigen::Vector3d(x, y, z)).cast<float>());
  }
  void see(const Scan& scan) {
    map_.insert(scan);
    ++counts_.scans_inserted;
  }
  std::string act(const TeachEvent& event) {
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  using TeachSessionOf::act;
  std::string mark(const std::string& name, const std::string& link = "", double x = 0.42,
                   double mass = 0.0) {
    TeachEvent event;
    event.time = ++time_;
    event.action = TeachAction::object;
    event.name = name;
    event.link = link;
    event.mass = mass;
    if (const std::string why = act(event); !why.empty()) return why;
    EXPECT_EQ(session_.state(), TeachState::marking);
    EXPECT_EQ(session_.brush().use, Brush::Use::none);
    for (double turn = 0.0; turn < 6.3; turn += 0.3)
      for (const double height : {0.0, 0.05, 0.11}) {
        PaintingSample sample;
        sample.accepted = turn < 6.2;
        sample.sphere.center = {x + 0.025 * std::cos(turn), 0.16 + 0.025 * std::sin(turn), 0.1225 + height};
        sample.sphere.radius = 0.02;
        sample.bound.total = 0.002;
        session_.see({frame_, {}, &sample, {}, time_, {}});
      }
    return act(TeachAction::object_off);
  }
  /// The first of the arm's configurations with the tip so, from above, that the session takes.
  std::string take(TeachAction action, const Eigen::Vector3d& tip, const std::string& name = "") {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = tip;
    pose.linear() = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Configuration near = (Configuration(6) << 0, -1.9, 1.7, -1.4, -1.57, 0).finished();
    std::string why = "none";
    for (const Configuration& q : goal_configurations(session_.robot()->robot(), pose, near)) {
      TeachEvent event;
      event.time = ++time_;
      event.action = action;
      event.name = name;
      event.q = to_text(std::vector<double>(q.begin(), q.end()));
      if ((why = act(event)).empty()) break;
    }
    return why;
  }
  Frame frame_;
};

TEST_F(TeachPick, AMarkedObjectIsTakenAndPutDownAndOnlyWhatHoldsItTouchesIt) {
  const std::string before = map_sha256(map_.snapshot());
  EXPECT_EQ(act(TeachAction::object_off), "no object is being marked; 'object' begins that");
  EXPECT_NE(mark("can", "hnd").find("did you mean 'hand'?"), std::string::npos);
  ASSERT_EQ(mark("can"), "");
  EXPECT_EQ(mark("can"), "there is an object 'can' already, expected another name");
  EXPECT_EQ(map_sha256(map_.snapshot()), before);
  EXPECT_EQ(act(TeachAction::pick), "no start is chosen; 'start' comes first");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  EXPECT_EQ(act(TeachAction::place, "0,0,0,0,0,0"), "nothing is picked; 'pick' comes first");
  EXPECT_EQ(act(TeachAction::pick, "cup"), "no object 'cup' is marked");
  EXPECT_NE(take(TeachAction::pick, {0.42, 0.16, 0.09}), "");  // the hand in the table
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}), "");
  EXPECT_EQ(act(TeachAction::via, "0,-1.9,1.7,-1.4,-1.57,0"),
            "a pick has no goals on the way; 'goal' says where the robot goes in the end");
  EXPECT_EQ(act(TeachAction::plan), "no place is chosen; 'place' says where 'can' goes");
  EXPECT_NE(take(TeachAction::place, {0.42, -0.2, 0.17}), "");  // the can in the table
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(act(TeachAction::goal, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(act(TeachAction::plan, "carry"), "");
  ASSERT_EQ(act(TeachAction::play), "")
      << session_.plans().back().plan.explanation() << session_.plans().back().plan.validation.first_contact;
  const TaughtPlan& taught = session_.plans().back();
  ASSERT_TRUE(taught.plan.is_proved());
  ASSERT_TRUE(taught.plan.pick.has_value());
  EXPECT_EQ(taught.plan.legs.size(), 7U);
  ASSERT_EQ(taught.plan.loads.size(), 1U);
  EXPECT_EQ(taught.plan.loads[0].legs, (std::vector<int>{2, 3, 4}));
  // The can stands, rides, and stands where it was put.
  ASSERT_EQ(session_.standing_objects().size(), 1U);
  const Eigen::Vector3d from = session_.standing_objects()[0].second.translation();
  std::size_t rides = 0;
  Eigen::Vector3d last = from;
  for (double at = time_; session_.state() == TeachState::playing; session_.before(at += 0.05)) {
    const auto standing = session_.standing_objects();
    EXPECT_EQ(standing.size() + session_.shown_loads().size(), 1U);
    rides += standing.empty();
    if (!standing.empty()) last = standing[0].second.translation();
  }
  EXPECT_GT(rides, 3U);
  EXPECT_NEAR((last - from).y(), -0.36, 1e-3);
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(map_sha256(map_.snapshot()), before);
}

/// The path is free, but no motor holds the can.
TEST_F(TeachPick, AMotionThatNeedsMoreTorqueThanThereIsIsNotApproved) {
  ASSERT_EQ(mark("can", "", 0.42, 90.0), "");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}), "");
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(act(TeachAction::plan, "heavy"), "");
  ASSERT_EQ(act(TeachAction::play), "");
  ASSERT_TRUE(session_.plans().back().plan.is_proved());
  const std::string why = act(TeachAction::approve);
  EXPECT_NE(why.find("its motion is not proved, and would not be exported: "), std::string::npos) << why;
  EXPECT_NE(why.find("the torque of joint "), std::string::npos) << why;
  EXPECT_FALSE(session_.plans().back().is_approved);
}

TEST_F(TeachPick, APickTakesNoVoxelOfAnotherMarkedObject) {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.48, 0.0, 1.5);
  add_box(scan, {0.47, 0.15, 0.11}, {0.50, 0.18, 0.22});
  see(scan);
  ASSERT_EQ(mark("can"), "");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(mark("cup", "", 0.48), "");
  const std::string refusal = "with 'can' voxels of 'cup' would leave the map";
  EXPECT_NE(take(TeachAction::pick, {0.42, 0.16, 0.21}, "can").find(refusal), std::string::npos);
  // Marked after the pick: the plan is refused.
  ASSERT_EQ(act(TeachAction::undo), "");
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}, "can"), "");
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(mark("cup", "", 0.48), "");
  EXPECT_NE(act(TeachAction::plan, "carry").find(refusal), std::string::npos);
}

TEST_F(TeachPick, APickIsUndoneStepByStepAndNotApprovedOnceItsWayIsBlocked) {
  ASSERT_EQ(mark("can", "hand"), "");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}), "");
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  Scan wall;  // across the way
  wall.map_from_sensor.translation() = Eigen::Vector3d(0.42, 0.0, 1.5);
  add_box(wall, {0.01, -0.03, 0.11}, {0.99, -0.01, 0.9});
  see(wall);
  const std::string why = act(TeachAction::approve);
  EXPECT_NE(why.find("the map has changed since it was planned: "), std::string::npos) << why;
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "plan is undone");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "place is undone");
  EXPECT_NE(act(TeachAction::plan).find("no place is chosen"), std::string::npos);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "pick is undone");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "object is undone");
  EXPECT_TRUE(session_.standing_objects().empty());
}

}  // namespace teach_session_picks_test
}  // namespace clearway
