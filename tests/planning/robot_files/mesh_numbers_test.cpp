#include "planning/robot_files/mesh_numbers.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>
#include <sstream>

#include "planning/robot_files/mesh_file.hpp"
#include "tests/worlds/mesh_samples.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace mesh_numbers_test {

using Points = std::vector<Eigen::Vector3d>;

class MeshNumbers : public testing::Test {
 protected:
  MeshHull read(const std::string& name, const std::string& content) {
    return read_mesh_hulls({{folder_.write(name, content)}}).at(0);
  }
  std::string failure(const std::string& name, const std::string& content) {
    return read(name, content).failure;
  }
  TemporaryFolder folder_;
  const MeshSample sample_ = ellipsoid(6, 8, {0.1F, 0.2F, 0.3F});
};

double farthest_from(const Points& points, const Points& others) {
  double most = 0.0;
  for (const Eigen::Vector3d& point : points) {
    double nearest = HUGE_VAL;
    for (const Eigen::Vector3d& other : others) nearest = std::min(nearest, (other - point).norm());
    most = std::max(most, nearest);
  }
  return most;
}

/// A number as programs write it, with the zero before the point or without, with a plus, an exponent.
std::string spelt(double value, std::mt19937_64& random) {
  std::array<char, 64> text{};
  const int kind = static_cast<int>(random() % 4);
  std::snprintf(text.data(), text.size(), kind == 1 ? "%.9e" : "%.9f", value);
  std::string word = text.data();
  if (kind == 2 && std::abs(value) < 1.0) word.erase(word.find('0'), 1);  // ".5", "-.5"
  if (kind == 3 && value >= 0.0) word = "+" + word;
  return word;
}

TEST_F(MeshNumbers, ObjectsHoldEveryVertexHoweverItIsSpelt) {
  std::mt19937_64 random(5);
  const Points expected = read("mesh.stl", as_stl(sample_)).corners;
  ASSERT_GT(expected.size(), 20U);
  const std::vector<std::string> behind{"", "", " 1", " .5 1 .5", " 1 0.2 .4 .6"};
  const std::vector<std::string> starts{"\t", " ", " \\\n", "\\\n ", "\\\r\n\\\n\t"};
  for (int trial = 0; trial < 30; ++trial) {
    std::string text = std::string(random() % 2 == 0 ? "" : "\xEF\xBB\xBF") +
                       (random() % 2 == 0 ? "" : "v 0 0 0 # \\\n") +
                       "mtllib C:\\meshes\\\n# ends so, too \\\n\to Thing\n";
    const std::size_t before = text.find("v 0 0 0") == std::string::npos ? 0 : 1;
    for (const Eigen::Vector3f& v : sample_.vertices) {
      text += std::string(random() % 3, ' ') + "v" + starts[random() % starts.size()];
      for (const float value : v) text += spelt(static_cast<double>(value), random) + " ";
      text += behind[random() % behind.size()] + (random() % 4 == 0 ? " # a corner\r\n" : "\n");
      if (random() % 4 == 0) text += "vt .5 .5\nvn 0 0 1\n";
    }
    text += "usemtl red\ns 1\n";
    for (const auto& t : sample_.triangles) {
      text += std::string(random() % 3, ' ') + "f";
      for (const int i : t) {
        const bool from_end = random() % 2 == 0;
        const int index =
            from_end ? i - static_cast<int>(sample_.vertices.size()) : i + 1 + static_cast<int>(before);
        const std::vector<std::string> others{"", "/1", "/1/1", "//1"};
        text += " " + std::to_string(index) + others[random() % others.size()];
        if (&i == &t.back() && random() % 3 == 0) text += "#corner";
      }
      text += "\n";
    }
    const MeshHull hull = read("mesh.obj", text);
    ASSERT_EQ(hull.failure, "") << text.substr(0, 400);
    EXPECT_LT(farthest_from(hull.corners, expected), 1e-6) << trial;
    EXPECT_LT(farthest_from(expected, hull.corners), 1e-6) << trial;
  }
}

