#include "planning/geometry/convex_pieces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning/geometry/convex_hull.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace convex_pieces_test {

using Points = std::vector<Eigen::Vector3d>;

void add(Points& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  mesh.insert(mesh.end(), {a, b, c});
}

void add_quad(Points& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  add(mesh, a, b, c), add(mesh, a, c, d);
}

/// A ring of `around` times `across` quads, of radius 1, whose tube is uneven.
Points torus(Random& random, int around, int across) {
  std::vector<double> radii;
  for (int i = 0; i < around * across; ++i) radii.push_back(random.between(0.15, 0.35));
  const auto at = [&](int i, int k) -> Eigen::Vector3d {
    i %= around, k %= across;
    const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * k / across;
    const double tube = radii[static_cast<std::size_t>(i * across + k)];
    return {(1 + tube * std::cos(v)) * std::cos(u), (1 + tube * std::cos(v)) * std::sin(u),
            tube * std::sin(v)};
  };
  Points mesh;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < across; ++k) add_quad(mesh, at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
  return mesh;
}

/// A star-shaped body with spikes and dents about the origin.
Points star(Random& random, int around, int rows) {
  std::vector<double> radii;
  for (int i = 0; i < around * (rows + 1); ++i) radii.push_back(random.between(0.2, 1.0));
  const auto at = [&](int i, int k) -> Eigen::Vector3d {
    i %= around;
    const double u = 2 * std::numbers::pi * i / around, v = std::numbers::pi * k / rows;
    const double r = k == 0 || k == rows ? 0.5 : radii[static_cast<std::size_t>(i * (rows + 1) + k)];
    if (k == 0 || k == rows) return {0, 0, k == 0 ? r : -r};
    return {r * std::sin(v) * std::cos(u), r * std::sin(v) * std::sin(u), r * std::cos(v)};
  };
  Points mesh;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < rows; ++k) {
      if (k > 0) add(mesh, at(i, k), at(i, k + 1), at(i + 1, k));
      if (k < rows - 1) add(mesh, at(i + 1, k), at(i, k + 1), at(i + 1, k + 1));
    }
  return mesh;
}

/// A plate with two walls on it, 1 wide, `mouth` apart; with corners on the planes of cuts.
Points channel(double mouth) {
  const std::vector<Eigen::Vector2d> outline{{0, 0},
                                             {1, 0},
                                             {1, 1},
                                             {0.5 + mouth / 2, 1},
                                             {0.5 + mouth / 2, 0.2},
                                             {0.5 - mouth / 2, 0.2},
                                             {0.5 - mouth / 2, 1},
                                             {0, 1}};
  const auto at = [&](std::size_t i, double z) -> Eigen::Vector3d {
    return {outline[i % 8].x(), outline[i % 8].y(), z};
  };
  Points mesh;
  for (std::size_t i = 0; i < 8; ++i) add_quad(mesh, at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1));
  for (const double z : {0.0, 1.0}) {
    add_quad(mesh, at(0, z), at(1, z), at(4, z), at(5, z));
    add_quad(mesh, at(1, z), at(2, z), at(3, z), at(4, z));
    add_quad(mesh, at(0, z), at(5, z), at(6, z), at(7, z));
  }
  return mesh;
}

/// By how often a ray leaves through a triangle; not for points on the surface.
bool is_enclosed(const Points& mesh, const Eigen::Vector3d& point) {
  const Eigen::Vector3d way = Eigen::Vector3d(0.5113, 0.3371, 0.7907).normalized();
  int crossings = 0;
  for (std::size_t i = 0; i < mesh.size(); i += 3) {
    const Eigen::Vector3d e1 = mesh[i + 1] - mesh[i], e2 = mesh[i + 2] - mesh[i], p = way.cross(e2);
    const double det = e1.dot(p);
    if (std::abs(det) < 1e-15) continue;
    const Eigen::Vector3d s = point - mesh[i], q = s.cross(e1);
    const double u = s.dot(p) / det, v = way.dot(q) / det;
    crossings += u >= 0 && v >= 0 && u + v <= 1 && e2.dot(q) / det > 0;
  }
  return crossings % 2 == 1;
}

/// Hulls by the planes of their triangles.
class Hulls {
 public:
  explicit Hulls(const std::vector<Points>& hulls) {
    for (const Points& hull : hulls) {
      planes_.emplace_back();
      for (const auto& [a, b, c] : hull_triangles(hull)) {
        const auto at = [&](int i) { return hull[static_cast<std::size_t>(i)]; };
        const Eigen::Vector3d normal = (at(b) - at(a)).cross(at(c) - at(a));
        planes_.back().emplace_back(normal.x(), normal.y(), normal.z(), -normal.dot(at(a)));
      }
      EXPECT_FALSE(planes_.back().empty());
    }
  }
  bool hold(const Eigen::Vector3d& point) const {
    return std::any_of(planes_.begin(), planes_.end(), [&](const auto& planes) {
      return std::all_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
        return plane.dot(point.homogeneous()) <= 1e-9;
      });
    });
  }

 private:
  std::vector<std::vector<Eigen::Vector4d>> planes_;
};

