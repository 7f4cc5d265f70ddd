// Scan graphs against OctoMap's own reader and writer.
#include "datasets/sources/scan_graph.hpp"

#include <gtest/gtest.h>
#include <octomap/ScanGraph.h>
#include <zlib.h>

#include <cmath>
#include <random>
#include <sstream>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace scan_graph_test {

std::vector<Frame> frames_of(FrameSource& source) {
  std::vector<Frame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<Frame> frames_in(const std::filesystem::path& file, const SourceOptions& options = {}) {
  return frames_of(*open_scan_graph(file, options));
}

const CloudFrame& cloud_of(const Frame& frame) { return std::get<CloudFrame>(frame.content); }

/// Scans of random points from random places, with edges between them.
void draw(octomap::ScanGraph& graph, int scans) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> uniform(-3.0F, 3.0F);
  const auto number = [&] { return uniform(engine); };
  for (int i = 0; i < scans; ++i) {
    auto* const points = new octomap::Pointcloud;  // the graph's, from now on
    for (int k = 0; k < 20 + 30 * i; ++k) points->push_back(number(), number(), number());
    graph.addNode(points, octomap::pose6d(number(), number(), number(), number(), number(), number()));
  }
  graph.connectPrevious();
}

void expect_as_octomap_has_it(const std::vector<Frame>& frames, octomap::ScanGraph& graph) {
  ASSERT_EQ(frames.size(), graph.size());
  std::size_t i = 0;
  for (const octomap::ScanNode* node : graph) {
    const CloudFrame& cloud = cloud_of(frames[i++]);
    EXPECT_EQ(cloud.kind, "points");
    ASSERT_EQ(cloud.points.size(), node->scan->size());
    for (std::size_t k = 0; k < cloud.points.size(); ++k) {
      const octomap::point3d there = node->pose.transform((*node->scan)[k]);
      const Eigen::Vector3d here = cloud.world_from_sensor * cloud.points[k].cast<double>();
      EXPECT_LT((here - Eigen::Vector3d(there.x(), there.y(), there.z())).norm(), 1e-5);
    }
    const octomap::point3d origin = node->pose.trans();
    EXPECT_LT(
        (cloud.world_from_sensor.translation() - Eigen::Vector3d(origin.x(), origin.y(), origin.z())).norm(),
        1e-6);
  }
}

std::string gz(const std::string& bytes, const std::filesystem::path& file) {
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(out);
  return file.string();
}

class ScanGraphs : public testing::Test {
 protected:
  /// As OctoMap writes it.
  std::string binary(int scans) {
    octomap::ScanGraph graph;
    draw(graph, scans);
    std::ostringstream out;
    graph.writeBinary(out);
    return out.str();
  }
  TemporaryFolder folder_;
};

TEST_F(ScanGraphs, InBinaryHoldWhatOctoMapWrote) {
  octomap::ScanGraph graph;
  draw(graph, 5);
  const std::string file = folder_.write("walk.graph", binary(5));
  EXPECT_TRUE(is_scan_graph(file));
  const auto source = open_scan_graph(file, {});
  const std::vector<Frame> frames = frames_of(*source);
  expect_as_octomap_has_it(frames, graph);
  EXPECT_EQ(frames.at(2).time, 2.0);
  EXPECT_EQ(frames.at(2).sensor, "walk");
  EXPECT_NE(source->time_caveat().find("holds no times"), std::string::npos);
  EXPECT_FALSE(source->damage());
  EXPECT_TRUE(source->warnings().empty());

  const std::string packed = gz(binary(5), folder_.file("walk2.graph.gz"));
  EXPECT_TRUE(is_scan_graph(packed));
  const std::vector<Frame> unpacked = frames_in(packed);
  expect_as_octomap_has_it(unpacked, graph);
  EXPECT_EQ(unpacked.at(0).sensor, "walk2");
}

TEST_F(ScanGraphs, InTextHoldWhatOctoMapReads) {
  const std::string text =
      "# a comment\n\nNODE 1 2 0.5 0.1 -0.2 1.5\n1 0 0\n 9 9 9\n2.5e-1 -1 1e-50\n# more\n3 3 3 17\r\n"
      "NODE -1 0 0 0 0 -3.1\nNODE 0 0 1 0 0.3 0\n-1 -2 -3";
  const std::string file = folder_.write("walk.log", text);
  ASSERT_TRUE(is_scan_graph(file));
  octomap::ScanGraph graph;
  std::istringstream in(text + "\n");  // OctoMap leaves out a last line without an end
  graph.readPlainASCII(in);
  expect_as_octomap_has_it(frames_in(file), graph);
  expect_as_octomap_has_it(frames_in(folder_.write("text.graph", text)), graph);
  EXPECT_TRUE(is_scan_graph(gz(text, folder_.file("walk.dat.gz"))));
  expect_as_octomap_has_it(frames_in(folder_.file("walk.dat.gz")), graph);
}