TEST_F(MeshNumbers, VerticesOfOtherCountsAndWeightsAreRefusedByTheirLine) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
  for (const char* numbers : {"1 2", "1", "", "1 2 3 1 5", "1 2 3 1 5 6 7 8"})
    EXPECT_NE(failure("m.obj", "v " + std::string(numbers) + "\n" + rest).find("line 1 has a vertex of "),
              std::string::npos)
        << numbers;
  EXPECT_NE(failure("m.obj", rest + "v 1 2 3 \\\n").find("its last line goes on"), std::string::npos);
  EXPECT_NE(failure("m.obj", rest + "v 1 2 3 0.5\n").find("line 5 has a vertex of another weight than 1"),
            std::string::npos);
}

/// What is no word of an .obj may be a vertex whose blank is missing.
TEST_F(MeshNumbers, WordsLikeThoseOfVerticesAndElementsAreRefusedByTheirLine) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
  for (const char* line :
       {"v0 0 5", "v-1 0 5", "V 0 0 5", "v\\ 0 0 5", "vw 0 0 5", "F 1 2 3", "f1 2 3", "p-1", "l\\ 1 2"}) {
    const std::string told = failure("m.obj", rest + line + "\n");
    EXPECT_NE(told.find(std::string("line 5 has '") + line[0]), std::string::npos) << line << ": " << told;
  }
  EXPECT_NE(failure("m.obj", rest + "call other.obj\n").find("line 5 calls another file"), std::string::npos);
  for (const char* line : {"vt 0 0", "vn 0 0 1", "vp 0 0", "parm u 0 1", "lod 1", "o v", "fo 1 2 3", "\\"})
    EXPECT_EQ(failure("m.obj", line + std::string("\n") + rest), "") << line;
}

/// A file that was cut off has lost faces, not the vertices before them.
TEST_F(MeshNumbers, VerticesWithoutAFaceAreOfTheHull) {
  const std::string whole = as_obj(sample_);
  const std::string cut = whole.substr(0, whole.find('\n', whole.find("f ")) + 1);
  EXPECT_LT(farthest_from(read("whole.obj", whole).corners, read("cut.obj", cut).corners), 1e-9);
}

TEST_F(MeshNumbers, LinesOfTextPlyHaveTheNumbersOfTheirProperties) {
  const std::string whole = as_ply(sample_, false);
  const std::size_t line = whole.find('\n', whole.find("end_header")) + 1, end = whole.find('\n', line);
  std::string fewer = whole, more = whole;
  fewer.replace(line, end - line, "0.1 0.2");
  EXPECT_NE(failure("m.ply", fewer).find("numbers, other than its properties"), std::string::npos);
  EXPECT_NE(failure("m.ply", more.insert(end, " 7")).find("other than its properties"), std::string::npos);
}

TEST_F(MeshNumbers, VerticesOfAPlyHaveEachCoordinateOnceInOnePlace) {
  const std::string whole = as_ply(sample_, false), z = "property float z\n";
  const std::string faces = "element face";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = whole;
    return changed.replace(changed.find(from), from.size(), to);
  };
  EXPECT_NE(
      failure("m.ply", with(faces, "element vertex 1\nproperty float x\nproperty float y\n" + z + faces))
          .find("its header has several 'element vertex', expected one"),
      std::string::npos);
  EXPECT_NE(failure("m.ply", with(z, "property float w\n")).find("have no 'property z'"), std::string::npos);
  EXPECT_NE(failure("m.ply", with(z, z + z)).find("have several 'property z'"), std::string::npos);
}

