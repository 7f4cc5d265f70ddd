// The independent check's voxels: read from the tree, and which of them it looks at.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "mapping/stamps/seen_stamps.hpp"
#include "planning/check/path_check_model.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::check {
namespace path_check_cells_test {

constexpr double edge = 0.1;
using Key = std::array<int, 3>;

Key key(const Eigen::Vector3i& cell) { return {cell.x(), cell.y(), cell.z()}; }

/// Clumps of occupied voxels and painted ones between them, more than 64 along x.
Snapshot clumps(Random& random) {
  FreeSpaceMap builder({.resolution = edge});
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d corner(random.between(-5.0, 5.0), random.between(-1.0, 1.0),
                                 random.between(-1.0, 1.0));
    for (int k = 0; k < 64; ++k) occupy(builder, corner + edge * Eigen::Vector3d(k % 4, k / 4 % 4, k / 16));
  }
  const int volume = builder.add_volume("free", {});
  for (int i = 0; i < 10; ++i) builder.paint(volume, {Eigen::Vector3d(i - 4.5, 0.2, 0.1), 0.7});
  return builder.snapshot();
}

/// The cells of the shell in the blocks that touch the box and are near.
template <class IsNear, class Visit>
void visit_shell(const BlockedCells& cells, const Eigen::AlignedBox3d& box, const IsNear& is_near,
                 const Visit& visit) {
  cells.visit_blocks(box, [&](const Eigen::Vector3d& middle, double reach, const Eigen::Vector3i& block) {
    if (!is_near(middle, reach)) return;
    int voxels = 0;
    cells.visit_shell(block, [&](const Eigen::Vector3d& center) { ++voxels, visit(center); });
    EXPECT_GT(voxels, 0);
  });
}

TEST(PathCheckCells, EveryVoxelIsThatOfTheMapAndTheShellIsWhatHasAFreeNeighbour) {
  Random random(4);
  const Snapshot map = clumps(random);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-5.13, -1.04, -0.97), Eigen::Vector3d(4.9, 1.11, 1.2));
  for (const Policy policy : {Policy::not_occupied, Policy::known_free}) {
    const BlockedCells cells(map, policy, 0xffff, box, 0.0);
    const Eigen::Vector3i low = cells.cell(box.min()), high = cells.cell(box.max());
    std::set<Key> expected, shell;
    int blocked = 0, all = 0;
    const auto is_inside = [&](const Eigen::Vector3i& at) {
      return (at.array() >= low.array()).all() && (at.array() <= high.array()).all();
    };
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x, ++all) {
          const Eigen::Vector3i at(x, y, z);
          const VoxelState state = map.state(cells.center(at));
          const bool truth = state == VoxelState::occupied || state == VoxelState::conflict ||
                             (policy == Policy::known_free && state != VoxelState::painted);
          ASSERT_EQ(cells.is_blocked(at), truth) << at.transpose();
          blocked += truth;
          bool surrounded = true;
          for (int k = 0; k < 27 && surrounded; ++k) {
            const Eigen::Vector3i next = at + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            surrounded = is_inside(next) && cells.is_blocked(next);
          }
          if (truth && !surrounded) expected.insert(key(at));
        }
      }
    }
    visit_shell(
        cells, box, [](const Eigen::Vector3d&, double) { return true; },
        [&](const Eigen::Vector3d& center) { EXPECT_TRUE(shell.insert(key(cells.cell(center))).second); });
    EXPECT_EQ(shell, expected);
    EXPECT_GT(blocked, 1000);
    EXPECT_LT(expected.size(), static_cast<std::size_t>(blocked));
    EXPECT_LT(blocked, all);
  }
}

/// Whether a body may not be there, by the map's own words.
bool is_forbidden(const Snapshot& map, const Requirement& requirement, const Eigen::Vector3d& center) {
  const Voxel voxel = map.voxel(center);
  if (!allows(requirement, voxel.state, voxel.volumes)) return true;
  if (requirement.policy != Policy::known_free || voxel.state != VoxelState::seen_free) return false;
  const auto seen = map.last_seen(center);
  return requirement.seen_within > 0.0 && (!seen || map.seen()->newest() - *seen > requirement.seen_within);
}