TEST_F(ScanGraphs, HavePointsInTheMapWhereTheSetupSaysSo) {
  const std::string file = folder_.write("walk.log", "NODE 1 2 3 0.1 0.2 0.3\n4 5 6\n");
  SourceOptions options;
  options.clouds = CloudFrameOf::map;
  const std::vector<Frame> frames = frames_in(file, options);
  const CloudFrame& cloud = cloud_of(frames.at(0));
  EXPECT_LT((cloud.world_from_sensor * cloud.points.at(0).cast<double>() - Eigen::Vector3d(4, 5, 6)).norm(),
            1e-5);
  EXPECT_EQ(cloud.world_from_sensor.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST_F(ScanGraphs, LeaveOutPointsThatAreNoneAndTellOfAnglesBeyondATurn) {
  const std::string file = folder_.write("walk.log", "NODE 0 0 0 0 0 90\nnan 1 2\n0 0 0\ninf 0 0\n+1 2 3\n");
  const auto source = open_scan_graph(file, {});
  const std::vector<Frame> frames = frames_of(*source);
  EXPECT_EQ(cloud_of(frames.at(0)).points.size(), 1U);
  EXPECT_EQ(cloud_of(frames.at(0)).unusable, 3U);
  ASSERT_EQ(source->warnings().size(), 1U);
  EXPECT_NE(source->warnings().front().find("line 1 has an angle"), std::string::npos);
}

TEST_F(ScanGraphs, ThatAreCutOrNoneGiveWhatCameBeforeAndSayWhere) {
  const std::string whole = binary(4);
  const auto damage_of = [&](const std::string& name, const std::string& bytes, std::size_t scans) {
    const auto source = open_scan_graph(folder_.write(name, bytes), {});
    EXPECT_EQ(frames_of(*source).size(), scans) << name;
    EXPECT_FALSE(source->next());
    return source->damage().value_or("");
  };
  // Edges do not count: without them the graph is whole.
  for (std::size_t size = 0; size < whole.size(); size += 37) {
    const auto source = open_scan_graph(folder_.write("cut.graph", whole.substr(0, size)), {});
    const std::size_t scans = frames_of(*source).size();
    EXPECT_EQ(source->damage().has_value(), scans < 4) << size;
  }
  EXPECT_NE(damage_of("cut.graph", whole.substr(0, 1000), 1)
                .find("node 2 of 4 is cut off; of it the 1 scan before"),
            std::string::npos);
  EXPECT_NE(damage_of("g2o.graph", "VERTEX_SE2 0 1 2 3\nEDGE_SE2 0 1\n", 0).find("nothing of it is used"),
            std::string::npos);
  std::string without_pose = whole;
  const double none = NAN;
  without_pose.replace(8 + 20 * 28 + 4, 8, std::string(reinterpret_cast<const char*>(&none), 8));
  EXPECT_NE(damage_of("nan.graph", without_pose, 0).find("has no pose"), std::string::npos);
  EXPECT_NE(damage_of("a.log", "NODE 0 0 0 0 0 0\n1 2 3\nNODE 1 2\n", 0).find("line 3: expected 'NODE x y z"),
            std::string::npos);
  EXPECT_NE(damage_of("b.log", "NODE 0 0 0 0 0 0\n1 2 3\nNODE 0 0 0 0 0 0\n1 2\n", 1)
                .find("line 4: expected a point"),
            std::string::npos);
  EXPECT_NE(damage_of("c.log", "NODE 0 0 0 0 0 0\n" + std::string(9000, '1'), 0).find("line 2 is no text"),
            std::string::npos);
}

TEST_F(ScanGraphs, AreNotWhatBeginsOtherwise) {
  for (const char* text : {"1 2 3\nNODE 0 0 0 0 0 0\n", "", "NODES 1\n", "# NODE\n"})
    EXPECT_FALSE(is_scan_graph(folder_.write("other.log", text))) << text;
  EXPECT_FALSE(is_scan_graph(folder_.file("missing.graph")));
  EXPECT_FALSE(is_scan_graph(folder_.path()));
}

}  // namespace scan_graph_test
}  // namespace clearway
