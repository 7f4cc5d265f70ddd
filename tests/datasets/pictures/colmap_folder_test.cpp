// Depth pictures beside the model that COLMAP made of their colours.
#include <gtest/gtest.h>

#include <cstdint>

#include "mapping/system/byte_reader.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace colmap_folder_test {

using namespace depth_folders;

using ColmapFolders = DepthFolders;

/// images.bin of level cameras at -x, without points.
std::string colmap_images_bin(const std::vector<std::pair<std::string, double>>& images) {
  std::string bytes;
  put(bytes, std::uint64_t{images.size()});
  for (const auto& [name, x] : images) {
    put(bytes, std::uint32_t{1});
    for (const double value : {1.0, 0.0, 0.0, 0.0, x, 0.0, 0.0}) put(bytes, value);
    put(bytes, std::uint32_t{1});
    bytes += name + '\0';
    put(bytes, std::uint64_t{0});
  }
  return bytes;
}

TEST_F(ColmapFolders, TheModelThatColmapWroteBesideThemPlacesPicturesAndHasTheirCamera) {
  for (const char* name : {"depth", "sparse", "sparse/0"}) make(name);
  folder_.write("depth/b.png", depth_png(10000));
  folder_.write("depth/a.png", depth_png(10000));
  folder_.write("sparse/0/images.txt", "1 1 0 0 0 -4 0 0 1 b.jpg\n\n2 1 0 0 0 -2 0 0 1 a.jpg\n\n");
  folder_.write("sparse/0/cameras.txt", "1 PINHOLE 48 36 50 52 24.5 18.5\n");
  SourceOptions with = options();
  with.depth.pose_scale = 0.5;
  const auto source = open(with);
  for (const double x : {1.0, 2.0}) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_NEAR(std::get<CloudFrame>(frame->content).world_from_sensor.translation().x(), x, 1e-12);
  }
  EXPECT_EQ(depth_layout(folder_.path())->camera, folder_ / "sparse/0/cameras.txt");
  folder_.write("images.txt", "a.png b.png list\n");  // somebody else's
  EXPECT_EQ(depth_layout(folder_.path())->poses, folder_ / "sparse/0/images.txt");
  for (const char* name : {"images", "cameras"})
    std::filesystem::remove(folder_ / ("sparse/0/" + std::string(name) + ".txt"));
  folder_.write("sparse/0/images.bin", colmap_images_bin({{"b.jpg", -4}, {"a.jpg", -2}}));
  folder_.write("sparse/0/cameras.bin", "not looked at here");
  const auto binary = open(with);
  for (const double x : {1.0, 2.0})
    EXPECT_NEAR(std::get<CloudFrame>(binary->next().value().content).world_from_sensor.translation().x(), x,
                1e-12);
  EXPECT_EQ(depth_layout(folder_.path())->camera, folder_ / "sparse/0/cameras.bin");
}

}  // namespace colmap_folder_test
}  // namespace clearway
