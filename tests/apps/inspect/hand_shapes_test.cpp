#include "apps/inspect/hand_shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include <nlohmann/json.hpp>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace hand_shapes_test {

constexpr double edge = 0.1;

using Cell = std::tuple<int, int, int>;

Cell cell_of(const Eigen::Vector3d& point) {
  const auto index = [](double value) { return static_cast<int>(std::floor(value / edge)); };
  return {index(point.x()), index(point.y()), index(point.z())};
}

std::set<Cell> set_of(const std::vector<Eigen::Vector3d>& centers) {
  std::set<Cell> cells;
  for (const Eigen::Vector3d& center : centers) cells.insert(cell_of(center));
  EXPECT_EQ(cells.size(), centers.size());
  return cells;
}

/// A random shape, as text and as the inequality that its points satisfy.
struct Drawn {
  std::string text;
  std::function<bool(const Eigen::Vector3d&)> holds;
};

Drawn draw(const std::string& kind, std::mt19937& random) {
  std::uniform_real_distribution<double> place(-0.3, 0.3), size(0.2, 0.9), angle(-3, 3);
  const Eigen::Vector3d middle(place(random), place(random), place(random));
  const Eigen::Vector3d sizes(size(random), size(random), size(random));
  const double roll = angle(random), pitch = angle(random), yaw = angle(random);
  std::ostringstream text;
  text.precision(17);
  text << kind << ':' << middle.x() << ',' << middle.y() << ',' << middle.z() << ',' << sizes.x();
  Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  if (kind == "sphere") {
    return {text.str(), [=](const Eigen::Vector3d& p) { return (p - middle).norm() <= sizes.x(); }};
  }
  text << ',' << sizes.y();
  if (kind == "box") text << ',' << sizes.z();
  const bool has_yaw_alone = roll > 0.0;
  if (has_yaw_alone) {
    turn = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    text << ',' << yaw;
  } else {
    text << ',' << roll << ',' << pitch << ',' << yaw;
  }
  if (kind == "box")
    return {text.str(), [=](const Eigen::Vector3d& p) {
              return ((turn.transpose() * (p - middle)).cwiseAbs() - 0.5 * sizes).maxCoeff() <= 0.0;
            }};
  return {text.str(), [=](const Eigen::Vector3d& p) {
            const Eigen::Vector3d q = turn.transpose() * (p - middle);
            return q.head<2>().norm() <= sizes.x() && std::abs(q.z()) <= 0.5 * sizes.y();
          }};
}

/// Points of a cell, its corners among them, on a grid of 6 a side.
template <typename Visit>
void visit_points(const Cell& cell, const Visit& visit) {
  constexpr int steps = 5;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j)
      for (int k = 0; k <= steps; ++k)
        visit(edge * Eigen::Vector3d(std::get<0>(cell) + double(i) / steps,
                                     std::get<1>(cell) + double(j) / steps,
                                     std::get<2>(cell) + double(k) / steps));
}

/// Against points: a cell with a point of the shape is met, one inside has no point elsewhere, and both the
/// other way round, but for what lies between the points.
TEST(HandShapes, MeetAndHoldTheVoxelsThatTheirPointsSay) {
  std::mt19937 random(3);
  for (const char* kind : {"box", "sphere", "cylinder"}) {
    std::size_t met_alone = 0, held = 0;
    for (int round = 0; round < 4; ++round) {
      const Drawn drawn = draw(kind, random);
      const std::set<Cell> met = set_of(cells_met({drawn.text}, edge));
      const std::set<Cell> inside = set_of(cells_inside({drawn.text}, edge));
      for (int x = -14; x < 14; ++x)
        for (int y = -14; y < 14; ++y)
          for (int z = -14; z < 14; ++z) {
            const Cell cell{x, y, z};
            std::size_t in = 0, all = 0;
            visit_points(cell, [&](const Eigen::Vector3d& point) {
              in += drawn.holds(point);
              ++all;
            });
            EXPECT_TRUE(in == 0 || met.contains(cell)) << drawn.text;
            met_alone += in == 0 && met.contains(cell);
            EXPECT_EQ(inside.contains(cell), in == all) << drawn.text;  // convex: the corners say it
            held += in == all;
          }
    }
    EXPECT_GT(held, 100U) << kind;
    EXPECT_LT(met_alone, 250U) << kind;  // met between the points
  }
}

