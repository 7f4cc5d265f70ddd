// Every record of a recording that we write has its own checksum; damage costs the records it touches.
#include "datasets/sources/sealed_records.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>

#include "datasets/sources/record_seal.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace sealed_records_test {

constexpr int comments = 40;

/// A recording of comments "0", "1", ... and the places where its members begin.
std::string recording(const TemporaryFolder& folder, std::vector<size_t>& begins) {
  const auto file = folder / "whole.rawlog";
  RecordingWriter writer(file);
  for (int i = 0; i < comments; ++i)
    writer.write(Frame{1000.0 + i, "", CommentFrame{std::to_string(i) + std::string(200, 'x')}});
  writer.finish();
  const std::string bytes = read_file(file);
  for (size_t at = 0; at < bytes.size(); at += seal_of(std::string_view(bytes).substr(at))->size)
    begins.push_back(at);
  return bytes;
}

struct Reading {
  std::vector<int> numbers;
  std::string damage;
  size_t lost = 0;
};

Reading read(const TemporaryFolder& folder, const std::string& bytes) {
  const auto file = folder / "read.rawlog";
  write_file(file, bytes);
  RecordingReader reader(file);
  Reading result;
  while (const auto frame = reader.next()) {
    const std::string& text = std::get<CommentFrame>(frame->content).text;
    result.numbers.push_back(std::stoi(text));
    EXPECT_EQ(text, std::to_string(result.numbers.back()) + std::string(200, 'x'));
  }
  result.damage = reader.damage().value_or("");
  result.lost = reader.counts().lost;
  return result;
}

TEST(SealedRecords, a_whole_recording_is_read_whole_and_ends_with_its_seal) {
  const TemporaryFolder folder;
  std::vector<size_t> begins;
  const Reading whole = read(folder, recording(folder, begins));
  EXPECT_EQ(begins.size(), comments + 1u);
  EXPECT_EQ(whole.numbers.size(), static_cast<size_t>(comments));
  EXPECT_EQ(whole.damage, "");
}

TEST(SealedRecords, a_flipped_bit_costs_one_record_which_is_named_by_number_and_time) {
  const TemporaryFolder folder;
  std::vector<size_t> begins;
  std::string bytes = recording(folder, begins);
  bytes[begins[7] + RecordSeal::header_bytes + 20] ^= 4;
  const Reading reading = read(folder, bytes);
  EXPECT_EQ(reading.numbers.size(), comments - 1u);
  EXPECT_EQ(std::count(reading.numbers.begin(), reading.numbers.end(), 7), 0);
  EXPECT_NE(reading.damage.find("object 8 (at 1007.000 s)"), std::string::npos) << reading.damage;
  EXPECT_EQ(reading.lost, 1u);
}

TEST(SealedRecords, no_flipped_bit_anywhere_is_taken_for_what_was_recorded) {
  const TemporaryFolder folder;
  std::vector<size_t> begins;
  const std::string whole = recording(folder, begins);
  std::mt19937 random(1);
  for (int i = 0; i < 60; ++i) {
    std::string bytes = whole;
    bytes[random() % bytes.size()] ^= static_cast<char>(1U << random() % 8);
    const Reading reading = read(folder, bytes);  // `read` compares each comment with what it was
    EXPECT_GE(reading.numbers.size(), comments - 1u);
    const bool is_whole = reading.numbers.size() == static_cast<size_t>(comments);  // deflate has unused bits
    EXPECT_TRUE(is_whole || !reading.damage.empty());
  }
}

TEST(SealedRecords, missing_doubled_and_cut_off_records_are_noticed_even_between_two_of_them) {
  const TemporaryFolder folder;
  std::vector<size_t> begins;
  const std::string whole = recording(folder, begins);
  const Reading missing = read(folder, whole.substr(0, begins[3]) + whole.substr(begins[5]));
  EXPECT_NE(missing.damage.find("objects 4 to 5 (missing)"), std::string::npos) << missing.damage;
  EXPECT_EQ(missing.numbers.size(), comments - 2u);
  const Reading doubled = read(folder, whole.substr(0, begins[4]) + whole.substr(begins[3]));
  EXPECT_NE(doubled.damage.find("a second object 4"), std::string::npos) << doubled.damage;
  EXPECT_EQ(doubled.numbers.size(), static_cast<size_t>(comments));
  const Reading cut = read(folder, whole.substr(0, begins[10]));
  EXPECT_EQ(cut.numbers.size(), 10u);
  EXPECT_NE(cut.damage.find("cut off"), std::string::npos) << cut.damage;
}

}  // namespace sealed_records_test
}  // namespace clearway
