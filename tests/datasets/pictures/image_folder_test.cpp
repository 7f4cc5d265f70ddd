#include "datasets/pictures/image_folder.hpp"

#include <gtest/gtest.h>

#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace image_folder_test {

GrayImage shade(int grey) { return {40, 32, std::vector<uint8_t>(40 * 32, static_cast<uint8_t>(grey))}; }

TEST(ImageFolder, GivesEachPictureWithItsTimeItsNameAndTheSetupsCamera) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const char* name : {"2.png", "1.png"}) {
    folder.write(name, png_bytes(shade(name[0])));
    files.push_back(folder / name);
  }
  const CameraIntrinsics camera{40, 32, 50, 51, 20, 16, {}};
  SourceOptions options;
  options.camera = camera;
  const auto source = open_pictures(files, "eye", options);
  for (const char* name : {"1.png", "2.png"}) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->time, name[0] - '0');
    EXPECT_EQ(frame->file, name);
    EXPECT_EQ(frame->sensor, "eye");
    EXPECT_EQ(std::get<ImageFrame>(frame->content).image, shade(name[0]));
    EXPECT_EQ(std::get<ImageFrame>(frame->content).intrinsics, camera);
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->damage());
  EXPECT_EQ(source->progress(), 1.0);
}

TEST(ImageFolder, DamagedPicturesAreReportedAndTheOthersKept) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < 6; ++i) {
    const std::string name = std::to_string(i) + ".png", bytes = png_bytes(shade(i));
    folder.write(name, i == 2 ? bytes.substr(0, bytes.size() / 2) : i == 4 ? "no picture" : bytes);
    files.push_back(folder / name);
  }
  const auto source = open_pictures(files, "eye", {});
  std::vector<double> times;
  while (const auto frame = source->next()) times.push_back(frame->time);
  EXPECT_EQ(times, (std::vector<double>{0, 1, 3, 5}));
  ASSERT_TRUE(source->damage());
  EXPECT_NE(source->damage()->find("2.png' is damaged: "), std::string::npos) << *source->damage();
  EXPECT_NE(source->damage()->find("1 more of 6 pictures"), std::string::npos) << *source->damage();
}

TEST(FilesInChild, AFileThatCrashesOrEatsMemoryCostsItselfAlone) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const char* content : {"fine", "crash", "eat", "fine", "throw", "fine"}) {
    const std::string name = std::to_string(files.size());
    folder.write(name, content);
    files.push_back(folder / name);
  }
  files.push_back(folder / "missing");
  FilesInChild decoded(files, "thing", [](const std::string& bytes, std::size_t) -> decltype(Frame::content) {
    if (bytes == "crash") std::abort();
    if (bytes == "eat") return CommentFrame{std::string(std::size_t{1} << 40U, 'x')};
    if (bytes == "throw") throw std::runtime_error("its reason");
    return CommentFrame{bytes};
  });
  std::vector<std::string> outcomes;
  while (const auto outcome = decoded.next()) {
    const bool whole = outcome->content && std::get<CommentFrame>(*outcome->content).text == "fine";
    outcomes.push_back(whole ? "fine" : outcome->refusal);
  }
  ASSERT_EQ(outcomes.size(), 7U);
  for (const int i : {0, 3, 5}) EXPECT_EQ(outcomes[static_cast<std::size_t>(i)], "fine") << i;
  EXPECT_NE(outcomes[1].find("crashes the decoder"), std::string::npos) << outcomes[1];
  EXPECT_NE(outcomes[2].find("is damaged"), std::string::npos) << outcomes[2];
  EXPECT_NE(outcomes[4].find("is damaged: its reason"), std::string::npos) << outcomes[4];
  EXPECT_NE(outcomes[6].find("cannot be read"), std::string::npos) << outcomes[6];
}

}  // namespace image_folder_test
}  // namespace clearway