TEST(HandShapes, ABoxOnVoxelBordersHoldsItsVoxels) {
  for (const double at : {0.0, 1.7, -33.3, 512.1}) {
    std::ostringstream text;
    text.precision(17);
    text << "box:" << at + 0.15 << ",0.2,0.3,0.3,0.4,0.2";
    EXPECT_EQ(cells_inside({text.str()}, edge).size(), 3U * 4U * 2U) << text.str();
  }
}

class HandEdits : public ::testing::Test {
 protected:
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.1});
    map.add_volume("tunnel", {"tool"});
    map.paint(0, {{0.0, 0.0, 0.0}, 0.4});
    save_map(map.snapshot(), map_);
  }
  TemporaryFolder folder_;
  std::string map_ = folder_.file("map"), out_ = folder_.file("out");
};

TEST_F(HandEdits, AreSavedCountedAndToldByPlanAndCheck) {
  // 2 x 2 x 2 painted voxels about the origin, and 2 x 2 x 8 beyond that nobody saw.
  const CommandRun run = run_command({"inspect", map_, "--occupy", "box:0,0,0.45,0.15,0.15,1.05", "--clear",
                                      "box:2,0,0,0.2,0.2,0.2", "--save", out_, "--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const auto edited = nlohmann::json::parse(run.out)["edited"];
  const Snapshot before = load_map(map_), made = load_map(out_);
  std::size_t occupied = 0, conflict = 0;
  for (int x = -1; x <= 0; ++x)
    for (int y = -1; y <= 0; ++y)
      for (int z = -1; z <= 9; ++z) {
        const Eigen::Vector3d center = 0.1 * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        const bool is_painted = before.state(center) == VoxelState::painted;
        ++(is_painted ? conflict : occupied);
        EXPECT_EQ(made.state(center), is_painted ? VoxelState::conflict : VoxelState::occupied);
      }
  EXPECT_EQ(edited["occupied"], occupied);
  EXPECT_EQ(edited["conflict"], conflict);
  EXPECT_EQ(edited["seen_free"], 8);
  EXPECT_EQ(edited["painted"], 0);
  EXPECT_EQ(made.state({2.05, 0.05, 0.05}), VoxelState::seen_free);
  EXPECT_EQ(made.state({2.15, 0.05, 0.05}), VoxelState::unknown);
  const std::string told = "edited by hand: 44 voxels made occupied, 8 voxels made free";
  EXPECT_NE(run_command({"inspect", out_}).out.find("44 voxels made occupied, 8 made free"),
            std::string::npos);
  const CommandRun plan =
      run_command({"plan", "--robot", "point", "--map", out_, "--start", "1,1", "--goal", "1,1.5", "--policy",
                   "not_occupied", "--out", folder_.file("plan.json")});
  EXPECT_NE(plan.out.find(told), std::string::npos) << plan.out << plan.log;
  const CommandRun check = run_command(
      {"check", folder_.file("plan.json"), "--map", out_, "--robot", "point", "--policy", "not_occupied"});
  EXPECT_NE(check.out.find(told), std::string::npos) << check.out << check.log;
}

TEST_F(HandEdits, AMapReaches32768VoxelsFromItsOriginAndNoShapeIsCutThere) {
  FreeSpaceMap small({.resolution = 0.0005});
  small.add_volume("dot", {"tool"});
  small.paint(0, {{0.0, 0.0, 0.0}, 0.01});
  save_map(small.snapshot(), map_ = folder_.file("small"));
  const auto run = [&](const std::string& shape) {
    return run_command({"inspect", map_, "--occupy", shape, "--save", out_});
  };
  for (const std::string sign : {"-", ""}) {
    EXPECT_EQ(run("box:" + sign + "16.38,0,0,0.007,0.001,0.001").status, exit_done);
    EXPECT_EQ(load_map(out_).state({(sign.empty() ? 1 : -1) * 16.38325, 0, 0}), VoxelState::occupied);
    const CommandRun beyond = run("box:0," + sign + "16.382,0,0.001,0.007,0.001");
    EXPECT_EQ(beyond.status, exit_bad_input);
    EXPECT_NE(beyond.log.find("expected a shape within 16.38 m of the map's origin"), std::string::npos)
        << beyond.log;
  }
}

TEST_F(HandEdits, ThatChangeNothingAreTold) {
  const CommandRun run = run_command({"inspect", map_, "--clear", "sphere:2,2,2,0.04", "--save", out_});
  EXPECT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.log.find("change no voxel"), std::string::npos) << run.log;
}

/// What both name is occupied.
TEST_F(HandEdits, OccupyComesAfterClear) {
  const CommandRun run = run_command({"inspect", map_, "--occupy", "sphere:2.05,0.05,0.05,0.01", "--clear",
                                      "box:2,0,0,1,1,1", "--save", out_});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("1 to occupied, 0 to conflict"), std::string::npos) << run.out;
  EXPECT_EQ(load_map(out_).state({2.05, 0.05, 0.05}), VoxelState::occupied);
  EXPECT_EQ(load_map(out_).state({2.15, 0.05, 0.05}), VoxelState::seen_free);
}