bool is_held(const std::vector<Points>& hulls, const Eigen::Vector3d& point) {
  return Hulls(hulls).hold(point);
}

double volume(const std::vector<Points>& hulls) {
  double sum = 0.0;
  for (const Points& hull : hulls)
    for (const auto& [a, b, c] : hull_triangles(hull)) {
      const auto at = [&](int i) { return hull[static_cast<std::size_t>(i)]; };
      sum += at(a).dot(at(b).cross(at(c))) / 6.0;
    }
  return sum;
}

Points turned(Points mesh, const Eigen::Matrix3d& turn) {
  for (Eigen::Vector3d& point : mesh) point = turn * point;
  return mesh;
}

/// The corners too, on which planes of cuts lie, and points of the surface.
void expect_contained(const Points& mesh, const std::vector<Points>& pieces, Random& random) {
  const Hulls hulls(pieces);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : mesh) box.extend(point);
  int enclosed = 0;
  for (int i = 0; i < 400; ++i) {
    Eigen::Vector3d point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = random.between(box.min()[axis], box.max()[axis]);
    if (!is_enclosed(mesh, point)) continue;
    ++enclosed;
    EXPECT_TRUE(hulls.hold(point)) << point.transpose();
  }
  EXPECT_GT(enclosed, 10);
  for (std::size_t i = 0; i < mesh.size(); i += 3) {
    const double a = random.between(0, 1), b = random.between(0, 1 - a);
    EXPECT_TRUE(hulls.hold(a * mesh[i] + b * mesh[i + 1] + (1 - a - b) * mesh[i + 2]));
    EXPECT_TRUE(hulls.hold(mesh[i]));
  }
}

TEST(ConvexPieces, TogetherContainWhatTheMeshEnclosesAndAreSmallerThanItsHull) {
  Random random(12);
  for (int trial = 0; trial < trials(2, 12); ++trial) {
    const Eigen::Matrix3d turn =
        trial % 3 == 0
            ? Eigen::Matrix3d::Identity()
            : Eigen::AngleAxisd(random.between(0, 3), random.point(1.0).normalized()).toRotationMatrix();
    for (const Points& mesh : {turned(torus(random, 14, 7), turn), turned(star(random, 9, 6), turn),
                               turned(channel(random.between(0.2, 0.8)), turn)}) {
      const double whole = volume(convex_pieces(mesh, 1));
      double least = whole;
      for (const std::size_t most : {2U, 16U}) {
        const std::vector<Points> hulls = convex_pieces(mesh, most);
        EXPECT_LE(hulls.size(), most);
        EXPECT_LE(volume(hulls), whole * (1 + 1e-9));
        least = std::min(least, volume(hulls));
        expect_contained(mesh, hulls, random);
      }
      EXPECT_LT(least, 0.97 * whole);  // cuts go along axes
    }
  }
}

/// Cubes of a grid of 6 x 6 x 6, whose faces lie in the planes that cut them; some touch by edges and corners
/// alone.
TEST(ConvexPieces, OfCubesWhoseFacesLieInThePlanesOfCutsAllAreContained) {
  constexpr int n = 6;
  Random random(77);
  for (int trial = 0; trial < trials(3, 25); ++trial) {
    const double share = random.between(0.1, 0.9);
    std::vector<bool> cells(n * n * n);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = random.unit() < share;
    const auto is_full = [&](const Eigen::Vector3i& c) {
      return c.minCoeff() >= 0 && c.maxCoeff() < n &&
             cells[static_cast<std::size_t>((c.x() * n + c.y()) * n + c.z())];
    };
    Points mesh;
    std::vector<Eigen::Vector3i> full;
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y)
        for (int z = 0; z < n; ++z) {
          const Eigen::Vector3i cell(x, y, z);
          if (!is_full(cell)) continue;
          full.push_back(cell);
          for (int axis = 0; axis < 3; ++axis)
            for (const int side : {0, 1}) {
              Eigen::Vector3i beside = cell;
              beside[axis] += side == 1 ? 1 : -1;
              if (is_full(beside)) continue;
              const auto at = [&](int u, int v) {
                Eigen::Vector3d corner = cell.cast<double>();
                corner[axis] += side, corner[(axis + 1) % 3] += u, corner[(axis + 2) % 3] += v;
                return corner;
              };
              add_quad(mesh, at(0, 0), at(1, 0), at(1, 1), at(0, 1));
            }
        }
    for (const std::size_t most : {3U, 12U, 40U}) {
      const std::vector<Points> pieces = convex_pieces(mesh, most);
      EXPECT_LE(pieces.size(), most);
      const Hulls hulls(pieces);
      for (const Eigen::Vector3i& cell : full)
        for (int i = 0; i < 12; ++i) {
          const Eigen::Vector3d corner(i & 1, (i >> 1) & 1, (i >> 2) & 1);
          const Eigen::Vector3d inside =
              i < 8 ? corner : Eigen::Vector3d(random.unit(), random.unit(), random.unit());
          EXPECT_TRUE(hulls.hold(cell.cast<double>() + inside)) << trial << ": " << cell.transpose();
        }
    }
  }
}