/// The data of a .ply, as text or bytes of either order.
class PlyWriter {
 public:
  explicit PlyWriter(int form) : form_(form) {}
  std::string format() const {
    return form_ == 0 ? "ascii" : form_ == 1 ? "binary_little_endian" : "binary_big_endian";
  }
  template <class Number>
  void add(Number number) {
    if (form_ == 0) {
      std::ostringstream text;
      text.precision(17);
      text << +number << ' ';
      data_ += text.str();
      return;
    }
    std::array<char, sizeof(Number)> bytes{};
    std::memcpy(bytes.data(), &number, bytes.size());
    if (form_ == 2) std::reverse(bytes.begin(), bytes.end());
    data_.append(bytes.data(), bytes.size());
  }
  void end_element() {
    if (form_ == 0) data_ += '\n';
  }
  const std::string& data() const { return data_; }

 private:
  int form_;
  std::string data_;
};

/// A .ply as scanners and programs write them: comments and other elements anywhere, properties in any order.
std::string drawn_ply(const MeshSample& sample, std::mt19937_64& random) {
  PlyWriter out(static_cast<int>(random() % 3));
  const std::vector<std::string> remarks{"", "comment height in metres\n", "obj_info num_cols 4\n"};
  const auto remark = [&] { return remarks[random() % remarks.size()]; };
  std::vector<std::string> elements{"vertex", "face", "sensor", "range_grid"};
  std::shuffle(elements.begin(), elements.end(), random);
  std::vector<std::string> properties{"x", "y", "z", "nx", "red"};
  std::shuffle(properties.begin(), properties.end(), random);
  const bool is_double = random() % 2 == 0;
  std::string header = "ply\nformat " + out.format() + " 1.0\n" + remark();
  for (const std::string& element : elements) {
    const bool is_vertex = element == "vertex", is_face = element == "face";
    const std::size_t count = is_vertex ? sample.vertices.size() : is_face ? sample.triangles.size() : 5;
    header += "element " + element + " " + std::to_string(count) + "\n" + remark();
    if (is_vertex) {
      for (const std::string& name : properties)
        header += std::string("property ") +
                  (name == "red" ? "uchar"
                   : is_double   ? "double"
                                 : "float") +
                  " " + name + "\n" + remark();
    } else if (element == "sensor") {
      header += "property float px\nproperty float py\n" + remark() + "property double pz\n";
    } else {
      header += "property list uchar int vertex_indices\n" + remark();
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (is_vertex) {
        for (const std::string& name : properties) {
          const std::size_t axis = std::string("xyz").find(name);
          const float number = name.size() == 1 ? sample.vertices[i][static_cast<Eigen::Index>(axis)] : 9.0F;
          if (name == "red")
            out.add(std::uint8_t{200});
          else if (is_double)
            out.add(static_cast<double>(number));
          else
            out.add(number);
        }
      } else if (element == "sensor") {
        out.add(1e3F);
        out.add(-2e3F);
        out.add(3e3);
      } else {
        out.add(std::uint8_t{3});
        for (const int corner : sample.triangles[i % sample.triangles.size()]) out.add(std::int32_t{corner});
      }
      out.end_element();
    }
  }
  return header + "end_header\n" + out.data();
}

TEST_F(MeshNumbers, FilesOfPlyHoldEveryVertexWhateverElseTheyHold) {
  std::mt19937_64 random(11);
  MeshSample odd = sample_;
  for (Eigen::Vector3f& vertex : odd.vertices) {  // numbers whose bytes are ends of lines, which assimp eats
    std::uint32_t bits = 0;
    std::memcpy(&bits, &vertex.x(), sizeof bits);
    bits = (bits & 0xffffff00U) | 0x0aU;
    std::memcpy(&vertex.x(), &bits, sizeof bits);
  }
  const Points expected = read("mesh.stl", as_stl(odd)).corners;
  for (int trial = 0; trial < 60; ++trial) {
    const std::string text = drawn_ply(odd, random);
    const MeshHull hull = read("mesh.ply", text);
    ASSERT_EQ(hull.failure, "") << text.substr(0, 500);
    EXPECT_LT(farthest_from(hull.corners, expected), 1e-6) << text.substr(0, 500);
    EXPECT_LT(farthest_from(expected, hull.corners), 1e-6) << text.substr(0, 500);
    const MeshTriangles faces = read_mesh_triangles({folder_.write("mesh.ply", text), {1, 1, 1}});
    ASSERT_EQ(faces.failure, "");
    EXPECT_EQ(faces.corners.size(), 3 * odd.triangles.size());
  }
}

