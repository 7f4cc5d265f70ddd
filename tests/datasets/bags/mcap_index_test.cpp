// Bags listed by their index, against the same bags read as a whole.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <random>

#include "datasets/bags/bag_source.hpp"
#include "datasets/bags/mcap_format.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/bags/sqlite_bag_writer.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace mcap_index_test {

namespace fs = std::filesystem;

/// A bag without its index.
class WithoutIndex final : public MessageBag {
 public:
  explicit WithoutIndex(MessageBag& bag) : bag_(bag) { topics_ = bag.topics(); }
  void visit(const std::vector<bool>& topics, const std::function<bool(const BagMessage&)>& take) override {
    bag_.visit(topics, take);
  }
  std::optional<double> first_time() const override { return bag_.first_time(); }
  std::uint64_t offset() const override { return bag_.offset(); }

 private:
  MessageBag& bag_;
};

std::string text_of(const std::vector<TopicContent>& contents, const std::vector<BagFrame>& frames) {
  std::string text;
  for (const TopicContent& content : contents)
    text += content.frame + ' ' + content.encoding + ' ' + std::to_string(content.recorded.first) + ' ' +
            std::to_string(content.recorded.last) + '\n';
  for (const BagFrame& frame : frames) text += frame.name + ' ' + frame.parent + '\n';
  return text;
}

/// @returns what both say
std::string expect_as_read_whole(MessageBag& bag) {
  EXPECT_TRUE(bag.spans());
  WithoutIndex whole(bag);
  const std::string by_index = text_of(contents_of(bag), frames_of(bag));
  EXPECT_EQ(by_index, text_of(contents_of(whole), frames_of(whole)));
  return by_index;
}

std::string expect_mcap_as_read_whole(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const std::string text = expect_as_read_whole(*open_mcap(descriptor, fs::file_size(file)));
  ::close(descriptor);
  return text;
}

/// Some 10 MB, in several chunks, of images that cannot be packed; "/late" comes in the last one alone.
void write_large(const fs::path& file) {
  worlds::CameraBag bag(file);
  std::mt19937 random(3);
  std::vector<std::uint8_t> pixels(640 * 480);
  for (int i = 0; i < 32; ++i) {
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
    bag.image("/image", 1.0 + i, "camera", "mono8", 640, pixels);
    bag.number("/number", 1.5 + i, 2.0F);
    bag.place(i < 2 ? "base" : "tool", 1.25 + i, {1, 2, 3}, {0, 0, 0, 1});
  }
  bag.image("/late", 40.0, "eye", "16UC1", 2, std::vector<std::uint16_t>{1, 2});
  bag.write();
}

const std::string& recorded(const std::string& name) {
  static std::map<std::string, std::string> files;
  auto& bytes = files[name];
  if (bytes.empty()) bytes = read_file(fs::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/ros/bags" / name);
  return bytes;
}

/// Where the content of the records of a kind lies in an MCAP file.
std::vector<std::size_t> records_of(const std::string& file, mcap::Opcode opcode) {
  std::vector<std::size_t> places;
  for (std::size_t at = mcap::magic.size(); at + 9 < file.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, &file[at + 1], sizeof size);
    if (static_cast<std::uint8_t>(file[at]) == opcode) places.push_back(at + 9);
    if (static_cast<std::uint8_t>(file[at]) == mcap::footer) break;
    at += 9 + size;
  }
  return places;
}

TEST(McapIndex, ListsWhatTheWholeBagHolds) {
  const TemporaryFolder folder;
  for (const char* name : {"cdr_none.mcap", "cdr_lz4.mcap", "cdr_zstd.mcap", "ros1_none.mcap"}) {
    SCOPED_TRACE(name);
    expect_mcap_as_read_whole(folder.write(name, recorded(name)));
  }
  write_large(folder / "large.mcap");
  const std::string text = expect_mcap_as_read_whole(folder / "large.mcap");
  EXPECT_NE(text.find("eye 16UC1 40.0"), std::string::npos) << text;
}

TEST(McapIndex, Ros1AndSqliteBagsAreListedByTheirsAlike) {
  const TemporaryFolder folder;
  write_large(folder / "large.bag");
  write_large(folder / "large.db3");
  EXPECT_EQ(expect_as_read_whole(*open_ros1_bag(folder / "large.bag")),
            expect_as_read_whole(*open_sqlite_bag(folder / "large.db3")));
}

TEST(McapIndex, OfALargeBagOnlyChunksThatAreAskedForAreRead) {
  const TemporaryFolder folder;
  worlds::CameraBag bag(folder / "a.mcap");
  std::mt19937 random(4);
  std::vector<std::uint8_t> pixels(2048 * 1024);
  for (int i = 0; i < 8; ++i) {
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
    bag.image("/image", 1.0 + i, "camera", "mono8", 2048, pixels);
  }
  bag.write();
  std::string bytes = read_file(folder / "a.mcap");
  const auto chunks = records_of(bytes, mcap::chunk);
  ASSERT_GT(chunks.size(), 2U);
  bytes[chunks[1] + 1000] = static_cast<char>(bytes[chunks[1] + 1000] ^ 1);
  const BagListing listing = list_contents(folder.write("flipped.mcap", bytes));
  EXPECT_FALSE(listing.damage) << *listing.damage;
  EXPECT_EQ(listing.contents.at("/image").recorded.last, 8.0);
  const auto statistics = records_of(bytes, mcap::statistics);
  ASSERT_EQ(statistics.size(), 1U);
  bytes[statistics[0] - 9] = '\x7f';  // a kind of record that nobody knows
  const BagListing whole = list_contents(folder.write("without.mcap", bytes));
  ASSERT_TRUE(whole.damage) << "all of it is read";
  EXPECT_EQ(whole.contents.at("/image").frame, "camera");
}

TEST(McapIndex, OneThatPointsElsewhereOrLacksMessagesIsNotBelieved) {
  const TemporaryFolder folder;
  const std::string& whole = recorded("cdr_none.mcap");
  const std::string expected = expect_mcap_as_read_whole(folder.write("a.mcap", whole));
  for (const std::size_t at : records_of(whole, mcap::message_index)) {
    std::string moved = whole, shorter = whole, nameless = whole;
    moved[at + 6 + 8] = static_cast<char>(moved[at + 6 + 8] + 1);  // the offset of its first entry
    EXPECT_EQ(expect_mcap_as_read_whole(folder.write("moved.mcap", moved)), expected);
    shorter[at + 2] = static_cast<char>(shorter[at + 2] - 16);  // one entry
    nameless[at] = '\x55';                                      // a channel that is not there
    for (const std::string& bytes : {shorter, nameless}) {
      const std::string file = folder.write("b.mcap", bytes);
      const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
      const auto bag = open_mcap(descriptor, bytes.size());
      EXPECT_FALSE(bag->spans());
      EXPECT_EQ(text_of(contents_of(*bag), frames_of(*bag)), expected);
      EXPECT_EQ(bag->damage(), "");
      ::close(descriptor);
    }
  }
}

}  // namespace mcap_index_test
}  // namespace clearway
