// REMOVE and MOVE of scene objects, as moveit_core's PlanningScene has them (processCollisionObjectRemove,
// processCollisionObjectMove). Where voxels are expected is computed by hand.
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

class SceneOperations : public Import {
 protected:
  /// Imports a scene of these objects; returns what is left out.
  Json left_out_of(const std::vector<std::string>& objects, const std::string& more = "") {
    std::filesystem::remove_all(folder_ / "out");
    std::string list;
    for (const std::string& object : objects) list += (list.empty() ? "{" : ", {") + object + "}";
    run_ = import("mbm", {folder_.write("s.yaml", more + "world: {collision_objects: [" + list + "]}")},
                  {"--json"});
    return run_.status == exit_done ? Json::parse(run_.out)["left_out"] : Json(run_.log);
  }

  void expect_occupied(const std::vector<Eigen::Vector3d>& points) const {
    EXPECT_EQ(map("s").counts().occupied, points.size());
    for (const Eigen::Vector3d& point : points)
      EXPECT_EQ(map("s").state(point), VoxelState::occupied) << point.transpose();
  }

  CommandRun run_;
};

std::string ball(const std::string& name, double x) {
  return "id: " + name +
         ", operation: 0, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: " +
         "[{position: [" + std::to_string(x) + ", 0.05, 0.05]}]";
}

/// Two balls, 1 m along x and 1 m along y of the object, which stands at x = 3.05, y = z = 0.05.
const std::string pair_of_balls =
    "id: pair, pose: {position: [3.05, 0.05, 0.05]}, primitives: [{type: sphere, dimensions: [0.01]}, {type: "
    "sphere, dimensions: [0.01]}], primitive_poses: [{position: [1, 0, 0]}, {position: [0, 1, 0]}]";

TEST_F(SceneOperations, ARemovedObjectIsNoObstacle) {
  EXPECT_EQ(left_out_of({ball("a", 1.05), ball("b", 2.05), "id: a, operation: 1"}), Json::array());
  expect_occupied({{2.05, 0.05, 0.05}});
  EXPECT_EQ(left_out_of({ball("a", 1.05), ball("b", 2.05), "id: a, operation: 1", "id: a, operation: 1",
                         ball("a", 4.05)}),
            Json{"s.yaml: the removal of object 'a', which is not there"});
  expect_occupied({{2.05, 0.05, 0.05}, {4.05, 0.05, 0.05}});
  // Without a name it is all of them.
  EXPECT_EQ(left_out_of({ball("a", 1.05), ball("b", 2.05), "id: '', operation: remove", ball("c", 4.05)}),
            Json::array());
  expect_occupied({{4.05, 0.05, 0.05}});
}

/// A quarter turn about z takes x to y, and y to -x.
TEST_F(SceneOperations, AMovedObjectTakesItsPiecesAlong) {
  const std::string there =
      "id: pair, operation: 3, pose: {position: [1.05, 2.05, 0.05], orientation: [0, 0, "
      "0.70710678, 0.70710678]}";
  EXPECT_EQ(left_out_of({pair_of_balls}), Json::array());
  expect_occupied({{4.05, 0.05, 0.05}, {3.05, 1.05, 0.05}});
  EXPECT_EQ(left_out_of({pair_of_balls, there}), Json::array());
  expect_occupied({{1.05, 3.05, 0.05}, {0.05, 2.05, 0.05}});
  // Moved twice, the second counts; shapes in the message do not.
  EXPECT_EQ(left_out_of({pair_of_balls, there,
                         "id: pair, operation: 3, pose: {position: [5.05, 0.05, 0.05]}, primitives: [{type: "
                         "box, dimensions: [9, 9, 9]}]"}),
            Json::array());
  expect_occupied({{6.05, 0.05, 0.05}, {5.05, 1.05, 0.05}});
  // Its pieces may get other places in it.
  EXPECT_EQ(left_out_of(
                {pair_of_balls, there + ", primitive_poses: [{position: [0, 0, 1]}, {position: [0, 0, 2]}]"}),
            Json::array());
  expect_occupied({{1.05, 2.05, 1.05}, {1.05, 2.05, 2.05}});
  const Json refused = left_out_of({pair_of_balls, there + ", primitive_poses: [{position: [0, 0, 1]}]"});
  EXPECT_EQ(run_.status, exit_bad_input);
  EXPECT_NE(refused.get<std::string>().find("or 2, one for each, got 1"), std::string::npos) << refused;
  EXPECT_EQ(left_out_of({ball("a", 1.05), there}),
            Json{"s.yaml: the move of object 'pair', which is not there"});
  expect_occupied({{1.05, 0.05, 0.05}});
}

/// The pose of a single piece is the object's where that states none: the move replaces it.
TEST_F(SceneOperations, ASinglePieceStandsWhereItsObjectIsMoved) {
  const std::string to = "id: a, operation: 3, pose: {position: [2.05, 0.05, 0.05]}";
  EXPECT_EQ(left_out_of({ball("a", 1.05), to}), Json::array());
  expect_occupied({{2.05, 0.05, 0.05}});
  EXPECT_EQ(left_out_of({ball("a", 1.05) + ", pose: {position: [0, 0, 1]}",
                         "id: a, operation: 3, pose: {position: [2, 0, 0]}"}),
            Json::array());
  expect_occupied({{3.05, 0.05, 0.05}});  // 1.05 is in the object's frame
}

/// A floor at z = 0.55 that is moved to z = 1.55 reaches as far from the robot as before.
TEST_F(SceneOperations, AMovedPlaneIsSpreadAboutTheRobotAgain) {
  const std::string floor = "id: floor, pose: {position: [0, 0, 0.55]}, planes: [{coef: [0, 0, 1, 0]}]";
  EXPECT_EQ(left_out_of({floor}), Json::array());
  const std::size_t before = map("s").counts().occupied;
  EXPECT_EQ(left_out_of({floor, "id: floor, operation: 3, pose: {position: [50, 0, 1.55]}"}), Json::array());
  EXPECT_EQ(map("s").counts().occupied, before);
  EXPECT_EQ(map("s").state({0.05, 0.05, 1.55}), VoxelState::occupied);
  EXPECT_EQ(map("s").state({0.05, 0.05, 0.55}), VoxelState::unknown);
}

TEST_F(SceneOperations, PlanesOfAttachedBodiesAreLeftOut) {
  EXPECT_EQ(
      left_out_of({ball("a", 1.05)},
                  "robot_state: {attached_collision_objects: [{link_name: lower, object: {id: cup, header: "
                  "{frame_id: lower}, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: "
                  "[{position: [0, 0, 0.1]}], planes: [{coef: [0, 0, 1, 0]}]}}]}\n"),
      Json{"s.yaml: planes of attached body 'cup'"});
}

}  // namespace import_test
}  // namespace clearway