/// Under each policy, with volumes and times, in boxes of few cells and many, wherever they begin.
TEST(PathCheckCells, ACellIsBlockedWhereTheMapSaysSoAndBeyondTheBoxAsThePolicyHasIt) {
  constexpr double voxel = 0.05;
  worlds::Dice dice(6);
  FreeSpaceMap builder({.resolution = voxel, .integration = Integration::compatible});
  builder.add_volume("tunnel", {"tool"});
  builder.add_volume("dock", {"base"});
  for (int round = 0; round < 6; ++round) {
    Scan scan = worlds::random_scan(dice, 300);
    std::erase_if(scan.points, [&](const Eigen::Vector3f& point) { return point[round % 3] < 0.0F; });
    scan.time = round == 0 ? std::nan("") : round;
    builder.insert(scan);
    builder.paint(round % 2, {dice.point(0.6), 0.25});
  }
  const Snapshot map = builder.snapshot();
  int stale = 0;
  for (const Requirement& requirement :
       {Requirement{Policy::not_occupied, 0xffff, 2.0}, Requirement{Policy::painted, 0xffff, 2.0},
        Requirement{Policy::painted, 1}, Requirement{Policy::painted, 2}, Requirement{Policy::known_free},
        Requirement{Policy::known_free, 0xffff, 2.0}, Requirement{Policy::known_free, 0xffff, 3.5}}) {
    for (const int wide : {1, 2, 63, 64, 65, 66}) {
      const Eigen::Vector3i size(wide, 1 + wide % 7, 2 + wide % 5);
      const Eigen::Vector3i first(dice.whole(-16, 16) - wide / 2, dice.whole(-16, 10), dice.whole(-16, 10));
      const Eigen::Vector3d inwards = Eigen::Vector3d::Constant(0.3);
      const BlockedCells cells(
          map, requirement.policy, requirement.volumes,
          {(first.cast<double>() + inwards) * voxel, ((first + size).cast<double>() - inwards) * voxel},
          requirement.seen_within);
      for (int z = -1; z <= size.z(); ++z) {
        for (int y = -1; y <= size.y(); ++y) {
          for (int x = -1; x <= size.x(); ++x) {
            const Eigen::Vector3i in_box(x, y, z), at = first + in_box;
            const bool is_in = (in_box.array() >= 0).all() && (in_box.array() < size.array()).all();
            const bool truth = is_in ? is_forbidden(map, requirement, cells.center(at))
                                     : requirement.policy != Policy::not_occupied;
            ASSERT_EQ(cells.is_blocked(at), truth) << wide << ": " << in_box.transpose();
            stale += is_in && truth && requirement.seen_within > 0.0 &&
                     map.state(cells.center(at)) == VoxelState::seen_free;
          }
        }
      }
    }
  }
  EXPECT_GT(stale, 100);
}

TEST(PathCheckCells, ABlockThatIsNotNearIsLeftOutWithAllOfItsVoxels) {
  Random random(5);
  const Snapshot map = clumps(random);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-5.0, -1.5, -1.5), Eigen::Vector3d(5.0, 1.5, 1.5));
  const BlockedCells cells(map, Policy::not_occupied, 0xffff, box, 0.0);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d at(random.between(-5.0, 5.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    const double radius = random.between(0.1, 1.0);
    std::set<Key> found, expected;
    visit_shell(
        cells, box,
        [&](const Eigen::Vector3d& middle, double reach) { return (middle - at).norm() - reach < radius; },
        [&](const Eigen::Vector3d& center) {
          if ((center - at).norm() < radius) found.insert(key(cells.cell(center)));
        });
    visit_shell(
        cells, box, [](const Eigen::Vector3d&, double) { return true; },
        [&](const Eigen::Vector3d& center) {
          if ((center - at).norm() < radius) expected.insert(key(cells.cell(center)));
        });
    EXPECT_EQ(found, expected);
  }
}

TEST(PathCheckCells, ARobotFarOffTheMapIsReportedAsSuch) {
  const Snapshot map = FreeSpaceMap({.resolution = 0.005}).snapshot();
  const auto sentence = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) -> std::string {
    try {
      const BlockedCells cells(map, Policy::known_free, 0xffff, {low, high}, 0.0);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const Eigen::Vector3d far(2e7, 0.0, 0.0);
  EXPECT_NE(sentence(far, far + Eigen::Vector3d::Ones()).find("2e+07 m from the map's origin"),
            std::string::npos);
  const Eigen::Vector3d last(-2.1e9 * 0.005, 0.0, 0.0), step(0.01, 0.0, 0.0);
  EXPECT_NE(sentence(last - step, last + step).find("from the map's origin"), std::string::npos);
  for (int axis = 0; axis < 3; ++axis) {  // and a robot that only its upper end takes there
    const Eigen::Vector3d at = 2.1e9 * 0.005 * Eigen::Vector3d::Unit(axis), some(0.01, 0.01, 0.01);
    EXPECT_NE(sentence(at - some, at + some).find("from the map's origin"), std::string::npos) << axis;
  }
  EXPECT_NE(sentence(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(6.0)).find("coarser map"),
            std::string::npos);
}

}  // namespace path_check_cells_test
}  // namespace clearway::check