TEST_F(MeshNumbers, APlySaysWhichOfItsNumbersCannotBe) {
  const std::string
      head =
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
          "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n",
      points = "0 0 0\n200000000000000000000e-21 0 0\n0 1 0\n0 0 1\n";
  const MeshHull hull = read("m.ply", head + points + "3 0 1 2\n");
  ASSERT_EQ(hull.failure, "");
  EXPECT_LT(farthest_from({{0.2, 0, 0}}, hull.corners), 1e-7);
  EXPECT_NE(failure("m.ply", head + points + "3 0 1 4\n").find("a face names a vertex that is not there"),
            std::string::npos);
  EXPECT_NE(failure("m.ply", head + points + "3 0 1 -1\n").find("a face names a vertex that is not there"),
            std::string::npos);
  std::string other = head + points + "3 0 1 2\n";
  other.replace(other.find("ascii"), 5, "text");
  EXPECT_NE(failure("m.ply", other), "");
  EXPECT_NE(failure("m.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\n"
                    "property uchar y\nproperty uchar z\nend_header\nabc")
                .find("its vertices have 'x' as a whole number, expected float or double"),
            std::string::npos);
}

/// A .ply counts its faces, so that none can be lost unseen.
TEST_F(MeshNumbers, PointsOfAPlyBesideItsFacesAreNoPartOfTheBody) {
  const std::string far = "9 9 9\n", near = "0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n",
                    head =
                        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                        "property float z\nelement face 2\nproperty list uchar int vertex_indices\n",
                    patches = "element patch 1\nproperty list uchar int corners\n", end = "end_header\n";
  const Points body{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  for (const std::string& text :
       {head + end + near + far + "3 0 1 2\n3 0 2 3\n", head + end + far + near + "3 1 2 3\n3 1 3 4\n"}) {
    const MeshHull hull = read("m.ply", text);
    ASSERT_EQ(hull.failure, "");
    EXPECT_EQ(hull.corners.size(), 4U);
    EXPECT_LT(farthest_from(body, hull.corners), 1e-7);
    EXPECT_EQ(read_mesh_triangles({folder_.write("m.ply", text), {1, 1, 1}}).corners.size(), 6U);
  }
  const std::string holes = "property list uchar int holes\n", textures = "property list uchar float uv\n",
                    edges = "element edge 1\nproperty int vertex1\nproperty int vertex2\n";
  for (const auto& [text, what] :
       {std::pair(head + patches + end + near + far + "3 0 1 2\n3 0 2 3\n4 0 1 2 4\n",
                  "lists that may be faces, too"),
        std::pair(head + edges + end + near + far + "3 0 1 2\n3 0 2 3\n0 4\n", "edges"),
        std::pair(head + holes + end + near + far + "3 0 1 2 1 4\n3 0 2 3 0\n", "other lists of faces")}) {
    const MeshHull all = read("m.ply", text);
    EXPECT_LT(farthest_from({{9, 9, 9}}, all.corners), 1e-6) << what;
  }
  const MeshHull textured =
      read("m.ply", head + textures + end + near + far + "3 0 1 2 2 0.5 0.5\n3 0 2 3 0\n");
  EXPECT_EQ(textured.corners.size(), 4U);
}

/// What is joined to a file, or what its header forgets, is no part of the mesh: nothing may be lost so.
TEST_F(MeshNumbers, DataBehindThoseThatAreCountedIsDamage) {
  const MeshSample other = ellipsoid(3, 4, {1.0F, 1.0F, 1.0F});
  for (const auto& [name, content] : all_mesh_files(sample_)) {
    if (name == "mesh.obj" || name == "mesh.dae") continue;
    EXPECT_EQ(failure(name, content + std::string("\n \n")), "") << name;
    const std::string joined = content + all_mesh_files(other).at(name);
    if (name == "text.stl")  // two solids, both of them read
      EXPECT_EQ(farthest_from(read("other.stl", as_stl(other)).corners, read(name, joined).corners), 0.0);
    else
      EXPECT_NE(failure(name, joined).find("it holds more data than its header says"), std::string::npos)
          << name;
  }
  std::string fewer = as_ply(sample_, false);
  fewer.replace(fewer.find("element face ") + 13, 2, "10");
  EXPECT_NE(failure("m.ply", fewer).find("it holds more data than its header says"), std::string::npos);
  const std::string solid = as_text_stl(sample_), facets = as_text_stl(other);
  const std::string bare =
      facets.substr(facets.find("facet"), facets.find("endsolid") - facets.find("facet"));
  EXPECT_EQ(farthest_from(read("other.stl", as_stl(other)).corners,
                          read("m.stl", solid + bare + "endsolid\n").corners),
            0.0);
}

/// The words of a text .stl as programs write them: letters of either case, lines that end anywhere.
TEST_F(MeshNumbers, TextsOfStlHoldEveryVertexHoweverTheyAreSpelt) {
  std::mt19937_64 random(6);
  const Points expected = read("mesh.stl", as_stl(sample_)).corners;
  const std::vector<std::string> ends{"\n", "\r\n", "\r", "\n\n \t\n"}, joined{" ", "\t", "\n"},
      normals{"0 0 1", "-nan(ind) -nan(ind) -nan(ind)", "1.#IND 1.#QNAN -1.#IND", "nan NaN inf"};
  for (int trial = 0; trial < 30; ++trial) {
    const std::string& end = ends[random() % ends.size()];
    const auto word = [&, is_upper = random() % 2 == 0](std::string text) {
      if (is_upper) std::transform(text.begin(), text.end(), text.begin(), ::toupper);
      return text;
    };
    const auto pause = [&] { return random() % 4 == 0 ? joined[random() % joined.size()] : end; };
    std::string text = std::string(random() % 2 == 0 ? "" : "\xEF\xBB\xBF") + (random() % 2 == 0 ? "" : end) +
                       word("solid") + " facet of vertex 9 9 9" + end;
    for (const auto& triangle : sample_.triangles) {
      text +=
          word("facet normal ") + normals[random() % normals.size()] + pause() + word("outer loop") + pause();
      for (const int i : triangle) {
        text += word("vertex");
        for (const float value : sample_.vertices[static_cast<std::size_t>(i)])
          text += " " + spelt(static_cast<double>(value), random);
        text += pause();
      }
      text += word("endloop") + pause() + word("endfacet") + pause();
      if (random() % 9 == 0)
        text += word("endsolid") + end + (random() % 2 == 0 ? word("solid b") + end : "");
    }
    const MeshHull hull = read("mesh.stl", text + word("endsolid facet") + end);
    ASSERT_EQ(hull.failure, "") << text.substr(0, 400);
    EXPECT_LT(farthest_from(hull.corners, expected), 1e-6) << trial;
    EXPECT_LT(farthest_from(expected, hull.corners), 1e-6) << trial;
  }
}

TEST_F(MeshNumbers, FacetsOfStlAreThreeVerticesEach) {
  const std::string head = "solid\nfacet normal 0 0 1\nouter loop\n", vertex = "vertex 1 2 3\n";
  const std::string tail = "endloop\nendfacet\nendsolid\n";
  EXPECT_NE(failure("m.stl", head + vertex + vertex + tail).find("line 7 ends a facet of 2 vertices"),
            std::string::npos);
  EXPECT_NE(failure("m.stl", head + vertex + vertex + vertex + vertex + tail).find("a facet of 4 vertices"),
            std::string::npos);
  EXPECT_NE(
      failure("m.stl", "solid\n" + vertex + "endsolid\n").find("line 2 has a vertex outside of a facet"),
      std::string::npos);
  EXPECT_NE(failure("m.stl", head + "vertx 1 2 3\n" + tail)
                .find("line 4 has 'vertx', expected a word of a text .stl"),
            std::string::npos);
  const std::string whole = as_text_stl(sample_);
  EXPECT_NE(failure("m.stl", whole.substr(0, whole.rfind("endsolid"))).find("it has no 'endsolid'"),
            std::string::npos);
}

/// assimp reads the numbers up to the first comment.
TEST_F(MeshNumbers, CommentsOfColladaEndNoListOfNumbers) {
  const std::string whole = as_dae(sample_);
  const Points expected = read("m.dae", whole).corners;
  for (const char* list : {"<float_array", "<p>"}) {
    std::string text = whole;
    const std::size_t begin = text.find('>', text.find(list)) + 1;
    text.insert(text.find(' ', begin + 40), "<!-- 1 2 3 -->");
    const MeshHull hull = read("m.dae", text);
    ASSERT_EQ(hull.failure, "");
    EXPECT_EQ(farthest_from(expected, hull.corners), 0.0) << list;
  }
}

TEST_F(MeshNumbers, ColladaFilesThatPlaceNothingOrWhatIsNotThereAreRefused) {
  const std::string whole = as_dae(sample_), instance = "<instance_geometry url='#g'/>";
  const auto with = [&](const std::string& text) {
    std::string changed = whole;
    return changed.replace(changed.find(instance), instance.size(), text);
  };
  EXPECT_EQ(failure("m.dae", with(instance)), "");
  EXPECT_NE(failure("m.dae", with("")), "");
  for (const char* url : {"#g2", "g", "", "other.dae#g"})
    EXPECT_NE(failure("m.dae", with(instance + "<instance_geometry url='" + url + "'/>"))
                  .find("its <instance_geometry> has url"),
              std::string::npos)
        << url;
  EXPECT_NE(failure("m.dae", with("<skew>45 1 0 0 0 1 0</skew>" + instance)).find("<skew>"),
            std::string::npos);
}

TEST_F(MeshNumbers, NodesOfColladaAreInTheFileAndTurnAboutUnitAxes) {
  const std::string whole = as_dae(sample_), instance = "<instance_geometry url='#g'/>";
  const auto with = [&](const std::string& text) {
    std::string changed = whole;
    return changed.replace(changed.find(instance), instance.size(), text);
  };
  for (const char* url : {"#nix", "other.dae#n", ""})
    EXPECT_NE(failure("m.dae", with(instance + "<instance_node url='" + url + "'/>"))
                  .find("its <instance_node> has url"),
              std::string::npos);
  std::mt19937_64 random(6);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d axis(between(-2, 2), between(-2, 2), between(-2, 2));
    const double degrees = between(-180, 180);
    std::ostringstream rotate;
    rotate.precision(17);
    rotate << "<node id='turned'><rotate>" << axis.x() << " " << axis.y() << " " << axis.z() << " " << degrees
           << "</rotate>" << instance << "</node>";
    Points expected;
    for (const Eigen::Vector3d& corner : read("m.stl", as_stl(sample_)).corners)
      expected.push_back(Eigen::AngleAxisd(degrees * 3.14159265358979323846 / 180.0, axis.normalized()) *
                         corner);
    const MeshHull hull = read("m.dae", with(rotate.str()));
    ASSERT_EQ(hull.failure, "");
    EXPECT_LT(farthest_from(hull.corners, expected), 1e-6);
    EXPECT_LT(farthest_from(expected, hull.corners), 1e-6);
  }
}

}  // namespace mesh_numbers_test
}  // namespace clearway