/// Nobody looked there: what the path sweeps is not "seen" without a word.
TEST_F(HandEdits, WhatIsFreeByHandAloneIsToldOfThePathThatRestsOnIt) {
  FreeSpaceMap seen({.resolution = 0.1});  // a wall in the way that scans hit, with times
  for (int i = 0; i < 3; ++i) {
    Scan scan;
    scan.time = 10.0 + i;
    scan.map_from_sensor.translation() = Eigen::Vector3d(1.0, -0.5, 0.0);
    for (int x = -20; x <= 20; ++x)
      for (int z = -20; z <= 20; ++z)
        scan.points.emplace_back(0.04F * static_cast<float>(x), 1.75F, 0.04F * static_cast<float>(z));
    seen.insert(scan);
  }
  save_map(seen.snapshot(), folder_ / "seen");
  for (const std::string& map : {map_, folder_.file("seen")}) {  // what nobody saw; what was seen occupied
    ASSERT_EQ(run_command({"inspect", map, "--clear", "box:1,1.25,0,1.6,2,1.2", "--save", out_}).status,
              exit_done);
    const CommandRun plan =
        run_command({"plan", "--robot", "point", "--map", out_, "--start", "1,1", "--goal", "1,1.5",
                     "--policy", "known_free", "--out", folder_.file("plan.json")});
    ASSERT_EQ(plan.status, exit_done) << plan.out << plan.log;
    const CommandRun check = run_command(
        {"check", folder_.file("plan.json"), "--map", out_, "--robot", "point", "--policy", "known_free"});
    for (const CommandRun* run : {&plan, &check}) {
      const std::size_t at = run->out.find(" % no later look is known: they may be free by hand alone)");
      ASSERT_NE(at, std::string::npos) << run->out << run->log;
      const std::size_t begin = run->out.rfind("(of ", at) + 4;
      EXPECT_GT(std::stod(run->out.substr(begin, at - begin)), map == map_ ? 99.0 : 10.0) << run->out;
    }
    std::filesystem::remove_all(out_);
  }
  ASSERT_EQ(run_command({"inspect", map_, "--occupy", "box:5,5,5,0.2,0.2,0.2", "--save", out_}).status,
            exit_done);
  EXPECT_EQ(run_command({"plan", "--robot", "point", "--map", out_, "--start", "1,1", "--goal", "1,1.5",
                         "--policy", "not_occupied"})
                .out.find("by hand alone"),
            std::string::npos);
}

TEST_F(HandEdits, RefuseWhatIsNoShapeInOneSentence) {
  const auto refused = [&](const std::string& shape, const std::string& why) {
    const CommandRun run = run_command({"inspect", map_, "--occupy", shape, "--save", out_});
    EXPECT_EQ(run.status, exit_bad_input) << shape;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(why), std::string::npos) << run.log;
  };
  refused("cube:1,2,3", "box:X,Y,Z,SX,SY,SZ, sphere:X,Y,Z,R or");
  refused("box", "box:X,Y,Z,SX,SY,SZ");
  refused("box:1,2,3,1,1", "and then YAW");
  refused("box:1,2,3,1,1,1,0,0", "and then YAW");
  refused("sphere:1,2,3,1,0.5", "expected sphere:X,Y,Z,R");
  refused("sphere:1,2,3,-1", "sizes above 0");
  refused("sphere:1,2,a,1", "--occupy");
  refused("sphere:1,2,300000,1", "a middle within 100 km");
  refused("box:1,2,3,1,1,1,90", "angles in radians, each within a whole turn");
  refused("cylinder:1,2,3,1,1,0,0,-7", "angles in radians, each within a whole turn");
  refused("box:0,0,0,900,900,900", "more than 25000000 voxels");
  const CommandRun run = run_command({"inspect", map_, "--clear", "sphere:1,2,3,1"});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("expected --save DIR"), std::string::npos) << run.log;
}

}  // namespace hand_shapes_test
}  // namespace clearway
