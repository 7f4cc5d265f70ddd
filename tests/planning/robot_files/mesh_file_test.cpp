#include "planning/robot_files/mesh_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/mesh_samples.hpp"
#include "tests/worlds/mutated_bytes.hpp"

namespace clearway {
namespace mesh_file_test {

namespace fs = std::filesystem;

class MeshFile : public testing::Test {
 protected:
  std::string failure(const std::string& name, const std::string& content,
                      const Eigen::Vector3d& scale = Eigen::Vector3d::Ones()) const {
    const fs::path file = folder_.write(name, content);
    const MeshHull hull = read_mesh_hulls({{file, scale}}).at(0);
    EXPECT_NE(hull.failure.empty(), hull.corners.empty());
    std::string text = hull.failure;
    if (const auto at = text.find(file.string()); at != std::string::npos)
      text.replace(at, file.string().size(), name);
    return text;
  }

  RobotFolder folder_;
  const MeshSample sample_ = ellipsoid(6, 8, {0.1F, 0.2F, 0.3F});
};

/// Whether both hold the same points, to 1 um.
bool are_same_points(std::vector<Eigen::Vector3d> a, std::vector<Eigen::Vector3d> b) {
  const auto holds = [](const std::vector<Eigen::Vector3d>& all, const Eigen::Vector3d& point) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Eigen::Vector3d& p) { return (p - point).norm() < 1e-6; });
  };
  return std::all_of(a.begin(), a.end(), [&](const Eigen::Vector3d& p) { return holds(b, p); }) &&
         std::all_of(b.begin(), b.end(), [&](const Eigen::Vector3d& p) { return holds(a, p); });
}

TEST_F(MeshFile, EveryKindOfFileGivesTheSameHullTimesItsScaleInOneGo) {
  const Eigen::Vector3d scale(0.5, -2.0, 1.0);
  std::vector<Eigen::Vector3d> expected;
  for (const Eigen::Vector3f& v : sample_.vertices) expected.push_back(v.cast<double>().cwiseProduct(scale));
  std::vector<ScaledMesh> meshes;
  for (const auto& [name, content] : all_mesh_files(sample_))
    meshes.push_back({folder_.write(name, content), scale});
  for (const char* name : {"UPPER.STL", "ros.stlb"})
    meshes.push_back({folder_.write(name, as_stl(sample_)), scale});
  meshes.push_back({folder_.write("appended.stl", as_stl(sample_) + "made by a CAD program"), scale});
  const std::vector<MeshHull> hulls = read_mesh_hulls(meshes);
  ASSERT_EQ(hulls.size(), meshes.size());
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    EXPECT_EQ(hulls[i].failure, "");
    EXPECT_TRUE(are_same_points(hulls[i].corners, expected)) << meshes[i].file;
  }
}

TEST_F(MeshFile, FilesThatAreNotWholeSayWhatIsMissing) {
  EXPECT_EQ(failure("m.stl", ""), "'m.stl' is damaged: it is empty");
  EXPECT_EQ(failure("m.dae", "hello"), "'m.dae' is damaged: it cannot be read as .dae: line 1 is not XML");
  std::string fewer = as_stl(sample_);
  --fewer[80];  // how many facets its header counts
  EXPECT_EQ(failure("m.stl", fewer), "'m.stl' is damaged: its header counts other facets than it holds");
  EXPECT_EQ(failure("m.stl", "no mesh"),
            "'m.stl' is damaged: it is neither a binary .stl nor a text that begins with 'solid'");
  EXPECT_EQ(failure("m.obj", "# nothing\n"), "'m.obj' is damaged: it cannot be read as .obj");
  EXPECT_EQ(failure("m.ply", "ply\nformat ascii 1.0\nend_head"),
            "'m.ply' is damaged: its header is cut off or garbled");
  const std::string most =
      "ply\nformat ascii 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 0\n";
  EXPECT_EQ(failure("m.ply", most), "'m.ply' is damaged: it holds fewer elements than its header says");
  for (const std::string kind : {"text.stl", "mesh.stl", "text.ply", "mesh.ply", "mesh.dae"}) {
    const std::string whole = all_mesh_files(sample_).at(kind);
    for (const double part : {0.05, 0.5, 0.9}) {
      const std::string cut =
          whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())));
      EXPECT_NE(failure(kind, cut), "") << kind << " " << part;
    }
  }
}