/// A box has nothing to gain.
TEST(ConvexPieces, OfAConvexMeshThereIsOne) {
  Points box;
  for (const int axis : {0, 1, 2})
    for (const double side : {0.0, 1.0}) {
      const auto at = [&](double u, double v) {
        Eigen::Vector3d point;
        point[axis] = side, point[(axis + 1) % 3] = u, point[(axis + 2) % 3] = v;
        return point;
      };
      add_quad(box, at(0, 0), at(1, 0), at(1, 1), at(0, 1));
    }
  EXPECT_EQ(convex_pieces(box, 16), std::vector<Points>{hull_corners(box)});
}

TEST(ConvexPieces, OfAChannelLeaveItsMouthFree) {
  const std::vector<Points> hulls = convex_pieces(channel(0.5), 8);
  EXPECT_FALSE(is_held(hulls, {0.5, 0.8, 0.5}));
  EXPECT_TRUE(is_held(convex_pieces(channel(0.5), 1), {0.5, 0.8, 0.5}));
  EXPECT_NEAR(volume(hulls), 1 - 0.5 * 0.8, 0.05);
}

/// Two plates are the faces of a solid whose sides nobody drew, or two sheets: nothing says which.
TEST(ConvexPieces, WhatIsNotClosedStaysInOneHull) {
  Points plates;
  for (const double x : {0.0, 1.0}) add_quad(plates, {x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1});
  const std::vector<Points> hulls = convex_pieces(plates, 8);
  ASSERT_EQ(hulls.size(), 1U);
  EXPECT_TRUE(is_held(hulls, {0.5, 0.5, 0.5}));
  Points both = channel(0.5);
  for (Eigen::Vector3d& point : both) point.x() += 5.0;
  both.insert(both.end(), plates.begin(), plates.end());
  const std::vector<Points> mixed = convex_pieces(both, 8);
  EXPECT_TRUE(is_held(mixed, {0.5, 0.5, 0.5}));
  EXPECT_FALSE(is_held(mixed, {5.5, 0.8, 0.5}));
  EXPECT_FALSE(is_held(mixed, {3.0, 0.5, 0.5}));
  EXPECT_EQ(convex_pieces(both, 1).size(), 1U);
  Points open = channel(0.5);
  open.resize(open.size() - 3);  // half of a wall's end
  EXPECT_EQ(convex_pieces(open, 8).size(), 1U);
}

/// No single cut of these saves anything: their halves are as large as they are.
TEST(ConvexPieces, RegularRingsAreOpened) {
  for (const auto& [around, across] : {std::pair{12, 8}, std::pair{60, 24}, std::pair{16, 5}}) {
    Points mesh;
    const auto at = [&, n = around, m = across](int i, int k) -> Eigen::Vector3d {
      const double u = 2 * std::numbers::pi * (i % n) / n, v = 2 * std::numbers::pi * (k % m) / m;
      return {(1 + 0.25 * std::cos(v)) * std::cos(u), (1 + 0.25 * std::cos(v)) * std::sin(u),
              0.25 * std::sin(v)};
    };
    for (int i = 0; i < around; ++i)
      for (int k = 0; k < across; ++k) add_quad(mesh, at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
    Random random(4);
    const std::vector<Points> hulls = convex_pieces(mesh, 8);
    EXPECT_GT(hulls.size(), 2U) << around;
    EXPECT_FALSE(is_held(hulls, Eigen::Vector3d::Zero())) << around << ", " << hulls.size();
    expect_contained(mesh, hulls, random);
  }
}

/// Exporters leave some triangles out.
TEST(ConvexPieces, SmallHolesAreClosed) {
  Random random(8);
  const Points whole = torus(random, 40, 20);
  Points holed;
  for (std::size_t i = 0; i < whole.size(); i += 3)
    if (i % 300 != 0 && i != 303) holed.insert(holed.end(), {whole[i], whole[i + 1], whole[i + 2]});
  const std::vector<Points> hulls = convex_pieces(holed, 16);
  EXPECT_GT(hulls.size(), 4U);
  EXPECT_FALSE(is_held(hulls, Eigen::Vector3d::Zero()));
  const Hulls held(hulls);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d point = random.point(1.3);
    if (!is_enclosed(whole, point) || !is_enclosed(holed, point)) continue;
    EXPECT_TRUE(held.hold(point)) << point.transpose();
  }
}

TEST(ConvexPieces, OfMorePartsThanHullsAreStillAllThere) {
  Random random(3);
  Points mesh;
  for (int i = 0; i < 9; ++i) {
    Points part = channel(0.5);
    for (Eigen::Vector3d& point : part) point += Eigen::Vector3d(2.0 * (i % 3), 2.0 * (i / 3), 0.0);
    mesh.insert(mesh.end(), part.begin(), part.end());
  }
  for (const std::size_t most : {1U, 4U, 9U, 30U}) {
    const std::vector<Points> hulls = convex_pieces(mesh, most);
    EXPECT_LE(hulls.size(), most);
    expect_contained(mesh, hulls, random);
  }
}

}  // namespace convex_pieces_test
}  // namespace clearway
