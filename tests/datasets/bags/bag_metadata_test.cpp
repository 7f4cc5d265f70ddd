#include "datasets/bags/bag_metadata.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace bag_metadata_test {

class BagMetadata : public ::testing::Test {
 protected:
  std::vector<std::string> parts_of(const std::string& text) {
    folder_.write("metadata.yaml", text);
    return listed_parts(folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(BagMetadata, ListsFilesInTheirOrderWithoutFolders) {
  EXPECT_EQ(parts_of("rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: mcap\n"
                     "  relative_file_paths:\n    - walk/walk_0.mcap\n    - walk_10.mcap\n"
                     "  topics_with_message_count:\n    - topic_metadata:\n        name: /tf\n"
                     "        offered_qos_profiles: \"- history: 3\\n  depth: 0\"\n      message_count: 3\n"
                     "  compression_format: \"\"\n  custom_data: ~\n"),
            (std::vector<std::string>{"walk_0.mcap", "walk_10.mcap"}));
  const std::string longest(250, 'a');
  EXPECT_EQ(parts_of("rosbag2_bagfile_information: {relative_file_paths: [" + longest + ".mcap]}"),
            std::vector<std::string>{longest + ".mcap"});
}

TEST_F(BagMetadata, ListsNothingWhereNothingIsListed) {
  EXPECT_TRUE(parts_of("rosbag2_bagfile_information:\n  version: 9\n").empty());
  EXPECT_TRUE(parts_of("other: 3").empty());
  EXPECT_TRUE(parts_of("").empty());
  EXPECT_TRUE(parts_of("rosbag2_bagfile_information: {relative_file_paths: []}").empty());
}

TEST_F(BagMetadata, CompressionIsRefusedByItsModeUnlessFilesLieThereUnpacked) {
  const auto refusal = [&](const std::string& mode, const std::string& format = "zstd") {
    folder_.write("metadata.yaml", "rosbag2_bagfile_information:\n  compression_format: " + format +
                                       "\n  compression_mode: " + mode + "\n");
    return complaint([&] { require_unpacked(folder_.path()); });
  };
  EXPECT_EQ(refusal("\"\""), "");
  EXPECT_NE(refusal("FILE").find("has compressed files ('zstd'), as its metadata.yaml says"),
            std::string::npos);
  EXPECT_NE(refusal("file").find("`zstd -d` of each"), std::string::npos);
  folder_.write("a_0.mcap", "");
  EXPECT_EQ(refusal("FILE"), "");
  EXPECT_EQ(refusal("MESSAGE"), "");
  EXPECT_NE(refusal("MESSAGE", "lz4").find("has compressed messages ('lz4')"), std::string::npos);
}

TEST_F(BagMetadata, WhatIsNoMetadataIsRefusedByName) {
  for (const char* text :
       {"rosbag2_bagfile_information: {relative_file_paths: a.mcap}", "rosbag2_bagfile_information: [1, 2]",
        "[1", "just words", "rosbag2_bagfile_information: {relative_file_paths: [{a: b}]}"}) {
    const std::string sentence = complaint([&] { parts_of(text); });
    EXPECT_NE(sentence.find("metadata.yaml'"), std::string::npos) << text << ": " << sentence;
    EXPECT_NE(sentence.find("expected"), std::string::npos) << text << ": " << sentence;
  }
}

}  // namespace bag_metadata_test
}  // namespace clearway