TEST_F(MeshFile, WrongKindsAndFilesThatAreNoneAreNotOpened) {
  for (const char* name : {"m.glb", "m.GLTF"}) {
    const std::string why = failure(name, "x");
    EXPECT_NE(why.find("is glTF, whose y axis some programs turn to z and others do not"), std::string::npos)
        << why;
  }
  EXPECT_EQ(failure("m.txt", "x"), "m.txt: is not a mesh of a known kind, expected .dae, .obj, .ply or .stl");
  const MeshHull none = read_mesh_hulls({{folder_.path() / "none.stl"}}).at(0);
  EXPECT_NE(none.failure.find("no such mesh file"), std::string::npos);
  EXPECT_FALSE(none.is_damaged);
  const MeshHull device = read_mesh_hulls({{"/dev/zero"}}).at(0);
  EXPECT_NE(device.failure.find("is not a regular file"), std::string::npos);
  EXPECT_TRUE(read_mesh_hulls({}).empty());
}

TEST_F(MeshFile, VerticesThatNoRobotHasAreRefused) {
  const std::string far =
      "'m.obj' is damaged: it has a vertex that is not finite or farther than 1 km from the origin";
  const std::string rest = "v 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(failure("m.obj", "v 1e30 0 0\nf 1 2 3\n" + rest), far);
  EXPECT_EQ(failure("m.obj", "v nan 0 0\n" + rest + "f 1 2 4\n"), far);
  EXPECT_EQ(failure("m.obj", "v 1e999 0 0\n" + rest + "f 1 2 4\n"),
            "'m.obj' is damaged: line 1 has '1e999', expected a number");
  EXPECT_EQ(failure("m.obj", "v 2000 0 0\n" + rest + "f 1 2 4\n"), far);
  EXPECT_EQ(failure("m.obj", "v 2000 0 0\n" + rest + "f 1 2 4\n", {0.001, 0.001, 0.001}), "");
}

TEST_F(MeshFile, ACoordinateThatIsNoNumberIsNamedWithItsLine) {
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string obj = "v 1 0 0\nv 0 -2 0 # back\nv 0 0 +3\nf 1 2 3\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 0 0\n0 -2 0\n0 0 3\n3 0 1 2\n";
  const std::string stl =
      "solid 2m\nfacet normal 0 0 0\n outer loop\n  vertex 1 0 0\n  vertex 0 -2 0\n  vertex 0 0 3\n"
      " endloop\nendfacet\nendsolid 2m\n";
  for (const auto& [name, text, line] :
       {std::tuple("m.obj", obj, "2"), std::tuple("m.ply", ply, "11"), std::tuple("m.stl", stl, "5")}) {
    EXPECT_EQ(failure(name, text), "");
    for (const std::string word : {"-2m", "-2,5", "two", "0x2", "2e"}) {
      EXPECT_EQ(failure(name, with(text, "-2", word)), "'" + std::string(name) + "' is damaged: line " +
                                                           line + " has '" + word + "', expected a number");
    }
  }
  EXPECT_EQ(failure("m.obj", with(obj, "-2 0 # back", "\\\n-2m 0")),
            "'m.obj' is damaged: line 3 has '-2m', expected a number");
  EXPECT_EQ(failure("m.obj", with(obj, "-2 0 # back", "\\\n-2 0")), "");
  EXPECT_EQ(failure("m.obj", "v 1 0 0 1\nv 0 2 0 1\nv 0 0 3 1\nf 1 2 3\n"), "");  // with weights
  EXPECT_EQ(failure("m.ply", with(ply, "3 0 1 2", "3 0 1 2m")),
            "'m.ply' is damaged: line 13 has '2m', expected a number");
  EXPECT_EQ(failure("m.stl", with(stl, "0 -2 0", "0 -2")),
            "'m.stl' is damaged: line 5 has '', expected a number");
}

