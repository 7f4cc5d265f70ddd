#include "datasets/cameras/picture_matrices.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace picture_matrices_test {

TEST(PictureMatrices, BelongToThePicturesThatAreCalledAsTheyAre) {
  const TemporaryFolder folder;
  folder.write("000000.txt", "160 0 95.5\n0 150 71.5\n0 0 1\n");
  folder.write("000001.txt", "161 0 95.5\n0 151 71.5\n0 0 1\n");
  EXPECT_TRUE(has_matrix_of(folder.path(), "depth/000000.png"));
  EXPECT_FALSE(has_matrix_of(folder.path(), "depth/000002.png"));
  const ImageSize size{192, 144};
  const auto cameras = cameras_of_matrices(folder.path(), {"000001.png", "000000.png"}, size);
  EXPECT_EQ(cameras, (std::vector<CameraIntrinsics>{{192, 144, 161, 151, 95.5, 71.5, {}},
                                                    {192, 144, 160, 150, 95.5, 71.5, {}}}));
  const auto refusal = [&](const std::optional<ImageSize>& of) {
    return complaint([&] { cameras_of_matrices(folder.path(), {"000000.png"}, of); });
  };
  EXPECT_NE(refusal({}).find("000000.txt' has a matrix alone, of colour pictures whose size is not known"),
            std::string::npos);
  EXPECT_NE(refusal(ImageSize{48, 36}).find("far from the middle of pictures of 48 x 36"), std::string::npos);
  folder.write("000000.txt", "160 0\n");
  EXPECT_NE(refusal(size).find("expected a matrix of 3 or 4 rows"), std::string::npos);
}

}  // namespace picture_matrices_test
}  // namespace clearway
