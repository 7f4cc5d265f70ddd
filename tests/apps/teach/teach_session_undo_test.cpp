#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "tests/worlds/taught_planar.hpp"

namespace clearway {
namespace teach_session_undo_test {

class TeachSessionUndo : public worlds::TeachSessionOf {
 protected:
  /// A ball far from the arm, as a stroke or an eraser of its own.
  void stroke(TeachAction on, const Eigen::Vector3d& center) {
    const bool paints = on == TeachAction::paint_on;
    EXPECT_EQ(act(on), "");
    const Sphere ball{center, 0.3};
    paints ? static_cast<void>(map_.paint(0, ball, time_)) : static_cast<void>(map_.erase(0, ball, time_));
    ++(paints ? counts_.spheres : counts_.erasers);
    EXPECT_EQ(act(paints ? TeachAction::paint_off : TeachAction::erase_off), "");
  }
  std::string digest() const { return map_sha256(map_.snapshot()); }
};

TEST_F(TeachSessionUndo, TakesBackTheLastStrokeAndLeavesWhatWasChosenSince) {
  paint_everything();
  const std::string before = digest();
  stroke(TeachAction::paint_on, {5.0, 0.0, 0.0});
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_TRUE(session_.has_strokes());
  const std::size_t version = session_.map_version();
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(remark(), "stroke is undone");
  EXPECT_EQ(digest(), before);
  EXPECT_GT(session_.map_version(), version);
  EXPECT_TRUE(session_.start());
  EXPECT_TRUE(session_.goal());
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::undo), "");  // of the goal, as if the stroke had not been
  EXPECT_EQ(remark(), "goal is undone");
  EXPECT_FALSE(session_.goal());
  EXPECT_TRUE(session_.start());
}

TEST_F(TeachSessionUndo, GoesBackStrokeByStroke) {
  const std::string empty = digest();
  stroke(TeachAction::paint_on, {5.0, 0.0, 0.0});
  const std::string first = digest();
  stroke(TeachAction::paint_on, {6.0, 0.0, 0.0});
  const std::string second = digest();
  stroke(TeachAction::erase_on, {5.5, 0.0, 0.0});
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(remark(), "eraser is undone");
  EXPECT_EQ(digest(), second);
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(digest(), first);
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(digest(), empty);
  EXPECT_EQ(act(TeachAction::undo_stroke), "no stroke was made, or none is left");
  EXPECT_FALSE(session_.has_strokes());
  EXPECT_EQ(act(TeachAction::undo), "nothing was done");
}

TEST_F(TeachSessionUndo, EndsTheStrokeThatIsBeingMade) {
  ASSERT_EQ(act(TeachAction::paint_on), "");
  map_.paint(0, {Eigen::Vector3d::Zero(), 1.0}, time_);
  ++counts_.spheres;
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(session_.state(), TeachState::ready);
  EXPECT_EQ(map_.snapshot().counts().painted, 0U);
  ASSERT_EQ(act(TeachAction::object, "cup"), "");
  EXPECT_EQ(act(TeachAction::undo_stroke), "a stroke marks an object; 'object_off' ends it");
}

TEST_F(TeachSessionUndo, SaysWhichPlacesAreNotFreeWithoutTheStroke) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_NE(remark().find("; the start is not free any more: "), std::string::npos) << remark();
  EXPECT_NE(remark().find("; the goal is not free any more: "), std::string::npos) << remark();
  EXPECT_TRUE(session_.start());
}

/// A plan rests on the stroke, and a person who takes that back has not approved what is left.
TEST_F(TeachSessionUndo, WithdrawsWhatWasPlannedAndApprovedSince) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan, "early"), "");
  ASSERT_EQ(act(TeachAction::approve), "");
  stroke(TeachAction::paint_on, {5.0, 0.0, 0.0});
  ASSERT_EQ(act(TeachAction::plan, "late"), "");
  ASSERT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(act(TeachAction::undo_stroke), "");
  EXPECT_EQ(remark(), "stroke is undone, and the approval of 'late'");
  EXPECT_TRUE(session_.plans()[0].is_approved);  // before the stroke
  EXPECT_FALSE(session_.plans()[1].is_approved);
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(session_.last_plan(), nullptr);
  EXPECT_EQ(act(TeachAction::approve), "a stroke was undone since it was planned; plan again");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "approval is undone");  // of the early plan
  EXPECT_FALSE(session_.plans()[0].is_approved);
}

TEST_F(TeachSessionUndo, OfAnotherArmConfigurationGivesTheFirstOneBack) {
  paint_everything();
  TeachEvent robot;
  robot.time = ++time_;
  robot.action = TeachAction::robot;
  robot.robot.robot = "planar2";
  robot.near = {0.4, 0.6};
  due_ = {robot};
  session_.before(time_);
  ASSERT_EQ(session_.events().back().refusal, "");
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  EXPECT_EQ(act(TeachAction::branch), "");
  EXPECT_EQ(remark(), "arm configuration 2 of 2");
  EXPECT_NEAR(session_.shown_configuration()[1], -0.6, 1e-3);
  EXPECT_TRUE(session_.start());  // as it was chosen
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "branch is undone");
  EXPECT_NEAR(session_.shown_configuration()[1], 0.6, 1e-9);
  ASSERT_EQ(act(TeachAction::robot, "point"), "");
  EXPECT_EQ(act(TeachAction::branch).find("the robot stands nowhere yet"), 0U);
}

}  // namespace teach_session_undo_test
}  // namespace clearway