TEST_F(MeshFile, FlatStraightAndDoubledVerticesHaveHullsToo) {
  for (const std::string& vertices :
       {std::string("v 1 1 1\nv 1 1 1\nv 1 1 1.001\n"), std::string("v 0 0 0\nv 1 0 0\nv 2 0 0\n"),
        std::string(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 3 3 0\nv 4 1 0\nv 5 1 0\nv 1 5 0\n"),
        std::string("v 0 0 0\nv 1e-30 0 0\nv 0 1e-5 0\n")}) {
    EXPECT_EQ(failure("m.obj", vertices + "f 1 2 3\n"), "");
  }
}

TEST_F(MeshFile, AMeshThatShrinksToAPointIsNoBody) {
  const std::string point =
      "' is damaged: its vertices lie in one point, to 0.001 mm, as they are scaled; expected a body of some "
      "extent";
  EXPECT_EQ(failure("m.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), "'m.obj" + point);
  EXPECT_EQ(failure("m.obj", "v 0 0 0\nv 1e-30 0 0\nv 0 9e-7 0\nf 1 2 3\n"), "'m.obj" + point);
  const MeshSample none{std::vector<Eigen::Vector3f>(3, {1.0F, 2.0F, 3.0F}), {{0, 1, 2}}};
  for (const auto& [name, content] : all_mesh_files(none))
    EXPECT_EQ(failure(name, content), "'" + name + point);
  EXPECT_EQ(failure("m.stl", as_stl(sample_), {1e-6, 1e-6, 1e-6}), "'m.stl" + point);
  EXPECT_EQ(failure("m.stl", as_stl(sample_), {1e-6, 1.0, 1e-6}), "");

  std::string dae = as_dae(sample_);
  dae.replace(dae.find("<matrix>1 0 0 0 0 1 0 0 0 0 1"), 29, "<matrix>0 0 0 0 0 0 0 0 0 0 0");
  EXPECT_EQ(failure("m.dae", dae), "'m.dae" + point);
  std::string empty = as_dae(sample_);
  empty.replace(empty.find("stride='3' count='"), 18, "stride='3' count='0' was='");
  EXPECT_EQ(failure("m.dae", empty), "'m.dae' is damaged: it cannot be read as .dae");
  std::string unit = as_dae(sample_);
  unit.replace(unit.find("meter='1'"), 9, "meter='0'");
  const std::string damage = "' is damaged: its <unit> has meter '0', expected metres in [0.000001, 1000]";
  EXPECT_EQ(failure("m.dae", unit), "'m.dae" + damage);
  const fs::path file = folder_.write("m.dae", unit);
  EXPECT_EQ(read_mesh_triangles({file}).failure, "'" + file.string() + damage);
}

TEST_F(MeshFile, WhatAMeshRefersToIsNotRead) {
  const std::string secret = folder_.write("secret.mtl", std::string("newmtl a\n"));
  const std::string obj =
      "mtllib " + secret + "\nmtllib /dev/zero\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(failure("m.obj", obj), "");
  std::string dae = as_dae(sample_);
  dae.replace(
      dae.find("<library_geometries>"), 0,
      "<library_images><image id='i'><init_from>file:///dev/zero</init_from></image></library_images>");
  EXPECT_EQ(failure("m.dae", dae), "");
  const std::string entity = "<?xml version='1.0'?><!DOCTYPE a [<!ENTITY e SYSTEM 'file:///dev/zero'>]>";
  EXPECT_EQ(failure("m.dae", entity + as_dae(sample_).substr(21)), "");
}

TEST_F(MeshFile, AMeshThatEndsItsReaderIsTheOneThatIsNamed) {
  std::string deep = "<COLLADA version='1.4.1'><library_visual_scenes><visual_scene id='s'>";
  for (int i = 0; i < 100'000; ++i) deep += "<node>";
  for (int i = 0; i < 100'000; ++i) deep += "</node>";
  deep += "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
  const fs::path good = folder_.write("good.stl", as_stl(sample_)), bad = folder_.write("bad.dae", deep);
  const std::vector<MeshHull> hulls = read_mesh_hulls({{good}, {bad}, {good}});
  EXPECT_EQ(hulls[0].failure, "");
  EXPECT_TRUE(hulls[1].is_damaged);
  EXPECT_NE(hulls[1].failure.find("bad.dae' is damaged: "), std::string::npos) << hulls[1].failure;
}

/// One change of the kind that disks, cables and people make.
std::string mutated(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
    const std::size_t at = below(text.size());
    switch (below(6)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:
        text.resize(std::max<std::size_t>(at, 1));
        break;
      case 2: {  // another number in place of one
        const std::array<const char*, 8> numbers{"99999999999", "-1", "4294967295", "nan",
                                                 "1e39",        "0",  "-inf",       "1e-320"};
        const std::size_t begin = text.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        text.replace(begin, text.find_first_not_of("0123456789.", begin) - begin,
                     numbers[below(numbers.size())]);
        break;
      }
      case 3: {  // four bytes of a binary file
        const std::array<std::uint32_t, 4> words{0xFFFFFFFFU, 0x7FFFFFFFU, 0U, 0x7F800000U};
        const std::uint32_t word = words[below(words.size())];
        if (at + sizeof(word) <= text.size()) std::memcpy(&text[at], &word, sizeof(word));
        break;
      }
      case 4:  // a piece twice
        text.insert(at, text.substr(below(text.size()), below(200)));
        break;
      default:
        text.erase(at, below(50));
    }
    if (text.empty()) text = "x";
  }
  return text;
}

long largest_child_kilobytes() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return usage.ru_maxrss;
}

/// Of processor time: another program beside this one makes no file slow. Who waits for nothing is ended by
/// the reader's own limit, with a sentence.
double children_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

long own_kilobytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

std::vector<std::string> kinds_of_meshes() {
  std::vector<std::string> kinds;
  for (const auto& [name, content] : all_mesh_files(ellipsoid(6, 8, {0.1F, 0.2F, 0.3F})))
    kinds.push_back(name);
  return kinds;
}

class DamagedMeshFile : public MeshFile, public testing::WithParamInterface<std::string> {};

TEST_P(DamagedMeshFile, EndsInAHullOrASentenceSoonAndInLittleMemory) {
  constexpr std::size_t batch = 25;
  std::mt19937_64 random(7);
  const std::string& name = GetParam();
  const std::string content = all_mesh_files(sample_).at(name);
  const auto count = static_cast<std::size_t>(mutations(50));
  std::size_t hulls = 0, crashes = 0, refused = 0;
  for (std::size_t done = 0; done < count;) {
    std::vector<ScaledMesh> meshes;
    for (std::size_t i = 0; i < std::min(batch, count - done); ++i)
      meshes.push_back({folder_.write(std::to_string(i) + name, mutated(content, random))});
    while (!meshes.empty()) {
      const double begin = children_seconds();
      const std::vector<MeshHull> read = read_mesh_hulls(meshes);
      EXPECT_LT(children_seconds() - begin, 5.0);
      std::size_t known = 0;  // up to the one that ended the child
      for (const MeshHull& hull : read) {
        if (hull.failure.find("a mesh before it") != std::string::npos) break;
        ++known;
        EXPECT_NE(hull.failure.empty(), hull.corners.empty());
        EXPECT_LT(hull.failure.size(), folder_.path().string().size() + 250);
        for (const Eigen::Vector3d& corner : hull.corners) EXPECT_LE(corner.cwiseAbs().maxCoeff(), 1000.0);
        hulls += hull.failure.empty();
        refused += !hull.failure.empty();
        crashes += hull.failure.find("crashed") != std::string::npos;
      }
      ASSERT_GT(known, 0u);
      done += known;
      meshes.erase(meshes.begin(), meshes.begin() + static_cast<std::ptrdiff_t>(known));
    }
  }
  RecordProperty("found", std::to_string(hulls) + " hulls, " + std::to_string(refused) +
                              " refused, of them " + std::to_string(crashes) + " by a crash");
  EXPECT_GT(hulls, 0u);
  EXPECT_GT(refused, 0u);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(largest_child_kilobytes(), own_kilobytes() + (128 + 20) * 1024);
#endif
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedMeshFile, testing::ValuesIn(kinds_of_meshes()));

TEST(FindMesh, NamesOfPackagesAreSearchedUpwardsAndNamesOfNothingRefused) {
  const RobotFolder folder;
  fs::create_directories(folder.path() / "arm/meshes");
  fs::create_directories(folder.path() / "arm/urdf/parts");
  folder.write("arm/meshes/a.stl", "x");
  const fs::path from = folder.path() / "arm/urdf";
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", from), folder.path() / "arm/meshes/a.stl");
  EXPECT_EQ(find_mesh("model://arm/meshes/a.stl", from), folder.path() / "arm/meshes/a.stl");
  EXPECT_EQ(find_mesh("../meshes/a.stl", from), from / "../meshes/a.stl");
  EXPECT_EQ(find_mesh("file:///x/a.stl", from), "/x/a.stl");
  EXPECT_THROW(find_mesh("package://", from), std::invalid_argument);
  EXPECT_THROW(find_mesh("package://arm", from), std::invalid_argument);
  EXPECT_THROW(find_mesh("package:///a.stl", from), std::invalid_argument);
  EXPECT_THROW(find_mesh("package:///", from), std::invalid_argument);
  folder.write("arm/b.stl", "x");
  folder.write("arm/urdf/parts/c.stl", "x");
  for (const char* name : {"package:///b.stl", "package://b.stl", "model://b.stl"})
    EXPECT_EQ(find_mesh(name, from), folder.path() / "arm/b.stl");
  EXPECT_EQ(find_mesh("package:///parts/c.stl", from), from / "parts/c.stl");
  EXPECT_THROW(find_mesh("package://arm/" + std::string(100'000, 'x'), from), std::invalid_argument);
}

/// As of a URDF that is given by its bare name.
TEST(FindMesh, AnEmptyFolderIsTheOneInWhichTheProgramRuns) {
  const RobotFolder folder;
  fs::create_directories(folder.path() / "arm/meshes");
  fs::create_directories(folder.path() / "arm/urdf/parts");
  folder.write("arm/meshes/a.stl", "x");
  const fs::path before = fs::current_path(), mesh = fs::canonical(folder.path()) / "arm/meshes/a.stl";
  fs::current_path(folder.path() / "arm/urdf");
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", ""), mesh);
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", "."), mesh);
  fs::current_path(folder.path());
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", "arm/urdf"), mesh);
  fs::current_path(before);
}

/// A repository that was unpacked under another name is the package that its package.xml says it is.
TEST(FindMesh, APackageIsKnownByItsPackageXmlToo) {
  const RobotFolder folder;
  fs::create_directories(folder.path() / "arm-main/meshes");
  fs::create_directories(folder.path() / "arm-main/urdf");
  folder.write("arm-main/meshes/a.stl", "x");
  const fs::path from = folder.path() / "arm-main/urdf";
  EXPECT_THROW(find_mesh("package://arm/meshes/a.stl", from), std::invalid_argument);
  folder.write("arm-main/package.xml", "<package><name>armoury</name></package>");
  EXPECT_THROW(find_mesh("package://arm/meshes/a.stl", from), std::invalid_argument);
  folder.write("arm-main/package.xml",
               "<?xml version='1.0'?>\n<package format='2'>\n  <name> arm </name>\n</package>");
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", from), folder.path() / "arm-main/meshes/a.stl");
  EXPECT_EQ(find_mesh("file://meshes/a.stl", from), from / "meshes/a.stl");
}

TEST(FindMesh, APackageXmlThatIsAPipeIsNotWaitedFor) {
  const RobotFolder folder;
  fs::create_directories(folder.path() / "arm-main/meshes");
  folder.write("arm-main/meshes/a.stl", "x");
  const fs::path pipe = folder.path() / "arm-main/package.xml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  try {
    find_mesh("package://arm/meshes/a.stl", folder.path() / "arm-main");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "package '" + pipe.string() + "' cannot be read: it is a pipe, expected a regular file");
  }
}

TEST(FindMesh, PackagesAreFoundWhereTheUserSaysAndWhereRosKeepsThem) {
  const RobotFolder folder;
  const fs::path at = folder.path();
  for (const char* below :
       {"given/meshes", "ws/arm/meshes", "ws/repository/hand/meshes", "ament/share/foot/meshes", "urdf"})
    fs::create_directories(at / below);
  for (const char* file : {"given/meshes/a.stl", "ws/arm/meshes/a.stl", "ws/repository/hand/meshes/a.stl",
                           "ament/share/foot/meshes/a.stl"})
    folder.write(file, "x");
  const fs::path from = at / "urdf";
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", from, {{"arm", at / "given"}}),
            at / "given/meshes/a.stl");
  EXPECT_THROW(find_mesh("package://arm/meshes/b.stl", from, {{"arm", at / "given"}}), std::invalid_argument);
  EXPECT_THROW(find_mesh("package://arm/meshes/a.stl", from), std::invalid_argument);
  ::setenv("ROS_PACKAGE_PATH", ("/no/such:" + (at / "ws").string()).c_str(), 1);
  ::setenv("AMENT_PREFIX_PATH", (at / "ament").c_str(), 1);
  EXPECT_EQ(find_mesh("package://arm/meshes/a.stl", from), at / "ws/arm/meshes/a.stl");
  EXPECT_EQ(find_mesh("package://hand/meshes/a.stl", from), at / "ws/repository/hand/meshes/a.stl");
  EXPECT_EQ(find_mesh("package://foot/meshes/a.stl", from), at / "ament/share/foot/meshes/a.stl");
  ::unsetenv("ROS_PACKAGE_PATH");
  ::unsetenv("AMENT_PREFIX_PATH");
}

TEST(MeshTriangles, AreThoseOfTheFileTimesTheScale) {
  const RobotFolder folder;
  const fs::path file = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const MeshTriangles square = read_mesh_triangles({file, {2.0, 3.0, 1.0}});
  ASSERT_EQ(square.corners.size(), 6U) << square.failure;
  double area = 0.0;
  for (std::size_t i = 0; i < 6; i += 3)
    area +=
        0.5 *
        (square.corners[i + 1] - square.corners[i]).cross(square.corners[i + 2] - square.corners[i]).norm();
  EXPECT_DOUBLE_EQ(area, 6.0);
  EXPECT_NE(read_mesh_triangles({folder.write("b.stl", "no mesh"), {1, 1, 1}}).failure, "");
  EXPECT_NE(read_mesh_triangles({folder.path() / "none.stl", {1, 1, 1}}).failure, "");
}

}  // namespace mesh_file_test
}  // namespace clearway
